//! Which move of a figure is cut, by the positions that the controller reports, and how long the
//! rest takes.

use husillo_controllers::MicrofactoryConfig;

/// A step of a straight move is this near to it, steps.
const NEAR: f64 = 1.0;
/// Steps that may have been made since the controller has reported a position.
const SINCE: f64 = 40.0;

/// A figure that is cut.
#[derive(Clone, Debug, Default)]
pub(super) struct Cutting {
    moves: Vec<[i16; 2]>,
    /// For each move, where it begins, in steps from the begin of the figure.
    begins: Vec<[i32; 2]>,
    /// For each move its time, and of it the time of the take-up before it, s.
    times_s: Vec<[f64; 2]>,
    /// Steps per second along the path.
    rate_hz: f64,
    /// The move that is cut, and which part of it is.
    index: usize,
    part: f64,
}

impl Cutting {
    /// A figure on a machine with these rates. At its begin the screws engage forward, as after
    /// homing.
    pub(super) fn new(moves: &[[i16; 2]], config: &MicrofactoryConfig) -> Self {
        let rate_hz = f64::from(config.axis_rate_hz.max(1));
        let [x, _, z] = config.backlash_steps;
        let (mut begins, mut times_s) = (Vec::new(), Vec::new());
        let (mut at, mut forward) = ([0_i32; 2], [true; 2]);
        for delta in moves {
            begins.push(at);
            let mut take_up = 0.0;
            let axes = at.iter_mut().zip(&mut forward).zip(delta).zip([x, z]);
            for (((at, forward), steps), backlash) in axes {
                *at += i32::from(*steps);
                if *steps != 0 && *forward != (*steps > 0) {
                    *forward = *steps > 0;
                    take_up += f64::from(backlash) / rate_hz;
                }
            }
            times_s.push([length(*delta) / rate_hz + take_up, take_up]);
        }
        Self {
            moves: moves.to_vec(),
            begins,
            times_s,
            rate_hz,
            index: 0,
            part: 0.0,
        }
    }

    /// Moves of the figure.
    pub(super) const fn count(&self) -> usize {
        self.moves.len()
    }

    /// Moves that are cut to their end.
    pub(super) const fn made(&self) -> usize {
        self.index
    }

    /// Steps of X and Z from its begin to its end.
    pub(super) fn end(&self) -> [i32; 2] {
        let sum = |axis: usize| {
            let steps = self.moves.iter().filter_map(|delta| delta.get(axis));
            steps.map(|steps| i32::from(*steps)).sum()
        };
        [sum(0), sum(1)]
    }

    /// The time from the contact to the end, s.
    pub(super) fn total_s(&self) -> f64 {
        self.times_s.iter().map(|[whole_s, _]| whole_s).sum()
    }

    /// The time that is left, s.
    pub(super) fn left_s(&self) -> f64 {
        let mut left = self.times_s.iter().skip(self.index);
        let now = left
            .next()
            .map_or(0.0, |[whole_s, take_up_s]| match self.part {
                // Nothing is seen of a take-up.
                0.0 => *whole_s,
                part => (whole_s - take_up_s) * (1.0 - part),
            });
        now + left.map(|[whole_s, _]| whole_s).sum::<f64>()
    }

    /// The figure is cut to its end.
    pub(super) const fn done(&mut self) {
        (self.index, self.part) = (self.moves.len(), 0.0);
    }

    /// The tool is here, in steps of X and Z from the begin, this time after the last call.
    pub(super) fn at(&mut self, place: [i32; 2], passed_s: f64) {
        let mut reach = self.rate_hz * passed_s + SINCE;
        for index in self.index..self.moves.len() {
            let least = if index == self.index { self.part } else { 0.0 };
            if let Some(part) = self.part_of(index, place).filter(|part| *part >= least) {
                (self.index, self.part) = (index, part);
                return;
            }
            let left = self.moves.get(index).map_or(0.0, |delta| length(*delta));
            reach -= left * (1.0 - least);
            if reach < 0.0 {
                return;
            }
        }
    }

