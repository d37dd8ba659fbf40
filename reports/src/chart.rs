//! The picture of path speed and acceleration over time.

use crate::text::duration;
use husillo_sim::observers::speed::{Band, Column, Speed, WINDOW_EVENTS};
use std::fmt::Write;

/// Left end of the time axis.
pub const LEFT: f64 = 78.0;
/// Right end of the time axis.
pub const RIGHT: f64 = 990.0;
/// Millimetres per minute of one nanometre per second.
const MM_PER_MIN: f64 = 60.0 / 1e6;
/// Millimetres of one nanometre.
const MM: f64 = 1e-6;

/// One of the two stacked charts.
#[derive(Clone, Copy, Debug)]
pub struct Panel {
    /// Top edge in the picture.
    pub top: f64,
    /// Bottom edge in the picture.
    pub bottom: f64,
    /// The value at the bottom.
    pub low: f64,
    /// The value at the top.
    pub high: f64,
}

impl Panel {
    /// The height of a value. A value beyond the panel is at its edge.
    pub fn y(&self, value: f64) -> f64 {
        let part = (value.clamp(self.low, self.high) - self.low) / (self.high - self.low);
        self.bottom - part * (self.bottom - self.top)
    }

    /// Draws lines and figures at round values, and the name with its unit.
    pub fn scale(&self, page: &mut String, name: &str) {
        let step = round_up((self.high - self.low) / 5.0 - 1e-9);
        let mut at = (self.low / step).ceil() * step;
        while at <= self.high + 1e-9 * step {
            let y = self.y(at);
            let _ = write!(
                page,
                "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{RIGHT}\"/><text x=\"{:.0}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                LEFT - 8.0,
                y + 4.0,
                figure(at, step)
            );
            at += step;
        }
        let _ = writeln!(
            page,
            "<text x=\"{LEFT}\" y=\"{:.0}\">{name}</text>",
            self.top - 9.0
        );
    }

    /// Draws a line through the bands of all columns. A band that is wider than the line is drawn
    /// as a vertical stroke.
    pub(crate) fn trace(
        &self,
        page: &mut String,
        class: &str,
        width: f64,
        bands: impl Iterator<Item = Band>,
    ) {
        let mut path = String::new();
        // End of the line so far, and the value at which it may continue.
        let mut pen: Option<(f64, f64)> = None;
        for (index, band) in bands.enumerate() {
            let x = LEFT + width * (index as f64 + 0.5);
            if band.is_empty() {
                if let Some((end, _)) = pen.take() {
                    let _ = write!(path, "H{end:.1}");
                }
                continue;
            }
            let (high, low) = (self.y(band.high.into()), self.y(band.low.into()));
            let mut ends = [high, low];
            match pen {
                Some((_, y)) if (y - high).abs().max((y - low).abs()) < 0.1 => {
                    pen = Some((x, y));
                    continue;
                }
                Some((end, y)) => {
                    if (y - low).abs() < (y - high).abs() {
                        ends = [low, high];
                    }
                    let _ = write!(path, "H{end:.1}L{x:.1} {:.1}", ends[0]);
                }
                // At least half a column wide, so that a single column is visible.
                None => {
                    let _ = write!(path, "M{:.1} {:.1}H{x:.1}", x - 0.5 * width, ends[0]);
                }
            }
            if low - high > 0.4 {
                let _ = write!(path, "V{:.1}", ends[1]);
            }
            pen = Some((x, ends[1]));
        }
        if let Some((end, _)) = pen {
            let _ = write!(path, "H{end:.1}");
        }
        if !path.is_empty() {
            let _ = writeln!(page, "<path class=\"{class}\" d=\"{path}\"/>");
        }
    }
}

/// The largest values of a chart; speeds in nm/s.
struct Largest {
    feed: Option<f64>,
    rapid: Option<f64>,
    programmed: f64,
    /// Largest magnitude, mm/s^2.
    acceleration: f64,
}

impl Largest {
    fn of(columns: &[Column]) -> Self {
        let all = |band: fn(&Column) -> Band| {
            let all = columns.iter().map(band).reduce(Band::with);
            all.filter(|band| !band.is_empty())
        };
        let largest = |band| all(band).map(|band| f64::from(band.high));
        Self {
            feed: largest(|c| c.feed),
            rapid: largest(|c| c.rapid),
            programmed: largest(|c| c.programmed).unwrap_or(0.0),
            acceleration: all(|c| c.acceleration)
                .map_or(0.0, |band| f64::from(band.high.max(-band.low)) * MM),
        }
    }

    /// The speed that determines the scale: of feed moves if there are any, otherwise of rapids.
    fn top(&self) -> Option<f64> {
        self.feed.or(self.rapid).filter(|top| *top > 0.0)
    }

    /// The top of the chart of speeds, mm/min. The chart is about cutting, so rapids that are much
    /// faster are drawn at its edge.
    fn high(&self, top: f64) -> f64 {
        let rapid = self.rapid.filter(|rapid| *rapid < 3.0 * top).unwrap_or(top);
        let is_near = self.programmed < 2.0 * top;
        let programmed = if is_near { self.programmed } else { 0.0 };
        ceiling(1.05 * MM_PER_MIN * top.max(rapid).max(programmed), 5.0)
    }

