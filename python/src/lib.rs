//! The native part of the Python package `husillo`: options in JSON and a program as bytes in,
//! answers in JSON and columns as bytes out. The package in `source/husillo` gives them types.
//!
//! Each function computes in a thread of its own: other Python threads run, and a signal, such as
//! that of Ctrl-C, ends the call.

mod failure;
mod stream;
mod waiting;

use pyo3::prelude::*;

/// The functions that the package calls.
#[pymodule(name = "_native")]
mod native {
    use crate::failure::{self, Reason};
    use crate::waiting::computed;
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
    fn machine(py: Python<'_>, options: String) -> PyResult<String> {
        text(py, move || calls::machine(&failure::options(&options)?))
    }

    /// Checks a program or a drill file.
    #[pyfunction]
    fn check(py: Python<'_>, options: String, program: Vec<u8>) -> PyResult<String> {
        text(py, move || {
            calls::check(&failure::options(&options)?, &program)
        })
    }

    /// The commands of a program: findings, then one command a line.
    #[pyfunction]
    fn commands(py: Python<'_>, options: String, program: Vec<u8>) -> PyResult<(String, String)> {
        texts(py, move || {
            calls::commands(&failure::options(&options)?, &program)
        })
    }

    /// Compares methods of interpolation.
    #[pyfunction]
    fn compare(py: Python<'_>, options: String, program: Vec<u8>) -> PyResult<String> {
        text(py, move || {
            calls::compare(&failure::options(&options)?, &program)
        })
    }

    /// Reads a drill file: its holes, and the program in G-code if there is a depth.
    #[pyfunction]
    fn holes(py: Python<'_>, options: String, file: Vec<u8>) -> PyResult<(String, String)> {
        texts(py, move || {
            calls::holes(&failure::options(&options)?, &file)
        })
    }

    /// Tunes a servo axis.
    #[pyfunction]
    fn tune(py: Python<'_>, options: String) -> PyResult<String> {
        text(py, move || calls::tune(&failure::options(&options)?))
    }

    /// The text of an answer.
    fn text(
        py: Python<'_>,
        make: impl FnOnce() -> Result<calls::Answer, calls::Failed> + Send + 'static,
    ) -> PyResult<String> {
        texts(py, make).map(|(text, _)| text)
    }

    /// The text of an answer and its data, which is text as well.
    fn texts(
        py: Python<'_>,
        make: impl FnOnce() -> Result<calls::Answer, calls::Failed> + Send + 'static,
    ) -> PyResult<(String, String)> {
        let made = computed(py, || {
            let lossy = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            let answer = make().map_err(Reason::from)?;
            Ok((lossy(&answer.text), lossy(&answer.data)))
        })?;
        made.map_err(|reason: Reason| reason.into())
    }
}