    /// Which part of a move is made at a place on it. None: the place is not on it.
    fn part_of(&self, index: usize, place: [i32; 2]) -> Option<f64> {
        let ([x, z], [begin_x, begin_z]) = (*self.moves.get(index)?, *self.begins.get(index)?);
        let [x, z] = [x, z].map(f64::from);
        let [place_x, place_z] = place;
        let from_x = f64::from(place_x) - f64::from(begin_x);
        let from_z = f64::from(place_z) - f64::from(begin_z);
        let square = x * x + z * z;
        let part = ((from_x * x + from_z * z) / square).clamp(0.0, 1.0);
        let apart = (from_x - part * x).hypot(from_z - part * z);
        (apart <= NEAR).then_some(part)
    }
}

fn length([x, z]: [i16; 2]) -> f64 {
    f64::from(x).hypot(f64::from(z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square of the original with its diagonal: its begin is passed three times.
    const SQUARE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

    fn cutting(moves: &[[i16; 2]]) -> Cutting {
        Cutting::new(moves, &MicrofactoryConfig::ORIGINAL)
    }

    #[test]
    fn the_move_that_is_cut_follows_the_positions() {
        let mut square = cutting(&SQUARE);
        let mut seen = Vec::new();
        for (index, delta) in SQUARE.into_iter().enumerate() {
            let [begin_x, begin_z] = square.begins[index];
            for part in 1..=40 {
                let at = |begin: i32, delta: i16| begin + i32::from(delta) * part / 40;
                square.at([at(begin_x, delta[0]), at(begin_z, delta[1])], 0.05);
                seen.push(square.made());
            }
        }
        let wanted: Vec<usize> = (0..5).flat_map(|index| [index; 40]).collect();
        assert_eq!(seen, wanted);
        assert!(square.left_s() < 1e-9);
    }

    #[test]
    fn a_way_back_on_the_same_line_is_the_next_move() {
        let mut there_and_back = cutting(&[[300, 0], [-300, 0], [0, 5]]);
        for (x, made) in [(100, 0), (280, 0), (300, 0), (290, 1), (150, 1), (0, 1)] {
            there_and_back.at([x, 0], 0.05);
            assert_eq!(there_and_back.made(), made, "at {x}");
        }
        there_and_back.at([0, 3], 0.05);
        assert_eq!(there_and_back.made(), 2);
    }

    #[test]
    fn short_moves_are_passed_and_far_ones_are_not() {
        let mut steps = cutting(&[[3, 0]; 100]);
        steps.at([62, 0], 0.05);
        assert_eq!(steps.made(), 20);
        // Twice the same place, a second of cutting apart.
        let mut twice = cutting(&[[400, 0], [0, 400], [0, -400], [-400, 0]]);
        twice.at([400, 0], 1.0);
        twice.at([400, 0], 0.05);
        assert_eq!(twice.made(), 0);
    }

    #[test]
    fn the_time_is_that_of_the_path_and_of_its_take_ups() {
        // As `husillo run examples/microfactory/zigzag.fig` simulates it.
        let zigzag = [[300, 700], [300, -500], [300, 500], [300, -700], [-1200, 0]];
        let mut zigzag = cutting(&zigzag);
        assert!((zigzag.total_s() - 11.72).abs() < 0.005);
        assert_eq!(zigzag.left_s(), zigzag.total_s());
        assert_eq!(zigzag.end(), [0, 0]);
        zigzag.at([150, 350], 1.0);
        let half_s = 300_f64.hypot(700.0) / 2.0 / 400.0;
        assert!((zigzag.left_s() - zigzag.total_s() + half_s).abs() < 1e-6);
        zigzag.done();
        assert_eq!((zigzag.made(), zigzag.left_s()), (5, 0.0));
    }
}
