//! A master of the servo network on any serial port of `embedded-io`.

use embedded_hal::delay::DelayNs;
use embedded_io::{Read, ReadReady, Write};
use husillo_book::{clock::Clock, module_line::ModuleLine};
use husillo_transports::nmc::{
    Baud, CYCLE_US, Command, Host, Items, Mode, Next, Outcome, Progress, Reply, Startup, Step,
    Timing, Trajectory,
};
use std::error::Error;

// ANCHOR: carry_out
/// Carries out one step: the loop between the host, its port and its clock. `None`: the host has
/// refused the step, and nothing was sent.
fn carry_out<P: Read + Write + ReadReady>(
    host: &mut Host,
    port: &mut P,
    clock: &mut Clock,
    step: Step,
) -> Result<Option<Outcome>, P::Error> {
    if host.start(step, clock.us()).is_err() {
        return Ok(None);
    }
    loop {
        while let Some(byte) = host.transmit(clock.us()) {
            port.write(&[byte])?;
        }
        while port.read_ready()? {
            let mut byte = [0];
            port.read(&mut byte)?;
            host.push(byte[0], clock.us());
        }
        match host.poll(clock.us()) {
            Progress::Done(outcome) => return Ok(Some(outcome)),
            // A port without a buffer for received bytes must not wait for so long.
            Progress::Waiting { us } => clock.delay_us(us.clamp(1, 50)),
            Progress::Sending | Progress::Idle => {}
        }
    }
}
// ANCHOR_END: carry_out

fn main() -> Result<(), Box<dyn Error>> {
    let mut clock = Clock::default();
    let mut port = ModuleLine::new(2, clock.clone());
    // ANCHOR: startup
    let mut host = Host::new(Timing::prompt(Baud::B19200, CYCLE_US));
    let mut startup = Startup::new(Baud::B115200);
    let mut outcome = None;
    let network = loop {
        match startup.next(outcome.as_ref()) {
            Next::Step(step) => {
                // After `Step::Switch` a real port changes its rate to `host.baud()`.
                outcome = carry_out(&mut host, &mut port, &mut clock, step)?;
            }
            Next::Done(network) => break network,
        }
    };
    println!(
        "{} modules at {} baud",
        network.modules,
        host.baud().bits_per_s()
    );
    // ANCHOR_END: startup
    assert!(network.is_complete && network.silent == 0);

    // ANCHOR: moves
    for (address, goal) in [(1, 2_000), (2, -500)] {
        let load = Command::LoadTrajectory(Trajectory {
            position: Some(goal),
            velocity: Some(4 << 16),     // 4 counts per servo cycle
            acceleration: Some(1 << 10), // 1/64 count per servo cycle, each cycle
            pwm: None,
            mode: Mode::Trapezoid,
            reverse: false,
            start_now: true,
        });
        let step = Step::Request {
            address,
            command: load,
        };
        let outcome = carry_out(&mut host, &mut port, &mut clock, step)?;
        assert!(matches!(
            outcome,
            Some(Outcome::Answered(_) | Outcome::Confirmed(_))
        ));
    }
    for address in [1, 2] {
        // Two equal readings: a wrong position passes the sum of one reply now and then.
        let step = Step::ReadTwice {
            address,
            items: Items::POSITION,
            jitter_counts: 1,
        };
        let outcome = carry_out(&mut host, &mut port, &mut clock, step)?;
        let reply = outcome.as_ref().and_then(Outcome::reply);
        let position = reply.and_then(Reply::position);
        println!("module {address} is at {position:?}");
        assert_eq!(position, Some([2_000, -500][usize::from(address) - 1]));
    }
    // ANCHOR_END: moves
    Ok(())
}
