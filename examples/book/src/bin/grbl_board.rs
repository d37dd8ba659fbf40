//! A Grbl controller on a board of one's own: any pins, any serial port, any flash.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_io::{Read, ReadReady, Write};
use embedded_storage::nor_flash::NorFlash;
use husillo_book::{clock::Clock, flash::Flash, pin::Pin, serial::Serial};
use husillo_controllers::{Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions};
use husillo_stepper::{
    DriverPins, Idle, Levels, Motors, PinError, PulseNanoseconds, StepDirection, StepDirectionPins,
    StepPulses, Unwired,
};
use husillo_store::Store;
use std::convert::Infallible;

// ANCHOR: board
/// What the board has. Every pin may have a type of its own.
struct Board<D, E, L, P, T, F> {
    drivers: StepPulses<D, 3>,
    /// ENABLE of all drivers: high switches them off.
    disable: E,
    limits: [L; 3],
    probe: P,
    serial: T,
    flash: Store<F>,
    clock: Clock,
}
// ANCHOR_END: board

// ANCHOR: run
impl<D, E, L, P, T, F> Board<D, E, L, P, T, F>
where
    D: DriverPins<3, Error = PinError>,
    E: OutputPin<Error = Infallible>,
    L: InputPin<Error = Infallible>,
    P: InputPin<Error = Infallible>,
    T: Read + Write + ReadReady<Error = Infallible>,
    F: NorFlash,
{
    /// The memory of the last run.
    fn memory(&mut self) -> Option<GrblMemory> {
        let mut bytes = [0; GrblMemory::BYTES];
        self.flash.read(0, &mut bytes).ok()?;
        GrblMemory::from_bytes(&bytes)
    }

    fn store(&mut self, memory: &GrblMemory) -> Result<(), husillo_store::StoreError<F::Error>> {
        let mut save = self.flash.save()?;
        save.write(&memory.to_bytes())?;
        save.commit()
    }

    fn inputs(&mut self) -> Result<GrblInputs, Infallible> {
        let [x, y, z] = &mut self.limits;
        // With internal pull-up resistors, pins without a wire are high.
        Ok(GrblInputs {
            limits: [x.is_high()?, y.is_high()?, z.is_high()?],
            probe: self.probe.is_high()?,
            ..GrblInputs::default()
        })
    }

    /// One turn of the main loop. Returns whether there was anything to do.
    fn turn(
        &mut self,
        grbl: &mut Grbl,
        motors: &mut Motors<3, StepDirection>,
    ) -> Result<bool, PinError> {
        while self.serial.read_ready()? {
            let mut byte = [0];
            self.serial.read(&mut byte)?;
            if grbl.receive(byte[0]) {
                grbl.halted(); // this loop makes events at once, so none is left
            }
        }
        while let Some(byte) = grbl.transmit() {
            self.serial.write(&[byte])?;
        }
        let inputs = self.inputs()?;
        // Writes levels after a wait.
        let (drivers, clock) = (&mut self.drivers, &mut self.clock);
        let mut written = Ok(());
        let present = |ticks, levels: &[Levels; 3]| {
            clock.delay_us(ticks);
            written = written.and(drivers.write(levels, clock));
        };
        let Some(event) = grbl.next_event(0, &inputs) else {
            motors.end_pulses(present); // no STEP stays high while nothing moves
            return written.and(Ok(false));
        };
        match event {
            GrblEvent::Step { wait_ticks, delta } => {
                motors.step(wait_ticks, &delta, present);
                grbl.made(0, 1);
            }
            GrblEvent::Wait { wait_ticks } => {
                motors.rest(wait_ticks, present);
                grbl.made(0, 1);
            }
            GrblEvent::Disable { is_high } => self.disable.set_state(is_high.into())?,
            // The settings are lost at power-off, but the controller works.
            GrblEvent::Store => drop(self.store(grbl.memory())),
            // No spindle, no coolant on this board.
            _ => {}
        }
        written.and(Ok(true))
    }
}
// ANCHOR_END: run

type Driver = StepDirectionPins<Pin, Pin, Unwired>;
type Mock = Board<(Driver, Driver, Driver), Pin, Pin, Pin, Serial, Flash>;

/// A board with its pins outside: STEP and DIR of each axis.
fn board(serial: &Serial, flash: Flash, steps: &[Pin; 3], directions: &[Pin; 3]) -> Mock {
    // ANCHOR: wiring
    let limits: [Pin; 3] = Default::default();
    limits.iter().for_each(|pin| pin.set(true));
    let driver = |axis: usize| {
        let (step, direction) = (steps[axis].clone(), directions[axis].clone());
        StepDirectionPins::active_low(step, direction, Unwired)
    };
    // On a chip, every pin has its own type.
    let drivers = (driver(0), driver(1), driver(2));
    let probe = Pin::default();
    probe.set(true);
    Board {
        drivers: StepPulses::new(drivers, [PulseNanoseconds::A4988; 3]),
        disable: Pin::default(),
        limits,
        probe,
        serial: serial.clone(),
        flash: Store::open(flash, 0..8192).expect("the area fits the flash"),
        clock: Clock::default(),
    }
    // ANCHOR_END: wiring
}

fn main() -> Result<(), PinError> {
    let serial = Serial::default();
    let (steps, directions): ([Pin; 3], [Pin; 3]) = Default::default();
    let mut flash = Flash::default();
    for session in [
        &["$100=80", "G91 G1 X10 Y-5 F1200", "?"][..],
        &["G1 X1 F600"],
    ] {
        let mut board = board(&serial, flash, &steps, &directions);
        // ANCHOR: main
        let memory = board.memory().unwrap_or(GrblMemory::FACTORY);
        let mut grbl = Grbl::new(GrblOptions::FULL, Some(&memory));
        let timing = PulseNanoseconds::A4988.ticks(1_000_000);
        let mut motors = Motors::new([StepDirection::new(timing); 3], Idle::Hold);
        // On a chip: loop { board.turn(&mut grbl, &mut motors)?; }
        // ANCHOR_END: main
        while board.turn(&mut grbl, &mut motors)? {}
        for line in session {
            serial.receive(line.as_bytes());
            serial.receive(b"\n");
            while board.turn(&mut grbl, &mut motors)? {}
            print!("{}", serial.take_sent().replace('\r', ""));
        }
        println!(
            "steps {:?}",
            [0, 1, 2].map(|axis: usize| steps[axis].rising_edges())
        );
        flash = board.flash.release();
    }
    // 10 mm at 80 steps, 5 mm at 250 steps; then 1 mm more at 80: the setting was kept.
    assert_eq!(
        [0, 1, 2].map(|axis: usize| steps[axis].rising_edges()),
        [880, 1250, 0]
    );
    Ok(())
}