    /// Sentences about the speeds beyond the top.
    fn beyond(&self, high: f64) -> String {
        let mut beyond = String::new();
        if let Some(rapid) = self.rapid.filter(|rapid| MM_PER_MIN * rapid > high) {
            let _ = write!(
                beyond,
                " Rapids, at up to {} mm/min, are cut off at the top.",
                figure(MM_PER_MIN * rapid, MM_PER_MIN * rapid / 20.0)
            );
        }
        let programmed = MM_PER_MIN * self.programmed;
        if programmed > high {
            let _ = write!(
                beyond,
                " The programmed feed, up to {} mm/min, is beyond the top.",
                figure(programmed, programmed / 20.0)
            );
        }
        beyond
    }
}

/// Adds the section to a report. Without `has_ramps` it explains why the speed jumps.
pub fn section(page: &mut String, speed: &Speed, has_ramps: bool) {
    let (columns, column_seconds) = speed.columns();
    let largest = Largest::of(columns);
    let Some(top) = largest.top() else {
        return;
    };
    let high = largest.high(top);
    page.push_str("<section><h2>Speed and acceleration over time</h2>\n");
    caption(page, speed, has_ramps);
    let beyond = largest.beyond(high);
    if !beyond.is_empty() {
        let _ = writeln!(page, "<p>{}</p>", beyond.trim_start());
    }
    let _ = writeln!(
        page,
        "<svg viewBox=\"0 0 1000 480\" role=\"img\" aria-labelledby=\"speed-t speed-d\">\
         <title id=\"speed-t\">Path speed and acceleration of the tool over time</title><desc \
         id=\"speed-d\">{}: \
         speed up to {} mm/min, acceleration up to {} mm/s^2</desc>",
        duration(speed.seconds()),
        figure(
            MM_PER_MIN * top.max(largest.rapid.unwrap_or(0.0)),
            0.01 * MM_PER_MIN * top
        ),
        figure(largest.acceleration, 0.01 * largest.acceleration)
    );
    let width = (RIGHT - LEFT) * column_seconds / speed.seconds().max(column_seconds);
    speeds(page, columns, width, high);
    accelerations(page, columns, width, largest.acceleration);
    time_scale(page, speed.seconds());
    page.push_str("</svg>\n");
    legend(page);
    page.push_str("</section>\n");
}

/// Converts a band to the unit of a chart.
fn scaled(band: Band, factor: f64) -> Band {
    Band {
        low: band.low * factor as f32,
        high: band.high * factor as f32,
    }
}

/// The chart of speeds.
fn speeds(page: &mut String, columns: &[Column], width: f64, high: f64) {
    let speeds = Panel {
        top: 30.0,
        bottom: 250.0,
        low: 0.0,
        high,
    };
    speeds.scale(page, "path speed, mm/min");
    let speed_of = |band: fn(&Column) -> Band| {
        (0..columns.len()).map(move |index| {
            let column = &columns[index];
            let moving = band(column);
            let is_next_to_stop = [index.wrapping_sub(1), index, index + 1]
                .iter()
                .any(|near| {
                    columns
                        .get(*near)
                        .is_none_or(|near| near.take_up || near.dwell)
                });
            if moving.is_empty() || !is_next_to_stop {
                return scaled(moving, MM_PER_MIN);
            }
            scaled(Band { low: 0.0, ..moving }, MM_PER_MIN)
        })
    };
    speeds.trace(page, "rapid", width, speed_of(|c| c.rapid));
    speeds.trace(page, "feed", width, speed_of(|c| c.feed));
    speeds.trace(
        page,
        "thin",
        width,
        columns.iter().map(|c| scaled(c.programmed, MM_PER_MIN)),
    );
    stops(page, columns, width, speeds.bottom + 8.0);
}

/// The chart of accelerations, up to the largest one in mm/s^2.
fn accelerations(page: &mut String, columns: &[Column], width: f64, largest: f64) {
    let limit = ceiling((1.05 * largest).max(1e-6), 2.0);
    let accelerations = Panel {
        top: 300.0,
        bottom: 440.0,
        low: -limit,
        high: limit,
    };
    accelerations.scale(page, "acceleration along the path, mm/s^2");
    accelerations.trace(
        page,
        "acceleration",
        width,
        columns.iter().map(|c| scaled(c.acceleration, MM)),
    );
}

fn caption(page: &mut String, speed: &Speed, has_ramps: bool) {
    let window = if speed.least_seconds() > 0.0 {
        format!(
            "at least {WINDOW_EVENTS} step events and {} ms",
            figure(1e3 * speed.least_seconds(), 0.1)
        )
    } else {
        format!("{WINDOW_EVENTS} step events")
    };
    let _ = writeln!(
        page,
        "<p>Speed of the simulated tool over windows of {window}. Each column shows its smallest \
         and its largest value. Acceleration is the change of speed from window to window; \
         acceleration across the path is not included.{}</p>",
        if has_ramps {
            ""
        } else {
            " This machine has no ramps: its speed jumps, and the acceleration is that of a jump \
             over one window."
        }
    );
}

