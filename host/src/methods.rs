//! Compares interpolation methods: options, texts and pages of what `husillo_methods` returns.

pub mod compare_page;
mod compare_picture;
pub mod compare_text;
pub mod interpolate;
pub mod one_move;
