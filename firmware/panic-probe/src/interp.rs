//! The public functions of `husillo-interp`.

use core::hint::black_box;

use husillo_interp::{Arc, Helix, Interpolator, Line, Moves, Path, Step, fraction_bits_for};

/// Keeps every function in the program.
pub fn keep() {
    black_box([
        fraction_bits_for as *const (),
        Line::<3>::new as *const (),
        Line::<3>::events as *const (),
        Line::<3>::remaining as *const (),
        Line::<3>::total_sweep as *const (),
        Line::<3>::largest_sweep as *const (),
        Step::delta as *const (),
        Step::deltas::<3> as *const (),
        <Line<3> as Iterator>::next as *const (),
        <Line<3> as Iterator>::size_hint as *const (),
        <Line<6> as Iterator>::next as *const (),
        Arc::new as *const (),
        Arc::wide as *const (),
        Arc::events as *const (),
        Arc::is_narrow as *const (),
        Arc::largest_sweep as *const (),
        Arc::quadrants as *const (),
        Arc::radius as *const (),
        Arc::remaining as *const (),
        Arc::sweep_bits as *const (),
        Arc::total_sweep as *const (),
        <Arc as Iterator>::next as *const (),
        <Arc as Iterator>::size_hint as *const (),
        Helix::<3>::new as *const (),
        Helix::<3>::arc as *const (),
        Helix::<3>::events as *const (),
        Helix::<3>::remaining as *const (),
        Helix::<3>::total_sweep as *const (),
        Helix::<3>::largest_sweep as *const (),
        Helix::<3>::radius as *const (),
        <Helix<3> as Iterator>::next as *const (),
        <Helix<3> as Iterator>::size_hint as *const (),
        <Path<3> as Iterator>::next as *const (),
        <Path<3> as Iterator>::size_hint as *const (),
        <Path<3> as Moves<3>>::line as *const (),
        <Path<3> as Moves<3>>::arc as *const (),
        <Path<3> as Interpolator>::remaining as *const (),
        <Path<3> as Interpolator>::total_sweep as *const (),
        <Path<3> as Interpolator>::largest_sweep as *const (),
        <Path<3> as Moves<3>>::radius as *const (),
    ]);
}
