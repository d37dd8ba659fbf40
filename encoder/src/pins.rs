//! A and B of an encoder at two pins: `embedded-hal` 1.0.

use core::fmt;

use embedded_hal::digital::{Error, ErrorKind, InputPin};

use crate::{Quadrature, Scale, Skipped, levels};

/// A quadrature decoder that reads its own pins.
///
/// [`sample`](QuadraturePins::sample) reads both pins. Call it in a timer interrupt that comes at
/// least once between two edges, or in the interrupt of both pins. With the feature
/// `embedded-hal-async`, [`edge`](QuadraturePins::edge) waits for the interrupts of the pins.
///
/// # Examples
/// ```
/// use embedded_hal::digital::{ErrorType, InputPin};
/// use husillo_encoder::{QuadraturePins, Scale};
/// # struct High;
/// # impl ErrorType for High { type Error = core::convert::Infallible; }
/// # impl InputPin for High {
/// #     fn is_high(&mut self) -> Result<bool, Self::Error> { Ok(true) }
/// #     fn is_low(&mut self) -> Result<bool, Self::Error> { Ok(false) }
/// # }
/// # let (pin_a, pin_b) = (High, High);
///
/// let mut knob = QuadraturePins::new(pin_a, pin_b, Scale::X4)?;
/// knob.sample()?; // in an interrupt
/// assert_eq!(knob.quadrature().position(), 0);
/// # Ok::<(), husillo_encoder::SampleError<core::convert::Infallible>>(())
/// ```
#[derive(Debug)]
pub struct QuadraturePins<A, B> {
    a: A,
    b: B,
    quadrature: Quadrature,
}

/// Why a sample gave no counts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SampleError<E> {
    /// A pin could not be read. The state is unchanged.
    Pin(E),
    /// Two edges have passed since the sample before.
    Skipped,
}

impl<E> From<Skipped> for SampleError<E> {
    fn from(_: Skipped) -> Self {
        SampleError::Skipped
    }
}

impl<E: Error> fmt::Display for SampleError<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SampleError::Pin(error) => match error.kind() {
                ErrorKind::Other => formatter.write_str("a pin of the encoder cannot be read"),
                kind => kind.fmt(formatter),
            },
            SampleError::Skipped => Skipped.fmt(formatter),
        }
    }
}

impl<E: Error> core::error::Error for SampleError<E> {}

impl<A: InputPin, B: InputPin<Error = A::Error>> QuadraturePins<A, B> {
    /// Takes the pins of A and B, and reads them. The position is 0.
    ///
    /// # Errors
    /// [`SampleError::Pin`] if a pin cannot be read.
    pub fn new(mut a: A, mut b: B, scale: Scale) -> Result<Self, SampleError<A::Error>> {
        let quadrature = Quadrature::new(scale, read(&mut a, &mut b)?);
        Ok(QuadraturePins { a, b, quadrature })
    }

    /// Reads the pins, and returns the counts since the sample before: -1, 0 or 1.
    ///
    /// # Errors
    /// [`SampleError::Pin`] if a pin cannot be read: nothing changes. [`SampleError::Skipped`] as
    /// for [`Quadrature::sample`].
    pub fn sample(&mut self) -> Result<i32, SampleError<A::Error>> {
        let levels = read(&mut self.a, &mut self.b)?;
        Ok(self.quadrature.sample(levels)?)
    }

    /// The decoder: position, direction, skipped edges.
    pub const fn quadrature(&self) -> &Quadrature {
        &self.quadrature
    }

    /// The decoder, to set its position.
    pub const fn quadrature_mut(&mut self) -> &mut Quadrature {
        &mut self.quadrature
    }

    /// Returns the pins.
    pub fn release(self) -> (A, B) {
        (self.a, self.b)
    }
}

#[cfg(feature = "embedded-hal-async")]
impl<A, B> QuadraturePins<A, B>
where
    A: InputPin + embedded_hal_async::digital::Wait,
    B: InputPin<Error = A::Error> + embedded_hal_async::digital::Wait,
{
    /// Waits for an edge of A or B, and returns its counts: -1 or 1, or 0 for an edge that does not
    /// count in this scale.
    ///
    /// If an edge has come since the sample before, it does not wait. So an edge is lost only if
    /// another one comes before the pins are read, which is reported.
    ///
    /// # Errors
    /// Those of [`sample`](QuadraturePins::sample).
    pub async fn edge(&mut self) -> Result<i32, SampleError<A::Error>> {
        use core::{future::poll_fn, pin::pin};

        let now = read(&mut self.a, &mut self.b)?;
        if now == self.quadrature.levels() {
            let mut a = pin!(self.a.wait_for_any_edge());
            let mut b = pin!(self.b.wait_for_any_edge());
            poll_fn(|context| {
                let first = a.as_mut().poll(context);
                if first.is_ready() {
                    return first;
                }
                b.as_mut().poll(context)
            })
            .await
            .map_err(SampleError::Pin)?;
        }
        self.sample()
    }
}

/// Reads both pins.
fn read<A: InputPin, B: InputPin<Error = A::Error>>(
    a: &mut A,
    b: &mut B,
) -> Result<u8, SampleError<A::Error>> {
    let [a, b] = [a.is_high(), b.is_high()];
    Ok(levels(
        a.map_err(SampleError::Pin)?,
        b.map_err(SampleError::Pin)?,
    ))
}
