//! Whole pulses at the pins of step and direction drivers.

use embedded_hal::delay::DelayNs;

use super::DriverPins;
use crate::{Levels, PulseNanoseconds};

/// Whole pulses at the pins of `N` step and direction drivers, with all times in nanoseconds.
///
/// It has two uses:
///
/// - [`step`](StepPulses::step) makes one pulse of each motor that steps, and waits for it. A loop
///   or a task drives the motors with it.
/// - [`write`](StepPulses::write) writes the levels of [`Motors`](crate::Motors) or
///   [`StepDirection`](crate::StepDirection), which give the times themselves. It waits only where
///   ENABLE or DIR changes together with the rise of STEP.
///
/// Both have an async form with the feature `embedded-hal-async`. A dropped future leaves the pins
/// as they are, before or after the rise of STEP. The next call first waits for the longest of all
/// times, so no pulse is cut short. The caller does not know whether the motors have stepped.
///
/// # Examples
/// ```
/// use husillo_stepper::{PinError, PulseNanoseconds, StepDirectionPins, StepPulses, Unwired};
/// # use embedded_hal::{delay::DelayNs, digital::{ErrorType, OutputPin}};
/// # struct Pin;
/// # impl ErrorType for Pin { type Error = core::convert::Infallible; }
/// # impl OutputPin for Pin {
/// #     fn set_low(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// #     fn set_high(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// # }
/// # struct Delay;
/// # impl DelayNs for Delay { fn delay_ns(&mut self, _: u32) {} }
/// # let (pa0, pa1, pb0, pb1, mut delay) = (Pin, Pin, Pin, Pin, Delay);
///
/// let x = StepDirectionPins::active_low(pa0, pa1, Unwired);
/// let y = StepDirectionPins::active_low(pb0, pb1, Unwired);
/// let times = [PulseNanoseconds::A4988, PulseNanoseconds::DRV8825];
/// let mut motors = StepPulses::new((x, y), times);
/// motors.set_enabled(true, &mut delay)?;
/// let taken_ns = motors.step(&[1, -1], &mut delay)?;
/// assert_eq!(taken_ns, 650 + 1900 + 1900); // set-up, high, low of the slower driver
/// # Ok::<(), PinError>(())
/// ```
#[derive(Debug)]
pub struct StepPulses<P, const N: usize> {
    pins: P,
    times: [PulseNanoseconds; N],
    /// From ENABLE to the first rise of STEP; `None`: the set-up time of the driver.
    enable_ns: Option<u32>,
    /// The levels written last. Unknown until the first write and after a failed one.
    shown: Option<[Levels; N]>,
    /// A time is passing. It remains set if the future is dropped meanwhile.
    is_waiting: bool,
}

/// Levels to write, and the time until the next ones.
#[derive(Copy, Clone)]
struct Phase<const N: usize> {
    levels: [Levels; N],
    wait_ns: u32,
}

impl<P: DriverPins<N>, const N: usize> StepPulses<P, N> {
    /// Takes the pins and the times of each driver. Nothing is written yet.
    pub const fn new(pins: P, times: [PulseNanoseconds; N]) -> Self {
        StepPulses {
            pins,
            times,
            enable_ns: None,
            shown: None,
            is_waiting: false,
        }
    }

    /// Sets the time from ENABLE to the first rise of STEP, in nanoseconds. Without this call it is
    /// the set-up time of the driver. A driver whose SLEEP is switched together with ENABLE needs a
    /// millisecond or two.
    #[must_use]
    pub const fn with_enable_ns(mut self, ns: u32) -> Self {
        self.enable_ns = Some(ns);
        self
    }

    /// Makes one step of each motor in the direction of the sign of its `delta`, and returns the
    /// nanoseconds that it has waited, to be subtracted from the wait before the next step.
    ///
    /// ENABLE of all drivers is switched on. DIR changes, the set-up time passes, all STEP pins
    /// rise, and fall after the longest high time. At the end the low time and the rest of the hold
    /// time pass, so the next step may come at once, also in the other direction. A motor whose
    /// `delta` is 0 keeps its levels. If all are 0, nothing is written.
    ///
    /// # Errors
    /// The error of the pins. Some of the motors may have stepped. The next call writes all pins.
    pub fn step<W: DelayNs>(&mut self, delta: &[i8; N], delay: &mut W) -> Result<u32, P::Error> {
        let mut taken_ns = self.pass(self.unfinished_ns(), delay);
        for phase in self.pulse(delta).iter().flatten() {
            self.show(&phase.levels)?;
            taken_ns = taken_ns.saturating_add(self.pass(phase.wait_ns, delay));
        }
        Ok(taken_ns)
    }

