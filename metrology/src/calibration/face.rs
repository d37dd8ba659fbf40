//! Calibration of the probe on a face at a known position.

use crate::error::Error;
use crate::heads::Stylus;
use crate::scale::Scale;
use husillo_probe::{Measurement, PreTravel, UnitVector};

/// A face perpendicular to an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// The axis, 0 for X to 2 for Z.
    pub axis: usize,
    /// Its position on the axis, an amount of the scale.
    pub position: i64,
}

impl Face {
    /// Returns the probe with the pre-travel that puts the point of this touch along the axis on
    /// the face.
    ///
    /// A sphere or a ring gives a table by direction. If the direction of this touch is in the
    /// table, all entries change, each by its component along the direction. This is equivalent to
    /// a shift of the sphere or ring. Its own touches cannot show such a shift.
    ///
    /// # Errors
    ///
    /// The pre-travel is more than `over_travel` counts, or less than -2 counts. The rounding of
    /// face and touch adds up to two counts.
    pub fn calibrate(
        &self,
        mut stylus: Stylus,
        measurement: &Measurement,
        scale: Scale,
        over_travel: u32,
    ) -> Result<Stylus, Error> {
        let face = surface_nm(&stylus, measurement)[self.axis];
        let direction = measurement.touch.direction;
        let parts = |vector: &UnitVector| vector.components().map(|part| part.to_num::<f64>());
        let cosine = |entry: &UnitVector| -> f64 {
            let pairs = parts(entry).into_iter().zip(parts(&direction));
            pairs.map(|(a, b)| a * b).sum()
        };
        // The component along the axis is 1 or -1. A pre-travel is below 2 m, so the cast does not
        // saturate.
        let beyond = (face - self.position) as f64 * parts(&direction)[self.axis];
        let found = i64::from(stylus.pre_travel.along(&direction)) + beyond as i64;
        let possible = scale.of_counts(-2)..=scale.of_counts(over_travel.into());
        if !possible.contains(&found) {
            return Err(Error::PreTravel {
                found: scale.text(found),
                most: scale.text(*possible.end()),
            });
        }
        let shifted = |nm: i32, part: f64| nm.saturating_add((beyond * part).round() as i32);
        let mut entries = stylus.pre_travel.entries().to_vec();
        let is_by_axis = is_by_axis(&stylus);
        if entries.iter().any(|(entry, _)| *entry == direction) {
            for (entry, nm) in &mut entries {
                let part = match is_by_axis {
                    true => f64::from(u8::from(*entry == direction)),
                    false => cosine(entry),
                };
                *nm = shifted(*nm, part);
            }
        } else {
            let nm = stylus.pre_travel.along(&direction);
            entries.push((direction, shifted(nm, 1.0)));
        }
        if let Some(pre_travel) = PreTravel::of(&entries) {
            stylus.pre_travel = pre_travel;
        }
        Ok(stylus)
    }
}

/// Whether the pre-travel has at most one entry for each direction of each axis.
#[must_use]
pub fn is_by_axis(stylus: &Stylus) -> bool {
    stylus.pre_travel.entries().len() <= 6
}

/// The touched point of a face perpendicular to the direction of travel: the latched position minus
/// pre-travel and ball radius, amounts of the scale.
#[must_use]
pub fn surface_nm(stylus: &Stylus, measurement: &Measurement) -> [i64; 3] {
    let touch = &measurement.touch;
    stylus.surface_nm(
        touch.position,
        &touch.direction,
        &touch.direction.reversed(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::pre_travel_by_sign;
    use crate::quantity::Fraction;
    use husillo_probe::Touch;

    const SCALE_NM: i64 = 2000;

    fn touched(z: i64) -> Measurement {
        Measurement {
            touch: Touch {
                position: [5, 6, z],
                direction: UnitVector::Z.reversed(),
            },
            touches: 1,
            spread: 0,
            over_travel: 0,
        }
    }

    fn calibrated(stylus: Stylus, z: i64) -> Result<Stylus, Error> {
        let face = Face {
            axis: 2,
            position: -5_000_000,
        };
        let scale = Scale::new(Some(Fraction {
            num: SCALE_NM,
            den: 1,
        }));
        face.calibrate(stylus, &touched(z), scale, 100)
    }

    #[test]
    fn a_face_gives_the_pre_travel_of_one_direction() {
        let stylus = Stylus {
            radius_nm: 1_000_000,
            pre_travel: pre_travel_by_sign([0; 2]),
        };
        // The signal came 8 um late.
        let found = calibrated(stylus, -4_008_000).unwrap();
        assert_eq!(found.pre_travel.along(&UnitVector::Z.reversed()), 8_000);
        assert_eq!(found.pre_travel.along(&UnitVector::X), 0);
        assert_eq!(surface_nm(&found, &touched(-4_008_000))[2], -5_000_000);
        // A second calibration changes nothing.
        assert_eq!(calibrated(found, -4_008_000).unwrap(), found);
        // -2 counts are rounding. Less is an error, and so is more than the over-travel.
        assert!(calibrated(stylus, -3_996_000).is_ok());
        for z in [-3_990_000, -4_300_000] {
            let none = calibrated(stylus, z);
            assert!(matches!(none, Err(Error::PreTravel { .. })), "{none:?}");
        }
    }

    #[test]
    fn a_face_displaces_the_body_of_a_table() {
        let slanted = UnitVector::new([0, 3, -4]).unwrap();
        let directions = [
            UnitVector::Z.reversed(),
            slanted,
            UnitVector::X,
            UnitVector::Y,
            UnitVector::X.reversed(),
            UnitVector::Y.reversed(),
            UnitVector::new([1, 0, -1]).unwrap(),
        ];
        let stylus = Stylus {
            radius_nm: 1_000_000,
            pre_travel: PreTravel::of(&directions.map(|direction| (direction, 5_000))).unwrap(),
        };
        let found = calibrated(stylus, -4_015_000).unwrap();
        let of = |direction| found.pre_travel.along(&direction);
        assert_eq!(of(directions[0]), 15_000);
        // The body seems to be shifted by 10 um. In this direction that is 0.8 of it, and nothing
        // perpendicular to it.
        assert_eq!((of(slanted), of(UnitVector::X)), (13_000, 5_000));
    }
}
