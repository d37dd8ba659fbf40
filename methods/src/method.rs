//! The interpolation methods by name.

use husillo_interp::{
    Arc, ArcDda, ArcError, ArcMove, DirectSearchPrinted, Interpolator, Line, LineDda, Staircase,
    Step,
};

/// Most axes of a line. Missing ones are zero.
pub const AXES: usize = 6;

/// A straight move in steps, or an arc in the first two axes.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A line from zero.
    Line([i32; AXES]),
    /// An arc.
    Arc(ArcMove),
}

/// The fixed properties of a method.
#[derive(Debug)]
pub struct Method {
    /// Its name in commands, JSON and machine files.
    pub name: &'static str,
    /// Whether a pass without a step takes time. Such passes of the printed DDA take none.
    pub times_idle: bool,
    /// Most additions and subtractions, then sign tests, per event with two axes, by the method
    /// alone. The borders of quadrants and the end of the move cost more.
    pub operations: [u32; 2],
    /// Its name in the instruction counts.
    kernel: &'static str,
}

/// Methods for lines.
pub const LINES: [Method; 3] = [
    Method {
        name: "dda-printed",
        times_idle: false,
        operations: [4, 2],
        kernel: "line_dda_printed_2_axes",
    },
    Method {
        name: "dda",
        times_idle: true,
        operations: [4, 2],
        kernel: "line_dda_2_axes",
    },
    Method {
        name: "bresenham",
        times_idle: true,
        operations: [4, 2],
        kernel: "line_2_axes",
    },
];

/// Methods for arcs.
pub const ARCS: [Method; 6] = [
    Method {
        name: "staircase-printed",
        times_idle: true,
        operations: [4, 1],
        kernel: "staircase_printed",
    },
    Method {
        name: "dda-printed",
        times_idle: false,
        operations: [6, 2],
        kernel: "arc_dda_printed",
    },
    Method {
        name: "direct-search-printed",
        times_idle: true,
        operations: [8, 5],
        kernel: "direct_search_printed",
    },
    Method {
        name: "staircase",
        times_idle: true,
        operations: [4, 1],
        kernel: "staircase",
    },
    Method {
        name: "dda",
        times_idle: true,
        operations: [6, 2],
        kernel: "arc_dda",
    },
    Method {
        name: "direct-search",
        times_idle: true,
        operations: [6, 2],
        kernel: "direct_search",
    },
];

/// Columns of the instruction counts: Cortex-M0, Cortex-M4F, RISC-V.
const PROCESSORS: [&str; 3] = ["thumbv6m", "thumbv7em", "rv32imac"];
/// Instructions per event, counted under QEMU for the check of the firmware.
const GOLDEN: &str = include_str!("counts.txt");

/// The events of a move, and the units of their sweep per BLU of path. `None` if every event is one
/// BLU.
pub type Walk = (Box<dyn Iterator<Item = Step>>, Option<f64>);

/// Every method of a shape.
pub const fn of(shape: &Shape) -> &'static [Method] {
    match shape {
        Shape::Line(_) => &LINES,
        Shape::Arc(_) => &ARCS,
    }
}

/// Finds a method by its name.
///
/// # Errors
///
/// The name is unknown. The message lists the known names.
pub fn by_name(
    methods: &'static [Method],
    name: &str,
    shapes: &str,
) -> Result<&'static Method, String> {
    methods
        .iter()
        .find(|method| method.name == name)
        .ok_or_else(|| {
            let names: Vec<_> = methods
                .iter()
                .map(|method| format!("`{}`", method.name))
                .collect();
            format!(
                "unknown method `{name}`; for {shapes} there are {}",
                names.join(", ")
            )
        })
}

impl Method {
    /// The events of a move.
    ///
    /// # Errors
    ///
    /// Why the method cannot make the move.
    pub fn events(&self, shape: &Shape) -> Result<Walk, String> {
        match shape {
            Shape::Line(delta) => self.line(*delta),
            Shape::Arc(arc) => self.arc(arc).map_err(|error| match error {
                ArcError::Centre => "its centre must be a whole step".to_owned(),
                error => error.to_string(),
            }),
        }
    }

    fn line(&self, delta: [i32; AXES]) -> Result<Walk, String> {
        let long = || "the line is 2^31 steps long or longer".to_owned();
        Ok(match self.name {
            "dda-printed" => (Box::new(LineDda::printed(delta).ok_or_else(long)?), None),
            "dda" => (Box::new(LineDda::new(delta).ok_or_else(long)?), None),
            _ => {
                let line = Line::new(delta);
                let square: f64 = delta.iter().map(|d| f64::from(*d).powi(2)).sum();
                let units = line.total_sweep() as f64 / square.sqrt();
                (Box::new(line), Some(units))
            }
        })
    }

    fn arc(&self, arc: &ArcMove) -> Result<Walk, ArcError> {
        Ok(match self.name {
            "staircase-printed" => {
                let events = Staircase::printed(arc)?;
                let units = f64::from(events.radius());
                (Box::new(events), Some(units))
            }
            "staircase" => {
                let events = Staircase::new(arc)?;
                let units = f64::from(events.radius());
                (Box::new(events), Some(units))
            }
            "dda-printed" => (Box::new(ArcDda::printed(arc)?), None),
            "dda" => (Box::new(ArcDda::new(arc)?), None),
            "direct-search-printed" => {
                let events = DirectSearchPrinted::new(arc)?;
                let units = f64::from(events.radius());
                (Box::new(events), Some(units))
            }
            _ => {
                let events = Arc::new(arc)?;
                let units = events.radius() as f64;
                (Box::new(events), Some(units))
            }
        })
    }

    /// Whether it accepts centres between the steps.
    pub fn takes_fractions(&self) -> bool {
        self.name == "direct-search"
    }

    /// Instructions per event on a Cortex-M0, a Cortex-M4F and an RV32IMAC, in this order. `None`
    /// without a count. Direct search with a centre between the steps has a separate count.
    pub fn instructions(&self, is_between: bool) -> [Option<f64>; PROCESSORS.len()] {
        let kernel = if is_between && self.takes_fractions() {
            "arc_32_bits"
        } else {
            self.kernel
        };
        PROCESSORS.map(|processor| instructions(GOLDEN, processor, kernel))
    }
}

/// The entry of a table. Its second line names the columns.
fn instructions(golden: &str, processor: &str, kernel: &str) -> Option<f64> {
    let mut lines = golden.lines().skip(1).map(str::split_whitespace);
    let column = lines.next()?.position(|name| name == processor)?;
    let mut row = lines.find(|row| row.clone().next() == Some(kernel))?;
    row.nth(column)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_counts_are_read() {
        let golden = "rustc 1\nkernel m4 m0\narc 9.00 12.50\n";
        assert_eq!(instructions(golden, "m0", "arc"), Some(12.5));
        assert_eq!(instructions(golden, "m0", "line"), None);
        for method in LINES.iter().chain(&ARCS) {
            assert!(
                method.instructions(true).iter().all(Option::is_some),
                "{}",
                method.name
            );
        }
    }

    #[test]
    fn the_error_of_an_unknown_name_lists_the_known_ones() {
        assert!(
            by_name(&LINES, "ratio", "lines")
                .unwrap_err()
                .contains("`bresenham`")
        );
    }
}
