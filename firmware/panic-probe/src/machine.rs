//! The public functions of `husillo-machine`.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_interp::Path;
use husillo_machine::{
    Axis, Cell as AnyCell, CellPair as AnyCellPair, ClosedLoop as AnyClosedLoop, Config,
    Drill as AnyDrill, Machine as AnyMachine, Means, Mill as AnyMill, MillStep, Motors, Scale,
    ServoAxis, ServoModule, servo_law,
};
use husillo_stepper::{Drive, Levels};

type Machine = AnyMachine<3, Path<3>, Backlash>;
type ClosedLoop = AnyClosedLoop<3, Path<3>, Backlash>;
type Cell = AnyCell<&'static [[i16; 2]]>;
type CellPair = AnyCellPair<&'static [[i16; 2]]>;
type Drill = AnyDrill<64>;
type Mill = AnyMill<'static>;

/// Where levels go.
fn show(ticks: u32, levels: &[Levels; 3]) {
    black_box((ticks, levels));
}

fn step(motors: &mut Motors<3, Drive>, wait_ticks: u32, delta: &[i8; 3]) {
    Motors::<3, Drive>::step(motors, wait_ticks, delta, show);
}

fn rest(motors: &mut Motors<3, Drive>, wait_ticks: u32) {
    Motors::<3, Drive>::rest(motors, wait_ticks, show);
}

fn end_pulses(motors: &mut Motors<3, Drive>) {
    Motors::<3, Drive>::end_pulses(motors, show);
}

/// Keeps every function in the program.
#[unsafe(export_name = "machine")]
pub fn keep() {
    black_box([
        Scale::new as *const (),
        Scale::nm as *const (),
        Scale::steps as *const (),
        Scale::nearest as *const (),
        Scale::position as *const (),
        Axis::max_feed_nm_per_min as *const (),
        Config::<3>::check as *const (),
        Means::name as *const (),
        Machine::new as *const (),
        Machine::with_lash as *const (),
        Machine::set_compensation as *const (),
        Machine::line as *const (),
        Machine::poll_line as *const (),
        Machine::block as *const (),
        Machine::has_room as *const (),
        Machine::has_ended as *const (),
        Machine::hold as *const (),
        Machine::resume as *const (),
        Machine::is_held as *const (),
        Machine::set_feed_override as *const (),
        Machine::next_event as *const (),
        Machine::abort as *const (),
        Machine::origin as *const (),
        Machine::executing as *const (),
        Machine::position_steps as *const (),
        Machine::modal as *const (),
        Machine::config as *const (),
        ClosedLoop::new as *const (),
        ClosedLoop::machine as *const (),
        ClosedLoop::machine_mut as *const (),
        ClosedLoop::hold as *const (),
        ClosedLoop::resume as *const (),
        ClosedLoop::abort as *const (),
        ClosedLoop::is_stopped as *const (),
        ClosedLoop::is_correcting as *const (),
        ClosedLoop::next_event as *const (),
        Cell::new as *const (),
        Cell::command as *const (),
        Cell::reset as *const (),
        Cell::is_moving as *const (),
        Cell::is_homed as *const (),
        Cell::position_steps as *const (),
        Cell::status as *const (),
        Cell::figure as *const (),
        Cell::set_figure as *const (),
        Cell::next_event as *const (),
        CellPair::new as *const (),
        CellPair::command as *const (),
        CellPair::next_event as *const (),
        CellPair::is_moving as *const (),
        CellPair::reset as *const (),
        CellPair::cell as *const (),
        CellPair::cell_mut as *const (),
        Mill::halted as *const (),
        Mill::homed as *const (),
        Mill::is_homed as *const (),
        Mill::is_moving as *const (),
        Mill::made as *const (),
        Mill::new as *const (),
        Mill::next_event as *const (),
        Mill::position_steps as *const (),
        Mill::receive as *const (),
        Mill::stops as *const (),
        Mill::will_tell as *const (),
        MillStep::deltas as *const (),
        Mill::transmit as *const (),
        Drill::new as *const (),
        Drill::reset as *const (),
        Drill::push as *const (),
        Drill::transmit as *const (),
        Drill::stored as *const (),
        Drill::position_steps as *const (),
        Drill::is_homed as *const (),
        Drill::is_working as *const (),
        Drill::spindle_turns as *const (),
        Drill::next_event as *const (),
        ServoAxis::new as *const (),
        ServoAxis::set_law as *const (),
        ServoAxis::set_position as *const (),
        ServoAxis::load as *const (),
        ServoAxis::loaded as *const (),
        ServoAxis::is_moving as *const (),
        ServoAxis::start as *const (),
        ServoAxis::stop as *const (),
        ServoAxis::search as *const (),
        ServoAxis::poll_search as *const (),
        ServoAxis::clear as *const (),
        ServoAxis::save_home as *const (),
        ServoAxis::tick as *const (),
        ServoAxis::position as *const (),
        ServoAxis::commanded as *const (),
        ServoAxis::velocity as *const (),
        ServoAxis::error_counts as *const (),
        ServoAxis::home as *const (),
        ServoAxis::inputs as *const (),
        ServoAxis::status as *const (),
        servo_law as *const (),
        ServoModule::new as *const (),
        ServoModule::link as *const (),
        ServoModule::axis as *const (),
        ServoModule::tick as *const (),
        Motors::<3, Drive>::new as *const (),
        step as *const (),
        rest as *const (),
        end_pulses as *const (),
        Motors::<3, Drive>::shortest_interval_ticks as *const (),
        Motors::<3, Drive>::set_enabled as *const (),
        Motors::<3, Drive>::levels as *const (),
        Motors::<3, Drive>::was_released as *const (),
    ]);
}
