//! The public functions of `husillo-stepper`.

use core::convert::Infallible;
use core::hint::black_box;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use husillo_stepper::{
    CoilDriver, Drive, Driver, DriverPins, L297, LevelPins, Levels, Microstep, Mode, Motors,
    OutputPins, Port, PortBits, PortPins, PulseNanoseconds, PulseTiming, Sequencer, StepDirection,
    StepDirectionPins, StepPulses, StepToggle, Switch, Unwired, sine,
};

/// Keeps every function in the program.
#[unsafe(export_name = "stepper")]
pub fn keep() {
    black_box([
        <Drive as CoilDriver>::step as *const (),
        <Drive as CoilDriver>::levels as *const (),
        <Drive as CoilDriver>::turn as *const (),
        <Drive as CoilDriver>::end_pulse as *const (),
        <Drive as CoilDriver>::timing as *const (),
        <Drive as CoilDriver>::set_enabled as *const (),
        <Drive as CoilDriver>::set_reduced as *const (),
        Driver::currents as *const (),
        Driver::pins as *const (),
        Driver::inputs as *const (),
        Driver::by_name as *const (),
        L297::new as *const (),
        L297::set as *const (),
        L297::outputs as *const (),
        L297::state as *const (),
        L297::timing as *const (),
        Levels::contains as *const (),
        Levels::is_high as *const (),
        Microstep::<64>::new as *const (),
        Microstep::<64>::step as *const (),
        Microstep::<64>::currents as *const (),
        Microstep::<64>::angle as *const (),
        Mode::steps_per_full as *const (),
        Mode::by_name as *const (),
        Motors::<3, Drive>::new as *const (),
        Motors::<3, Drive>::step::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::rest::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::end_pulses::<fn(u32, &[Levels; 3])> as *const (),
        Motors::<3, Drive>::shortest_interval_ticks as *const (),
        Motors::<3, Drive>::set_enabled as *const (),
        Motors::<3, Drive>::levels as *const (),
        Motors::<3, Drive>::was_released as *const (),
        Sequencer::new as *const (),
        Sequencer::reversed as *const (),
        Sequencer::set_mode as *const (),
        Sequencer::reset as *const (),
        Sequencer::restore as *const (),
        Sequencer::sixteenth as *const (),
        Sequencer::is_home as *const (),
        Sequencer::is_enabled as *const (),
        Sequencer::driver as *const (),
        Sequencer::mode as *const (),
        <Sequencer as CoilDriver>::step as *const (),
        <Sequencer as CoilDriver>::levels as *const (),
        <Sequencer as CoilDriver>::set_enabled as *const (),
        <Sequencer as CoilDriver>::set_reduced as *const (),
        sine as *const (),
        StepDirection::new as *const (),
        StepDirection::start as *const (),
        StepDirection::advance as *const (),
        StepDirection::is_idle as *const (),
        <StepDirection as CoilDriver>::turn as *const (),
        <StepDirection as CoilDriver>::step as *const (),
        <StepDirection as CoilDriver>::end_pulse as *const (),
        <StepDirection as CoilDriver>::timing as *const (),
        <StepDirection as CoilDriver>::levels as *const (),
        <StepDirection as CoilDriver>::set_enabled as *const (),
        PulseNanoseconds::ticks as *const (),
        PulseTiming::high as *const (),
        PulseTiming::low as *const (),
        PulseTiming::shortest_interval_ticks as *const (),
        StepDirection::longest_step_ticks as *const (),
        StepToggle::new as *const (),
        <StepToggle as CoilDriver>::step as *const (),
        <StepToggle as CoilDriver>::levels as *const (),
        <StepToggle as CoilDriver>::set_enabled as *const (),
        <StepToggle as CoilDriver>::set_reduced as *const (),
        <[Pin; 6] as OutputPins>::set as *const (),
        <(Pin, Pin, Pin, Pin) as OutputPins>::set as *const (),
        LevelPins::<[Pin; 6]>::new as *const (),
        LevelPins::<[Pin; 6]>::of as *const (),
        <LevelPins<[Pin; 6]> as DriverPins<1>>::write as *const (),
        LevelPins::<[Pin; 6]>::release as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::active_low as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::active_high as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::inverted as *const (),
        <StepDirectionPins<Pin, Pin, Pin> as DriverPins<1>>::write as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::release as *const (),
        <Unwired as OutputPin>::set_low as *const (),
        <Unwired as OutputPin>::set_high as *const (),
        <Axes as DriverPins<3>>::write as *const (),
        <[StepDirectionPins<Pin, Pin, Unwired>; 3] as DriverPins<3>>::write as *const (),
        <&mut Axes as DriverPins<3>>::write as *const (),
        PortBits::new as *const (),
        PortBits::active_low as *const (),
        PortBits::active_high as *const (),
        PortBits::inverted as *const (),
        PortPins::<Register, 3>::new as *const (),
        PortPins::<Register, 3>::release as *const (),
        <PortPins<Register, 3> as DriverPins<3>>::write as *const (),
        <&mut Register as Port>::write as *const (),
        StepPulses::<Axes, 3>::new as *const (),
        StepPulses::<Axes, 3>::with_enable_ns as *const (),
        StepPulses::<Axes, 3>::step::<Delay> as *const (),
        StepPulses::<Axes, 3>::write::<Delay> as *const (),
        StepPulses::<Axes, 3>::set_enabled::<Delay> as *const (),
        StepPulses::<Axes, 3>::release as *const (),
        step_async as *const (),
        set_enabled_async as *const (),
        Switch::<Pin>::active_high as *const (),
        Switch::<Pin>::active_low as *const (),
        Switch::<Pin>::is_closed as *const (),
    ]);
}

/// Three drivers of different kinds.
type Axes = (
    StepDirectionPins<Pin, Pin, Pin>,
    StepDirectionPins<Pin, Pin, Unwired>,
    LevelPins<(Pin, Pin, Pin, Pin)>,
);

type Pulses = StepPulses<Axes, 3>;

/// Polls a future once.
fn poll<T>(future: impl Future<Output = T>) -> bool {
    let mut context = core::task::Context::from_waker(core::task::Waker::noop());
    core::pin::pin!(future).poll(&mut context).is_ready()
}

fn step_async(motors: &mut Pulses, delta: &[i8; 3], delay: &mut Delay) -> bool {
    poll(StepPulses::step_async(motors, delta, delay))
}

/// It awaits `write_async`. A future that two functions await is not inlined, and then its check
/// against a poll after its end remains.
fn set_enabled_async(motors: &mut Pulses, on: bool, delay: &mut Delay) -> bool {
    poll(StepPulses::set_enabled_async(motors, on, delay))
}

/// A port in memory.
pub struct Register(u32);

impl Port for Register {
    type Error = Infallible;

    fn write(&mut self, high: u32, low: u32) -> Result<(), Infallible> {
        self.0 = black_box(self.0 & !low | high);
        Ok(())
    }
}

/// A pin that keeps its level in memory.
pub struct Pin(bool);

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0 = black_box(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0 = black_box(true);
        Ok(())
    }
}

/// A wait that takes no time.
pub struct Delay(u32);

impl DelayNs for Delay {
    fn delay_ns(&mut self, ns: u32) {
        self.0 = black_box(ns);
    }
}

impl embedded_hal_async::delay::DelayNs for Delay {
    async fn delay_ns(&mut self, ns: u32) {
        self.0 = black_box(ns);
    }
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(black_box(self.0))
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!black_box(self.0))
    }
}
