//! Bodies of the fuzz targets as plain functions, called by libFuzzer and by the replay of the
//! corpus on any compiler. Each takes any bytes and panics when an invariant of its crate does not
//! hold.

mod backlash;
mod bytes;
mod closed_loop;
mod contour;
mod drill;
mod excellon;
mod expressions;
mod format;
mod gcode;
mod grbl;
mod grbl_controller;
mod interp;
mod link;
mod machine;
mod microfactory;
mod micromill;
mod mutation;
mod nmc;
mod parameters;
mod planner;
mod reader;
mod servo;
mod stepper;
mod translate;

pub use backlash::backlash;
pub use closed_loop::closed_loop;
pub use contour::contour;
pub use drill::drill;
pub use excellon::excellon;
pub use expressions::expressions;
pub use format::format;
pub use gcode::gcode;
pub use grbl::grbl;
pub use grbl_controller::{grbl_controller, grblhal_controller};
pub use interp::interp;
pub use link::link;
pub use machine::machine;
pub use microfactory::microfactory;
pub use micromill::micromill;
pub use mutation::mutate;
pub use nmc::{nmc_host, nmc_module};
pub use parameters::parameters;
pub use planner::planner;
pub use reader::reader;
pub use servo::servo;
pub use stepper::stepper;
pub use translate::translate;

/// A target: takes any bytes.
pub type Target = fn(&[u8]);

/// Every target with its name, which is also that of its program and of its folder in `corpus`.
pub const TARGETS: [(&str, Target); 24] = [
    ("gcode", gcode),
    ("reader", reader),
    ("format", format),
    ("expressions", expressions),
    ("parameters", parameters),
    ("contour", contour),
    ("translate", translate),
    ("excellon", excellon),
    ("interp", interp),
    ("planner", planner),
    ("stepper", stepper),
    ("backlash", backlash),
    ("machine", machine),
    ("nmc_host", nmc_host),
    ("nmc_module", nmc_module),
    ("servo", servo),
    ("closed_loop", closed_loop),
    ("drill", drill),
    ("grbl", grbl),
    ("grbl_controller", grbl_controller),
    ("grblhal_controller", grblhal_controller),
    ("microfactory", microfactory),
    ("micromill", micromill),
    ("link", link),
];

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use super::TARGETS;

    #[test]
    fn every_input_of_the_corpus_holds_the_invariants() {
        for (name, target) in TARGETS {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("corpus")
                .join(name);
            let mut inputs = 0;
            for entry in fs::read_dir(&folder).expect("a folder of inputs for each target") {
                let path = entry.expect("an entry of the folder").path();
                println!("{}", path.display()); // the last one printed is the one that fails
                target(&fs::read(&path).expect("a file of bytes"));
                inputs += 1;
            }
            assert!(inputs > 0, "no input for {name}");
        }
    }

    #[test]
    fn no_bytes_and_equal_bytes_hold_the_invariants() {
        for (name, target) in TARGETS {
            println!("{name}");
            target(&[]);
            for byte in 0..=255 {
                for length in [1, 8, 64] {
                    target(&vec![byte; length]);
                }
            }
        }
    }
}
