//! Answers, and why there is none.

use crate::diagnostics::{Finding, Findings};
use crate::job::JobError;
use crate::text::json::{write_found, write_line};
use serde::Serialize;
use serde_json::{Value, json};
use std::io;

/// The answer of a call.
#[derive(Debug, Default)]
pub struct Answer {
    /// JSON.
    pub text: Vec<u8>,
    /// What is no JSON: it depends on the call.
    pub data: Vec<u8>,
}

impl Answer {
    /// An answer in JSON.
    ///
    /// # Errors
    ///
    /// The value cannot be written as JSON.
    pub fn of(body: &impl Serialize) -> Result<Self, Failed> {
        Self::with(body, Vec::new())
    }

    /// An answer in JSON with data.
    ///
    /// # Errors
    ///
    /// The value cannot be written as JSON.
    pub fn with(body: &impl Serialize, data: Vec<u8>) -> Result<Self, Failed> {
        let text = serde_json::to_vec(body).map_err(io::Error::from)?;
        Ok(Self { text, data })
    }

    /// An object with the name of its schema.
    ///
    /// # Errors
    ///
    /// The value cannot be written as JSON.
    pub fn listed(schema: &str, body: &impl Serialize) -> Result<Self, Failed> {
        let mut answer = Self::default();
        write_line(schema, body, &mut answer.text)?;
        Ok(answer)
    }

    /// The same with findings in it.
    ///
    /// # Errors
    ///
    /// The value cannot be written as JSON.
    pub fn found(schema: &str, body: &impl Serialize, findings: &Findings) -> Result<Self, Failed> {
        let mut answer = Self::default();
        write_found(schema, body, findings, &mut answer.text)?;
        Ok(answer)
    }
}

/// Why a call has no answer.
#[derive(Debug)]
pub struct Failed {
    /// A sentence.
    pub why: String,
    /// The findings that explain it, as JSON.
    pub findings: Value,
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

    /// The answer that says so: `{"error": ..., "findings": [...]}`.
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
