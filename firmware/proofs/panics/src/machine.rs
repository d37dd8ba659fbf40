//! The public functions of `husillo-machine`.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_interp::{ArcMove, Path};
use husillo_machine::{
    Axis, ClosedLoop as AnyClosedLoop, Config, Machine as AnyMachine, Means, Motors,
    ServoAxis as AnyServoAxis, StepGuard, extent,
};
use husillo_stepper::{Drive, Levels};

type ServoAxis = AnyServoAxis;
type Machine = AnyMachine<3, Path<3>, Backlash>;
type ClosedLoop = AnyClosedLoop<3, Path<3>, Backlash>;

/// Keeps every function in the program.
#[unsafe(export_name = "machine")]
pub fn keep() {
    black_box([
        Axis::max_feed_nm_per_min as *const (),
        Config::<3>::check as *const (),
        Config::<3>::check_travel as *const (),
        Config::<3>::check_arcs::<fn(&ArcMove) -> bool> as *const (),
        Config::<3>::nearest_steps as *const (),
        Config::<3>::path::<Path<3>> as *const (),
        StepGuard::<3>::new as *const (),
        StepGuard::<3>::rest as *const (),
        StepGuard::<3>::begin::<Path<3>> as *const (),
        StepGuard::<3>::follows as *const (),
        StepGuard::<3>::step as *const (),
        StepGuard::<3>::pass as *const (),
        StepGuard::<3>::stepped_aside as *const (),
        extent::<3> as *const (),
        Means::name as *const (),
        Machine::new as *const (),
        Machine::place as *const (),
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
        Motors::<3, Drive>::new as *const (),
        Motors::<3, Drive>::step::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::rest::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::end_pulses::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::shortest_interval_ticks as *const (),
        Motors::<3, Drive>::set_enabled as *const (),
        Motors::<3, Drive>::levels as *const (),
        Motors::<3, Drive>::was_released as *const (),
    ]);
}
