//! The words of the language.

use super::dimension::Figure;

/// Statements that measure no feature.
pub const ORDERS: [&str; 9] = [
    "units",
    "clearance",
    "search",
    "safe",
    "moves",
    "goto",
    "jog",
    "zero",
    "frame",
];

/// A feature: its keyword, its clauses, and its figures.
pub type Feature = (&'static str, &'static [&'static str], &'static [Figure]);

use Figure::{Angle, Diameter, Form, Length, Width, X, Y, Z};

pub const FEATURES: [Feature; 14] = [
    ("touch", &["towards", "within"], &[X, Y, Z]),
    (
        "point",
        &["at", "towards", "clearance", "search"],
        &[X, Y, Z],
    ),
    (
        "edge",
        &["at", "towards", "points", "over", "clearance", "search"],
        &[X, Y, Z, Angle, Form],
    ),
    (
        "corner",
        &["at", "towards", "inset", "inside", "clearance", "search"],
        &[X, Y, Angle],
    ),
    (
        "web",
        &["at", "along", "width", "clearance", "search"],
        &[X, Y, Z, Width],
    ),
    (
        "pocket",
        &["at", "along", "width", "clearance", "search"],
        &[X, Y, Z, Width],
    ),
    (
        "bore",
        &[
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "boss",
        &[
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "circle",
        &[
            "of",
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "inside",
            "outside",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "plane",
        &["of", "at", "towards", "clearance", "search"],
        &[X, Y, Z, Form],
    ),
    (
        "line",
        &["of", "at", "towards", "clearance", "search"],
        &[X, Y, Z, Angle, Form],
    ),
    (
        "sphere",
        &["of", "at", "diameter", "points", "clearance", "search"],
        &[X, Y, Z, Diameter, Form],
    ),
    ("distance", &["between", "along"], &[Length]),
    ("angle", &["between"], &[Angle]),
];

/// Words that cannot be names, because they have another meaning.
pub const RESERVED: [&str; 20] = [
    "at", "towards", "along", "of", "between", "points", "over", "inset", "inside", "outside",
    "within", "from", "to", "x", "y", "z", "diameter", "width", "form", "length",
];
