//! The built-in machines.

/// Name, path and text of each built-in machine.
pub const BUILT_IN: [(&str, &str, &str); 9] = [
    (
        "micromill",
        "machines/micromill.toml",
        include_str!("../../../machines/micromill.toml"),
    ),
    (
        "free",
        "machines/free.toml",
        include_str!("../../../machines/free.toml"),
    ),
    (
        "free6",
        "machines/free6.toml",
        include_str!("../../../machines/free6.toml"),
    ),
    (
        "router",
        "machines/router.toml",
        include_str!("../../../machines/router.toml"),
    ),
    (
        "router4",
        "machines/router4.toml",
        include_str!("../../../machines/router4.toml"),
    ),
    (
        "lathe",
        "machines/lathe.toml",
        include_str!("../../../machines/lathe.toml"),
    ),
    (
        "printer",
        "machines/printer.toml",
        include_str!("../../../machines/printer.toml"),
    ),
    (
        "drill",
        "machines/drill.toml",
        include_str!("../../../machines/drill.toml"),
    ),
    (
        "microfactory",
        "machines/microfactory.toml",
        include_str!("../../../machines/microfactory.toml"),
    ),
];

/// Name, path and text of each built-in measuring machine.
pub const MEASURING: [(&str, &str, &str); 2] = [
    (
        "cmm",
        "machines/cmm.toml",
        include_str!("../../../machines/cmm.toml"),
    ),
    (
        "cmm3",
        "machines/cmm3.toml",
        include_str!("../../../machines/cmm3.toml"),
    ),
];
