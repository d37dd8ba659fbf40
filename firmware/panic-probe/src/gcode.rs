//! The public functions of `husillo-gcode`.

use core::hint::black_box;

use fixed::types::I32F32;
use husillo_gcode::excellon::{
    self, Digits, Features, Inference, Lines, Number, Reader, Settings, Tools, Units, WarningKind,
    lines,
};
use husillo_gcode::{
    Block, Blocks, Commands, Decimal, Dialect, ErrorKind, Modal, Plane, Words, words,
};

/// Keeps every function in the program.
pub fn keep() {
    keep_excellon();
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

/// The drill files.
fn keep_excellon() {
    black_box([
        lines as *const (),
        <Lines as Iterator>::next as *const (),
        Inference::new as *const (),
        Inference::observe as *const (),
        Inference::settle as *const (),
        Settings::format as *const (),
        Reader::<8>::new as *const (),
        Reader::<8>::set_tool as *const (),
        Reader::<8>::tools as *const (),
        Reader::<8>::warning as *const (),
        Reader::<8>::is_ended as *const (),
        Reader::<8>::format as *const (),
        Reader::<8>::read as *const (),
        Tools::<8>::get as *const (),
        Tools::<8>::iter as *const (),
        <Features as Iterator>::next as *const (),
        <Features as Iterator>::size_hint as *const (),
        Number::written as *const (),
        Number::has_point as *const (),
        Number::is_zero as *const (),
        Number::has_leading_zero as *const (),
        Number::has_trailing_zero as *const (),
        Number::whole as *const (),
        Number::plain as *const (),
        Number::value as *const (),
        Number::length as *const (),
        Digits::new as *const (),
        Digits::whole as *const (),
        Digits::places as *const (),
        Digits::all as *const (),
        Units::digits as *const (),
        excellon::ErrorKind::code as *const (),
        WarningKind::code as *const (),
    ]);
}
