//! The native part of the Python package `husillo`: options in JSON and a program as bytes in,
//! answers in JSON and columns as bytes out. The package in `source/husillo` gives them types.
//!
//! No function holds the interpreter while it computes.

mod failure;
mod stream;

use pyo3::prelude::*;

/// The functions that the package calls.
#[pymodule(name = "_native")]
mod native {
    use crate::failure::{self, Reason};
    use husillo_simulator::calls;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::failure::Failed;
    #[pymodule_export]
    use crate::stream::Stream;

    /// The built-in machines.
    #[pyfunction]
    fn machines(py: Python<'_>) -> PyResult<String> {
        text(py, calls::machines)
    }

    /// A machine with its axes and the text of its file.
    #[pyfunction]
    fn machine(py: Python<'_>, options: &str) -> PyResult<String> {
        text(py, || calls::machine(&failure::options(options)?))
    }

    /// Checks a program or a drill file.
    #[pyfunction]
    fn check(py: Python<'_>, options: &str, program: &[u8]) -> PyResult<String> {
        text(py, || calls::check(&failure::options(options)?, program))
    }

    /// The commands of a program: findings, then one command a line.
    #[pyfunction]
    fn commands(py: Python<'_>, options: &str, program: &[u8]) -> PyResult<(String, String)> {
        texts(py, || calls::commands(&failure::options(options)?, program))
    }

    /// Compares methods of interpolation.
    #[pyfunction]
    fn compare(py: Python<'_>, options: &str, program: &[u8]) -> PyResult<String> {
        text(py, || calls::compare(&failure::options(options)?, program))
    }

    /// Reads a drill file: its holes, and the program in G-code if there is a depth.
    #[pyfunction]
    fn holes(py: Python<'_>, options: &str, file: &[u8]) -> PyResult<(String, String)> {
        texts(py, || calls::holes(&failure::options(options)?, file))
    }

    /// Tunes a servo axis.
    #[pyfunction]
    fn tune(py: Python<'_>, options: &str) -> PyResult<String> {
        text(py, || calls::tune(&failure::options(options)?))
    }

    /// The text of an answer, made without the interpreter.
    fn text(
        py: Python<'_>,
        make: impl Send + FnOnce() -> Result<calls::Answer, calls::Failed>,
    ) -> PyResult<String> {
        texts(py, make).map(|(text, _)| text)
    }

    /// The text of an answer and its data, which is text as well.
    fn texts(
        py: Python<'_>,
        make: impl Send + FnOnce() -> Result<calls::Answer, calls::Failed>,
    ) -> PyResult<(String, String)> {
        let lossy = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let made = py.detach(|| match make() {
            Ok(answer) => Ok((lossy(&answer.text), lossy(&answer.data))),
            Err(failed) => Err(Reason::from(failed)),
        });
        Ok(made?)
    }
}
