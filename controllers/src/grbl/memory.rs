//! Data that is kept while the power is off.

use husillo_transports::grbl::{LINE_CHARACTERS, Settings};

#[cfg(feature = "grblhal")]
use super::hal::HalMemory;
#[cfg(feature = "height-map")]
use super::height::HeightMap;

/// A stored line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StoredLine<const N: usize = LINE_CHARACTERS> {
    text: [u8; N],
    length: u8,
}

impl<const N: usize> StoredLine<N> {
    pub(super) const EMPTY: Self = StoredLine {
        text: [0; N],
        length: 0,
    };

    /// Stores a text. A line of the link always fits.
    pub(super) fn new(text: &[u8]) -> Self {
        let mut line = Self::EMPTY;
        for (slot, byte) in line.text.iter_mut().zip(text) {
            *slot = *byte;
            line.length = line.length.wrapping_add(1); // at most 255
        }
        line
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.text
            .get(..usize::from(self.length))
            .unwrap_or_default()
    }
}

/// Settings, coordinate data and stored lines of a controller, which are kept while the power is
/// off.
///
/// The controller returns [`GrblEvent::Store`](crate::GrblEvent::Store) when its memory has
/// changed. The caller stores the [bytes](GrblMemory::to_bytes), for example with `husillo-store`,
/// and passes them to the controller at the next start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblMemory {
    pub(super) settings: Settings,
    /// Positions of G54 to G59, G28 and G30, in nanometres.
    pub(super) places: [[i64; 3]; 8],
    /// The lines of `$N0` and `$N1`, and the text of `$I`.
    pub(super) lines: [StoredLine; 3],
    #[cfg(feature = "grblhal")]
    pub(super) hal: HalMemory,
    #[cfg(feature = "height-map")]
    pub(super) map: HeightMap,
}

const PLACES_BYTES: usize = 8 * 3 * 8;
const LINE_BYTES: usize = LINE_CHARACTERS + 1;
/// Bytes of the data that only the protocol of grblHAL needs.
#[cfg(feature = "grblhal")]
const HAL_BYTES: usize = HalMemory::BYTES;
#[cfg(not(feature = "grblhal"))]
const HAL_BYTES: usize = 0;
/// Bytes of the height map.
#[cfg(feature = "height-map")]
const MAP_BYTES: usize = HeightMap::BYTES;
#[cfg(not(feature = "height-map"))]
const MAP_BYTES: usize = 0;

impl GrblMemory {
    /// Number of bytes of the stored form.
    pub const BYTES: usize =
        1 + Settings::BYTES + PLACES_BYTES + 3 * LINE_BYTES + HAL_BYTES + MAP_BYTES;
    /// First byte of the stored form: its version.
    const FORM: u8 = 1;

    /// The memory of a new machine.
    pub const FACTORY: GrblMemory = GrblMemory {
        settings: Settings::DEFAULT,
        places: [[0; 3]; 8],
        lines: [StoredLine::EMPTY; 3],
        #[cfg(feature = "grblhal")]
        hal: HalMemory::FACTORY,
        #[cfg(feature = "height-map")]
        map: HeightMap::NONE,
    };

    /// Returns this memory with other settings.
    pub const fn with_settings(self, settings: Settings) -> Self {
        GrblMemory { settings, ..self }
    }

    /// Returns the settings.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Converts the memory to its stored form.
    pub fn to_bytes(&self) -> [u8; GrblMemory::BYTES] {
        let mut bytes = [0; GrblMemory::BYTES];
        let settings = self.settings.to_bytes();
        let places = self.places.iter().flatten();
        let places = places.flat_map(|place| place.to_le_bytes());
        let lines = self.lines.iter();
        let lines = lines.flat_map(|line| core::iter::once(line.length).chain(line.text));
        let all = core::iter::once(Self::FORM)
            .chain(settings)
            .chain(places)
            .chain(lines);
        #[cfg(feature = "grblhal")]
        let all = all.chain(self.hal.bytes());
        #[cfg(feature = "height-map")]
        let all = all.chain(self.map.bytes());
        for (slot, byte) in bytes.iter_mut().zip(all) {
            *slot = byte;
        }
        bytes
    }

    /// Reads the stored form. Returns `None` if length or version differ.
    pub fn from_bytes(bytes: &[u8]) -> Option<GrblMemory> {
        let (form, rest) = bytes.split_first()?;
        let (settings, rest) = rest.split_first_chunk()?;
        let others = PLACES_BYTES + 3 * LINE_BYTES + HAL_BYTES + MAP_BYTES;
        if *form != Self::FORM || rest.len() != others {
            return None;
        }
        let mut memory = GrblMemory {
            settings: Settings::from_bytes(settings),
            ..GrblMemory::FACTORY
        };
        // Not `chunks_exact` with `zip`: it keeps a division by the length, which could panic.
        let mut rest = rest;
        for slot in memory.places.iter_mut().flatten() {
            let (bytes, others) = rest.split_first_chunk()?;
            *slot = i64::from_le_bytes(*bytes);
            rest = others;
        }
        for slot in &mut memory.lines {
            let (bytes, others) = rest.split_first_chunk::<LINE_BYTES>()?;
            let (length, text) = bytes.split_first()?;
            *slot = StoredLine::new(text.get(..usize::from(*length))?);
            rest = others;
        }
        #[cfg(feature = "grblhal")]
        {
            let (bytes, others) = rest.split_at_checked(HAL_BYTES)?;
            memory.hal = HalMemory::from_bytes(bytes)?;
            rest = others;
        }
        #[cfg(feature = "height-map")]
        {
            memory.map = HeightMap::take(&mut rest)?;
        }
        rest.is_empty().then_some(memory)
    }
}
