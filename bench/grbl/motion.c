/* The time of the motion of programs by the planner of Grbl, on the router of
   `husillo-bench --bin motion`. Only the speeds are planned; no step is made.

     motion FILE...    prints file, refused lines, blocks and seconds */
#include <stdio.h>

#include "grbl.h"

#include "program.h"
#include "surroundings.h"

static double minutes;
/* Square of the speed at the end of the last block. */
static double speed_sqr;
static size_t blocks;

/* Takes the first block from the queue. It changes from the speed of the last block to its planned
   end speed with its acceleration, at most at its nominal speed. */
void execute(void) {
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

int main(int count, char **arguments) {
    for (int number = 1; number < count; number++) {
        size_t length;
        unsigned char *program = read_program(arguments[number], &length);
        if (!program) return 2;
        router_on();
        minutes = speed_sqr = blocks = 0;
        struct counts counts = take(program, length, NULL);
        free(program);
        stand();
        printf("%s %zu %zu %.1f\n", arguments[number], counts.refused, blocks, minutes * 60);
    }
    return 0;
}
