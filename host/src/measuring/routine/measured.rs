//! The time at which a routine was measured.

use jiff::Timestamp;

/// The present time, UTC, as in `2026-11-25 10:40`. `SOURCE_DATE_EPOCH` in the environment replaces
/// it, so that a report can be reproduced exactly.
///
/// Source: <https://reproducible-builds.org/specs/source-date-epoch/>.
pub fn now() -> String {
    let given = std::env::var("SOURCE_DATE_EPOCH").ok();
    let given = given.and_then(|seconds| Timestamp::from_second(seconds.parse().ok()?).ok());
    let time = given.unwrap_or_else(Timestamp::now);
    time.strftime("%Y-%m-%d %H:%M UTC").to_string()
}
