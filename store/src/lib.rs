#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod store;

mod save;

mod header;
mod unit;

mod error;

pub use error::StoreError;
pub use save::Save;
pub use store::Store;
