/* The time of the motion of programs by the planner of Grbl, on the router of
   `husillo-bench --bin motion`: 400 steps/mm, 6000 mm/min, 500 mm/s^2, defaults of Grbl for corners
   and arcs. Only the speeds are planned; no step is made.

     motion FILE...    prints file, refused lines, blocks and seconds */
#include <stdio.h>

#include "grbl.h"

#include "surroundings.h"

static double minutes;
/* Square of the speed at the end of the last block. */
static double speed_sqr;
static size_t blocks;

/* Takes the first block from the queue. It changes from the speed of the last block to its planned
   end speed with its acceleration, at most at its nominal speed. */
static void execute(void) {
    plan_block_t *block = plan_get_current_block();
    if (!block) return;
    double acceleration = block->acceleration, way = block->millimeters;
    double top = plan_compute_profile_nominal_speed(block);
    double before = sqrt(speed_sqr), after = sqrt(plan_get_exec_block_exit_speed_sqr());
    double peak_sqr = (before * before + after * after) / 2 + acceleration * way;
    double peak = peak_sqr < top * top ? sqrt(peak_sqr) : top;
    double ramps = (2 * peak * peak - before * before - after * after) / (2 * acceleration);
    minutes += (2 * peak - before - after) / acceleration;
    if (way > ramps) minutes += (way - ramps) / peak;
    speed_sqr = after * after;
    blocks++;
    plan_discard_current_block();
}

static void stand(void) {
    while (plan_get_current_block()) execute();
    speed_sqr = 0;
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

static void begin(void) {
    switch_on();
    for (int axis = 0; axis < N_AXIS; axis++) {
        settings.steps_per_mm[axis] = 400;
        settings.max_rate[axis] = 6000;
        settings.acceleration[axis] = 500.0 * 60 * 60;
        sys_position[axis] = 0;
    }
    settings.junction_deviation = DEFAULT_JUNCTION_DEVIATION;
    sys.state = STATE_IDLE;
    sys.f_override = sys.r_override = sys.spindle_speed_ovr = 100;
    minutes = speed_sqr = blocks = 0;
    plan_reset();
    plan_sync_position();
}

/* Removes blanks and comments, and makes capitals. */
static void clean(char *line) {
    char *to = line;
    int is_comment = 0;
    for (const char *next = line; *next && *next != ';'; next++) {
        if (*next == '(') is_comment = 1;
        if (!is_comment && *next > ' ') *to++ = *next >= 'a' && *next <= 'z' ? *next - ('a' - 'A') : *next;
        if (*next == ')') is_comment = 0;
    }
    *to = 0;
}

int main(int count, char **arguments) {
    for (int number = 1; number < count; number++) {
        FILE *file = fopen(arguments[number], "r");
        if (!file) return 2;
        begin();
        char line[256];
        size_t refused = 0;
        while (fgets(line, sizeof line, file)) {
            clean(line);
            refused += *line && gc_execute_line(line) != STATUS_OK;
        }
        fclose(file);
        stand();
        printf("%s %zu %zu %.1f\n", arguments[number], refused, blocks, minutes * 60);
    }
    return 0;
}
