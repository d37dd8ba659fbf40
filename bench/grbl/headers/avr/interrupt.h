/* An interrupt is a function that the test harness calls. Nothing interrupts. */
#define ISR(vector) void vector(void)
#define sei() ((void)0)
#define cli() ((void)0)
