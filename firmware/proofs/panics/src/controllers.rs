//! The public functions of `husillo-controllers`.

use core::hint::black_box;

use husillo_controllers::{
    Controller, Drill as AnyDrill, DrillEvent, Microfactory as AnyMicrofactory, MicrofactoryEvent,
    MicrofactoryStation as AnyMicrofactoryStation, Micromill as AnyMicromill, MicromillConfig,
    MicromillEvent, MicromillStep, MicromillStops as Stops, ServoModule, ServoModuleOutput,
    StopBytes, Timed, servo_law,
};

type Microfactory = AnyMicrofactory<&'static [[i16; 2]]>;
type MicrofactoryStation = AnyMicrofactoryStation<100, 2>;
type Drill = AnyDrill<64>;
type Micromill = AnyMicromill<'static>;

/// Keeps every function in the program.
#[unsafe(export_name = "controllers")]
pub fn keep() {
    black_box([
        Microfactory::new as *const (),
        Microfactory::command as *const (),
        Microfactory::reset as *const (),
        Microfactory::is_moving as *const (),
        Microfactory::is_homed as *const (),
        Microfactory::position_steps as *const (),
        Microfactory::status as *const (),
        Microfactory::figure as *const (),
        Microfactory::figure_mut as *const (),
        Microfactory::next_event as *const (),
        MicrofactoryStation::new as *const (),
        MicrofactoryStation::store as *const (),
        MicrofactoryStation::command as *const (),
        MicrofactoryStation::is_moving as *const (),
        MicrofactoryStation::machine as *const (),
        <MicrofactoryStation as Controller>::machines as *const (),
        <MicrofactoryStation as Controller>::stops as *const (),
        <MicrofactoryStation as Controller>::receive as *const (),
        <MicrofactoryStation as Controller>::next_event as *const (),
        <MicrofactoryStation as Controller>::transmit as *const (),
        <MicrofactoryStation as Controller>::reset as *const (),
        <Micromill as Controller>::stops as *const (),
        <Stops as StopBytes>::takes as *const (),
        <Micromill as Controller>::expire as *const (),
        <Micromill as Controller>::lease_us as *const (),
        <Micromill as Controller>::receive as *const (),
        <Micromill as Controller>::next_event as *const (),
        <Micromill as Controller>::reset as *const (),
        <Drill as Controller>::stops as *const (),
        <Drill as Controller>::receive as *const (),
        <Drill as Controller>::next_event as *const (),
        <ServoModule as Controller>::stops as *const (),
        <ServoModule as Controller>::receive as *const (),
        <ServoModule as Controller>::next_event as *const (),
        <ServoModule as Controller>::transmit as *const (),
        <ServoModule as Controller>::reset as *const (),
        Micromill::expire as *const (),
        Micromill::halted as *const (),
        Micromill::homed as *const (),
        Micromill::is_homed as *const (),
        Micromill::is_moving as *const (),
        Micromill::lease_us as *const (),
        Micromill::made as *const (),
        Micromill::new as *const (),
        Micromill::next_event as *const (),
        Micromill::position_steps as *const (),
        Micromill::receive as *const (),
        Micromill::stops as *const (),
        Micromill::reports_next as *const (),
        MicromillConfig::with_step_of as *const (),
        MicromillStep::deltas as *const (),
        Micromill::transmit as *const (),
        Drill::new as *const (),
        Drill::reset as *const (),
        Drill::push as *const (),
        Drill::transmit as *const (),
        Drill::stored as *const (),
        Drill::position_steps as *const (),
        Drill::is_homed as *const (),
        Drill::is_working as *const (),
        Drill::spindle_turns as *const (),
        Drill::next_event as *const (),
        <DrillEvent as Timed>::wait_ticks as *const (),
        <MicrofactoryEvent as Timed>::wait_ticks as *const (),
        <MicromillEvent as Timed>::wait_ticks as *const (),
        <ServoModuleOutput as Timed>::wait_ticks as *const (),
        servo_law as *const (),
        ServoModule::new as *const (),
        ServoModule::link as *const (),
        ServoModule::axis as *const (),
        ServoModule::tick as *const (),
    ]);
}
