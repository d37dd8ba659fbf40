//! The public functions of `husillo-encoder`.

use core::convert::Infallible;
use core::hint::black_box;

use husillo_encoder::{
    Byte, Extended, Index, Quadrature, QuadraturePins as AnyPins, SampleError, StepWatch,
    VelocityByCount, VelocityByPeriod, levels, read_running, running_value,
};

use crate::stepper::Pin;

type QuadraturePins = AnyPins<Pin, Pin>;

/// Reads a byte of a counter.
type Port = fn(Byte) -> u8;

/// Keeps every function in the program.
#[unsafe(export_name = "encoder")]
pub fn keep() {
    black_box([
        levels as *const (),
        Quadrature::new as *const (),
        Quadrature::sample as *const (),
        Quadrature::position as *const (),
        Quadrature::set_position as *const (),
        Quadrature::direction as *const (),
        Quadrature::skipped as *const (),
        Quadrature::levels as *const (),
        QuadraturePins::new as *const (),
        QuadraturePins::sample as *const (),
        QuadraturePins::quadrature as *const (),
        QuadraturePins::quadrature_mut as *const (),
        QuadraturePins::release as *const (),
        <SampleError<Infallible> as core::fmt::Display>::fmt as *const (),
        Index::new as *const (),
        Index::sample as *const (),
        Index::set_position as *const (),
        Extended::<8>::new as *const (),
        Extended::<8>::update as *const (),
        Extended::<16>::update as *const (),
        Extended::<32>::update as *const (),
        Extended::<16>::position as *const (),
        Extended::<16>::position_32 as *const (),
        Extended::<16>::set_position as *const (),
        read_running::<Port> as *const (),
        running_value as *const (),
    ]);
    velocity();
    watch();
}

fn watch() {
    black_box([
        StepWatch::new as *const (),
        StepWatch::step as *const (),
        StepWatch::behind as *const (),
        StepWatch::is_tolerable as *const (),
        StepWatch::is_there as *const (),
        StepWatch::steps as *const (),
        StepWatch::legs as *const (),
        StepWatch::accept as *const (),
    ]);
}

fn velocity() {
    black_box([
        VelocityByCount::<10>::new as *const (),
        VelocityByCount::<10>::update as *const (),
        VelocityByCount::<16>::update as *const (),
        VelocityByPeriod::<1>::new as *const (),
        VelocityByPeriod::<1>::update as *const (),
        VelocityByPeriod::<4>::update as *const (),
        VelocityByPeriod::<4>::millicounts_per_s as *const (),
        VelocityByPeriod::<4>::set_position as *const (),
    ]);
}
