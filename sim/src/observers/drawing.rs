//! The path of the tool as strokes of a picture. Its memory is bounded for a program of any length.

/// The kind of move of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Manual moves and steps.
    Jog,
    /// Rapid moves and homing.
    Rapid,
    /// Cutting moves.
    Feed,
}

/// A point of the tool, and the nearest point of the programmed path; nm, in the axes of the
/// picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position of the tool.
    pub tool: [f64; 2],
    /// Nearest point of the programmed path.
    pub ideal: [f64; 2],
}

/// Consecutive points of one class.
#[derive(Clone, Debug)]
pub struct Stroke {
    /// The kind of move.
    pub class: Class,
    /// At least one point.
    pub points: Vec<Point>,
}

/// Strokes, thinned out to a fixed number of points.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The strokes in their order.
    pub strokes: Vec<Stroke>,
    /// Positions where an axis reversed and its backlash was taken up.
    pub take_ups: Vec<[f64; 2]>,
    /// Least distance of a point from the one before, nm. Nearer points are left out.
    pub spacing: f64,
    points: usize,
    last: [f64; 2],
}

/// Most points kept. They give a report of about 1 MB, and are finer than the pixels of its
/// pictures.
const MOST_POINTS: usize = 40_000;
/// Most take-up marks kept.
const MOST_MARKS: usize = 2_000;

impl Default for Drawing {
    /// An empty drawing.
    fn default() -> Self {
        Self {
            strokes: Vec::new(),
            take_ups: Vec::new(),
            spacing: 0.0,
            points: 0,
            last: [f64::MAX; 2],
        }
    }
}

impl Drawing {
    /// Whether a point at `tool` is far enough from the last one to be kept.
    #[inline]
    pub fn wants(&self, tool: [f64; 2]) -> bool {
        (tool[0] - self.last[0]).abs() > self.spacing
            || (tool[1] - self.last[1]).abs() > self.spacing
    }

    /// Begins a stroke.
    pub fn begin(&mut self, class: Class, at: Point) {
        if self
            .strokes
            .last()
            .is_none_or(|stroke| stroke.class != class)
        {
            self.strokes.push(Stroke {
                class,
                points: Vec::new(),
            });
        }
        self.add(at);
    }

    /// Adds a point to the stroke.
    pub fn add(&mut self, at: Point) {
        let Some(stroke) = self.strokes.last_mut() else {
            return;
        };
        stroke.points.push(at);
        self.last = at.tool;
        self.points += 1;
        if self.points > MOST_POINTS {
            self.thin();
        }
    }

    /// Marks a take-up.
    pub fn take_up(&mut self, at: [f64; 2]) {
        if self.take_ups.len() < MOST_MARKS {
            self.take_ups.push(at);
        }
    }

    /// Doubles the spacing until at least half of the points are free again.
    fn thin(&mut self) {
        while self.points > MOST_POINTS / 2 {
            self.spacing = if self.spacing > 0.0 {
                2.0 * self.spacing
            } else {
                self.size() / 16_384.0 + 1.0
            };
            let spacing = self.spacing;
            for stroke in &mut self.strokes {
                thin(&mut stroke.points, spacing);
            }
            self.strokes.retain(|stroke| stroke.points.len() > 1);
            self.points = self.strokes.iter().map(|stroke| stroke.points.len()).sum();
        }
        if self.strokes.is_empty() {
            self.last = [f64::MAX; 2];
        }
    }

    fn size(&self) -> f64 {
        let [low, high] = self.bounds().unwrap_or([[0.0; 2]; 2]);
        (high[0] - low[0]).max(high[1] - low[1])
    }

    /// Lower and upper corner of all strokes.
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        let mut points = self
            .strokes
            .iter()
            .flat_map(|stroke| &stroke.points)
            .map(|point| point.tool);
        let first = points.next()?;
        Some(points.fold([first, first], |[low, high], at| {
            [
                [low[0].min(at[0]), low[1].min(at[1])],
                [high[0].max(at[0]), high[1].max(at[1])],
            ]
        }))
    }
}

/// Keeps the first point, the last one, and each point farther than `spacing` from the previous
/// kept one.
fn thin(points: &mut Vec<Point>, spacing: f64) {
    let Some((first, last)) = points.first().copied().zip(points.last().copied()) else {
        return;
    };
    let mut kept = first.tool;
    let mut is_first = true;
    points.retain(|point| {
        let far =
            (point.tool[0] - kept[0]).abs() > spacing || (point.tool[1] - kept[1]).abs() > spacing;
        if far {
            kept = point.tool;
        }
        std::mem::take(&mut is_first) || far
    });
    if kept != last.tool && (points.len() > 1 || first.tool != last.tool) {
        points.push(last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_bounded() {
        let mut drawing = Drawing::default();
        let at = |k: u32| {
            let angle = f64::from(k) * 0.001;
            let tool = [angle * 1000.0 * angle.cos(), angle * 1000.0 * angle.sin()];
            Point { tool, ideal: tool }
        };
        drawing.begin(Class::Feed, at(0));
        for k in 1..1_000_000 {
            if drawing.wants(at(k).tool) {
                drawing.add(at(k));
            }
            if k % 1000 == 0 {
                drawing.begin(
                    if k % 2000 == 0 {
                        Class::Feed
                    } else {
                        Class::Rapid
                    },
                    at(k),
                );
            }
        }
        let points: usize = drawing
            .strokes
            .iter()
            .map(|stroke| stroke.points.len())
            .sum();
        assert!((5_000..=MOST_POINTS).contains(&points), "{points}");
    }
}
