/* Puts settings, parameters and parser into the state after power-up, in check mode. */
void switch_on(void);

/* The router of `husillo-bench`, ready to move: 400 steps/mm, 6000 mm/min, 500 mm/s^2, defaults of
   Grbl for corners and arcs. For builds with PLANNED. */
void router_on(void);

/* Executes what is planned, a part at a time. A build with PLANNED has one of its own. */
void execute(void);

/* Executes all that is planned. The axes then stand. */
void stand(void);
