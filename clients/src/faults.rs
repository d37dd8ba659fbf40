//! Tests of every machine with every fault in every state. They check how long the machine moves
//! after the fault, what the operator reads, and that work continues after the repair.
//!
//! The machines run in simulated time. The results are the table of `docs/faults.md`.

mod cmm;
mod drill;
mod microfactory;
mod micromill;
mod soak;

use cmm::Cmm;
use drill::Drill;
use husillo_sim::device::{Device, Emulation, LineFault, Machine};
use microfactory::Microfactory;
use micromill::Micromill;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What the machine does when the fault occurs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum State {
    Idle,
    /// The first homing after the power came on.
    FirstHoming,
    Homing,
    Jog,
    Program,
    /// A guarded move of a measuring routine.
    Guarded,
    Probing,
}

impl State {
    const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::FirstHoming => "first homing",
            Self::Homing => "homing",
            Self::Jog => "jog",
            Self::Program => "program",
            Self::Guarded => "guarded",
            Self::Probing => "probing",
        }
    }
}

/// A fault, and the lines of the panel that cause and repair it.
#[derive(Debug)]
struct Fault {
    name: &'static str,
    begins: &'static str,
    ends: &'static [&'static str],
    /// Longest motion after the fault, ms. `None`: the motion ends by itself.
    most_ms: Option<u64>,
    /// Whether the machine cannot detect the fault.
    is_hidden: bool,
}

impl Fault {
    const fn new(name: &'static str, begins: &'static str, ends: &'static [&'static str]) -> Self {
        Self {
            name,
            begins,
            ends,
            most_ms: None,
            is_hidden: false,
        }
    }

    /// The machine comes to rest within this time after the fault, ms.
    const fn ends_within(self, ms: u64) -> Self {
        Self {
            most_ms: Some(ms),
            ..self
        }
    }

    /// The machine cannot detect the fault.
    const fn unnoticed(self) -> Self {
        Self {
            is_hidden: true,
            ..self
        }
    }
}

/// A simulated machine with its panel and its line.
trait Bench {
    /// Carries out a line of the panel after this time.
    fn schedule(&mut self, after_ms: u64, line: &str);

    /// Sets a fault of the line. It hits the byte this many bytes from now. `None`: no further
    /// fault.
    fn disturb(&mut self, fault: Option<(u64, LineFault)>);

    /// Simulates the machine without its client for this time.
    fn pass(&mut self, ms: u64);

    /// Simulated time, ms.
    fn now_ms(&self) -> u64;

    /// Time of the last step since the last call, ms. 0: there was none.
    fn last_step_ms(&mut self) -> u64;
}

impl<M: Machine> Bench for Device<M> {
    fn schedule(&mut self, after_ms: u64, line: &str) {
        Device::schedule(self, after_ms * 1000, line);
    }

    fn disturb(&mut self, fault: Option<(u64, LineFault)>) {
        let line = self.line();
        line.fault = fault.map(|(bytes, fault)| (line.carried + bytes, fault));
    }

    fn pass(&mut self, ms: u64) {
        (0..ms).for_each(|_| drop(self.tick()));
    }

    fn now_ms(&self) -> u64 {
        self.now_us() / 1000
    }

    /// In a row, the columns of the motors follow the number, the time and the wait.
    fn last_step_ms(&mut self) -> u64 {
        let motors = M::COLUMNS.split(',').filter(|name| name.starts_with('d'));
        let motors = motors.count();
        let step = |row: &str| {
            let columns = row.split(',').map(|column| column.parse::<i64>());
            let columns: Vec<i64> = columns.map(|column| column.unwrap_or(0)).collect();
            let steps = columns.get(3..3 + motors)?;
            let is_step = steps.iter().any(|delta| *delta != 0);
            is_step.then(|| columns[1].unsigned_abs() / 1000)
        };
        self.made().lines().rev().find_map(step).unwrap_or(0)
    }
}

/// A machine with its client.
trait Subject: Sized {
    const MACHINE: &'static str;
    /// A motion that needs no host has ended after this time, ms.
    const REST_MS: u64 = 200_000;
    const FAULTS: &'static [Fault];
    /// The states of the machine. Each has the time from the start of its action to the fault, ms.
    const STATES: &'static [(State, u64)];

    /// A homed machine with a client for this state.
    fn new(state: State) -> Self;

    /// The simulated machine behind the client.
    fn bench(&mut self) -> &mut dyn Bench;

    /// Begins the motion of a state and waits for its end. In [`State::Idle`] it is a short move.
    fn act(&mut self, state: State) -> Result<String, String>;

    /// Whether the machine is at the position that it reports.
    fn is_true(&mut self) -> bool;

    /// Acts as another program: homes the machine and moves it. Also returns what the operator
    /// reads after homing.
    fn begin_again(self) -> Result<(Self, String), String>;
}

