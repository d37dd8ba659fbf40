//! The error that remains with compensation, for each cell of the work area.

use super::line_pair::LinePair;
use super::survey::{CELLS, Leftover};
use super::table::{BacklashTable, Map};

/// The remaining error of each cell.
#[derive(Clone, Debug)]
pub struct Field {
    /// Borders of the columns and of the rows, mm.
    pub edges_mm: [Vec<f64>; 2],
    /// Largest signed deviation in each cell, um. Row by row, lowest Y first.
    pub um: Vec<f64>,
    /// Lowest and highest deviation, um.
    pub span_um: [f64; 2],
}

impl Field {
    /// The field of a survey over a travel of X and Y.
    #[must_use]
    pub fn surveyed(left: Leftover, travel_mm: [[f64; 2]; 2]) -> Self {
        Self {
            edges_mm: [0, 1].map(|index| {
                let [low, high] = travel_mm[index];
                let part = |cell| low + (high - low) * cell as f64 / CELLS[index] as f64;
                (0..=CELLS[index]).map(part).collect()
            }),
            um: left.cells_um,
            span_um: left.span_um,
        }
    }

    /// Computes the error that a map leaves at measured pairs of lines. `backlash` has the pairs
    /// and the backlash that each shows, nm. A cell reaches halfway to the next position, and has
    /// the largest error that was measured at its own.
    #[must_use]
    pub fn measured(
        axis: usize,
        table: &BacklashTable,
        backlash: &[(LinePair, f64)],
        map: &Map,
        step_nm: [f64; 3],
        travel_mm: [[f64; 2]; 2],
    ) -> Self {
        let edges = |index: usize| -> Vec<f64> {
            let [low, high] = travel_mm[index];
            let own = table.axes.iter().position(|axis| *axis == index);
            let positions = own.map_or(&[][..], |own| table.positions_mm[own].as_slice());
            let middles = positions.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
            [low].into_iter().chain(middles).chain([high]).collect()
        };
        let edges_mm = [edges(0), edges(1)];
        let [columns, rows] = edges_mm.each_ref().map(|edges| edges.len() - 1);
        let mut um = vec![0.0_f64; columns * rows];
        let mut span_um = [0.0_f64; 2];
        for (pair, nm) in backlash.iter().filter(|(pair, _)| pair.axis == axis) {
            let off = (nm - pair.taken_up_nm(map, step_nm, travel_mm)) / 1e3;
            span_um = [span_um[0].min(off), span_um[1].max(off)];
            let [column, row] = [0, 1].map(|index| {
                let at = pair.position_mm[index].unwrap_or(f64::MIN);
                let inner = &edges_mm[index][1..edges_mm[index].len() - 1];
                inner.partition_point(|edge| *edge <= at)
            });
            let cell = &mut um[row * columns + column];
            if off.abs() > cell.abs() {
                *cell = off;
            }
        }
        Self {
            edges_mm,
            um,
            span_um,
        }
    }
}
