//! The public functions of `husillo-transports`.

use core::convert::Infallible;
use core::hint::black_box;

use embedded_hal::digital::{ErrorType as PinErrorType, OutputPin};
use embedded_hal_nb::nb;
use embedded_hal_nb::serial;
use husillo_transports::microfactory::{
    self, ByteTable, Device, Order, Report, figure_check, move_bytes,
};
use husillo_transports::nmc::{
    Auxiliary, Baud, Command, Frame, Homing, Host, Items, Module, Outcome, PathPoints, Polling,
    Receiver, Reply, Startup, Status, Timing, Trajectory, flush_byte, reported_velocity,
    unseen_pairs_in_halves,
};
use husillo_transports::rs485::{AsyncIoPort, Echo, EnablePin, IoPort, NbPort, Turnaround};

/// Keeps every function in the program.
#[unsafe(export_name = "transports")]
pub fn keep() {
    drill::keep();
    micromill::keep();
    link::keep();
    grbl::keep();
    black_box([
        Auxiliary::contains as *const (),
        Baud::bits_per_s as *const (),
        Baud::characters_us as *const (),
        Baud::divisor as *const (),
        Baud::from_divisor as *const (),
        Order::is_a_motion as *const (),
        Device::acknowledging as *const (),
        Device::leave_mode as *const (),
        Device::machine as *const (),
        Device::new as *const (),
        Device::of_two_machines as *const (),
        Device::receive as *const (),
        Device::reset as *const (),
        Device::storing as *const (),
        ByteTable::is_unambiguous as *const (),
        Report::byte as *const (),
        Report::of as *const (),
        microfactory::Status::bytes as *const (),
        microfactory::Status::of as *const (),
        microfactory::Switches::bytes as *const (),
        microfactory::Switches::of as *const (),
        figure_check as *const (),
        move_bytes as *const (),
        Command::decode as *const (),
        Command::finding as *const (),
        Command::frame as *const (),
        Command::is_in_range as *const (),
        Command::repeat as *const (),
        Echo::<8>::hears_itself as *const (),
        Echo::<8>::learn as *const (),
        Echo::<8>::new as *const (),
        Echo::<8>::received as *const (),
        Echo::<8>::sent as *const (),
        Echo::<8>::silence as *const (),
        EnablePin::<Pin>::active_high as *const (),
        EnablePin::<Pin>::active_low as *const (),
        EnablePin::<Pin>::release as *const (),
        EnablePin::<Pin>::set as *const (),
        Frame::bytes as *const (),
        Frame::new as *const (),
        Homing::contains as *const (),
        Homing::is_cancel as *const (),
        Homing::with as *const (),
        Host::adopt as *const (),
        Host::baud as *const (),
        Host::members_of as *const (),
        Host::new as *const (),
        Host::poll as *const (),
        Host::push as *const (),
        Host::send_command as *const (),
        Host::set_timing as *const (),
        Host::start as *const (),
        Host::timing as *const (),
        Host::transmit as *const (),
        AsyncIoPort::<Port, Pin, 8>::echo as *const (),
        AsyncIoPort::<Port, Pin, 8>::new as *const (),
        AsyncIoPort::<Port, Pin, 8>::release as *const (),
        send_async as *const (),
        receive_async as *const (),
        IoPort::<Port, Pin, 8>::echo as *const (),
        IoPort::<Port, Pin, 8>::new as *const (),
        IoPort::<Port, Pin, 8>::receive as *const (),
        IoPort::<Port, Pin, 8>::release as *const (),
        IoPort::<Port, Pin, 8>::send as *const (),
        Items::contains as *const (),
        Items::length as *const (),
        Items::of_version as *const (),
        Items::with as *const (),
        Module::address as *const (),
        Module::enables_next as *const (),
        Module::forget_partial as *const (),
        Module::group as *const (),
        Module::is_sending as *const (),
        Module::items as *const (),
        Module::new as *const (),
        Module::owes_reply as *const (),
        Module::push as *const (),
        Module::reply as *const (),
        Module::set_enabled as *const (),
        Module::take as *const (),
        Module::transmit as *const (),
        Module::version as *const (),
        NbPort::<Port, Pin, 8>::complete as *const (),
        NbPort::<Port, Pin, 8>::echo as *const (),
        NbPort::<Port, Pin, 8>::is_driving as *const (),
        NbPort::<Port, Pin, 8>::new as *const (),
        NbPort::<Port, Pin, 8>::receive as *const (),
        NbPort::<Port, Pin, 8>::release as *const (),
        NbPort::<Port, Pin, 8>::send as *const (),
        Outcome::reply as *const (),
        PathPoints::new as *const (),
        PathPoints::points as *const (),
        Polling::module_us as *const (),
        Polling::rate_mhz as *const (),
        Polling::round_us as *const (),
        Receiver::address as *const (),
        Receiver::code as *const (),
        Receiver::data as *const (),
        Receiver::is_idle as *const (),
        Receiver::new as *const (),
        Receiver::push as *const (),
        Receiver::reset as *const (),
        Reply::auxiliary as *const (),
        Reply::decode as *const (),
        Reply::home as *const (),
        Reply::position as *const (),
        Reply::velocity as *const (),
        Startup::new as *const (),
        Startup::next as *const (),
        Startup::resetting_each as *const (),
        Status::contains as *const (),
        Timing::patient as *const (),
        Timing::prompt as *const (),
        Trajectory::is_relative as *const (),
        Turnaround::begin as *const (),
        Turnaround::complete as *const (),
        Turnaround::heard as *const (),
        Turnaround::is_driving as *const (),
        Turnaround::new as *const (),
        Turnaround::wait_us as *const (),
        flush_byte as *const (),
        reported_velocity as *const (),
        unseen_pairs_in_halves as *const (),
    ]);
}

