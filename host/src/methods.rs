//! Compares interpolation methods on the bare grid.

pub mod compare;
pub mod compare_page;
pub mod compare_picture;
pub mod compare_text;
pub mod curve;
pub mod decision;
pub mod grid_moves;
pub mod interpolate;
pub mod method;
pub mod trial;
