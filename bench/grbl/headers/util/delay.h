/* There are no delays in check mode. */
#define _delay_ms(milliseconds) ((void)(milliseconds))
#define _delay_us(microseconds) ((void)(microseconds))
