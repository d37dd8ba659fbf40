/* The registers that the step interrupt writes are variables. The parser uses nothing of this
   header. */
#include <stdint.h>

extern volatile uint8_t PORTB, PORTD, DDRB, DDRD;
extern volatile uint8_t TCNT0, TCCR0A, TCCR0B, TIMSK0, TCCR1A, TCCR1B, TIMSK1;
extern volatile uint16_t OCR1A;

enum { CS00, CS01, CS02 };
enum { CS10, CS11, CS12, WGM12, WGM13 };
enum { WGM10, WGM11, COM1B0 = 4, COM1B1, COM1A0, COM1A1 };
enum { TOIE0, OCIE0A, OCIE0B };
enum { TOIE1, OCIE1A, OCIE1B };