/// A pin that keeps its level in memory.
struct Pin(bool);

impl PinErrorType for Pin {
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

/// A port that takes any byte and returns any byte, or is not ready.
struct Port;

impl serial::ErrorType for Port {
    type Error = serial::ErrorKind;
}

impl serial::Read<u8> for Port {
    fn read(&mut self) -> nb::Result<u8, serial::ErrorKind> {
        black_box(Ok(0))
    }
}

impl serial::Write<u8> for Port {
    fn write(&mut self, byte: u8) -> nb::Result<(), serial::ErrorKind> {
        black_box(byte);
        black_box(Ok(()))
    }

    fn flush(&mut self) -> nb::Result<(), serial::ErrorKind> {
        black_box(Ok(()))
    }
}

impl embedded_io::ErrorType for Port {
    type Error = embedded_io::ErrorKind;
}

impl embedded_io::Read for Port {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, embedded_io::ErrorKind> {
        black_box(bytes);
        black_box(Ok(1))
    }
}

impl embedded_io::Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, embedded_io::ErrorKind> {
        black_box(bytes);
        black_box(Ok(1))
    }

    fn flush(&mut self) -> Result<(), embedded_io::ErrorKind> {
        black_box(Ok(()))
    }
}

impl embedded_io::ReadReady for Port {
    fn read_ready(&mut self) -> Result<bool, embedded_io::ErrorKind> {
        black_box(Ok(true))
    }
}

/// Polls a future once.
fn poll<T>(future: impl Future<Output = T>) -> bool {
    let mut context = core::task::Context::from_waker(core::task::Waker::noop());
    core::pin::pin!(future).poll(&mut context).is_ready()
}

fn send_async(port: &mut AsyncIoPort<Port, Pin, 8>, message: &[u8]) -> bool {
    poll(AsyncIoPort::send(port, message))
}

fn receive_async(port: &mut AsyncIoPort<Port, Pin, 8>) -> bool {
    poll(AsyncIoPort::receive(port))
}

/// A future that is at once ready.
fn ready<T: Copy>(value: T) -> impl Future<Output = T> {
    core::future::poll_fn(move |_| core::task::Poll::Ready(black_box(value)))
}

impl embedded_io_async::Read for Port {
    fn read(
        &mut self,
        bytes: &mut [u8],
    ) -> impl Future<Output = Result<usize, embedded_io::ErrorKind>> {
        black_box(bytes);
        ready(Ok(1))
    }
}

