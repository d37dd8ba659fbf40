//! Compares interpolation methods: options of `husillo_methods`.

pub mod interpolate;
pub mod one_move;
