//! Table 4.1: rates of X and Z for three ratios of their distances.

use super::PULSES;
use crate::originals::{Parameter, Row, Table};
use husillo_controllers::{
    Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryReport,
};
use husillo_sim::MicrofactoryRig;
use husillo_transports::microfactory::{ByteTable, Device};

/// Ratio of the distances, and the phase frequencies of X and Z, Hz.
const READINGS: [(i16, [f64; 2]); 3] = [
    (2, [110.6, 55.31]),
    (3, [101.4, 33.83]),
    (4, [70.10, 15.22]),
];
/// Steps of Z in a move.
const STEPS: i16 = 300;
/// Spread of a ratio: the last digits of the frequencies.
const RATIO_SPREAD: f64 = 0.01;
/// Spread of a frequency, Hz.
const RATE_SPREAD_HZ: f64 = 0.05;

/// Rates of both axes on the original, and with the controller of today.
///
/// # Errors
///
/// The simulated machine does not cut a move.
pub fn rates() -> Result<Table, String> {
    let mut rows = Vec::new();
    for (ratio, [x_hz, z_hz]) in READINGS {
        let [x_today, z_today] = cut([ratio * STEPS, STEPS])?;
        for (letter, measured, today) in [("X", x_hz, x_today), ("Z", z_hz, z_today)] {
            let name = format!("ratio {ratio}: {letter}");
            rows.push(Row {
                today: Some(today),
                ..Row::new(name, "Hz", measured, RATE_SPREAD_HZ)
            });
        }
        let [x_steps, z_steps] = cut_by_whole_ratio([ratio * STEPS, STEPS]);
        rows.push(
            Row::new(
                format!("ratio {ratio}: X per Z"),
                "X/Z",
                x_hz / z_hz,
                RATIO_SPREAD,
            )
            .rebuilt(x_steps / z_steps)
            .today(x_today / z_today, f64::from(ratio)),
        );
    }
    Ok(Table {
        number: "4.1",
        title: "phase frequencies of X and Z for three ratios of their distances",
        spread: "frequencies: their last digit; ratios: what follows from it",
        rows,
        parameters: vec![Parameter::new(
            "steps of Z",
            STEPS.to_string(),
            "ours: the original states only the ratios",
        )],
        notes: vec![
            "The rates themselves depend on the time of the original's loops, which is not stated: \
             they fall with the ratio. Today every move has the same speed along its path."
                .into(),
            "Outside: the rates for the ratio 4 have a ratio of 4.61. The original divides in \
             integers, so it cannot be the ratio of the steps that were made: a rate is wrong, or \
             the distances had another ratio."
                .into(),
        ],
    })
}

/// The steps that the original makes. It divides the larger number of steps by the smaller one, in
/// integers, and makes a step of Z each time X has made that number of steps.
fn cut_by_whole_ratio([x, z]: [i16; 2]) -> [f64; 2] {
    let whole = x / z;
    let mut made = [0.0; 2];
    for step in 1..=x {
        made[0] += 1.0;
        if step % whole == 0 {
            made[1] += 1.0;
        }
    }
    made
}

/// Cuts one move in X and Z and returns their phase frequencies, Hz.
fn cut(move_steps: [i16; 2]) -> Result<[f64; 2], String> {
    let config = MicrofactoryConfig::ORIGINAL;
    let mut link = Device::new(ByteTable::DEFAULT);
    let mut machine = Microfactory::new(config, [move_steps]);
    let mut rig = MicrofactoryRig::new(&config, [400; 3], 1200, 0);
    let (mut steps, mut ticks) = ([0_u32; 2], 0_u64);
    for byte in *b"HG" {
        let received = link.receive(byte, machine.is_moving());
        let command = received.command.ok_or("the link takes no command")?;
        if !machine.command(command) {
            return Err(format!("the machine refuses {command:?}"));
        }
        let mut has_touched = false;
        loop {
            let event = machine.next_event(&rig.inputs());
            rig.apply(&event);
            match event {
                MicrofactoryEvent::Idle => break,
                MicrofactoryEvent::Report(MicrofactoryReport::Contact) => has_touched = true,
                MicrofactoryEvent::Step(step) if has_touched => {
                    let [x, _, z, _] = step.delta;
                    steps[0] += u32::from(x.unsigned_abs());
                    steps[1] += u32::from(z.unsigned_abs());
                    ticks += u64::from(step.wait_ticks);
                }
                _ => {}
            }
        }
    }
    if steps.contains(&0) {
        return Err("the figure has no steps".into());
    }
    let seconds = ticks as f64 / f64::from(config.timer_hz);
    Ok(steps.map(|steps| f64::from(steps) / seconds / PULSES))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ratio_is_exact_today() {
        let table = rates().unwrap();
        assert_eq!(table.counts(), [3, 2]);
        for (ratio, rows) in [2.0, 3.0, 4.0].into_iter().zip(table.rows.chunks(3)) {
            let [x, z] = [0, 1].map(|index| rows[index].today.unwrap());
            // The speed along the path is that of 400 steps per second.
            assert!((x.hypot(z) / 100.0 - 1.0).abs() < 0.01, "{x} {z}");
            assert!((rows[2].today.unwrap() - ratio).abs() < 1e-9);
        }
    }
}
