/* Puts settings, parameters and parser into the state after power-up, in check mode. */
void switch_on(void);

/* The router of `husillo-bench`, ready to move: 400 steps/mm, 6000 mm/min, 500 mm/s^2, defaults of
   Grbl for corners and arcs. For builds with PLANNED. */
void router_on(void);
