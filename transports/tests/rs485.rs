//! Half-duplex lines: the times of driver enable, and the ports behind the features.

use husillo_transports::rs485::{Echo, Heard, Turnaround};

const CHARACTER_US: u32 = 87;

/// ```text
///  request ...|                     |
///  silence    0 ........... 87      |
///  driving                  87 ... 434 (4 characters): released with the last stop bit
/// ```
#[test]
fn the_line_is_driven_after_the_turnaround_and_let_go_at_the_end() {
    let begin_us = u32::MAX - 40; // across the wrap
    let mut line = Turnaround::new(CHARACTER_US);
    line.heard(begin_us);
    for later in 0..CHARACTER_US {
        assert!(!line.begin(begin_us.wrapping_add(later)));
        assert_eq!(
            line.wait_us(begin_us.wrapping_add(later)),
            CHARACTER_US - later
        );
    }
    assert!(line.begin(begin_us.wrapping_add(CHARACTER_US)));
    assert!(line.is_driving());
    let end_us = begin_us.wrapping_add(5 * CHARACTER_US);
    line.complete(end_us);
    assert!(!line.is_driving());
    assert!(!line.begin(end_us), "the others are given their turn");
    assert!(line.begin(end_us.wrapping_add(CHARACTER_US)));
}

#[test]
fn silence_long_ago_stays_long_ago() {
    let mut line = Turnaround::new(CHARACTER_US);
    line.heard(0);
    assert_eq!(line.wait_us(1_000_000), 0);
    assert_eq!(line.wait_us(10), 0, "the clock has wrapped");
}

#[test]
fn whether_the_line_returns_bytes_is_learned_from_one() {
    let mut echo = Echo::<4>::new(true);
    for (heard, hears_itself) in [(None, false), (Some(0), true), (Some(3), false)] {
        echo.learn(0, heard);
        assert_eq!(echo.hears_itself(), hears_itself);
    }
    assert!(
        echo.sent(9),
        "nothing is kept of a line that returns nothing"
    );
    assert_eq!(echo.received(9), Heard::Foreign(9));
}

#[cfg(any(feature = "embedded-io", feature = "embedded-hal-nb"))]
mod ports {
    use std::cell::RefCell;
    use std::collections::VecDeque;
    use std::convert::Infallible;
    use std::rc::Rc;

    use embedded_hal::digital::{ErrorType, OutputPin};
    use husillo_transports::rs485::{Echo, EnablePin};

    /// What happened, in order.
    #[derive(Debug, Clone, PartialEq, Eq)]
    enum Event {
        Driving(bool),
        Sent(u8),
        Complete,
    }

    /// A transceiver, its port and the line: what is sent is returned where the line does so.
    #[derive(Debug, Default)]
    struct Wire {
        events: Vec<Event>,
        receive: VecDeque<u8>,
        returns: bool,
        /// Spoils the byte sent after so many.
        spoil: Option<usize>,
        /// Characters the shift register still holds.
        shifting: u8,
    }

    #[derive(Debug, Clone)]
    struct Port(Rc<RefCell<Wire>>);

    #[derive(Debug, Clone)]
    struct Pin(Rc<RefCell<Wire>>);

    impl ErrorType for Pin {
        type Error = Infallible;
    }

