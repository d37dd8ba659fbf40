//! Survey of the error that remains with compensation. The axes move back and forth over the whole
//! work area while the tool is observed.

use super::bench::Bench;

/// Cells of the work area along X and Y. The lines of the survey go through their middles.
pub const CELLS: [usize; 2] = [20, 14];

/// The error that remains on one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Leftover {
    /// Largest signed error in each cell, um. Row by row, lowest Y first.
    pub cells_um: Vec<f64>,
    /// Lowest and highest error anywhere, um.
    pub span_um: [f64; 2],
}

/// Moves along X through the middle of every row of cells and back, then along Y through the middle
/// of every column and back. Returns the errors of X from the rows and those of Y from the columns.
///
/// # Errors
///
/// The machine refuses a move.
pub fn survey(bench: &mut dyn Bench, travel_mm: [[f64; 2]; 2]) -> Result<[Leftover; 2], String> {
    let mut axis_of = |axis: usize| -> Result<Leftover, String> {
        let other = 1 - axis;
        let mut cells = vec![0.0_f64; CELLS[0] * CELLS[1]];
        let mut span = [0.0_f64; 2];
        let [low, high] = travel_mm[axis];
        for line in 0..CELLS[other] {
            let [from, to] = travel_mm[other];
            let at = from + (to - from) * (line as f64 + 0.5) / CELLS[other] as f64;
            let [own, across] = [["X", "Y"], ["Y", "X"]][axis];
            for end in [low, high, low] {
                bench.make(
                    &format!("G0 {own}{end:.4} {across}{at:.4}"),
                    &mut |moment| {
                        if moment.is_take_up {
                            return;
                        }
                        let off = (moment.tool_nm[axis] - moment.sent_nm[axis]) / 1e3;
                        span = [span[0].min(off), span[1].max(off)];
                        let position = [0, 1].map(|index| {
                            let [low, high] = travel_mm[index];
                            let part = (moment.sent_nm[index] / 1e6 - low) / (high - low);
                            ((part * CELLS[index] as f64).max(0.0) as usize).min(CELLS[index] - 1)
                        });
                        let cell = &mut cells[position[1] * CELLS[0] + position[0]];
                        if off.abs() > cell.abs() {
                            *cell = off;
                        }
                    },
                )?;
            }
        }
        Ok(Leftover {
            cells_um: cells,
            span_um: span,
        })
    };
    Ok([axis_of(0)?, axis_of(1)?])
}
