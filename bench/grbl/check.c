/* Runs the parser of Grbl in check mode on a program and measures the time.

     check PASSES FILE    prints bytes, lines, refused lines, CPU seconds of the fastest pass
     check rows FILE      prints number, error code and machine position in mm of every line */
#include <stdio.h>
#include <time.h>

#include "grbl.h"

#include "surroundings.h"

struct counts {
    size_t lines;
    size_t refused;
};

/* The result of the characters of a line as they arrive. */
enum place { CODE, BRACKETS, REST };

/* Reads a program as Grbl reads it from its serial line: in capitals, without blanks, control
   characters, slashes and comments, at most LINE_BUFFER_SIZE - 1 characters per line. A carriage
   return ends a line too, so CR LF makes two lines. */
static struct counts take(const unsigned char *program, size_t length, int is_told) {
    struct counts counts = {0, 0};
    char line[LINE_BUFFER_SIZE];
    size_t filled = 0;
    enum place place = CODE;
    uint8_t code = STATUS_OK;
    for (const unsigned char *next = program, *end = program + length; next != end; next++) {
        unsigned char byte = *next;
        if (byte == '\n' || byte == '\r') {
            line[filled] = 0;
            if (code == STATUS_OK && filled) code = line[0] == '$' ? STATUS_INVALID_STATEMENT : gc_execute_line(line);
            counts.lines++;
            counts.refused += code != STATUS_OK;
            if (is_told) {
                const float *at = gc_state.position;
                printf("%zu e%d %.4f %.4f %.4f\n", counts.lines, code, at[0], at[1], at[2]);
            }
            filled = 0;
            place = CODE;
            code = STATUS_OK;
        } else if (place != CODE) {
            if (byte == ')' && place == BRACKETS) place = CODE;
        } else if (byte <= ' ' || byte == '/') {
            continue;
        } else if (byte == '(') {
            place = BRACKETS;
        } else if (byte == ';') {
            place = REST;
        } else if (filled == LINE_BUFFER_SIZE - 1) {
            place = REST;
            code = STATUS_OVERFLOW;
        } else {
            line[filled++] = byte >= 'a' && byte <= 'z' ? byte - ('a' - 'A') : byte;
        }
    }
    return counts;
}

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + now.tv_nsec * 1e-9;
}

/* The contents of the file with a line feed at the end, or nothing. */
static unsigned char *read_file(const char *path, size_t *length) {
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END)) return NULL;
    long size = ftell(file);
    rewind(file);
    unsigned char *text = size < 0 ? NULL : malloc((size_t)size + 1);
    if (!text || fread(text, 1, (size_t)size, file) != (size_t)size) return NULL;
    fclose(file);
    *length = (size_t)size;
    if (size && text[size - 1] != '\n') text[(*length)++] = '\n';
    return text;
}

int main(int count, char **arguments) {
    size_t length = 0;
    unsigned char *program = count == 3 ? read_file(arguments[2], &length) : NULL;
    if (!program) {
        fprintf(stderr, "usage: check PASSES|rows FILE, where FILE can be read\n");
        return 2;
    }
    if (!strcmp(arguments[1], "rows")) {
        switch_on();
        take(program, length, 1);
        return 0;
    }
    struct counts counts = {0, 0};
    double best = 1e9;
    for (int passes = atoi(arguments[1]); passes > 0; passes--) {
        switch_on();
        double begin = cpu_seconds();
        counts = take(program, length, 0);
        double taken = cpu_seconds() - begin;
        if (taken < best) best = taken;
    }
    printf("%zu %zu %zu %.6f\n", length, counts.lines, counts.refused, best);
    return 0;
}