/// What the operator reads if the fault has no effect.
const CARRIED_OUT: &str = "carried out";
/// What the operator reads if the machine cannot detect the fault.
const UNSEEN: &str = "nothing: the steps are lost unseen";
/// A part of what the operator reads if homing shows that steps were lost.
const LOST: &str = "since the last homing steps were lost";

/// The result of a fault in one state of a machine.
#[derive(Clone)]
struct Row {
    machine: &'static str,
    fault: &'static str,
    state: State,
    /// `None`: the motion was carried out.
    moved_ms: Option<u64>,
    read: String,
}

/// Causes a fault in a state. Returns the result.
fn row<S: Subject>(fault: &'static Fault, state: State, after_ms: u64) -> Row {
    let context = format!("{}, {}, {state:?}", S::MACHINE, fault.name);
    let mut machine = S::new(state);
    let begin_ms = machine.bench().now_ms();
    let is_idle = state == State::Idle;
    machine.bench().schedule(after_ms, fault.begins);
    if is_idle {
        machine.bench().pass(after_ms + 1);
    }
    let result = machine.act(state);
    // A motion that needs no host ends, too.
    machine.bench().pass(S::REST_MS);
    let moved_ms = (machine.bench().last_step_ms()).saturating_sub(begin_ms + after_ms);
    if let (Some(most_ms), false) = (fault.most_ms, is_idle) {
        assert!(moved_ms <= most_ms, "{context}: it moves for {moved_ms} ms");
    }
    let is_true = machine.is_true();
    let is_unseen = result.is_ok() && !is_true;
    assert!(!is_unseen || fault.is_hidden, "{context}: nobody notices");
    (fault.ends.iter()).for_each(|line| machine.bench().schedule(0, line));
    // A drill homes when its power returns.
    machine.bench().pass(60_000);
    let again = machine.begin_again();
    let (mut machine, homed) = again.unwrap_or_else(|why| panic!("{context}: {why}"));
    assert!(
        machine.is_true(),
        "{context}: work goes on at a wrong position"
    );
    let is_as_asked = result.is_ok();
    let read = match result {
        Err(why) => why,
        Ok(_) if is_true => CARRIED_OUT.into(),
        Ok(_) if homed.contains(LOST) => format!("at the next homing: {homed}"),
        Ok(_) => UNSEEN.into(),
    };
    Row {
        machine: S::MACHINE,
        fault: fault.name,
        state,
        moved_ms: (!is_as_asked).then_some(moved_ms),
        read,
    }
}

fn rows<S: Subject>() -> Vec<Row> {
    let cells = S::FAULTS.iter().flat_map(|fault| {
        let states = S::STATES.iter();
        states.map(move |(state, after_ms)| row::<S>(fault, *state, *after_ms))
    });
    cells.collect()
}

/// The tables, one for each machine. Each fault has a row for each state.
fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut last = None;
    for row in rows {
        if last != Some(row.machine) {
            last = Some(row.machine);
            let _ = write!(
                text,
                "\n## {}\n\n| fault | state | moves afterwards | the operator reads |\n\
                 | --- | --- | --- | --- |\n",
                row.machine
            );
        }
        let moved = match row.moved_ms {
            None => "as asked".into(),
            Some(0) => "not at all".into(),
            Some(ms) if ms < 1000 => format!("{ms} ms"),
            Some(ms) => format!("{:.1} s", ms as f64 / 1000.0),
        };
        let state = row.state.name();
        let read = row.read.replace('|', "\\|").replace('\n', "; ");
        let _ = writeln!(text, "| {} | {state} | {moved} | {read} |", row.fault);
    }
    text
}

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/faults.md");
/// The part of the page before the tables ends with this line.
const HEAD_END: &str = "<!-- The tables are written by the tests of husillo-clients. -->\n";

/// If `HUSILLO_WRITE` is set in the environment, the test writes the tables anew.
#[test]
fn the_page_of_faults_is_what_happens() {
    let rows = [
        rows::<Micromill>(),
        rows::<Drill>(),
        rows::<Microfactory>(),
        rows::<Cmm<false>>(),
        rows::<Cmm<true>>(),
    ]
    .concat();
    let tables = table(&rows);
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (head, old) = page.split_once(HEAD_END).unwrap();
    if std::env::var_os("HUSILLO_WRITE").is_some() {
        std::fs::write(PAGE, format!("{head}{HEAD_END}{tables}")).unwrap();
    } else {
        for (new, old) in tables.lines().zip(old.lines()) {
            assert_eq!(new, old, "HUSILLO_WRITE=1 writes the tables anew");
        }
        assert_eq!(tables.lines().count(), old.lines().count());
    }
    let mut counts = BTreeMap::new();
    rows.iter()
        .for_each(|row| *counts.entry(row.state).or_insert(0) += 1);
    assert!(counts.values().all(|count| *count >= 5), "{counts:?}");
}
