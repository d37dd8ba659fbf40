//! Speed over time.

/// A part of a path with a constant change of its acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// Its duration in s.
    pub seconds: f64,
    /// Speed at its start in mm/s.
    pub speed: f64,
    /// Acceleration along the path at its start in mm/s^2.
    pub acceleration: f64,
    /// Change of the acceleration in mm/s^3.
    pub jerk: f64,
    /// Radius of the path in mm; infinite on a line.
    pub radius: f64,
}

impl Piece {
    /// Speed after so many seconds.
    #[must_use]
    pub fn speed_at(&self, seconds: f64) -> f64 {
        self.speed + seconds * (self.acceleration + self.jerk * seconds / 2.0)
    }

    /// Time at which a part of its path has passed, by bisection.
    #[must_use]
    pub fn seconds_to(&self, path: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.seconds);
        for _ in 0..50 {
            let time: f64 = (low + high) / 2.0;
            let change = self.acceleration / 2.0 + self.jerk * time / 6.0;
            if time * (self.speed + time * change) < path {
                low = time;
            } else {
                high = time;
            }
        }
        high
    }

    /// Acceleration along the path after so many seconds.
    #[must_use]
    pub fn acceleration_at(&self, seconds: f64) -> f64 {
        self.acceleration + self.jerk * seconds
    }

    /// Length of the acceleration along the path and towards the centre.
    #[must_use]
    pub fn whole_acceleration_at(&self, seconds: f64) -> f64 {
        let towards = self.speed_at(seconds).powi(2) / self.radius;
        self.acceleration_at(seconds).hypot(towards)
    }
}

/// The speed along a path over time.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// The parts of the path, in order.
    pub pieces: Vec<Piece>,
    /// Speed at each junction, and the lower top speed of the moves before and after it.
    pub junctions: Vec<[f64; 2]>,
    /// Largest change of the velocity at a junction in mm/s.
    pub jump: f64,
}

/// Lowest and highest value in a column of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The lowest.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

impl Band {
    /// No value.
    pub const EMPTY: Band = Band {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    /// Includes a value.
    pub fn add(&mut self, value: f64) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }
}

impl Profile {
    /// Duration in s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.seconds).sum()
    }

    /// Speed, acceleration along the path and jerk in columns of equal time, for a picture.
    #[must_use]
    pub fn columns(&self, count: usize, column_seconds: f64) -> Vec<[Band; 3]> {
        let mut columns = vec![[Band::EMPTY; 3]; count];
        let last = count.saturating_sub(1);
        let mut start = 0.0;
        for piece in &self.pieces {
            let end = start + piece.seconds;
            let within = |at: f64| ((at / column_seconds) as usize).min(last);
            for (column, bands) in (columns.iter_mut().enumerate())
                .take(within(end) + 1)
                .skip(within(start))
            {
                let border = column as f64 * column_seconds;
                for at in [border.max(start), (border + column_seconds).min(end)] {
                    let time = at - start;
                    bands[0].add(piece.speed_at(time));
                    bands[1].add(piece.acceleration_at(time));
                    bands[2].add(piece.jerk);
                }
            }
            start = end;
        }
        columns
    }
}
