//! Moves a geared DC motor, in a simple model, to a position and holds it against a load.

use fixed::types::{I16F16, I32F0};
use husillo_pid::{Conditional, Gains, Integration, Limits, OfMeasurement, Pid, State};

fn main() -> Result<(), husillo_pid::SettingsError> {
    let gains = Gains {
        proportional: I16F16::lit("2"),
        integral: I16F16::lit("0.01"),
        derivative: I16F16::lit("40"),
    };
    let limits = Limits {
        low: I32F0::from_num(-255),
        high: I32F0::from_num(255),
    };
    let pid = Pid::new(gains, Integration::Bilinear, limits)?
        .with_anti_windup(Conditional)
        .with_derivative(OfMeasurement);
    let mut axis = State::default();

    // Velocity in 1/1024 counts per sample, position in 1/1024 counts. The velocity follows the
    // drive with a lag.
    let (mut velocity, mut position) = (0_i32, 0_i32);
    let target = I32F0::from_num(400);
    println!("sample  position  drive");
    for sample in 0..=2000 {
        let measured = I32F0::from_num(position >> 10);
        let drive = pid.update(&mut axis, target, measured).to_num::<i32>();
        let load = if sample < 1000 { 0 } else { 60 };
        velocity += (16 * (drive - load) - velocity) / 64;
        position += velocity;
        if sample % 200 == 0 {
            println!("{sample:6}  {measured:8}  {drive:5}");
        }
    }
    let rest = target - I32F0::from_num(position >> 10);
    assert!(rest.abs() <= 1, "off by {rest} counts");
    Ok(())
}