    /// Writes levels.
    ///
    /// If ENABLE switches on, the enable time passes before STEP rises and before the call returns.
    /// If DIR changes and STEP rises in one call, the set-up time passes between them. At the first
    /// call, STEP is low for the low time. The caller keeps all other times.
    ///
    /// # Errors
    /// The error of the pins. The next call writes all pins.
    pub fn write<W: DelayNs>(
        &mut self,
        levels: &[Levels; N],
        delay: &mut W,
    ) -> Result<(), P::Error> {
        self.pass(self.unfinished_ns(), delay);
        if let Some(before) = self.before(levels) {
            self.show(&before.levels)?;
            self.pass(before.wait_ns, delay);
        }
        self.show(levels)
    }

    /// Switches ENABLE of all drivers on or off. STEP and DIR keep their levels; at the first call,
    /// STEP is low and DIR high. After switching on, the next [`step`](StepPulses::step) may come
    /// at once.
    ///
    /// # Errors
    /// The error of the pins. The next call writes all pins.
    pub fn set_enabled<W: DelayNs>(&mut self, on: bool, delay: &mut W) -> Result<(), P::Error> {
        let levels = self.enabled(on);
        self.write(&levels, delay)
    }

    /// Returns the pins.
    pub fn release(self) -> P {
        self.pins
    }

    /// Writes levels that are due.
    fn show(&mut self, levels: &[Levels; N]) -> Result<(), P::Error> {
        self.shown = None;
        self.pins.write(levels)?;
        self.shown = Some(*levels);
        Ok(())
    }

    /// Waits, and returns the time. No other time is passing then.
    fn pass<W: DelayNs>(&mut self, ns: u32, delay: &mut W) -> u32 {
        if ns > 0 {
            delay.delay_ns(ns);
            self.is_waiting = false;
        }
        ns
    }

    /// The longest of all times if a future was dropped while one of them passed, otherwise 0.
    fn unfinished_ns(&self) -> u32 {
        if !self.is_waiting {
            return 0;
        }
        let longest = |ns: u32, times: &PulseNanoseconds| {
            let PulseNanoseconds {
                setup,
                hold,
                high,
                low,
            } = *times;
            ns.max(setup).max(hold).max(high).max(low)
        };
        self.times.iter().fold(self.enable_ns.unwrap_or(0), longest)
    }

    /// The levels of each driver that were written last, where they are known.
    fn known(&self) -> [Option<Levels>; N] {
        self.shown.map_or([None; N], |shown| shown.map(Some))
    }

    /// The levels written last, or those of an idle driver.
    fn levels(&self) -> [Levels; N] {
        self.shown.unwrap_or([Levels::DIR; N])
    }

    fn enabled(&self, on: bool) -> [Levels; N] {
        self.levels().map(|levels| {
            let others = levels.0 & !Levels::ENABLE.0;
            Levels(if on {
                others | Levels::ENABLE.0
            } else {
                others
            })
        })
    }

    /// The levels before those whose STEP rises, if time must pass between them.
    fn before(&self, levels: &[Levels; N]) -> Option<Phase<N>> {
        let mut before = *levels;
        let mut wait_ns = 0;
        for ((low, times), shown) in before.iter_mut().zip(&self.times).zip(self.known()) {
            let changed = Levels::changed(shown, *low);
            let rises = changed.contains(Levels::STEP) && low.contains(Levels::STEP);
            if shown.is_none() {
                wait_ns = wait_ns.max(times.low); // STEP may have been high
            }
            if changed.contains(Levels::ENABLE) && low.contains(Levels::ENABLE) {
                wait_ns = wait_ns.max(self.enable_ns.unwrap_or(times.setup));
            }
            if rises {
                if changed.contains(Levels::DIR) {
                    wait_ns = wait_ns.max(times.setup);
                }
                low.0 &= !Levels::STEP.0;
            }
        }
        (wait_ns > 0).then_some(Phase {
            levels: before,
            wait_ns,
        })
    }

