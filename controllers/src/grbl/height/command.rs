//! `$Z` commands.

use husillo_transports::grbl::{ErrorCode, HeightLine, decimal};

use super::super::lines::{Outcome, Task};
use super::super::{Grbl, Phase};
use super::map::HeightMap;

/// Decimals of a millimetre in a nanometre.
const NM_PLACES: u8 = 6;
/// Largest height, depth and feed: what 32 bits hold.
const MOST_NM: i64 = i32::MAX as i64;

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Executes the text after `$Z`. The axes are at rest, in Idle or Alarm.
    ///
    /// # Errors
    /// Fails with the error that answers the line. Nothing has changed in this case.
    pub(in super::super) fn map_command(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        if !self.options.has_height_map {
            return Err(ErrorCode::InvalidStatement);
        }
        match text {
            b"" => {
                self.task = Task::Map(0);
                return Ok(Outcome::Waits);
            }
            b"=0" if self.height.is_on() => self.switch_map_off(),
            b"=0" => {}
            b"=1" if self.phase == Phase::Alarm => return Err(ErrorCode::Locked),
            b"=1" => {
                if !self.switch_map_on() {
                    return Err(ErrorCode::InvalidStatement);
                }
            }
            // What follows changes the map.
            _ if self.height.is_on() => return Err(ErrorCode::NotIdle),
            b"C" => self.keep_map(HeightMap::NONE),
            b"Z" => self.level_here()?,
            [b'G', b'=', numbers @ ..] => {
                let map = self.grid_of(numbers)?;
                self.keep_map(map);
            }
            [b'P', b'=', numbers @ ..] => {
                let [depth, feed] = numbers_of(numbers)?;
                let range = 1..=MOST_NM;
                let exists = self.memory.map.exists();
                if !exists || !range.contains(&depth) || feed < 1 {
                    return Err(ErrorCode::InvalidStatement);
                }
                if self.phase == Phase::Alarm {
                    return Err(ErrorCode::Locked);
                }
                return self.begin_survey(depth, feed);
            }
            text => self.write_height(text)?,
        }
        Ok(Outcome::Done)
    }

    fn keep_map(&mut self, map: HeightMap) {
        if map != self.memory.map {
            self.memory.map = map;
            self.store();
        }
    }

    /// Reads X and Y of the first point, width and depth, columns and rows.
    fn grid_of(&self, text: &[u8]) -> Result<HeightMap, ErrorCode> {
        let [x, y, width, depth, columns, rows] = numbers_of(text)?;
        let origin = [self.of_work(0, x).0, self.of_work(1, y).0];
        let points = [columns, rows].map(|nm| {
            let (whole, rest) = (nm / 1_000_000, nm % 1_000_000);
            if rest == 0 { whole } else { 0 }
        });
        // No product or sum of the map leaves 64 bits.
        let is_near = [x, y, width, depth]
            .iter()
            .all(|nm| nm.unsigned_abs() <= 1 << 40);
        let map = HeightMap::level(origin, [width, depth], points);
        map.filter(|_| is_near).ok_or(ErrorCode::InvalidStatement)
    }

    /// `$Z12=0.05`: sets the height of a point.
    fn write_height(&mut self, text: &[u8]) -> Result<(), ErrorCode> {
        let (number, rest) = decimal(text, 0).ok_or(ErrorCode::InvalidStatement)?;
        let value = rest.strip_prefix(b"=").ok_or(ErrorCode::InvalidStatement)?;
        let [nm] = numbers_of(value)?;
        let height = i32::try_from(nm).map_err(|_| ErrorCode::InvalidStatement)?;
        let is_plain = text.first().is_some_and(u8::is_ascii_digit);
        let number = usize::try_from(number).ok().filter(|_| is_plain);
        let number = number.filter(|number| *number < self.memory.map.count());
        let mut map = self.memory.map;
        let slot = number.and_then(|number| map.heights.get_mut(number));
        *slot.ok_or(ErrorCode::InvalidStatement)? = height;
        self.keep_map(map);
        Ok(())
    }

    /// `$ZZ`: the height of the present place is 0 from now on.
    fn level_here(&mut self) -> Result<(), ErrorCode> {
        let [x, y, _] = self.machine.end_position();
        let mut map = self.memory.map;
        if !map.exists() {
            return Err(ErrorCode::InvalidStatement);
        }
        let here = map.height_at([x.0, y.0]);
        for height in &mut map.heights {
            *height = height.saturating_sub(here);
        }
        self.keep_map(map);
        Ok(())
    }

    /// Sends line `number` of the map. Returns whether there may be more to do.
    pub(in super::super) fn list_map(&mut self, number: u8) -> bool {
        let map = &self.memory.map;
        let [columns, rows] = map.points;
        if number == 0 {
            let mut origin = map.origin;
            if map.exists() {
                for (nm, zero) in origin.iter_mut().zip(self.work_zero_now()) {
                    *nm = nm.saturating_sub(zero);
                }
            }
            let line = HeightLine::Grid {
                is_on: self.height.is_on(),
                origin,
                size: map.size,
                points: map.points,
            };
            self.send_text(&line.write());
        } else if number <= rows && map.exists() {
            let row = number.saturating_sub(1);
            let heights = (0..columns).map(|column| map.height(column, row));
            let line = HeightLine::row(row, heights);
            self.send_text(&line.write());
        } else {
            self.end_line(Ok(Outcome::Done));
            return true;
        }
        self.task = Task::Map(number.saturating_add(1));
        true
    }
}

/// Reads numbers with commas between them, in millionths.
fn numbers_of<const N: usize>(text: &[u8]) -> Result<[i64; N], ErrorCode> {
    let mut numbers = [0; N];
    let mut rest = text;
    for (index, number) in (0..N).zip(&mut numbers) {
        if index > 0 {
            rest = rest.strip_prefix(b",").ok_or(ErrorCode::InvalidStatement)?;
        }
        (*number, rest) = decimal(rest, NM_PLACES).ok_or(ErrorCode::BadNumber)?;
    }
    if rest.is_empty() {
        Ok(numbers)
    } else {
        Err(ErrorCode::InvalidStatement)
    }
}
