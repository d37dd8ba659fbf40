//! Reads, checks and lists machine files.

pub mod backlash_file;
pub mod bytes_file;
pub mod encoder_file;
pub mod listing;
pub mod machine_file;
pub mod new_machine;
pub mod power;
pub mod table;
