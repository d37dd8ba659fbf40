//! The public functions of `husillo-gcode`.

use core::hint::black_box;

use fixed::types::I32F32;
use husillo_gcode::{
    Block, Blocks, Commands, Decimal, Dialect, ErrorKind, Modal, Plane, Words, words,
};

/// Keeps every function in the program.
pub fn keep() {
    black_box([
        words as *const (),
        Words::is_deleted as *const (),
        <Words as Iterator>::next as *const (),
        Decimal::new as *const (),
        Decimal::digits as *const (),
        Decimal::places as *const (),
        Decimal::is_negative as *const (),
        Decimal::is_zero as *const (),
        Decimal::last_place as *const (),
        Decimal::scaled as *const (),
        Decimal::whole as *const (),
        Decimal::to_fixed::<I32F32> as *const (),
        ErrorKind::code as *const (),
        Dialect::by_name as *const (),
        Dialect::name as *const (),
        Dialect::buffer as *const (),
        Dialect::block_delete as *const (),
        Dialect::with_block_delete as *const (),
        Dialect::blocks as *const (),
        <Blocks as Iterator>::next as *const (),
        Block::parse as *const (),
        Block::word as *const (),
        Block::line_number as *const (),
        Block::is_deleted as *const (),
        Block::is_empty as *const (),
        Plane::axes as *const (),
        Plane::name as *const (),
        Modal::<3>::new as *const (),
        Modal::<3>::plan as *const (),
        Modal::<3>::position as *const (),
        Modal::<3>::set_position as *const (),
        Modal::<3>::stop_outputs as *const (),
        Modal::<3>::work_offset as *const (),
        Modal::<3>::work_system as *const (),
        Modal::<3>::set_work_zero as *const (),
        Modal::<3>::home as *const (),
        Modal::<3>::set_home as *const (),
        Modal::<3>::dialect as *const (),
        Modal::<3>::motion as *const (),
        Modal::<3>::plane as *const (),
        Modal::<3>::units as *const (),
        Modal::<3>::distance as *const (),
        Modal::<3>::centre_distance as *const (),
        Modal::<3>::feed_mode as *const (),
        Modal::<3>::feed as *const (),
        Modal::<3>::spindle as *const (),
        Modal::<3>::coolant as *const (),
        Modal::<3>::tool as *const (),
        Modal::<3>::path as *const (),
        <Commands<3> as Iterator>::next as *const (),
        <Commands<3> as Iterator>::size_hint as *const (),
    ]);
}
