/* On a computer constants lie where everything lies. */
#define PROGMEM
#define PSTR(text) (text)
