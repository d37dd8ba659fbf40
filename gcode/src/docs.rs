//! The pages of the folder `docs` of the package.

#[doc = include_str!("../docs/agreement.md")]
pub mod agreement {}

#[doc = include_str!("../docs/codes.md")]
pub mod codes {}

#[cfg(feature = "extended")]
#[doc = include_str!("../docs/compensation.md")]
pub mod compensation {}

#[doc = include_str!("../docs/cost.md")]
pub mod cost {}

#[doc = include_str!("../docs/dialects.md")]
pub mod dialects {}

#[doc = include_str!("../docs/program.md")]
pub mod program {}

#[doc = include_str!("../docs/text.md")]
pub mod text {}