    impl OutputPin for Pin {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().events.push(Event::Driving(false));
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().events.push(Event::Driving(true));
            Ok(())
        }
    }

    impl Wire {
        fn send(&mut self, byte: u8) {
            let sent = self
                .events
                .iter()
                .filter(|event| matches!(event, Event::Sent(_)))
                .count();
            self.events.push(Event::Sent(byte));
            if self.returns {
                let is_spoilt = self.spoil == Some(sent);
                self.receive
                    .push_back(if is_spoilt { byte & 0x55 } else { byte });
            }
            self.shifting = 2;
        }
    }

    fn wire(returns: bool, spoil: Option<usize>) -> Rc<RefCell<Wire>> {
        Rc::new(RefCell::new(Wire {
            returns,
            spoil,
            ..Wire::default()
        }))
    }

    #[cfg(feature = "embedded-io")]
    const MESSAGE: [u8; 6] = [0xAA, 1, 0x0E, 0x0F, 0, 0];

    /// The line was driven for `MESSAGE` and released after its last stop bit.
    #[cfg(feature = "embedded-io")]
    fn check_message(events: &[Event]) {
        let bytes = MESSAGE.map(Event::Sent);
        let (begin, end) = (
            [Event::Driving(true)],
            [Event::Complete, Event::Driving(false)],
        );
        assert_eq!(events, [&begin[..], &bytes, &end].concat());
    }

    /// The first byte of `MESSAGE` was spoilt, and no other one was sent.
    #[cfg(feature = "embedded-io")]
    fn check_collision(events: &[Event]) {
        assert_eq!(
            events,
            [
                Event::Driving(true),
                Event::Sent(MESSAGE[0]),
                Event::Complete,
                Event::Driving(false)
            ]
        );
    }

    #[cfg(feature = "embedded-hal-nb")]
    mod nb {
        use super::*;
        use embedded_hal_nb::nb::{self, block};
        use embedded_hal_nb::serial;
        use husillo_transports::rs485::{NbError, NbPort};

        impl serial::ErrorType for Port {
            type Error = serial::ErrorKind;
        }

        impl serial::Read<u8> for Port {
            fn read(&mut self) -> nb::Result<u8, serial::ErrorKind> {
                self.0
                    .borrow_mut()
                    .receive
                    .pop_front()
                    .ok_or(nb::Error::WouldBlock)
            }
        }

        impl serial::Write<u8> for Port {
            fn write(&mut self, byte: u8) -> nb::Result<(), serial::ErrorKind> {
                self.0.borrow_mut().send(byte);
                Ok(())
            }

            fn flush(&mut self) -> nb::Result<(), serial::ErrorKind> {
                let mut wire = self.0.borrow_mut();
                if wire.shifting > 0 {
                    wire.shifting -= 1;
                    return Err(nb::Error::WouldBlock);
                }
                wire.events.push(Event::Complete);
                Ok(())
            }
        }

        #[test]
        fn the_driver_is_released_on_transmission_complete() {
            let wire = wire(true, None);
            let mut port: NbPort<Port, Pin, 8> = NbPort::new(
                Port(wire.clone()),
                EnablePin::active_high(Pin(wire.clone())),
                Echo::new(true),
            );
            for byte in [0x19, 0x19] {
                block!(port.send(byte)).expect("sent");
            }
            assert!(port.is_driving());
            assert_eq!(port.complete(), Err(nb::Error::WouldBlock));
            assert!(port.is_driving(), "the last byte is still on its way");
            block!(port.complete()).expect("released");
            assert_eq!(
                wire.borrow().events,
                [
                    Event::Driving(true),
                    Event::Sent(0x19),
                    Event::Sent(0x19),
                    Event::Complete,
                    Event::Driving(false)
                ]
            );
            // One's own, one's own, then somebody else's.
            wire.borrow_mut().receive.push_back(0x77);
            assert_eq!(
                [port.receive(), port.receive(), port.receive()],
                [Ok(None), Ok(None), Ok(Some(0x77))]
            );
            assert_eq!(port.receive(), Err(nb::Error::WouldBlock));
        }

        #[test]
        fn a_collision_lets_the_line_go() {
            let wire = wire(true, Some(1));
            let mut port: NbPort<Port, Pin, 8> = NbPort::new(
                Port(wire.clone()),
                EnablePin::active_low(Pin(wire.clone())),
                Echo::new(true),
            );
            block!(port.send(0xFF)).expect("sent");
            block!(port.send(0xFF)).expect("sent");
            assert_eq!(port.receive(), Ok(None));
            assert_eq!(port.receive(), Err(nb::Error::Other(NbError::Collision)));
            assert!(!port.is_driving());
            // Inverted: high lets go.
            assert_eq!(wire.borrow().events.last(), Some(&Event::Driving(true)));
        }

        #[test]
        fn a_full_list_of_echoes_waits() {
            let wire = wire(true, None);
            let mut port: NbPort<Port, Pin, 1> = NbPort::new(
                Port(wire.clone()),
                EnablePin::active_high(Pin(wire.clone())),
                Echo::new(true),
            );
            block!(port.send(1)).expect("sent");
            assert_eq!(port.send(2), Err(nb::Error::WouldBlock));
            assert_eq!(port.receive(), Ok(None));
            assert_eq!(port.send(2), Ok(()));
        }
    }

    #[cfg(feature = "embedded-io")]
    mod io {
        use super::*;
        use husillo_transports::rs485::{IoError, IoPort};

        impl embedded_io::ErrorType for Port {
            type Error = Infallible;
        }

        impl embedded_io::Read for Port {
            fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
                let byte = self.0.borrow_mut().receive.pop_front();
                bytes
                    .iter_mut()
                    .zip(byte)
                    .for_each(|(place, byte)| *place = byte);
                Ok(usize::from(byte.is_some()))
            }
        }

        impl embedded_io::Write for Port {
            fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
                self.0.borrow_mut().send(bytes[0]);
                Ok(1)
            }

            fn flush(&mut self) -> Result<(), Infallible> {
                self.0.borrow_mut().events.push(Event::Complete);
                Ok(())
            }
        }

        impl embedded_io::ReadReady for Port {
            fn read_ready(&mut self) -> Result<bool, Infallible> {
                Ok(!self.0.borrow().receive.is_empty())
            }
        }

        fn port(wire: &Rc<RefCell<Wire>>, hears_itself: bool) -> IoPort<Port, Pin, 4> {
            IoPort::new(
                Port(wire.clone()),
                EnablePin::active_high(Pin(wire.clone())),
                Echo::new(hears_itself),
            )
        }

        #[test]
        fn a_message_is_sent_and_its_echo_dropped() {
            for returns in [true, false] {
                let wire = wire(returns, None);
                let mut port = port(&wire, returns);
                port.send(&MESSAGE).expect("sent");
                check_message(&wire.borrow().events);
                assert_eq!(port.receive(), Ok(None));
                wire.borrow_mut().receive.extend([0x19, 0x1A]);
                assert_eq!(
                    (port.receive(), port.receive()),
                    (Ok(Some(0x19)), Ok(Some(0x1A)))
                );
            }
        }

        #[test]
        fn a_collision_ends_the_message_and_lets_the_line_go() {
            let wire = wire(true, Some(0));
            let mut port = port(&wire, true);
            assert_eq!(port.send(&MESSAGE), Err(IoError::Collision));
            check_collision(&wire.borrow().events);
        }
    }

    #[cfg(feature = "embedded-io-async")]
    mod io_async {
        use super::*;
        use core::future::{Future, poll_fn};
        use core::pin::pin;
        use core::task::{Context, Poll, Waker};
        use embedded_io_async::{ErrorType, Read, ReadReady, Write};
        use husillo_transports::rs485::{AsyncIoPort, IoError};

        /// The same wire, for a task: a write is pending once, a read until there is a byte.
        struct Waiting(Port);

        impl ErrorType for Waiting {
            type Error = Infallible;
        }

        impl Read for Waiting {
            async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
                poll_fn(|_| match self.0.0.borrow_mut().receive.pop_front() {
                    None => Poll::Pending,
                    Some(byte) => {
                        bytes[0] = byte;
                        Poll::Ready(Ok(1))
                    }
                })
                .await
            }
        }

        impl Write for Waiting {
            async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
                pend_once().await;
                self.0.0.borrow_mut().send(bytes[0]);
                Ok(1)
            }

            async fn flush(&mut self) -> Result<(), Infallible> {
                pend_once().await;
                self.0.0.borrow_mut().events.push(Event::Complete);
                Ok(())
            }
        }

        impl ReadReady for Waiting {
            fn read_ready(&mut self) -> Result<bool, Infallible> {
                Ok(!self.0.0.borrow().receive.is_empty())
            }
        }

        async fn pend_once() {
            let mut is_over = false;
            poll_fn(|_| match std::mem::replace(&mut is_over, true) {
                true => Poll::Ready(()),
                false => Poll::Pending,
            })
            .await;
        }

        fn poll<T>(future: core::pin::Pin<&mut impl Future<Output = T>>) -> Poll<T> {
            future.poll(&mut Context::from_waker(Waker::noop()))
        }

        /// Polls to the end, which must come within 50 polls.
        fn run<T>(future: impl Future<Output = T>) -> (T, u32) {
            let mut future = pin!(future);
            for polls in 1..50 {
                if let Poll::Ready(value) = poll(future.as_mut()) {
                    return (value, polls);
                }
            }
            panic!("still pending")
        }

        fn port(wire: &Rc<RefCell<Wire>>, hears_itself: bool) -> AsyncIoPort<Waiting, Pin, 4> {
            AsyncIoPort::new(
                Waiting(Port(wire.clone())),
                EnablePin::active_high(Pin(wire.clone())),
                Echo::new(hears_itself),
            )
        }

        #[test]
        fn a_message_is_sent_and_its_echo_dropped() {
            for returns in [true, false] {
                let wire = wire(returns, None);
                let mut port = port(&wire, returns);
                let (sent, polls) = run(port.send(&MESSAGE));
                assert_eq!((sent, polls), (Ok(()), 8), "six writes and the flush");
                check_message(&wire.borrow().events);
                {
                    let mut receiving = pin!(port.receive());
                    assert_eq!(poll(receiving.as_mut()), Poll::Pending);
                    wire.borrow_mut().receive.extend([0x19, 0x1A]);
                    assert_eq!(poll(receiving.as_mut()), Poll::Ready(Ok(0x19)));
                }
                assert_eq!(run(port.receive()), (Ok(0x1A), 1));
            }
        }

        #[test]
        fn a_collision_ends_the_message_and_lets_the_line_go() {
            let wire = wire(true, Some(0));
            let mut port = port(&wire, true);
            assert_eq!(run(port.send(&MESSAGE)).0, Err(IoError::Collision));
            check_collision(&wire.borrow().events);
        }

        #[test]
        fn a_dropped_message_lets_the_line_go() {
            let wire = wire(true, None);
            let mut port = port(&wire, true);
            {
                let mut sending = pin!(port.send(&[0xAA, 0xAA]));
                assert_eq!(poll(sending.as_mut()), Poll::Pending);
                assert_eq!(wire.borrow().events, [Event::Driving(true)]);
            }
            assert_eq!(wire.borrow().events.last(), Some(&Event::Driving(false)));
            // The byte that was not sent has no echo.
            wire.borrow_mut().receive.push_back(0x19);
            assert_eq!(run(port.receive()), (Ok(0x19), 1));
        }

        #[test]
        fn many_dropped_messages_leave_room_for_the_next_one() {
            let wire = wire(true, None);
            let mut port = port(&wire, true);
            for _ in 0..5 {
                let mut sending = pin!(port.send(&[0xAA, 0xAA]));
                assert_eq!(poll(sending.as_mut()), Poll::Pending);
            }
            assert_eq!(run(port.send(&[0xAA, 1])).0, Ok(()));
        }
    }
}
