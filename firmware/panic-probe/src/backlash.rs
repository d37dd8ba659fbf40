//! The public functions of `husillo-backlash`.

use core::hint::black_box;

use husillo_backlash::{Backlash, Compensator, Flank, Lash};

/// Keeps every function in the program.
pub fn keep() {
    black_box([
        Flank::towards as *const (),
        Backlash::new as *const (),
        Backlash::motor_target as *const (),
        Backlash::load_position as *const (),
        Backlash::flank as *const (),
        Backlash::lash_steps as *const (),
        <Backlash as Lash>::take_up as *const (),
        <Backlash as Lash>::is_free as *const (),
        Compensator::<3, Backlash>::new as *const (),
        Compensator::<3, Backlash>::before as *const (),
        Compensator::<3, Backlash>::is_straight_on as *const (),
        Compensator::<3, Backlash>::lash as *const (),
        Compensator::<3, Backlash>::lash_mut as *const (),
    ]);
}
