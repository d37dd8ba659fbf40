//! The two-line test and a survey on a machine with known backlash.

use super::*;
use husillo_backlash::BacklashMap;
use std::sync::Arc;

/// A machine with steps of 1 um on X and Y, whose controller may take up the backlash.
struct Screws {
    /// Position of the tool in the controller, um.
    sent_um: [i64; 2],
    /// How far the nut is behind the screw, um: 0 to the backlash.
    behind_um: [i64; 2],
    play_um: [i64; 2],
    /// Take-up of the controller when an axis reverses, um.
    taken_up_um: [i64; 2],
    is_positive: [bool; 2],
}

impl Screws {
    fn new(play_um: [i64; 2], taken_up_um: [i64; 2]) -> Self {
        Self {
            sent_um: [0; 2],
            behind_um: play_um,
            play_um,
            taken_up_um,
            is_positive: [true; 2],
        }
    }

    /// Makes one step of the screw. The nut follows when the backlash is taken up.
    fn turn(&mut self, axis: usize, way: i64) {
        self.behind_um[axis] = (self.behind_um[axis] + way).clamp(0, self.play_um[axis]);
    }

    fn step(&mut self, axis: usize, way: i64, each: &mut dyn FnMut(&Moment)) {
        if self.is_positive[axis] != (way > 0) {
            self.is_positive[axis] = way > 0;
            for _ in 0..self.taken_up_um[axis] {
                self.turn(axis, way);
                each(&self.moment(true));
            }
        }
        self.sent_um[axis] += way;
        self.turn(axis, way);
        each(&self.moment(false));
    }

    /// The machine is homed in the positive direction. While an axis moves in this direction, the
    /// tool is at its commanded position.
    fn moment(&self, is_take_up: bool) -> Moment {
        let nm = |um: i64| um as f64 * 1e3;
        let tool = |axis: usize| {
            // The controller does not count the steps of a take-up.
            let taken_up = if self.is_positive[axis] {
                0
            } else {
                self.taken_up_um[axis]
            };
            self.sent_um[axis] - taken_up + self.play_um[axis] - self.behind_um[axis]
        };
        Moment {
            sent_nm: [nm(self.sent_um[0]), nm(self.sent_um[1]), 0.0],
            tool_nm: [nm(tool(0)), nm(tool(1)), 0.0],
            is_take_up,
            at_s: 0.0,
        }
    }
}

impl Bench for Screws {
    /// Moves X first, then Y, because these tests measure nothing on oblique moves.
    fn make(&mut self, block: &str, each: &mut dyn FnMut(&Moment)) -> Result<(), String> {
        for (axis, letter) in ["X", "Y"].into_iter().enumerate() {
            let word = block
                .split_whitespace()
                .find_map(|word| word.strip_prefix(letter));
            let Some(word) = word else { continue };
            let mm: f64 = word.parse().map_err(|_| format!("{block}: no number"))?;
            let goal = (mm * 1e3).round() as i64;
            while self.sent_um[axis] != goal {
                let way = (goal - self.sent_um[axis]).signum();
                self.step(axis, way, each);
            }
        }
        Ok(())
    }
}

const TRAVEL_MM: [[f64; 2]; 2] = [[0.0, 4.0], [0.0, 3.0]];
const STEP_NM: [f64; 3] = [1e3; 3];

/// A map with one value everywhere.
fn map(um: u32) -> Map {
    let positions: [Arc<[i32]>; 2] = [vec![0].into(), vec![0].into()];
    BacklashMap::new([0, 1], positions, vec![um].into()).unwrap()
}

#[test]
fn two_lines_find_the_play_and_a_survey_finds_the_rest() {
    let play = [204, 178];
    for taken_up in [[0, 0], [190, 190]] {
        let mut screws = Screws::new(play, taken_up);
        let run_up = if taken_up[0] == 0 {
            WHOLE_RUN_UP_MM
        } else {
            RUN_UP_MM
        };
        let pairs = cut_all(&mut screws, 2.0, TRAVEL_MM, run_up).unwrap();
        assert_eq!(pairs.len(), 2 * 3 * 3);
        let maps = taken_up.map(|um| map(um as u32));
        let backlash: Vec<_> = pairs
            .iter()
            .map(|pair| {
                pair.within(TRAVEL_MM).unwrap();
                let taken_up_nm = pair.taken_up_nm(&maps[pair.axis], STEP_NM, TRAVEL_MM);
                (*pair, pair.backlash_nm(taken_up_nm))
            })
            .collect();
        for (axis, play) in play.into_iter().enumerate() {
            let table = backlash_table(axis, &backlash).unwrap().unwrap();
            assert_eq!(table.axes, [0, 1]);
            let is_play = |um: &f64| (um - play as f64).abs() < 1e-6;
            assert!(table.backlash_um.iter().all(is_play), "{table:?}");
            // The error that remains with a map of the take-up.
            let left = Field::measured(axis, &table, &backlash, &maps[axis], STEP_NM, TRAVEL_MM);
            let wanted = (play - taken_up[axis]) as f64;
            assert!(left.um.iter().all(|um| (um - wanted).abs() < 1e-6));
        }
    }
    let mut screws = Screws::new([204, 178], [190, 190]);
    let [x, y] = survey(&mut screws, TRAVEL_MM).unwrap();
    // The take-up of X is 14 um too small, that of Y 12 um too large. Both show only in the
    // negative direction.
    assert_eq!((x.span_um, y.span_um), ([0.0, 14.0], [-12.0, 0.0]));
    let field = Field::surveyed(x, TRAVEL_MM);
    assert_eq!(field.edges_mm.map(|edges| edges.len() - 1), CELLS);
}

#[test]
fn readings_that_make_no_table_are_refused() {
    let pair = |x: Option<f64>, y: Option<f64>, measured_nm: f64| LinePair {
        axis: 0,
        position_mm: [x, y],
        programmed_nm: 0.0,
        measured_nm,
    };
    let table = |pairs: &[LinePair]| {
        let pairs: Vec<_> = pairs
            .iter()
            .map(|pair| (*pair, pair.backlash_nm(0.0)))
            .collect();
        backlash_table(0, &pairs)
    };
    assert_eq!(table(&[]), Ok(None));
    // Readings of bands along Y are averaged.
    let bands = [
        pair(Some(1.0), None, 100e3),
        pair(Some(1.0), None, 110e3),
        pair(Some(2.0), None, 90e3),
    ];
    let bands = table(&bands).unwrap().unwrap();
    assert_eq!(
        (bands.axes, &bands.backlash_um[..]),
        ([0, 0], &[105.0, 90.0][..])
    );
    let why = |pairs: &[LinePair]| table(pairs).unwrap_err();
    assert!(why(&[pair(None, None, 1e5)]).contains("where it was made"));
    let mixed = [pair(Some(1.0), None, 1e5), pair(Some(1.0), Some(1.0), 1e5)];
    assert!(why(&mixed).contains("leave out"));
    let corner = [
        pair(Some(1.0), Some(1.0), 1e5),
        pair(Some(2.0), Some(2.0), 1e5),
    ];
    assert!(why(&corner).contains("no reading at X2.000 Y1.000"));
    assert!(why(&[pair(Some(1.0), None, -2e4)]).contains("below zero"));
    let outside = pair(Some(9.0), None, 1e5).within(TRAVEL_MM);
    assert!(outside.unwrap_err().contains("the travel is 0 to 4 mm"));
}