impl embedded_io_async::Write for Port {
    fn write(
        &mut self,
        bytes: &[u8],
    ) -> impl Future<Output = Result<usize, embedded_io::ErrorKind>> {
        black_box(bytes);
        ready(Ok(1))
    }

    fn flush(&mut self) -> impl Future<Output = Result<(), embedded_io::ErrorKind>> {
        ready(Ok(()))
    }
}

/// The link of the drill. Its types have the same names as those of the servo network.
mod drill {
    use core::hint::black_box;

    use husillo_transports::drill::{
        Device, Host, MachineState, Reading, Record, RecordBytes, Records, Table, Timing,
        record_bytes, records,
    };

    pub fn keep() {
        black_box([
            Device::<64>::cut_short as *const (),
            Device::<64>::discard_drilling as *const (),
            Device::<64>::done as *const (),
            Device::<64>::expire as *const (),
            Device::<64>::fail as *const (),
            Device::<64>::is_expired as *const (),
            Device::<64>::is_full as *const (),
            Device::<64>::is_manual as *const (),
            Device::<64>::is_receiving as *const (),
            Device::<64>::is_working as *const (),
            Device::<64>::lease_us as *const (),
            Device::<64>::new as *const (),
            Device::<64>::push as *const (),
            Device::<64>::set_machine as *const (),
            Device::<64>::stored as *const (),
            Device::<64>::take as *const (),
            Device::<64>::teach as *const (),
            Device::<64>::transmit as *const (),
            Host::ask_at_work as *const (),
            Host::begun_bytes as *const (),
            Host::done_bytes as *const (),
            Host::give_up as *const (),
            Host::is_at_work as *const (),
            Host::new as *const (),
            Host::poll as *const (),
            Host::push as *const (),
            Host::record as *const (),
            Host::start as *const (),
            Host::stop as *const (),
            Host::stored_bytes as *const (),
            Host::transmit as *const (),
            Host::wait_on as *const (),
            MachineState::bits as *const (),
            MachineState::set_bits as *const (),
            Reading::number as *const (),
            Timing::of as *const (),
            Timing::original as *const (),
            Record::to_bytes as *const (),
            Record::from_bytes as *const (),
            Table::steps as *const (),
            Table::move_x as *const (),
            Table::move_y as *const (),
            Table::hole as *const (),
            record_bytes::<[Record; 3]> as *const (),
            <RecordBytes<core::array::IntoIter<Record, 3>> as Iterator>::next as *const (),
            records as *const (),
            <Records as Iterator>::next as *const (),
        ]);
    }
}

mod micromill {
    use core::hint::black_box;

    use husillo_transports::micromill::{
        Answer, Axis, AxisState, Device, Host, HostTiming, Line, Order, State, StateDigits, Stops,
        Text,
    };

    pub fn keep() {
        black_box([
            Answer::byte as *const (),
            Answer::of as *const (),
            Axis::letter as *const (),
            AxisState::motor_steps as *const (),
            Device::<64>::answer as *const (),
            Device::<64>::default as *const (),
            Device::<64>::has_room as *const (),
            Device::<64>::is_silent as *const (),
            Device::<64>::tells_steps as *const (),
            Device::<64>::is_streaming as *const (),
            Device::<64>::new as *const (),
            Device::<64>::push as *const (),
            Device::<64>::report as *const (),
            Device::<64>::set_motion as *const (),
            Device::<64>::step as *const (),
            Device::<64>::stops as *const (),
            Device::<64>::transmit as *const (),
            Host::is_streaming as *const (),
            Host::lines as *const (),
            Host::new as *const (),
            Host::poll as *const (),
            Host::push as *const (),
            Host::start as *const (),
            Host::transmit as *const (),
            HostTiming::of as *const (),
            Line::read as *const (),
            Order::is_answered as *const (),
            Order::read as *const (),
            Order::text as *const (),
            State::homed as *const (),
            State::motor_steps as *const (),
            StateDigits::new as *const (),
            StateDigits::push as *const (),
            StateDigits::state as *const (),
            Stops::takes as *const (),
            Text::bytes as *const (),
        ]);
    }
}

