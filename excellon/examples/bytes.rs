//! Holes from bytes as they arrive, as a controller without a file system reads them.
//!
//! `cargo run -p husillo-excellon --example bytes`. The loop uses no heap: on a chip, `PORT` is a
//! UART, and `drill` moves the axes. A whole file cannot be kept there to infer its format, so the
//! operator sets it.

use husillo_excellon::{Error, Feature, Hole, Inference, Overrides, Profile, Reader, Units, Zeros};

const PORT: &[u8] = b"T1C0.8\nT2C1.0\n%\nT1\nX10.0Y5.0\nX12.54Y5.0\nT2\nX20.0Y20.0\nM30\n";

/// A line of up to 96 bytes. The rest of a longer one is dropped.
struct Line {
    bytes: [u8; 96],
    length: usize,
}

impl Line {
    /// Takes a byte. Returns whether it ends the line.
    fn push(&mut self, byte: u8) -> bool {
        if byte == b'\n' {
            return true;
        }
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
        false
    }
}

fn drill(hole: &Hole) {
    let [x, y] = hole.at_nm;
    println!("X {x} nm, Y {y} nm, tool {}", hole.tool.number);
}

fn main() -> Result<(), Error> {
    let set_by_operator = Overrides {
        units: Some(Units::Millimetres),
        zeros: Some(Zeros::Trailing),
        digits: None,
        profile: Profile::Excellon,
    };
    let mut reader = Reader::<16>::new(&Inference::new().settle(&set_by_operator));
    let mut line = Line {
        bytes: [0; 96],
        length: 0,
    };
    for byte in PORT {
        if !line.push(*byte) {
            continue;
        }
        for feature in reader.read(&line.bytes[..line.length])? {
            if let Feature::Hole(hole) = feature {
                drill(&hole);
            }
        }
        line.length = 0;
    }
    assert!(reader.is_ended());
    Ok(())
}
