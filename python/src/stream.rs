//! A run whose entries arrive in batches while it is computed.

use crate::failure::{self, Reason, fault};
use crate::waiting::received;
use husillo_simulator::calls::{self, Ready};
use husillo_simulator::job::{Batches, Columns};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

/// Batches that wait for their reader. With the one that is read and the one that is made there
/// are four in memory.
const WAITING: usize = 2;

/// What the thread of a run sends.
enum Message {
    /// The program may run: the units of its machine, in JSON.
    Ready(String),
    Batch(Columns),
    /// The run has ended: its figures, in JSON.
    End(String),
    Failed(Reason),
}

/// The columns of a batch: `wait_ticks` (32 bits), `kind` (8), `line` (32), `delta` (8),
/// `commanded` (32), `tool` (32), in the byte order of this computer.
type Batch<'py> = [Bound<'py, PyBytes>; 6];

/// A run that is computed in a thread of its own.
#[pyclass(frozen)]
#[derive(Debug)]
pub struct Stream {
    units: String,
    /// `None` after the end, and when it is closed.
    messages: Mutex<Option<Receiver<Message>>>,
    answer: Mutex<Option<String>>,
}

#[pymethods]
impl Stream {
    /// Places and checks a program, and begins to run it. A batch has `size` entries.
    #[new]
    fn new(py: Python<'_>, options: &str, program: &[u8], size: usize) -> PyResult<Self> {
        let options: calls::Options = failure::options(options).map_err(Reason::from)?;
        let (sender, messages) = sync_channel(WAITING);
        let program = program.to_vec();
        thread::spawn(move || {
            let last = match run(&options, &program, size, &sender) {
                Ok(answer) => Message::End(answer),
                Err(reason) => Message::Failed(reason),
            };
            // Without a reader nobody waits for the end.
            let _ = sender.send(last);
        });
        let messages = Mutex::new(Some(messages));
        match receive(py, &messages)? {
            Some(Message::Ready(units)) => Ok(Self {
                units,
                messages,
                answer: Mutex::new(None),
            }),
            Some(Message::Failed(reason)) => Err(reason.into()),
            _ => Err(fault()),
        }
    }

    /// The units of the machine, in JSON.
    #[getter]
    fn units(&self) -> &str {
        &self.units
    }

    /// The columns of the next batch; `None` after the last one, and when it is closed.
    fn next<'py>(&self, py: Python<'py>) -> PyResult<Option<Batch<'py>>> {
        match receive(py, &self.messages)? {
            Some(Message::Batch(columns)) => Ok(Some(bytes(py, &columns))),
            Some(Message::End(answer)) => {
                self.close();
                *lock(&self.answer) = Some(answer);
                Ok(None)
            }
            Some(Message::Failed(reason)) => {
                self.close();
                Err(reason.into())
            }
            Some(Message::Ready(_)) => Err(fault()),
            None => Ok(None),
        }
    }

    /// The figures of the run, in JSON; `None` before its end.
    fn answer(&self) -> Option<String> {
        lock(&self.answer).clone()
    }

    /// Ends the run. Its thread ends at the next batch.
    fn close(&self) {
        lock(&self.messages).take();
    }
}

/// Runs a program, and sends its batches. Returns its figures.
fn run(
    options: &calls::Options,
    program: &[u8],
    size: usize,
    sender: &SyncSender<Message>,
) -> Result<String, Reason> {
    let mut ready = Ready::new(options, program)?;
    let start = ready.start()?;
    let axes = ready.job.machine.axes.len();
    let mut units = ready.units();
    units["start"] = json!(&start[..axes]);
    let send = |sender: &SyncSender<Message>, message| {
        let sent = sender.send(message);
        sent.map_err(|_| io::Error::other("the run was closed"))
    };
    send(sender, Message::Ready(units.to_string())).map_err(|error| error.to_string())?;
    let batches = sender.clone();
    let lines = ready.take_lines();
    let observer = Batches::new(axes, size, start, lines, move |batch| {
        send(&batches, Message::Batch(batch))
    });
    let simulated = ready.simulate(Some(Box::new(observer)))?;
    let answer = ready.answer(&simulated, json!({}))?;
    Ok(String::from_utf8_lossy(&answer.text).into_owned())
}

/// The next message; `None` if the stream is closed. A signal, such as that of Ctrl-C, ends the
/// wait.
fn receive(
    py: Python<'_>,
    messages: &Mutex<Option<Receiver<Message>>>,
) -> PyResult<Option<Message>> {
    received(py, |patience| {
        let messages = lock(messages);
        messages
            .as_ref()
            .map(|open| open.recv_timeout(patience))
            .transpose()
    })
}

fn bytes<'py>(py: Python<'py>, columns: &Columns) -> Batch<'py> {
    let four = |values: &[[u8; 4]]| PyBytes::new(py, values.as_flattened());
    let unsigned =
        |values: &[u32]| -> Vec<_> { values.iter().map(|of| of.to_ne_bytes()).collect() };
    let signed = |values: &[i32]| -> Vec<_> { values.iter().map(|of| of.to_ne_bytes()).collect() };
    let delta: Vec<u8> = columns.delta.iter().map(|of| of.cast_unsigned()).collect();
    [
        four(&unsigned(&columns.wait_ticks)),
        PyBytes::new(py, &columns.kind),
        four(&unsigned(&columns.line)),
        PyBytes::new(py, &delta),
        four(&signed(&columns.commanded)),
        four(&signed(&columns.tool)),
    ]
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
