/* On a computer, constants are in ordinary memory. */
#define PROGMEM
#define PSTR(text) (text)
