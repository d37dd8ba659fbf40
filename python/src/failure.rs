//! Why a call has no answer, as an exception.

use husillo_simulator::calls;
use pyo3::exceptions::PyException;
use pyo3::{PyErr, create_exception};
use serde::de::DeserializeOwned;

create_exception!(
    _native,
    Failed,
    PyException,
    "A call has no answer: a sentence, and its findings in JSON."
);

/// A reason that threads can pass on.
#[derive(Clone, Debug)]
pub struct Reason {
    why: String,
    findings: String,
}

impl From<calls::Failed> for Reason {
    fn from(failed: calls::Failed) -> Self {
        Self {
            why: failed.why,
            findings: failed.findings.to_string(),
        }
    }
}

impl From<String> for Reason {
    fn from(why: String) -> Self {
        calls::Failed::from(why).into()
    }
}

impl From<Reason> for PyErr {
    fn from(Reason { why, findings }: Reason) -> Self {
        Failed::new_err((why, findings))
    }
}

/// A mistake of this package.
pub fn fault() -> PyErr {
    Reason::from("fault in husillo: a call has ended without a result".to_owned()).into()
}

/// Reads options. They are read as a value first, so that an error has no place in JSON that the
/// caller has not written.
pub fn options<T: DeserializeOwned>(json: &str) -> Result<T, calls::Failed> {
    let value: Result<serde_json::Value, _> = serde_json::from_str(json);
    let read = value.and_then(T::deserialize);
    read.map_err(|error| format!("options: {error}").into())
}
