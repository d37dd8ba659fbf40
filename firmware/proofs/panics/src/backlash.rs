//! The public functions of `husillo-backlash`.

use core::hint::black_box;

use husillo_backlash::{
    Backlash, BacklashMap, BacklashModel, Calibration, Compensator, ErrorTable, Flank, Knot,
    MapError, MappedBacklash as AnyMapped, Play, Squareness, TableError,
};

type MappedBacklash = AnyMapped<&'static [i32], &'static [u32]>;

/// Keeps every function in the program.
#[unsafe(export_name = "backlash")]
pub fn keep() {
    black_box([
        Flank::towards as *const (),
        Backlash::new as *const (),
        Backlash::motor_target as *const (),
        Backlash::load_position as *const (),
        Backlash::flank as *const (),
        Backlash::backlash_steps as *const (),
        <Backlash as BacklashModel<3>>::take_up as *const (),
        <Backlash as BacklashModel<3>>::is_free as *const (),
        <Backlash as BacklashModel<3>>::follow as *const (),
        BacklashMap::<&[i32], &[u32]>::new as *const (),
        BacklashMap::<&[i32], &[u32]>::steps as *const (),
        BacklashMap::<&[i32], &[u32]>::axes as *const (),
        BacklashMap::<&[i32], &[u32]>::positions as *const (),
        BacklashMap::<&[i32], &[u32]>::entries as *const (),
        BacklashMap::<&[i32], &[u32]>::is_free as *const (),
        <MapError as core::fmt::Display>::fmt as *const (),
        Play::new as *const (),
        Play::at as *const (),
        <Play as BacklashModel<3>>::take_up as *const (),
        <Play as BacklashModel<3>>::is_free as *const (),
        Play::owed as *const (),
        Play::owes as *const (),
        Play::step as *const (),
        Play::set_behind as *const (),
        Play::set_zero as *const (),
        Play::load as *const (),
        Play::carry as *const (),
        Play::take_up as *const (),
        Play::undo as *const (),
        Play::set_backlash as *const (),
        MappedBacklash::new as *const (),
        MappedBacklash::load_position as *const (),
        MappedBacklash::flank as *const (),
        MappedBacklash::map as *const (),
        <MappedBacklash as BacklashModel<3>>::take_up as *const (),
        <MappedBacklash as BacklashModel<3>>::follow as *const (),
        <MappedBacklash as BacklashModel<3>>::is_free as *const (),
        Compensator::<3, MappedBacklash>::before as *const (),
        Compensator::<3, MappedBacklash>::follow as *const (),
        Compensator::<3, MappedBacklash>::play as *const (),
        Compensator::<3, Backlash>::new as *const (),
        Compensator::<3, Backlash>::before as *const (),
        Compensator::<3, Backlash>::play as *const (),
        Compensator::<3, Backlash>::is_straight_on as *const (),
        Compensator::<3, Backlash>::backlash as *const (),
        Compensator::<3, Backlash>::backlash_mut as *const (),
        ErrorTable::<[Knot; 4]>::new as *const (),
        ErrorTable::<[Knot; 4]>::position_nm as *const (),
        ErrorTable::<[Knot; 4]>::reading_nm as *const (),
        ErrorTable::<[Knot; 4]>::correction_nm as *const (),
        ErrorTable::<[Knot; 4]>::scale_ppb as *const (),
        ErrorTable::<[Knot; 4]>::knots as *const (),
        <TableError as core::fmt::Display>::fmt as *const (),
        Squareness::position_nm as *const (),
        Squareness::reading_nm as *const (),
        Calibration::<&[Knot]>::position_nm as *const (),
        Calibration::<&[Knot]>::reading_nm as *const (),
    ]);
}
