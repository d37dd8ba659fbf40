//! The public functions of `husillo-stepper`.

use core::convert::Infallible;
use core::hint::black_box;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use husillo_stepper::{
    CoilDriver, Drive, Driver, L297, LevelPins, Levels, Microstep, Mode, Motors, PulseNanoseconds,
    PulseTiming, Sequencer, StepDirection, StepDirectionPins, StepToggle, Switch, Unwired, sine,
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
        LevelPins::<Pin, 6>::new as *const (),
        LevelPins::<Pin, 6>::write as *const (),
        LevelPins::<Pin, 6>::release as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::active_low as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::active_high as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::write::<Delay> as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::step::<Delay> as *const (),
        StepDirectionPins::<Pin, Pin, Pin>::release as *const (),
        Unwired::<Infallible>::new as *const (),
        <Unwired<Infallible> as OutputPin>::set_low as *const (),
        <Unwired<Infallible> as OutputPin>::set_high as *const (),
        Switch::<Pin>::active_high as *const (),
        Switch::<Pin>::active_low as *const (),
        Switch::<Pin>::is_closed as *const (),
    ]);
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
