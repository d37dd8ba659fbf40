//! The decoder with its pins.
#![cfg(feature = "embedded-hal-async")]

use core::cell::Cell;
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin};
use embedded_hal_async::digital::Wait;
use husillo_encoder::{QuadraturePins, SampleError, Scale};

/// A pin whose levels the test sets, with the number of edges that its waits have seen.
struct Pin<'a> {
    level: &'a Cell<Option<bool>>,
}

#[derive(Debug, PartialEq)]
struct Broken;

impl Error for Broken {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for Pin<'_> {
    type Error = Broken;
}

impl InputPin for Pin<'_> {
    fn is_high(&mut self) -> Result<bool, Broken> {
        self.level.get().ok_or(Broken)
    }

    fn is_low(&mut self) -> Result<bool, Broken> {
        self.is_high().map(|is_high| !is_high)
    }
}

impl Wait for Pin<'_> {
    async fn wait_for_high(&mut self) -> Result<(), Broken> {
        self.wait_for_any_edge().await
    }

    async fn wait_for_low(&mut self) -> Result<(), Broken> {
        self.wait_for_any_edge().await
    }

    async fn wait_for_rising_edge(&mut self) -> Result<(), Broken> {
        self.wait_for_any_edge().await
    }

    async fn wait_for_falling_edge(&mut self) -> Result<(), Broken> {
        self.wait_for_any_edge().await
    }

    async fn wait_for_any_edge(&mut self) -> Result<(), Broken> {
        let before = self.level.get();
        core::future::poll_fn(|_| match self.level.get() {
            None => Poll::Ready(Err(Broken)),
            now if now == before => Poll::Pending,
            _ => Poll::Ready(Ok(())),
        })
        .await
    }
}

/// Polls a future once.
fn poll<T>(future: impl Future<Output = T>) -> Poll<T> {
    pin!(future).poll(&mut Context::from_waker(Waker::noop()))
}

#[test]
fn samples_of_the_pins_are_those_of_their_levels() {
    let (a, b) = (Cell::new(Some(false)), Cell::new(Some(true)));
    let mut encoder = QuadraturePins::new(Pin { level: &a }, Pin { level: &b }, Scale::X4).unwrap();
    assert_eq!(encoder.quadrature().levels(), 0b10);
    // B falls: from 10 to 00 is forwards.
    b.set(Some(false));
    assert_eq!(encoder.sample(), Ok(1));
    a.set(Some(true));
    assert_eq!(encoder.sample(), Ok(1));
    assert_eq!(encoder.sample(), Ok(0));
    // Both change.
    a.set(Some(false));
    b.set(Some(true));
    assert_eq!(encoder.sample(), Err(SampleError::Skipped));
    assert_eq!(encoder.quadrature().position(), 2);
}

#[test]
fn a_pin_that_cannot_be_read_changes_nothing() {
    let (a, b) = (Cell::new(Some(false)), Cell::new(Some(false)));
    let mut encoder = QuadraturePins::new(Pin { level: &a }, Pin { level: &b }, Scale::X4).unwrap();
    a.set(Some(true));
    b.set(None);
    assert_eq!(encoder.sample(), Err(SampleError::Pin(Broken)));
    assert_eq!(encoder.quadrature().levels(), 0);
    b.set(Some(false));
    assert_eq!(encoder.sample(), Ok(1));
    assert!(
        QuadraturePins::new(
            Pin { level: &a },
            Pin {
                level: &Cell::new(None)
            },
            Scale::X1
        )
        .is_err()
    );
}

#[test]
fn edges_of_both_pins_are_waited_for() {
    let (a, b) = (Cell::new(Some(false)), Cell::new(Some(false)));
    let mut encoder = QuadraturePins::new(Pin { level: &a }, Pin { level: &b }, Scale::X4).unwrap();
    for (is_a, level, counts) in [
        (true, true, 1),
        (false, true, 1),
        (true, false, 1),
        (true, true, -1),
    ] {
        let mut edge = pin!(encoder.edge());
        let mut context = Context::from_waker(Waker::noop());
        assert_eq!(edge.as_mut().poll(&mut context), Poll::Pending);
        let pin = if is_a { &a } else { &b };
        pin.set(Some(level));
        assert_eq!(edge.as_mut().poll(&mut context), Poll::Ready(Ok(counts)));
    }
    assert_eq!(encoder.quadrature().position(), 2);
}

/// An edge between two calls is not waited for: its interrupt has gone by.
#[test]
fn an_edge_before_the_call_is_counted_at_once() {
    let (a, b) = (Cell::new(Some(false)), Cell::new(Some(false)));
    let mut encoder = QuadraturePins::new(Pin { level: &a }, Pin { level: &b }, Scale::X4).unwrap();
    a.set(Some(true));
    assert_eq!(poll(encoder.edge()), Poll::Ready(Ok(1)));
}
