//! Storage of parameters.

use super::value::Value;
use crate::error::parameters::Fault;

/// The highest number of a parameter.
pub(super) const LAST: i64 = 5602;

/// The last of the numbered parameters that are local to each subroutine.
pub(super) const LAST_LOCAL: u16 = 30;

/// The last number that is never a parameter of the machine.
pub(super) const LAST_USER: u16 = 5000;

/// Some letters as capitals; the rest beyond the length of the longest known name is cut off.
#[derive(Copy, Clone, Debug, Default)]
pub(super) struct Capitals {
    bytes: [u8; 24],
    count: usize,
}

impl Capitals {
    pub(super) fn push(&mut self, byte: u8) {
        if let Some(slot) = self.bytes.get_mut(self.count) {
            *slot = byte;
            self.count = self.count.wrapping_add(1);
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.count).unwrap_or_default()
    }
}

/// The rest of a name that begins with `_`, as predefined names do.
pub(super) fn predefined(name: &[u8]) -> Option<Capitals> {
    let mut bytes = letters(name);
    if bytes.next() != Some(b'_') {
        return None;
    }
    let mut rest = Capitals::default();
    bytes.for_each(|byte| rest.push(byte));
    Some(rest)
}

/// Identifies a parameter: a number, or a name as written in the text.
#[derive(Copy, Clone, Debug)]
pub(super) enum Key<'t> {
    Number(u16),
    Name(&'t [u8]),
}

/// The significant bytes of a name: without blanks, in capitals.
fn letters(name: &[u8]) -> impl Iterator<Item = u8> + '_ {
    name.iter()
        .filter(|byte| !matches!(byte, b' ' | b'\t' | b'\r' | b'\n'))
        .map(u8::to_ascii_uppercase)
}

/// Whether two names are equal except for case and blanks.
pub(super) fn is_same_name(left: &[u8], right: &[u8]) -> bool {
    letters(left).eq(letters(right))
}

impl<'t> Key<'t> {
    /// The parameter of this number; `None` for a number that is not whole or not from 1 to 5602.
    pub(super) fn numbered(number: Value) -> Option<Key<'t>> {
        let number = number
            .whole()
            .filter(|number| (1..=LAST).contains(number))?;
        u16::try_from(number).ok().map(Key::Number)
    }

    fn is(self, other: Key<'_>) -> bool {
        match (self, other) {
            (Key::Number(left), Key::Number(right)) => left == right,
            (Key::Name(left), Key::Name(right)) => is_same_name(left, right),
            _ => false,
        }
    }

    /// Whether each subroutine has its own: #1 to #30, and names without a leading `_`.
    fn is_local(self) -> bool {
        match self {
            Key::Number(number) => number <= LAST_LOCAL,
            Key::Name(name) => letters(name).next() != Some(b'_'),
        }
    }

    fn hash(self) -> u32 {
        let mix = |hash: u32, byte: u32| (hash ^ byte).wrapping_mul(0x0100_0193);
        match self {
            Key::Number(number) => mix(0x811c_9dc5, u32::from(number)),
            Key::Name(name) => {
                letters(name).fold(0x811c_9dc5, |hash, byte| mix(hash, u32::from(byte)))
            }
        }
    }
}

#[derive(Copy, Clone, Debug)]
struct Entry<'t> {
    key: Key<'t>,
    value: Value,
}

/// Numbered and named parameters: `GLOBALS` that are visible everywhere, and `LOCALS` of the main
/// program and all running subroutines together. Only parameters that were assigned take room.
///
/// A global parameter is found by its hash, in one or two probes while the table is not nearly
/// full. A local one is found by a search of those of its subroutine.
#[derive(Clone, Debug)]
pub(super) struct Table<'t, const GLOBALS: usize, const LOCALS: usize> {
    globals: [Option<Entry<'t>>; GLOBALS],
    locals: [Entry<'t>; LOCALS],
    /// Number of locals in use; `base..count` are those of the running subroutine.
    count: usize,
    base: usize,
}

impl<'t, const GLOBALS: usize, const LOCALS: usize> Table<'t, GLOBALS, LOCALS> {
    pub(super) const fn new() -> Self {
        let unused = Entry {
            key: Key::Number(0),
            value: Value::ZERO,
        };
        Table {
            globals: [None; GLOBALS],
            locals: [unused; LOCALS],
            count: 0,
            base: 0,
        }
    }

    /// The slots of a global parameter in the order of the search.
    fn slots(key: Key<'_>) -> impl Iterator<Item = usize> {
        // Below GLOBALS; an empty table has no slots.
        let first = (key.hash() as usize).checked_rem(GLOBALS).unwrap_or(0);
        (first..GLOBALS).chain(0..first.min(GLOBALS))
    }

    fn current(&self) -> &[Entry<'t>] {
        self.locals.get(self.base..self.count).unwrap_or_default()
    }

    /// The value of a parameter; `None` when it was never assigned.
    pub(super) fn get(&self, key: Key<'_>) -> Option<Value> {
        if key.is_local() {
            let found = self.current().iter().find(|entry| entry.key.is(key))?;
            return Some(found.value);
        }
        for slot in Self::slots(key) {
            let entry = self.globals.get(slot).copied().flatten()?;
            if entry.key.is(key) {
                return Some(entry.value);
            }
        }
        None
    }

    /// Sets the value of a parameter.
    pub(super) fn set(&mut self, key: Key<'t>, value: Value) -> Result<(), Fault> {
        if key.is_local() {
            let current = self
                .locals
                .get_mut(self.base..self.count)
                .unwrap_or_default();
            if let Some(entry) = current.iter_mut().find(|entry| entry.key.is(key)) {
                entry.value = value;
                return Ok(());
            }
            return self.push(key, value);
        }
        for slot in Self::slots(key) {
            let Some(entry) = self.globals.get_mut(slot) else {
                break;
            };
            if entry.is_none_or(|entry| entry.key.is(key)) {
                *entry = Some(Entry { key, value });
                return Ok(());
            }
        }
        Err(Fault::ParametersFull)
    }

    /// Adds a new local whose name does not exist yet.
    fn push(&mut self, key: Key<'t>, value: Value) -> Result<(), Fault> {
        let slot = self
            .locals
            .get_mut(self.count)
            .ok_or(Fault::ParametersFull)?;
        *slot = Entry { key, value };
        self.count = self.count.wrapping_add(1);
        Ok(())
    }

    /// Begins a subroutine with #1, #2, ... Returns the argument for [`Table::leave`].
    pub(super) fn enter(&mut self, arguments: &[Value]) -> Result<usize, Fault> {
        let caller = self.base;
        let base = self.count;
        for (number, value) in (1u16..).zip(arguments) {
            if let Err(fault) = self.push(Key::Number(number), *value) {
                self.count = base;
                return Err(fault);
            }
        }
        self.base = base;
        Ok(caller)
    }

    /// Ends a subroutine and drops its locals.
    pub(super) fn leave(&mut self, caller: usize) {
        self.count = self.base;
        self.base = caller;
    }
}
