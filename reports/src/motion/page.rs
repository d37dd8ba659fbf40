//! The page of `husillo compare motion`: the table, and a picture of each rule.

use super::{MEANING, Motion, TITLES};
use crate::chart::{LEFT, Panel, RIGHT, ceiling, time_scale};
use crate::frame;
use crate::text::duration;
use husillo_methods::motion::{Figures, Profile};
use husillo_sim::observers::speed::Band;
use std::fmt::Write;

/// Columns of a picture.
const COLUMNS: usize = 900;

/// Largest values of all rules.
struct Largest {
    seconds: f64,
    speed: f64,
    acceleration: f64,
    jerk: f64,
}

/// Writes the page.
pub fn html(of: &Motion) -> String {
    let title = format!("{}: motion compared", of.title);
    let line = "The speed along one path by the rules of several controllers";
    let mut page = frame::open(&title, &of.title, line, "");
    table(&mut page, of);
    let most = |value: fn(&Figures) -> f64| {
        let values = of.rules.iter().map(|(figures, _)| value(figures));
        values.fold(1e-9, f64::max)
    };
    let largest = Largest {
        seconds: most(|figures| figures.seconds),
        speed: most(|figures| figures.top_speed),
        acceleration: most(|figures| figures.acceleration),
        jerk: most(|figures| figures.jerk.unwrap_or(0.0)),
    };
    for (figures, profile) in &of.rules {
        picture(&mut page, figures, profile, &largest);
    }
    frame::notes(&mut page, &of.notes);
    frame::close(page, None)
}

fn table(page: &mut String, of: &Motion) {
    page.push_str(
        "<section><h2>Figures</h2><div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>",
    );
    for title in TITLES {
        // Writing to a String cannot fail.
        let _ = write!(page, "<th scope=\"col\">{title}</th>");
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for [rule, cells @ ..] in of.rows() {
        let _ = write!(page, "<tr><th scope=\"row\">{rule}</th>");
        for cell in cells {
            let _ = write!(page, "<td>{cell}</td>");
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody></table></div>\n");
    for text in MEANING {
        let _ = writeln!(page, "<p>{text}</p>");
    }
    page.push_str("</section>\n");
}

/// Speed, acceleration and jerk over time, on the same scales for all rules.
fn picture(page: &mut String, figures: &Figures, profile: &Profile, largest: &Largest) {
    let name = figures.rule.name();
    let _ = writeln!(
        page,
        "<section><h2>{name}: {}</h2>\n<svg viewBox=\"0 0 1000 480\" role=\"img\" \
         aria-labelledby=\"{name}-t\"><title id=\"{name}-t\">Speed, acceleration and jerk over \
         time by the rule {name}</title>",
        duration(figures.seconds)
    );
    let columns = profile.columns(COLUMNS, largest.seconds / COLUMNS as f64);
    let width = (RIGHT - LEFT) / COLUMNS as f64;
    let panel = |top: f64, bottom: f64, low: f64, high: f64| Panel {
        top,
        bottom,
        low,
        high,
    };
    let both = |value: f64| ceiling((1.05 * value).max(1e-6), 2.0);
    let [acceleration, jerk] = [both(largest.acceleration), both(largest.jerk)];
    let speed = ceiling(1.05 * largest.speed, 4.0);
    let panels = [
        ("path speed, mm/s", "feed", panel(30.0, 130.0, 0.0, speed)),
        (
            "acceleration along the path, mm/s^2",
            "acceleration",
            panel(165.0, 250.0, -acceleration, acceleration),
        ),
        (
            "jerk along the path, mm/s^3",
            "acceleration",
            panel(300.0, 440.0, -jerk, jerk),
        ),
    ];
    for (number, (title, class, panel)) in panels.iter().enumerate() {
        if number == 2 && figures.jerk.is_none() {
            let _ = writeln!(
                page,
                "<text x=\"{LEFT}\" y=\"291\">The acceleration jumps by up to {:.0} mm/s^2: the \
                 jerk has no limit.</text>",
                figures.acceleration_jump
            );
            continue;
        }
        panel.scale(page, title);
        let bands = columns.iter().map(|column| Band {
            low: column[number].low as f32,
            high: column[number].high as f32,
        });
        panel.trace(page, class, width, bands);
    }
    time_scale(page, largest.seconds);
    page.push_str("</svg></section>\n");
}
