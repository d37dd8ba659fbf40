//! Any bytes on the line of a Grbl controller, at either end.

use husillo_transports::grbl::{
    Line, LineReader, Message, Receiver, Settings, Units, key_and_value,
};

/// - Each line end gives one line, within its length, whatever came before it.
/// - A message that was read is written, and read again as the same line.
/// - A setting that is taken is printed and read back.
pub fn grbl(data: &[u8]) {
    let (mut receiver, mut reader) = (Receiver::<128>::new(), LineReader::new());
    let mut settings = Settings::DEFAULT;
    let (mut lines, mut ends) = (0, 0);
    for byte in data {
        ends += u32::from(matches!(byte, b'\r' | b'\n'));
        receiver.push(*byte);
        while let Some(byte) = receiver.take() {
            let Some(line) = reader.push(byte) else {
                continue;
            };
            lines += 1;
            if let Line::Text([b'$', setting @ ..]) = line {
                let Ok((number, value)) = key_and_value(setting) else {
                    continue;
                };
                let before = settings;
                match settings.write(number, value) {
                    Err(_) => assert_eq!(settings, before),
                    Ok(()) => assert_eq!(Settings::from_bytes(&settings.to_bytes()), settings),
                }
            }
        }
    }
    assert_eq!(lines, ends);
    for line in data.split(|byte| *byte == b'\n') {
        if let Some(message) = Message::parse(line) {
            let text = message.write(Units::Millimetres);
            let again =
                Message::parse(text.bytes()).map(|message| message.write(Units::Millimetres));
            assert!(line.len() > 200 || again.is_some_and(|again| again == text));
        }
    }
}
