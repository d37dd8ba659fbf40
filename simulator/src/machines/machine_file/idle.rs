//! `[idle]` of a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::Quantity;

/// Motor current at standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// Full current.
    Hold,
    /// Reduced current after this many microseconds.
    Reduced(u64),
    /// No current after this many microseconds.
    Off(u64),
}

impl Idle {
    /// Reads the table.
    pub(super) fn read(table: &mut Table<'_, '_>) -> Self {
        let after = table
            .quantity(
                "after",
                "a time as in \"30 s\"",
                |quantity| match quantity {
                    Quantity::Time(time) => u64::try_from(time.rounded()).ok(),
                    _ => None,
                },
            )
            .unwrap_or(0);
        let policy = table.choice(
            "policy",
            &[
                ("hold", Idle::Hold),
                ("reduced", Idle::Reduced(after)),
                ("off", Idle::Off(after)),
            ],
        );
        policy.unwrap_or(Idle::Hold)
    }
}
