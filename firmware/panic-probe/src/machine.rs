//! The public functions of `husillo-machine`.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_interp::Path;
use husillo_machine::{
    Axis, Cell as AnyCell, ClosedLoop as AnyClosedLoop, Config, Machine as AnyMachine, Means,
    Motors, Scale, ServoAxis, ServoModule,
};
use husillo_stepper::Sequencer;

type Machine = AnyMachine<3, Path<3>, Backlash>;
type ClosedLoop = AnyClosedLoop<3, Path<3>, Backlash>;
type Cell = AnyCell<&'static [[i16; 2]]>;

/// Keeps every function in the program.
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
        Cell::figure as *const (),
        Cell::set_figure as *const (),
        Cell::next_event as *const (),
        ServoAxis::new as *const (),
        ServoAxis::set_law as *const (),
        ServoAxis::set_position as *const (),
        ServoAxis::load as *const (),
        ServoAxis::loaded as *const (),
        ServoAxis::is_moving as *const (),
        ServoAxis::start as *const (),
        ServoAxis::stop as *const (),
        ServoAxis::search as *const (),
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
        ServoModule::new as *const (),
        ServoModule::link as *const (),
        ServoModule::axis as *const (),
        ServoModule::tick as *const (),
        Motors::<3, Sequencer>::new as *const (),
        Motors::<3, Sequencer>::step as *const (),
        Motors::<3, Sequencer>::rest as *const (),
        Motors::<3, Sequencer>::set_enabled as *const (),
        Motors::<3, Sequencer>::levels as *const (),
        Motors::<3, Sequencer>::was_released as *const (),
    ]);
}
