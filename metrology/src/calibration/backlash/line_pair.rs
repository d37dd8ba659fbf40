//! What the two-line test measures, and the table by place that comes of it.

use super::place_table::{Map, PlaceTable};

/// What the reading of a mark may be off, um: so far below zero is no lash at all.
const NOISE_UM: f64 = 10.0;

/// Places nearer to each other than this are one, mm.
const SAME_MM: f64 = 0.001;

/// Two lines of the two-line test, and what was measured between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePair {
    /// X or Y, by number.
    pub axis: usize,
    /// Where the line from above was cut, mm; `None` along an axis that bands lie along.
    pub place_mm: [Option<f64>; 2],
    /// From the line that was reached from below to that reached from above, as programmed, nm;
    /// signed.
    pub programmed_nm: f64,
    /// The same as measured.
    pub measured_nm: f64,
}

impl LinePair {
    /// Play at the place, nm, where `taken_up_nm` of it was made up for.
    #[must_use]
    pub fn lash_nm(&self, taken_up_nm: f64) -> f64 {
        taken_up_nm + self.measured_nm - self.programmed_nm
    }

    /// What a map takes up where the pair was cut, nm; for bands, in the middle of the travel along
    /// them.
    #[must_use]
    pub fn taken_up_nm(&self, map: &Map, step_nm: [f64; 3], travel_mm: [[f64; 2]; 2]) -> f64 {
        let at = map.axes().map(|axis| {
            let place = self.place_mm.get(axis).copied().flatten();
            let middle = travel_mm
                .get(axis)
                .map_or(0.0, |[low, high]| (low + high) / 2.0);
            (place.unwrap_or(middle) * 1e6 / step_nm[axis]).round() as i32
        });
        f64::from(map.steps(at)) * step_nm[self.axis]
    }

    /// Whether the pair was cut where the axes go.
    ///
    /// # Errors
    ///
    /// A sentence with the place and the travel.
    pub fn within(&self, travel_mm: [[f64; 2]; 2]) -> Result<(), String> {
        for ((place, [low, high]), letter) in self.place_mm.iter().zip(travel_mm).zip(["X", "Y"]) {
            if place.is_some_and(|mm| !(low..=high).contains(&mm)) {
                let mm = place.unwrap_or_default();
                return Err(format!(
                    "a reading at {letter}{mm}, and the travel is {low} to {high} mm"
                ));
            }
        }
        Ok(())
    }
}

/// The table of an axis from its readings, each with the lash that it says, in nm; several at a
/// place are averaged. `None` without readings.
///
/// # Errors
///
/// A sentence: a place of the grid without a reading, or readings of bands and of places.
pub fn place_table(axis: usize, pairs: &[(LinePair, f64)]) -> Result<Option<PlaceTable>, String> {
    let own: Vec<_> = pairs.iter().filter(|(pair, _)| pair.axis == axis).collect();
    let Some((first, _)) = own.first() else {
        return Ok(None);
    };
    let letter = if axis == 0 { "X" } else { "Y" };
    let has = first.place_mm.map(|place| place.is_some());
    if own
        .iter()
        .any(|(reading, _)| reading.place_mm.map(|place| place.is_some()) != has)
    {
        return Err(format!(
            "{letter}: some readings have a place that others leave out"
        ));
    }
    if has == [false; 2] {
        return Err(format!("{letter}: no reading says where it was made"));
    }
    let along = |index: usize| {
        let mut places: Vec<f64> = own
            .iter()
            .map(|(reading, _)| reading.place_mm[index].unwrap_or(0.0))
            .collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|later, earlier| (*later - *earlier).abs() < SAME_MM);
        places
    };
    let places = [along(0), along(1)];
    let mut lash_um = Vec::new();
    for y in &places[1] {
        for x in &places[0] {
            let here = own.iter().filter(|(reading, _)| {
                let at = reading.place_mm.map(|place| place.unwrap_or(0.0));
                (at[0] - x).abs() < SAME_MM && (at[1] - y).abs() < SAME_MM
            });
            let (sum, count) =
                here.fold((0.0, 0_u32), |(sum, count), (_, nm)| (sum + nm, count + 1));
            if count == 0 {
                return Err(format!(
                    "{letter}: no reading at X{x:.3} Y{y:.3}, where others of that column and \
                     that row are"
                ));
            }
            let um = sum / f64::from(count) / 1e3;
            if um < -NOISE_UM {
                return Err(format!(
                    "{letter}: a lash of {um:.0} um at X{x:.3} Y{y:.3}: there is none below zero; \
                     is a reading mistyped?"
                ));
            }
            lash_um.push(um.max(0.0));
        }
    }
    let (axes, places_mm) = match has {
        [true, true] => ([0, 1], places),
        [x, _] => {
            let [along_x, along_y] = places;
            let (axis, places) = if x { (0, along_x) } else { (1, along_y) };
            ([axis; 2], [places, vec![0.0]])
        }
    };
    Ok(Some(PlaceTable {
        axes,
        places_mm,
        lash_um,
    }))
}
