//! The position of the simulated tool after each step, as CSV.

use crate::observers::{Now, Observer};
use husillo_gcode::Axes;
use husillo_machine::Origin;
use std::io::{self, Write};

/// Writes `event,t_us,x_nm,y_nm,z_nm,kind`, one row per step, with further axes after Z. The column
/// of a rotary axis ends with `_udeg` and is in millionths of a degree.
#[derive(Debug)]
pub struct Trace<W> {
    out: W,
    timer_hz: u32,
    axes: usize,
}

impl<W: Write> Trace<W> {
    /// Writes the heading for these axes.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    pub fn new(mut out: W, timer_hz: u32, axes: &Axes) -> io::Result<Self> {
        out.write_all(b"event,t_us")?;
        for (axis, letter) in axes.letters().enumerate() {
            let unit = if axes.is_rotary(axis) { "udeg" } else { "nm" };
            let letter = char::from(letter.to_ascii_lowercase());
            write!(out, ",{letter}_{unit}")?;
        }
        out.write_all(b",kind\n")?;
        let axes = axes.len();
        Ok(Self {
            out,
            timer_hz,
            axes,
        })
    }
}

impl<W: Write> Observer for Trace<W> {
    #[cold]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        let micros = u128::from(now.ticks) * 1_000_000 / u128::from(self.timer_hz);
        let kind = match now.origin {
            Origin::TakeUp => "take-up",
            Origin::Rapid => "rapid",
            Origin::Feed => "feed",
            Origin::Rest => "rest",
        };
        write!(self.out, "{},{micros}", now.event)?;
        for nm in now.tool_nm.iter().take(self.axes) {
            write!(self.out, ",{}", nm.round() as i64)?;
        }
        writeln!(self.out, ",{kind}")
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::now;
    use std::cell::RefCell;
    use std::rc::Rc;

    #[derive(Clone, Default)]
    struct Shared(Rc<RefCell<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.borrow_mut().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn each_step_is_a_row() {
        let out = Shared::default();
        let mut trace = Trace::new(out.clone(), 2_000_000, &Axes::XYZ).unwrap();
        trace.step(&now(1)).unwrap();
        let seen = Now {
            origin: Origin::TakeUp,
            tool_nm: [-139.6, 0.4, -0.4, 0.0, 0.0, 0.0],
            ..now(7)
        };
        trace.step(&seen).unwrap();
        trace.finish().unwrap();
        let text = String::from_utf8(out.0.borrow().clone()).unwrap();
        let rows = "event,t_us,x_nm,y_nm,z_nm,kind\n1,500,1000,0,0,feed\n7,3500,-140,0,0,take-up\n";
        assert_eq!(text, rows);
    }
}
