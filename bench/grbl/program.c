/* Programs, and the time that they take. */
#include <stdio.h>
#include <time.h>

#include "grbl.h"

#include "program.h"

/* The result of the characters of a line as they arrive. */
enum place { CODE, BRACKETS, REST };

struct counts take(const unsigned char *program, size_t length, void (*told)(size_t, uint8_t)) {
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
            if (told) told(counts.lines, code);
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

double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + now.tv_nsec * 1e-9;
}

unsigned char *read_program(const char *path, size_t *length) {
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
