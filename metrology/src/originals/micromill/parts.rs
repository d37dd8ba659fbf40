//! Tables 16 to 20: the head in three sizes and the logo in two.

use super::cutting::{approach, cut};
use super::measured::mark_width_um;
use super::part_tables::{Detail, PARTS, Part};
use super::squares::cut_rectangle;
use super::{
    LAST_TAKE_UP_UM, LEFT_UM, MIDDLE_MM, READING_UM, Screws, Settings, Shop, parameters, scale,
};
use crate::calibration::backlash::Bench;
use crate::originals::{Parameter, Row, Table};

/// Cuts a part. Its extents are cut on the fitted screws, with the last take-up of the original and
/// then with the map of today. Each of its details is cut on screws with the backlash that remained
/// there.
///
/// # Errors
///
/// There is no such part, or the machine refuses a move.
pub fn part(number: &str, shop: &Shop<'_>) -> Result<Table, String> {
    let part = PARTS.iter().find(|part| part.number == number);
    let part = part.ok_or_else(|| format!("no part has table {number}"))?;
    let bed = Bed {
        shop,
        place_mm: place_mm(part, &shop.screws),
    };
    let mut rows = Vec::new();
    bed.add_extents(&mut rows, part)?;
    bed.add_widths(&mut rows, part)?;
    let mut parameters = parameters(&shop.screws);
    let [x, y] = bed.place_mm;
    parameters.push(Parameter::new(
        "position of the part",
        format!("X {x:.1} Y {y:.1} mm"),
        "fitted to its backlash and sizes, on a grid of 0.5 mm; the original does not state it",
    ));
    if !part.details.is_empty() {
        parameters.push(Parameter::new(
            "play at a width",
            "what was measured there".into(),
            "of the table itself, for the widths only",
        ));
    }
    Ok(Table {
        number: part.number,
        title: part.title,
        spread: "play: 33 um in X and 27 um in Y, which is what the original says remained; sizes: \
                 this and 10 um for reading two marks; widths: 10 um, their difference: 33 um and \
                 20 um",
        rows,
        parameters,
        notes: notes(part),
    })
}

/// The position at which the fitted screws explain the backlash values and the sizes of a part
/// best. The positions of a grid of 0.5 mm are tried.
fn place_mm(part: &Part, screws: &Screws) -> [f64; 2] {
    const GRID_MM: f64 = 0.5;
    // The part must be within the area in which the screws were measured.
    let room = [0, 1].map(|axis| {
        let room = MIDDLE_MM[axis] - part.programmed_mm[axis] / 2.0 - 0.5;
        (room / GRID_MM).max(0.0) as i32
    });
    let width_um = mark_width_um();
    let cost = |at_mm: [f64; 2]| -> f64 {
        let from = [0, 1].map(|axis| at_mm[axis] - MIDDLE_MM[axis]);
        let half = part.programmed_mm.map(|size| size / 2.0);
        // The upper left corner for X, the lower left one for Y.
        let corners = [
            [from[0] - half[0], from[1] + half[1]],
            [from[1] - half[1], from[0] - half[0]],
        ];
        let off = |axis: usize| {
            let [own, other] = corners[axis];
            let backlash_um = screws.axes()[axis].backlash_um(own, other);
            let left_um = backlash_um - LAST_TAKE_UP_UM[axis] * scale();
            let size_um = 1e3 * part.programmed_mm[axis] * scale() - left_um + width_um;
            let points = part.left_um[axis].iter();
            let points = points.map(|(_, um)| (um - left_um.abs()).powi(2));
            points.sum::<f64>() + (1e3 * part.measured_mm[axis] - size_um).powi(2)
        };
        off(0) + off(1)
    };
    let places = (-room[0]..=room[0]).flat_map(|column| {
        (-room[1]..=room[1]).map(move |row| [column, row].map(|cells| GRID_MM * f64::from(cells)))
    });
    let places = places.map(|from| [0, 1].map(|axis| MIDDLE_MM[axis] + from[axis]));
    let best = places.min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    best.unwrap_or(MIDDLE_MM)
}

fn notes(part: &Part) -> Vec<String> {
    let mut notes = vec![
        "The contour is not known: a rectangle of the same extents is cut. The play left at all \
         points of an axis is that of the rectangle, without sign as in the original."
            .to_owned(),
    ];
    if !part.details.is_empty() {
        notes.push(
            "A width that is cut towards the right on one side and towards the left on the other \
             is wrong by the play that is left: narrower or wider by the order of its sides. The \
             widths are from the middle of one mark to that of the other."
                .to_owned(),
        );
    }
    notes.extend(part.note.map(str::to_owned));
    notes
}

/// Screws with the last take-up of the original plus this backlash in X, um.
fn with_left(left_um: f64) -> Screws {
    let [x, y] = LAST_TAKE_UP_UM.map(|um| um * scale());
    Screws::even([x + left_um, y])
}

/// The mill with a part on it.
struct Bed<'a> {
    shop: &'a Shop<'a>,
    place_mm: [f64; 2],
}

