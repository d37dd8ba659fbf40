//! Interpolation methods, compared.

mod page;
mod picture;
mod text;

pub use page::html;
pub use text::print;
