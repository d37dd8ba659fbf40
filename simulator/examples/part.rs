//! Checks a program for a machine, prints its findings, and runs it on the simulated machine.
//!
//! ```sh
//! cargo run -p husillo-simulator --example part -- examples/gear.nc micromill
//! ```

use husillo_simulator::diagnostics::Findings;
use husillo_simulator::job::{Job, Options, Text};
use husillo_simulator::machines::machine_file::MachineFile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (name, program) = match arguments.next() {
        Some(path) => (path.clone(), std::fs::read(path)?),
        None => (
            "square.nc".to_owned(),
            b"G21 G91 F1.2\nG1 X1\nY1\nX-1\nY-1\nM2\n".to_vec(),
        ),
    };
    let machine = arguments.next().unwrap_or("micromill".to_owned());
    let machine = MachineFile::built_in(&machine).ok_or(format!("no machine {machine}"))?;
    let mut job = Job::new(Text::new(name, program), machine, None)?;

    let mut findings = Findings::new(50);
    let mut facts = job.check(&mut findings)?;
    for line in findings.short() {
        println!("{line}");
    }
    if findings.errors > 0 {
        return Err(format!("{} errors: it does not run", findings.errors).into());
    }
    let simulated = job.simulate(&mut facts, Options::default(), || {})?;
    let results = simulated.results(&job, &facts);
    println!("{} events in {:.1} s", results.events, results.duration_s);
    println!("largest deviation: {:.0} nm", results.max_deviation_nm);
    println!("reversals of the axes: {:?}", results.reversals);
    println!("lost steps: {}", results.lost_steps);
    Ok(())
}
