/* Stubs for the functions of Grbl that its parser calls in check mode ($C). Parameters are kept in
   memory instead of the EEPROM; spindle, coolant, probe and reports do nothing. Neither do planner
   and stepper, except in a build with PLANNED and STEPPED. */
#include "grbl.h"

#include "surroundings.h"

settings_t settings;
system_t sys;
int32_t sys_position[N_AXIS];
int32_t sys_probe_position[N_AXIS];
volatile uint8_t sys_probe_state;
volatile uint8_t sys_rt_exec_state;
volatile uint8_t sys_rt_exec_alarm;
volatile uint8_t sys_rt_exec_motion_override;
volatile uint8_t sys_rt_exec_accessory_override;

/* The six frames, then G28 and G30. */
static float kept[(SETTING_INDEX_NCOORD) + 1][N_AXIS];

void switch_on(void) {
    memset(&settings, 0, sizeof settings);
    settings.arc_tolerance = DEFAULT_ARC_TOLERANCE;
    memset(&sys, 0, sizeof sys);
    sys.state = STATE_CHECK_MODE;
    memset(kept, 0, sizeof kept);
    gc_init();
}

#ifdef PLANNED
void router_on(void) {
    switch_on();
    for (int axis = 0; axis < N_AXIS; axis++) {
        settings.steps_per_mm[axis] = 400;
        settings.max_rate[axis] = 6000;
        settings.acceleration[axis] = 500.0 * 60 * 60;
        sys_position[axis] = 0;
    }
    settings.junction_deviation = DEFAULT_JUNCTION_DEVIATION;
    settings.pulse_microseconds = DEFAULT_STEP_PULSE_MICROSECONDS;
    settings.stepper_idle_lock_time = DEFAULT_STEPPER_IDLE_LOCK_TIME;
    sys.state = STATE_IDLE;
    sys.f_override = sys.r_override = sys.spindle_speed_ovr = 100;
    plan_reset();
    plan_sync_position();
}
#endif

#ifdef PLANNED
void stand(void) {
    while (plan_get_current_block()) execute();
}

/* The queue is full, or a line waits for its end. */
void protocol_auto_cycle_start() { execute(); }
void protocol_buffer_synchronize() { stand(); }
void spindle_sync(uint8_t state, float rpm) {
    (void)state, (void)rpm;
    stand();
}
void coolant_sync(uint8_t mode) {
    (void)mode;
    stand();
}
#endif

uint8_t settings_read_coord_data(uint8_t index, float *coordinates) {
    memcpy(coordinates, kept[index], sizeof kept[index]);
    return true;
}
void settings_write_coord_data(uint8_t index, float *coordinates) {
    memcpy(kept[index], coordinates, sizeof kept[index]);
}
void system_convert_array_steps_to_mpos(float *position, int32_t *steps) {
    for (int axis = 0; axis < N_AXIS; axis++) position[axis] = steps[axis];
}
void system_flag_wco_change() { sys.report_wco_counter = 0; }

/* Jogging is a separate command, not part of a program; it is never sent. */
uint8_t jog_execute(plan_line_data_t *data, parser_block_t *block) {
    (void)data, (void)block;
    return STATUS_INVALID_JOG_COMMAND;
}

#ifndef PLANNED
/* Returns at once in check mode. */
void spindle_sync(uint8_t state, float rpm) { (void)state, (void)rpm; }
void coolant_sync(uint8_t mode) { (void)mode; }
void protocol_buffer_synchronize() {}
#endif

/* Messages to the sender; the test harness counts the codes. */
void report_status_message(uint8_t code) { (void)code; }
void report_feedback_message(uint8_t code) { (void)code; }

/* Outside check mode only. */
void spindle_set_state(uint8_t state, float rpm) { (void)state, (void)rpm; }
void coolant_set_state(uint8_t mode) { (void)mode; }
void protocol_execute_realtime() {}
void protocol_exec_rt_system() {}
void system_set_exec_state_flag(uint8_t mask) { sys_rt_exec_state |= mask; }

#ifdef WHOLE_ARCS
/* Replaces motion_control.c: an arc stays one command, as a line does. */
void mc_line(float *target, plan_line_data_t *data) { (void)target, (void)data; }
void mc_arc(float *target, plan_line_data_t *data, float *position, float *offset, float radius, uint8_t axis_0,
            uint8_t axis_1, uint8_t axis_linear, uint8_t is_clockwise) {
    (void)target, (void)data, (void)position, (void)offset, (void)radius;
    (void)axis_0, (void)axis_1, (void)axis_linear, (void)is_clockwise;
}
void mc_dwell(float seconds) { (void)seconds; }
uint8_t mc_probe_cycle(float *target, plan_line_data_t *data, uint8_t flags) {
    (void)target, (void)data, (void)flags;
    return GC_PROBE_CHECK_MODE;
}
#else
/* Outside check mode only, called by motion_control.c. */
void limits_soft_check(float *target) { (void)target; }
void probe_configure_invert_mask(uint8_t is_probe_away) { (void)is_probe_away; }
uint8_t probe_get_state() { return false; }
void report_probe_parameters() {}
void system_set_exec_alarm(uint8_t code) { sys_rt_exec_alarm = code; }
#ifdef PLANNED
/* Called by planner.c and stepper.c. */
uint8_t get_direction_pin_mask(uint8_t axis) { return 1 << (X_DIRECTION_BIT + axis); }
#ifdef STEPPED
volatile uint8_t PORTB, PORTD, DDRB, DDRD;
volatile uint8_t TCNT0, TCCR0A, TCCR0B, TIMSK0, TCCR1A, TCCR1B, TIMSK1;
volatile uint16_t OCR1A;
uint8_t get_step_pin_mask(uint8_t axis) { return 1 << (X_STEP_BIT + axis); }
void probe_state_monitor() {}
uint8_t spindle_compute_pwm_value(float rpm) { return (void)rpm, 0; }
void spindle_set_speed(uint8_t pwm) { (void)pwm; }
#else
void st_reset() {}
void st_update_plan_block_parameters() {}
#endif
#else
void st_reset() {}
void plan_reset() {}
void plan_sync_position() {}
uint8_t plan_check_full_buffer() { return false; }
uint8_t plan_buffer_line(float *target, plan_line_data_t *data) {
    (void)target, (void)data;
    return PLAN_OK;
}
void protocol_auto_cycle_start() {}
#endif
#endif
