/* Runs the parser of Grbl in check mode on a program and measures the time.

     check PASSES FILE    prints bytes, lines, refused lines, CPU seconds of the fastest pass
     check rows FILE      prints number, error code and machine position in mm of every line */
#include <stdio.h>

#include "grbl.h"

#include "program.h"
#include "surroundings.h"

static void tell(size_t number, uint8_t code) {
    const float *at = gc_state.position;
    printf("%zu e%d %.4f %.4f %.4f\n", number, code, at[0], at[1], at[2]);
}

int main(int count, char **arguments) {
    size_t length = 0;
    unsigned char *program = count == 3 ? read_program(arguments[2], &length) : NULL;
    if (!program) {
        fprintf(stderr, "usage: check PASSES|rows FILE, where FILE can be read\n");
        return 2;
    }
    if (!strcmp(arguments[1], "rows")) {
        switch_on();
        take(program, length, tell);
        return 0;
    }
    struct counts counts = {0, 0};
    double best = 1e9;
    for (int passes = atoi(arguments[1]); passes > 0; passes--) {
        switch_on();
        double begin = cpu_seconds();
        counts = take(program, length, NULL);
        double taken = cpu_seconds() - begin;
        if (taken < best) best = taken;
    }
    printf("%zu %zu %zu %.6f\n", length, counts.lines, counts.refused, best);
    return 0;
}
