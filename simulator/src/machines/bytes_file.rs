//! `[bytes]` of a machine file: the bytes of a link that takes byte commands.

use crate::machines::table::Table;
use husillo_transports::microfactory::ByteTable;

/// Reads `[bytes]`: one character per command, two per motor. A character that is not named is that
/// of [`ByteTable::DEFAULT`].
pub fn read(table: &mut Table<'_, '_>) -> ByteTable {
    let mut bytes = ByteTable::DEFAULT;
    let [first, second] = &mut bytes.machines;
    for (key, byte) in [
        ("home", &mut bytes.home),
        ("manual", &mut bytes.manual),
        ("steps", &mut bytes.steps),
        ("figure", &mut bytes.figure),
        ("stop", &mut bytes.stop),
        ("run", &mut bytes.run),
        ("emergency", &mut bytes.emergency),
        ("clear", &mut bytes.clear),
        ("line", &mut bytes.line),
        ("keep", &mut bytes.keep),
        ("ask", &mut bytes.ask),
        ("switches", &mut bytes.switches),
        ("first", first),
        ("second", second),
        ("lease", &mut bytes.lease),
    ] {
        if let Some([one]) = characters(table, key, "one ASCII character") {
            *byte = one;
        }
    }
    for (key, motor) in ["x", "y", "z", "spindle"]
        .into_iter()
        .zip(&mut bytes.motors)
    {
        if let Some(both) = characters(table, key, "two ASCII characters, forward and backward") {
            *motor = both;
        }
    }
    if !bytes.is_unambiguous() {
        table.wrong(
            table.span(),
            "two commands of `bytes` have the same byte",
            "each command needs its own byte, and `?` is reserved for the answer to a refused one",
        );
    }
    bytes
}

fn characters<const N: usize>(
    table: &mut Table<'_, '_>,
    key: &str,
    wanted: &str,
) -> Option<[u8; N]> {
    let span = table.value(key)?.1;
    let text = table.string(key)?;
    let bytes = text
        .is_ascii()
        .then(|| text.as_bytes().try_into().ok())
        .flatten();
    if bytes.is_none() {
        table.wrong(
            span,
            &format!("`{key}` is {text:?}"),
            &format!("expected {wanted}"),
        );
    }
    bytes
}
