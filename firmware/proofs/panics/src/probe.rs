//! The public functions of `husillo-probe`.

use core::hint::black_box;
use core::iter::Copied;
use core::slice::Iter;

use husillo_probe::{
    Calibration, Circle, Cycle, Debounce, Edge, Latch, Line, Middle, Plan, Plane, PreTravel,
    Repeatability, Request, Sphere, Tip, Touch, UnitVector, corner_nm,
};

/// Points from a buffer.
type Points = Copied<Iter<'static, [i64; 3]>>;
type Touches = Copied<Iter<'static, Touch>>;

/// Keeps every function in the program.
#[unsafe(export_name = "probe")]
pub fn keep() {
    black_box([
        Edge::level as *const (),
        Debounce::new as *const (),
        Debounce::sample as *const (),
        Debounce::level as *const (),
        Debounce::delay_samples as *const (),
        Latch::<[i64; 3], 16>::new as *const (),
        Latch::<[i64; 3], 16>::sample as *const (),
        Latch::<[i64; 3], 16>::level as *const (),
        Latch::<[i32; 1], 5>::new as *const (),
        Latch::<[i32; 1], 5>::sample as *const (),
        Plan::check as *const (),
        Cycle::new as *const (),
        Cycle::tick as *const (),
        Cycle::poll::<fn(Request)> as *const (),
        Cycle::is_over as *const (),
        Cycle::plan as *const (),
    ]);
    black_box([
        UnitVector::new as *const (),
        UnitVector::components as *const (),
        UnitVector::reversed as *const (),
        UnitVector::cosine as *const (),
        UnitVector::scaled as *const (),
        UnitVector::length_along as *const (),
        PreTravel::uniform as *const (),
        PreTravel::<6>::new as *const (),
        PreTravel::<6>::of as *const (),
        PreTravel::<6>::entries as *const (),
        PreTravel::<6>::along as *const (),
        Tip::<6>::surface_nm as *const (),
        Tip::<6>::centre_nm as *const (),
        Tip::<6>::position_nm as *const (),
        Tip::<6>::cosine_error_nm as *const (),
        Repeatability::new as *const (),
        Repeatability::push as *const (),
        Repeatability::readings as *const (),
        Repeatability::mean as *const (),
        Repeatability::range as *const (),
        Repeatability::largest_deviation as *const (),
        Repeatability::standard_deviation as *const (),
        <Repeatability as Extend<i64>>::extend::<Copied<Iter<'static, i64>>> as *const (),
        <Repeatability as FromIterator<i64>>::from_iter::<Copied<Iter<'static, i64>>> as *const (),
    ]);
    black_box([
        Calibration::<6>::fit::<Touches> as *const (),
        Plane::new as *const (),
        Plane::fit::<Points> as *const (),
        Plane::edge::<Points> as *const (),
        Plane::across::<Points> as *const (),
        Plane::distance_nm as *const (),
        Plane::moved_nm as *const (),
        Line::fit::<Points> as *const (),
        Line::distance_nm as *const (),
        Line::crossing_nm as *const (),
        Circle::fit::<Points> as *const (),
        Circle::distance_nm as *const (),
        Circle::grown_nm as *const (),
        Sphere::fit::<Points> as *const (),
        Sphere::distance_nm as *const (),
        Sphere::grown_nm as *const (),
        Middle::of as *const (),
        corner_nm as *const (),
    ]);
}
