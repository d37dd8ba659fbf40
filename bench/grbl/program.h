#include <stddef.h>
#include <stdint.h>

/* The file with a line feed at the end, or NULL where it cannot be read. */
unsigned char *read_program(const char *path, size_t *length);

/* The CPU seconds that this process has taken. */
double cpu_seconds(void);

struct counts {
    size_t lines;
    size_t refused;
};

/* Reads a program as Grbl reads it from its serial line: in capitals, without blanks, control
   characters, slashes and comments, at most LINE_BUFFER_SIZE - 1 characters per line. A carriage
   return ends a line too, so CR LF makes two lines. `told` is called after each line with its
   number and its error code, where it is not NULL. */
struct counts take(const unsigned char *program, size_t length, void (*told)(size_t, uint8_t));
