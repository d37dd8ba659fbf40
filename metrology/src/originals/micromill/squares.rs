//! Table 14: squares after the first compensation.

use super::cutting::{approach, cut, extent_mm};
use super::measured::{SQUARE_MM, SQUARES, mark_width_um};
use super::{FIRST_TAKE_UP_UM, LEFT_UM, MIDDLE_MM, READING_UM, Settings, Shop, parameters};
use crate::calibration::backlash::Bench;
use crate::originals::{Parameter, Row, Table};

/// A rectangle that was cut.
pub struct Cut {
    /// Length of its upper and of its left edge, mm.
    pub size_mm: [f64; 2],
    /// Distance along X from the start of the lower edge to the end of the upper edge, and distance
    /// along Y from this start to the end of the left edge, um. This is the backlash that remained.
    pub left_um: [f64; 2],
}

/// Cuts the squares with the first take-up of the original, then with the map of today.
///
/// # Errors
///
/// The machine refuses a move.
pub fn squares(shop: &Shop<'_>) -> Result<Table, String> {
    let width_um = mark_width_um();
    let mut rows = Vec::new();
    for square in &SQUARES {
        let middle = [0, 1].map(|axis| MIDDLE_MM[axis] + square.at_mm[axis]);
        let make =
            |settings: &Settings| cut_rectangle(&mut *shop.mill(settings)?, middle, [SQUARE_MM; 2]);
        let original = make(&Settings::original(FIRST_TAKE_UP_UM))?;
        let mapped = make(&shop.today)?;
        for (axis, letter) in ["x", "y"].into_iter().enumerate() {
            let width_mm = width_um / 1e3;
            rows.push(
                Row::new(
                    format!("{}: D{letter}", square.name),
                    "mm",
                    square.size_mm[axis],
                    LEFT_UM[axis] / 1e3 + READING_UM / 1e3,
                )
                .rebuilt(original.size_mm[axis] + width_mm)
                .today(mapped.size_mm[axis] + width_mm, SQUARE_MM + width_mm),
            );
        }
        for (axis, letter) in ["X", "Y"].into_iter().enumerate() {
            rows.push(
                Row::new(
                    format!("{}: left {letter}", square.name),
                    "um",
                    square.left_um[axis],
                    LEFT_UM[axis],
                )
                .rebuilt(original.left_um[axis])
                .today(mapped.left_um[axis], 0.0),
            );
        }
    }
    let mut parameters = parameters(&shop.screws);
    parameters.push(Parameter::new(
        "width of a mark",
        format!("{width_um:.1} um"),
        "fitted: the mean over the twelve lengths of tables 13 and 14",
    ));
    Ok(Table {
        number: "14",
        title: "squares of 2.5 mm with a take-up of 192.5 um in X and 168.5 um in Y",
        spread: "what is left: 33 um in X and 27 um in Y, which is what the original says \
                 remained; sizes: this and 10 um for reading two marks",
        rows,
        parameters,
        notes: vec![
            "The original prints the remaining backlash without sign. Y of square X is larger than \
             programmed, so the take-up was 19 um too large: -19."
                .into(),
            "The positions of the squares are not stated. Here they are in the thirds from upper \
             left to lower right, where the backlash values of Y agree with table 13 within 7 um."
                .into(),
        ],
    })
}

/// Cuts a rectangle anticlockwise from its lower left corner.
pub fn cut_rectangle(
    bench: &mut dyn Bench,
    middle_mm: [f64; 2],
    size_mm: [f64; 2],
) -> Result<Cut, String> {
    let low = [0, 1].map(|axis| middle_mm[axis] - size_mm[axis] / 2.0);
    let high = [0, 1].map(|axis| low[axis] + size_mm[axis]);
    approach(bench, low)?;
    let lower = cut(bench, &format!("G1 X{:.5} F1", high[0]))?;
    cut(bench, &format!("G1 Y{:.5}", high[1]))?;
    let upper = cut(bench, &format!("G1 X{:.5}", low[0]))?;
    let left = cut(bench, &format!("G1 Y{:.5}", low[1]))?;
    let [Some(begin), Some(corner), Some(end)] = [lower.first(), upper.last(), left.last()] else {
        return Err("a rectangle without steps".into());
    };
    let ends = [corner, end];
    Ok(Cut {
        size_mm: [extent_mm(&upper, 0), extent_mm(&left, 1)],
        left_um: [0, 1].map(|axis| (ends[axis].tool_nm[axis] - begin.tool_nm[axis]) / 1e3),
    })
}
