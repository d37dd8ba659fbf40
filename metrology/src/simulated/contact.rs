//! Faces of a simulated work piece.

use std::str::FromStr;

/// A face before one axis. The contact of the probe is closed from a count on, in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// Address of the module, from 1.
    pub module: u8,
    count: i64,
    /// Whether the contact is closed at and below the count, not at and above it.
    is_below: bool,
}

impl Contact {
    /// Whether the probe touches the face when the motor is at `counts`.
    pub const fn is_closed(self, counts: i64) -> bool {
        if self.is_below {
            counts <= self.count
        } else {
            counts >= self.count
        }
    }
}

impl Contact {
    /// Whether the face is touched in the positive direction.
    pub(super) const fn is_touched_upwards(self) -> bool {
        !self.is_below
    }
}

impl FromStr for Contact {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(':').and_then(|(module, place)| {
            let (count, is_below) = match (place.strip_prefix(".."), place.strip_suffix("..")) {
                (Some(count), _) => (count, true),
                (None, Some(count)) => (count, false),
                (None, None) => (place, false),
            };
            let module = module.parse().ok().filter(|module| *module > 0)?;
            Some(Self {
                module,
                count: count.parse().ok()?,
                is_below,
            })
        });
        parsed.ok_or_else(|| {
            "expected MODULE:COUNT, closed from this count on, or MODULE:..COUNT, closed up to \
             it"
            .into()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides() {
        let closed = |text: &str| {
            let contact: Contact = text.parse().unwrap();
            [2999, 3000, 3001].map(|counts| contact.is_closed(counts))
        };
        assert_eq!(closed("1:3000"), [false, true, true]);
        assert_eq!(closed("1:3000.."), [false, true, true]);
        assert_eq!(closed("1:..3000"), [true, true, false]);
        for text in ["", "3000", "0:3000", "1:", "x:1", "1:..1.."] {
            assert!(text.parse::<Contact>().is_err(), "{text}");
        }
    }
}