impl Bed<'_> {
    fn add_extents(&self, rows: &mut Vec<Row>, part: &Part) -> Result<(), String> {
        let make = |settings: &Settings| {
            let bench = &mut *self.shop.mill(settings)?;
            cut_rectangle(bench, self.place_mm, part.programmed_mm)
        };
        let original = make(&Settings::original(LAST_TAKE_UP_UM))?;
        let today = make(&self.shop.today)?;
        let width_mm = mark_width_um() / 1e3;
        for (axis, letter) in ["X", "Y"].into_iter().enumerate() {
            let spread_mm = (LEFT_UM[axis] + READING_UM) / 1e3;
            let name = format!("size {letter}");
            let programmed_mm = part.programmed_mm[axis] + width_mm;
            rows.push(
                Row::new(name, "mm", part.measured_mm[axis], spread_mm)
                    .rebuilt(original.size_mm[axis] + width_mm)
                    .today(today.size_mm[axis] + width_mm, programmed_mm),
            );
        }
        for (axis, letter) in ["X", "Y"].into_iter().enumerate() {
            for (name, left_um) in part.left_um[axis] {
                let name = format!("left {letter} at {name}");
                rows.push(
                    Row::new(name, "um", *left_um, LEFT_UM[axis])
                        .rebuilt(original.left_um[axis].abs())
                        .today(today.left_um[axis].abs(), 0.0),
                );
            }
        }
        Ok(())
    }

    fn add_widths(&self, rows: &mut Vec<Row>, part: &Part) -> Result<(), String> {
        let original = Settings::original(LAST_TAKE_UP_UM);
        let make = |screws: &Screws, from_mm: f64, detail: &Detail, is_wider| {
            let at_mm = [self.place_mm[0] + from_mm, self.place_mm[1]];
            let bench = &mut *(self.shop.build)(&original, screws)?;
            cut_width(bench, at_mm, detail.programmed_um / 1e3, is_wider)
        };
        for detail in part.details {
            let is_wider = detail.measured_um > detail.programmed_um;
            let width = make(&with_left(detail.left_um), 0.0, detail, is_wider)?;
            let name = format!("width {}", detail.name);
            rows.push(Row::new(name, "um", detail.measured_um, READING_UM).rebuilt(width));
        }
        let (Some([mirrored, at_once]), [h, j]) = (part.mirrored_um, part.details) else {
            return Ok(());
        };
        // Each width is halfway between the middle of the part and its edge.
        let apart_mm = part.programmed_mm[0] / 4.0;
        let left = |is_wider| make(&self.shop.screws, -apart_mm, h, is_wider);
        let right = |is_wider| make(&self.shop.screws, apart_mm, j, is_wider);
        let spread = LEFT_UM[0] + 2.0 * READING_UM;
        for (name, measured, rebuilt) in [
            (
                "h wider than j, two halves",
                mirrored,
                left(true)? - right(true)?,
            ),
            (
                "h wider than j, in one go",
                at_once,
                left(true)? - right(false)?,
            ),
        ] {
            rows.push(Row::new(name, "um", measured, spread).rebuilt(rebuilt));
        }
        Ok(())
    }
}

/// Cuts two marks along Y, and returns their distance in X, um. If `is_wider`, the left mark is
/// reached from the left, and the right mark from the right. Otherwise each is reached from the
/// other side.
fn cut_width(
    bench: &mut dyn Bench,
    [x, y]: [f64; 2],
    width_mm: f64,
    is_wider: bool,
) -> Result<f64, String> {
    /// Run-up, mm: more than the backlash that remains after any take-up.
    const BEYOND_MM: f64 = 0.1;
    let ends = [x, x + width_mm];
    let (first, second) = if is_wider { (0, 1) } else { (1, 0) };
    approach(bench, [ends[first], y])?;
    let mut marks_um = [0.0; 2];
    let mut mark = |bench: &mut dyn Bench, end: usize, to: f64| -> Result<(), String> {
        let moments = cut(bench, &format!("G1 Y{to:.5} F1"))?;
        let last = moments.last().ok_or("a mark without steps")?;
        marks_um[end] = last.tool_nm[0] / 1e3;
        Ok(())
    };
    mark(bench, first, y + 0.02)?;
    if is_wider {
        cut(bench, &format!("G1 X{:.5}", ends[second] + BEYOND_MM))?;
    }
    cut(bench, &format!("G1 X{:.5}", ends[second]))?;
    mark(bench, second, y + 0.04)?;
    Ok(marks_um[1] - marks_um[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In all six widths of the original, the error of the width equals the backlash that remained
    /// at it.
    #[test]
    fn widths_are_wrong_by_the_play_left() {
        for detail in PARTS.iter().flat_map(|part| part.details) {
            let off = (detail.measured_um - detail.programmed_um).abs();
            assert_eq!(off, detail.left_um, "{}", detail.name);
        }
    }

    /// At the small parts more backlash remained than in the middle of the work area, so they lie
    /// left of the middle. All positions are on the table.
    #[test]
    fn parts_lie_where_their_plays_are() {
        let screws = Screws::fitted();
        for part in &PARTS {
            let place_mm = place_mm(part, &screws);
            for axis in 0..2 {
                let half = part.programmed_mm[axis] / 2.0;
                let from = (place_mm[axis] - MIDDLE_MM[axis]).abs() + half;
                assert!(from < MIDDLE_MM[axis], "{}: {place_mm:?}", part.number);
            }
        }
    }
}
