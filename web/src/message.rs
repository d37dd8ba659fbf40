//! Requests and answers as bytes.

use husillo_simulator::calls::Answer;

/// A request: the text in JSON, and the binary data.
pub struct Request<'a> {
    pub text: &'a [u8],
    pub data: &'a [u8],
}

impl<'a> Request<'a> {
    /// Its parts; `None` if it is cut off.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (length, rest) = bytes.split_first_chunk()?;
        let (text, data) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        Some(Self { text, data })
    }
}

/// An answer as bytes.
pub fn bytes(mut answer: Answer) -> Vec<u8> {
    let mut bytes = (answer.text.len() as u32).to_le_bytes().to_vec();
    bytes.append(&mut answer.text);
    bytes.append(&mut answer.data);
    bytes
}
