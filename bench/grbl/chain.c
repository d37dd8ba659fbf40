/* The whole chain of Grbl, from the text of a program to the levels of the step port: its parser,
   its planner, its segments and its step interrupt, on the router of `husillo-bench --bin chain`.

     chain PASSES FILE    prints refused lines, axis steps, CPU seconds of the fastest pass */
#include "stepper.c"

#include <stdio.h>

#include "program.h"
#include "surroundings.h"

static uint64_t steps;

/* Prepares segments, and runs the interrupt until all of them are executed. The count reads the
   levels that the next interrupt writes. */
void execute(void) {
    static const uint8_t axes[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    st_prep_buffer();
    while (segment_buffer_tail != segment_buffer_head) {
        TIMER1_COMPA_vect();
        steps += axes[(st.step_outbits & STEP_MASK) >> X_STEP_BIT];
    }
}

int main(int count, char **arguments) {
    size_t length = 0;
    unsigned char *program = count == 3 ? read_program(arguments[2], &length) : NULL;
    if (!program) {
        fprintf(stderr, "usage: chain PASSES FILE, where FILE can be read\n");
        return 2;
    }
    struct counts counts = {0, 0};
    double best = 1e9;
    for (int passes = atoi(arguments[1]); passes > 0; passes--) {
        steps = 0;
        router_on();
        st_reset();
        st_wake_up();
        double begin = cpu_seconds();
        counts = take(program, length, NULL);
        stand();
        double taken = cpu_seconds() - begin;
        if (taken < best) best = taken;
    }
    printf("%zu %lu %.6f\n", counts.refused, (unsigned long)steps, best);
    return 0;
}