/// The link of frames.
mod link {
    use core::hint::black_box;

    use husillo_transports::link::{Frame, Master, Peer, Receiver, Sent, Station, Timing};

    pub fn keep() {
        black_box([
            Frame::encode as *const (),
            Master::<3>::broadcast as *const (),
            Master::<3>::call as *const (),
            Master::<3>::is_up as *const (),
            Master::<3>::new as *const (),
            Master::<3>::poll as *const (),
            Master::<3>::push as *const (),
            Master::<3>::send as *const (),
            Master::<3>::poll_send as *const (),
            Master::<3>::transmit as *const (),
            Master::<3>::unacknowledged as *const (),
            Peer::<7>::call as *const (),
            Peer::<7>::caller as *const (),
            Peer::<7>::is_up as *const (),
            Peer::<7>::poll as *const (),
            Peer::<7>::push as *const (),
            Peer::<7>::send as *const (),
            Peer::<7>::poll_send as *const (),
            Peer::<7>::station as *const (),
            Peer::<7>::transmit as *const (),
            Peer::<7>::unacknowledged as *const (),
            Receiver::new as *const (),
            Receiver::push as *const (),
            Sent::bytes as *const (),
            Sent::transmit as *const (),
            Station::is_up as *const (),
            Station::new as *const (),
            Station::poll as *const (),
            Station::push as *const (),
            Station::send as *const (),
            Station::poll_send as *const (),
            Station::transmit as *const (),
            Station::unacknowledged as *const (),
            Timing::of as *const (),
            Timing::wait_us as *const (),
        ]);
    }
}

/// The link of Grbl.
mod grbl {
    use core::hint::black_box;

    use husillo_transports::grbl::{
        Accessories, Adjust, Alarm, ErrorCode, Feedback, HeightLine, LineReader, Message,
        Parameter, Pins, Place, Realtime, Receiver, Settings, State, Status, Text, Window, decimal,
        key_and_value,
    };

    pub fn keep() {
        black_box([
            Accessories::put_letters as *const (),
            Adjust::apply as *const (),
            Alarm::number as *const (),
            Alarm::of as *const (),
            Alarm::text as *const (),
            ErrorCode::number as *const (),
            ErrorCode::of as *const (),
            ErrorCode::text as *const (),
            Feedback::text as *const (),
            HeightLine::parse as *const (),
            HeightLine::row::<[i32; 2]> as *const (),
            HeightLine::write as *const (),
            LineReader::clear as *const (),
            LineReader::new as *const (),
            LineReader::push as *const (),
            Message::is_answer as *const (),
            Message::parse as *const (),
            Message::write as *const (),
            Parameter::name as *const (),
            Pins::put as *const (),
            Place::new as *const (),
            Place::nm as *const (),
            Place::put as *const (),
            Realtime::byte as *const (),
            Realtime::of as *const (),
            Receiver::<256>::clear as *const (),
            Receiver::<256>::free as *const (),
            Receiver::<256>::lost as *const (),
            Receiver::<256>::new as *const (),
            Receiver::<256>::push as *const (),
            Receiver::<256>::room as *const (),
            Receiver::<256>::take as *const (),
            Settings::from_bytes as *const (),
            Settings::is_set as *const (),
            Settings::milli as *const (),
            Settings::text as *const (),
            Settings::to_bytes as *const (),
            Settings::whole as *const (),
            Settings::write as *const (),
            State::name as *const (),
            Status::new as *const (),
            Text::bytes as *const (),
            Text::new as *const (),
            Text::put as *const (),
            Text::put_decimal as *const (),
            Text::put_length as *const (),
            Text::put_number as *const (),
            Window::answered as *const (),
            Window::bytes as *const (),
            Window::clear as *const (),
            Window::lines as *const (),
            Window::new as *const (),
            Window::send as *const (),
            decimal as *const (),
            key_and_value as *const (),
        ]);
    }
}
