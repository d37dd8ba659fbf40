//! Table 13: pairs of lines in the regions of the work area.

use super::cutting::{approach, cut, extent_mm};
use super::measured::{REGIONS, Region, mark_width_um, third_mm};
use super::{LEFT_UM, MIDDLE_MM, READING_UM, Settings, Shop, parameters};
use crate::calibration::backlash::Bench;
use crate::originals::{Parameter, Row, Table};

/// Distance of the two lines, mm.
const APART_MM: f64 = 0.1;

/// Cuts both lines of every region without take-up, as the original did, then with the map of
/// today.
///
/// # Errors
///
/// The machine refuses a move.
pub fn lines(shop: &Shop<'_>) -> Result<Table, String> {
    let width_um = mark_width_um();
    let mut rows = Vec::new();
    for region in &REGIONS {
        let make = |settings: &Settings| cut_pair(&mut *shop.mill(settings)?, region);
        let [there, back] = make(&Settings::original([0.0; 2]))?;
        let [there_today, back_today] = make(&shop.today)?;
        let Region { name, axis, .. } = *region;
        let width_mm = width_um / 1e3;
        rows.push(
            Row::new(
                format!("{name}: length"),
                "mm",
                region.measured_mm,
                READING_UM / 1e3,
            )
            .rebuilt(there + width_mm)
            .today(there_today + width_mm, region.programmed_mm + width_mm),
        );
        rows.push(
            Row::new(
                format!("{name}: backlash"),
                "um",
                region.backlash_um,
                LEFT_UM[axis],
            )
            .rebuilt(1e3 * (there - back))
            .today(1e3 * (there_today - back_today), 0.0),
        );
    }
    let mut parameters = parameters(&shop.screws);
    parameters.push(Parameter::new(
        "width of a mark",
        format!("{width_um:.1} um"),
        "fitted: the mean over the twelve lengths of tables 13 and 14",
    ));
    Ok(Table {
        number: "13",
        title: "backlash by region: two lines, joined at one end",
        spread: "lengths: 10 um, the largest error of reading a mark; backlash: 33 um in X and 27 \
                 um in Y, which remained according to the original",
        rows,
        parameters,
        notes: vec![
            "The positions of the lines within their thirds are not stated. Here they are cut in \
             the middle of their axis. The thirds count from the left and from the top, because \
             the backlash values of all tables then agree best."
                .into(),
        ],
    })
}

/// Cuts the line there and the line back. Returns their lengths, mm.
fn cut_pair(bench: &mut dyn Bench, region: &Region) -> Result<[f64; 2], String> {
    let (own, across) = (region.axis, 1 - region.axis);
    let names = ["X", "Y"];
    let begin = MIDDLE_MM[own] - region.programmed_mm / 2.0;
    let beside = MIDDLE_MM[across] + third_mm(across, region.third);
    let mut start = [0.0; 2];
    (start[own], start[across]) = (begin, beside);
    approach(bench, start)?;
    let end = begin + region.programmed_mm;
    let there = cut(bench, &format!("G1 {}{end:.5} F1", names[own]))?;
    cut(
        bench,
        &format!("G1 {}{:.5}", names[across], beside + APART_MM),
    )?;
    let back = cut(bench, &format!("G1 {}{begin:.5}", names[own]))?;
    Ok([&there, &back].map(|line| extent_mm(line, own)))
}
