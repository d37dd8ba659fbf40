//! The built-in machines.

/// Name, path and text of each built-in machine.
pub const BUILT_IN: [(&str, &str, &str); 6] = [
    (
        "micromill",
        "machines/micromill.toml",
        include_str!("../../../../machines/micromill.toml"),
    ),
    (
        "free",
        "machines/free.toml",
        include_str!("../../../../machines/free.toml"),
    ),
    (
        "router",
        "machines/router.toml",
        include_str!("../../../../machines/router.toml"),
    ),
    (
        "lathe",
        "machines/lathe.toml",
        include_str!("../../../../machines/lathe.toml"),
    ),
    (
        "drill",
        "machines/drill.toml",
        include_str!("../../../../machines/drill.toml"),
    ),
    (
        "microfactory",
        "machines/microfactory.toml",
        include_str!("../../../../machines/microfactory.toml"),
    ),
];
