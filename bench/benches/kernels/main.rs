//! The kernels of every crate, one group each. The measuring times are short: the whole takes about a minute.
#![allow(missing_docs)] // criterion_group! makes undocumented public items

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};

fn quick() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800))
}

criterion_group!(name = kernels; config = quick(); targets = nothing);
criterion_main!(kernels);
fn nothing(_: &mut Criterion) {}