    /// The phases of one pulse; none if no motor steps.
    fn pulse(&self, delta: &[i8; N]) -> Option<[Phase<N>; 3]> {
        if delta.iter().all(|delta| *delta == 0) {
            return None;
        }
        let mut low = self.enabled(true);
        let mut high = low;
        let [mut setup_ns, mut high_ns, mut low_ns] = [0_u32; 3];
        let axes = low.iter_mut().zip(&mut high).zip(delta).zip(&self.times);
        for ((((low, high), delta), times), shown) in axes.zip(self.known()) {
            let direction = match delta.signum() {
                0 => low.0 & Levels::DIR.0,
                1 => Levels::DIR.0,
                _ => 0,
            };
            *low = Levels(Levels::ENABLE.0 | direction);
            *high = *low;
            let changed = Levels::changed(shown, *low);
            // STEP may be high: at the first call, in a pulse of `write`, after a dropped future.
            if changed.contains(Levels::STEP) {
                setup_ns = setup_ns.max(times.low);
            }
            if changed.contains(Levels::ENABLE) {
                setup_ns = setup_ns.max(self.enable_ns.unwrap_or(times.setup));
            }
            if *delta != 0 {
                high.0 |= Levels::STEP.0;
                if changed.contains(Levels::DIR) {
                    setup_ns = setup_ns.max(times.setup);
                }
                high_ns = high_ns.max(times.high);
                low_ns = low_ns.max(times.low);
            }
        }
        // The hold time counts from the rise.
        let stepped = delta
            .iter()
            .zip(&self.times)
            .filter(|(delta, _)| **delta != 0);
        for (_, times) in stepped {
            low_ns = low_ns.max(times.hold.saturating_sub(high_ns));
        }
        let phase = |levels, wait_ns| Phase { levels, wait_ns };
        Some([
            phase(low, setup_ns),
            phase(high, high_ns),
            phase(low, low_ns),
        ])
    }
}

#[cfg(feature = "embedded-hal-async")]
impl<P: DriverPins<N>, const N: usize> StepPulses<P, N> {
    /// As [`step`](StepPulses::step), but other tasks run while it waits. A delay of an executor
    /// often has ticks of a microsecond or more. It waits at least the times of the drivers.
    ///
    /// # Errors
    /// As for `step`. The nanoseconds are those it has asked for.
    pub async fn step_async<W: embedded_hal_async::delay::DelayNs>(
        &mut self,
        delta: &[i8; N],
        delay: &mut W,
    ) -> Result<u32, P::Error> {
        let mut taken_ns = self.pass_async(self.unfinished_ns(), delay).await;
        for phase in self.pulse(delta).iter().flatten() {
            self.show(&phase.levels)?;
            let passed_ns = self.pass_async(phase.wait_ns, delay).await;
            taken_ns = taken_ns.saturating_add(passed_ns);
        }
        Ok(taken_ns)
    }

    /// As [`write`](StepPulses::write), but other tasks run while it waits.
    ///
    /// # Errors
    /// As for `write`.
    pub async fn write_async<W: embedded_hal_async::delay::DelayNs>(
        &mut self,
        levels: &[Levels; N],
        delay: &mut W,
    ) -> Result<(), P::Error> {
        self.pass_async(self.unfinished_ns(), delay).await;
        if let Some(before) = self.before(levels) {
            self.show(&before.levels)?;
            self.pass_async(before.wait_ns, delay).await;
        }
        self.show(levels)
    }

    /// As `pass`, but other tasks run. If it is dropped, the next call waits again.
    async fn pass_async<W: embedded_hal_async::delay::DelayNs>(
        &mut self,
        ns: u32,
        delay: &mut W,
    ) -> u32 {
        if ns > 0 {
            self.is_waiting = true;
            delay.delay_ns(ns).await;
            self.is_waiting = false;
        }
        ns
    }

    /// As [`set_enabled`](StepPulses::set_enabled), but other tasks run while it waits.
    ///
    /// # Errors
    /// As for `set_enabled`.
    pub async fn set_enabled_async<W: embedded_hal_async::delay::DelayNs>(
        &mut self,
        on: bool,
        delay: &mut W,
    ) -> Result<(), P::Error> {
        let levels = self.enabled(on);
        self.write_async(&levels, delay).await
    }
}
