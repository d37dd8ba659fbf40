/* Puts settings, parameters and parser into the state after power-up, in check mode. */
void switch_on(void);