/// Draws bars under the axis while the tool stands still.
fn stops(page: &mut String, columns: &[Column], width: f64, y: f64) {
    let bars = |is_stop: fn(&Column) -> bool| {
        let (mut path, mut index) = (String::new(), 0);
        while index < columns.len() {
            let run = columns[index..].iter().take_while(|c| is_stop(c)).count();
            if run > 0 {
                let x = LEFT + width * index as f64;
                let _ = write!(path, "M{x:.1} {y:.1}h{:.1}", (width * run as f64).max(1.0));
            }
            index += run.max(1);
        }
        path
    };
    for (class, path) in [
        ("stop take-up", bars(|c| c.take_up)),
        ("stop dwell", bars(|c| c.dwell)),
    ] {
        if !path.is_empty() {
            let _ = writeln!(page, "<path class=\"{class}\" d=\"{path}\"/>");
        }
    }
}

/// Draws ticks and figures of the time below panels that end at 250 and 440. The time fills the
/// width of the picture.
pub fn time_scale(page: &mut String, seconds: f64) {
    let (unit, name) = match seconds {
        s if s < 1.0 => (1e-3, "ms"),
        s if s < 180.0 => (1.0, "s"),
        s if s < 10_800.0 => (60.0, "min"),
        _ => (3600.0, "h"),
    };
    let whole = seconds / unit;
    let step = round_up(whole / 10.0);
    let mut at = 0.0;
    while at <= whole * (1.0 + 1e-9) {
        let x = LEFT + (RIGHT - LEFT) * at / whole;
        let _ = write!(
            page,
            "<path class=\"grid\" d=\"M{x:.1} 250v4M{x:.1} 440v5\"/><text x=\"{x:.1}\" y=\"458\" \
             text-anchor=\"middle\">{}</text>",
            figure(at, step)
        );
        at += step;
    }
    let _ = writeln!(
        page,
        "<text x=\"{RIGHT}\" y=\"475\" text-anchor=\"end\">time, {name}</text>"
    );
}

fn legend(page: &mut String) {
    page.push_str(
        "<svg viewBox=\"0 0 1000 28\" role=\"img\" aria-label=\"Legend: feed solid, rapid dashed, \
         programmed feed thin, \
         take-up a bar, dwell a dotted bar\" style=\"border:0\">\n",
    );
    let entries = [
        ("feed", "feed"),
        ("rapid", "rapid"),
        ("thin", "programmed feed"),
        ("stop take-up", "backlash take-up"),
        ("stop dwell", "dwell"),
    ];
    for (index, (class, text)) in entries.iter().enumerate() {
        let _ = writeln!(
            page,
            "<g transform=\"translate({} 14)\"><path class=\"{class}\" d=\"M0 0h40\"/><text \
             x=\"48\" y=\"4\">{text}</text></g>",
            10 + 190 * index
        );
    }
    page.push_str("</svg>\n");
}

/// Rounds up to a multiple of a round step. The result has at most `parts` such steps.
pub fn ceiling(value: f64, parts: f64) -> f64 {
    let step = round_up(value / parts);
    (value / step).ceil() * step
}

/// Rounds up to 1, 2 or 5 times a power of ten.
pub fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|round| *round >= value * (1.0 - 1e-9))
        .unwrap_or(value)
}

/// A value with as many decimals as its step needs.
pub fn figure(value: f64, step: f64) -> String {
    let decimals = (-step.max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text
        .trim_start_matches('-')
        .chars()
        .all(|c| matches!(c, '0' | '.'))
    {
        return "0".to_owned();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_sim::observers::speed::{Move, Stop};

    #[test]
    fn a_motion_with_a_stop_is_drawn() {
        let mut speed = Speed::new(1_000_000, Some(1000));
        speed.turn(Move {
            circle: None,
            programmed: Some(1e6),
        });
        for k in 1..=1000_u32 {
            speed.advance(u64::from(k) * 1000, &[1000.0 * f64::from(k), 0.0, 0.0]);
        }
        speed.stand(2_000_000, Stop::TakeUp);
        let mut page = String::new();
        section(&mut page, &speed, true);
        assert!(page.contains("class=\"feed\"") && page.contains("stop take-up"));
        assert!(page.contains("path speed, mm/min") && page.contains("mm/s^2"));
        assert!(!page.contains("NaN") && !page.contains("inf"));
    }

    #[test]
    fn nothing_is_drawn_without_motion() {
        let mut page = String::new();
        section(&mut page, &Speed::new(1_000_000, None), false);
        assert_eq!(page, "");
    }

    #[test]
    fn values_are_rounded_up() {
        assert_eq!([0.9, 1.0, 1.1, 230.0].map(round_up), [1.0, 1.0, 2.0, 500.0]);
        assert_eq!(
            (figure(0.25, 0.05), figure(-0.0, 1.0)),
            ("0.25".to_owned(), "0".to_owned())
        );
    }
}
