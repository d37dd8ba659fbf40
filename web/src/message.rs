//! Requests and answers as bytes.

use husillo_simulator::diagnostics::{Finding, Findings};
use husillo_simulator::job::JobError;
use serde::Serialize;
use serde_json::{Value, json};
use std::io;

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

/// An answer.
#[derive(Debug, Default)]
pub struct Answer {
    pub text: Vec<u8>,
    pub data: Vec<u8>,
}

impl Answer {
    /// An answer in JSON.
    pub fn of(body: &impl Serialize) -> Result<Self, Failed> {
        Self::with(body, Vec::new())
    }

    /// An answer in JSON with binary data.
    pub fn with(body: &impl Serialize, data: Vec<u8>) -> Result<Self, Failed> {
        let text = serde_json::to_vec(body).map_err(io::Error::from)?;
        Ok(Self { text, data })
    }

    /// As bytes.
    pub fn bytes(mut self) -> Vec<u8> {
        let mut bytes = (self.text.len() as u32).to_le_bytes().to_vec();
        bytes.append(&mut self.text);
        bytes.append(&mut self.data);
        bytes
    }
}

/// Why a request has no answer.
#[derive(Debug)]
pub struct Failed {
    why: String,
    findings: Value,
}

impl Failed {
    /// A reason, with the findings that explain it.
    pub fn found(why: String, findings: &[Finding]) -> Self {
        let findings = serde_json::to_value(findings).unwrap_or_default();
        Self { why, findings }
    }

    /// The reason of a program with errors.
    pub fn refused(name: &str, findings: &Findings) -> Self {
        let (errors, warnings) = (findings.errors, findings.warnings);
        let why = format!("{name}: errors: {errors}, warnings: {warnings}");
        Self::found(why, findings.kept())
    }

    /// The answer that says so.
    pub fn answer(self) -> Answer {
        let body = json!({"error": self.why, "findings": self.findings});
        Answer {
            text: body.to_string().into_bytes(),
            data: Vec::new(),
        }
    }
}

impl From<String> for Failed {
    fn from(why: String) -> Self {
        Self::found(why, &[])
    }
}

impl From<io::Error> for Failed {
    fn from(error: io::Error) -> Self {
        error.to_string().into()
    }
}

impl From<JobError> for Failed {
    fn from(error: JobError) -> Self {
        error.to_string().into()
    }
}
