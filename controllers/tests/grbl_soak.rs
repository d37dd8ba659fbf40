//! A sender and a controller over hours of simulated time, with holds, overrides, doors, resets,
//! cancelled jogs and pulled cables at random. Every step is accounted for: after each event each
//! motor is where its number of pulses along the lines sent has taken it, and the controller
//! reports this position.
//!
//! `cargo test -p husillo-controllers --test grbl_soak -- --ignored` runs 200,000 lines. It takes
//! minutes.

use husillo_controllers::{Grbl, GrblMemory, GrblOptions};
use husillo_sim::{Emulated, GrblRig, Random};
use husillo_transports::grbl::Settings;
use std::collections::VecDeque;

/// Bytes that the link carries in each direction per millisecond.
const BYTES_PER_MS: usize = 11;
/// Characters that may wait for their answers.
const WINDOW: usize = 127;
/// Longest time until the machine is at rest, ms.
const PATIENCE_MS: u64 = 60_000;

/// What is counted.
#[derive(Debug, Default)]
struct Tally {
    lines: u64,
    pulses: u64,
    holds: u32,
    doors: u32,
    overrides: u32,
    resets: u32,
    jogs: u32,
    cables: u32,
    ms: u64,
}

struct Session {
    emulated: Emulated<Grbl, GrblRig>,
    random: Random,
    /// Bytes under way to the controller.
    there: VecDeque<u8>,
    heard: Vec<u8>,
    /// Lengths of the lines that are not answered yet.
    open: VecDeque<usize>,
    refused: Vec<String>,
    banners: u32,
    /// Targets of the lines that were sent since the last reset, in steps.
    targets: Vec<[i64; 3]>,
    /// Position and pulses at the last reset.
    base: [i64; 3],
    base_pulses: [u64; 3],
    tally: Tally,
}

impl Session {
    fn new(seed: u64, options: GrblOptions) -> Self {
        let mut settings = Settings::DEFAULT;
        for number in 110..113 {
            settings.write(number, b"6000").unwrap();
            settings.write(number + 10, b"800").unwrap();
        }
        let memory = GrblMemory::FACTORY.with_settings(settings);
        let grbl = Grbl::new(options, Some(&memory));
        let mut session = Session {
            emulated: Emulated::new(grbl, vec![GrblRig::new()]),
            random: Random::new(seed),
            there: VecDeque::new(),
            heard: Vec::new(),
            open: VecDeque::new(),
            refused: Vec::new(),
            banners: 0,
            targets: Vec::new(),
            base: [0; 3],
            base_pulses: [0; 3],
            tally: Tally::default(),
        };
        session.pass(200);
        session
    }

    fn rig(&self) -> &GrblRig {
        self.emulated.plant(0).unwrap()
    }

    fn pass(&mut self, ms: u64) {
        for _ in 0..ms {
            for _ in 0..BYTES_PER_MS {
                let Some(byte) = self.there.pop_front() else {
                    break;
                };
                self.emulated.receive(byte);
            }
            self.emulated.pass(1000, |_, _, _, _| {});
            for _ in 0..BYTES_PER_MS {
                let Some(byte) = self.emulated.transmit() else {
                    break;
                };
                self.hear(byte);
            }
            self.tally.ms += 1;
        }
    }

    fn hear(&mut self, byte: u8) {
        if byte != b'\n' {
            self.heard.push(byte);
            return;
        }
        let line = String::from_utf8(std::mem::take(&mut self.heard)).unwrap();
        let line = line.trim_end();
        if line == "ok" || line.starts_with("error:") {
            if line != "ok" {
                self.refused.push(line.to_owned());
            }
            self.open.pop_front();
        }
        self.banners += u32::from(line.starts_with("Grbl"));
    }

    fn realtime(&mut self, byte: u8) {
        self.emulated.receive(byte);
    }

    /// Sends a line when there is room for it.
    fn send(&mut self, line: &str) {
        let bytes = line.len() + 1;
        let mut waited = 0;
        while self.open.iter().sum::<usize>() + bytes > WINDOW {
            self.pass(1);
            waited += 1;
            assert!(
                waited < PATIENCE_MS,
                "no answer before {line}: {:?}",
                self.report()
            );
        }
        self.open.push_back(bytes);
        self.there.extend(line.bytes().chain(*b"\n"));
        self.tally.lines += 1;
    }

    fn last(&self) -> [i64; 3] {
        self.targets.last().copied().unwrap_or(self.base)
    }

    /// Sends a move by up to a millimetre in each axis.
    fn send_move(&mut self) {
        let mut to = self.last();
        for at in &mut to {
            *at += self.random.below(501) as i64 - 250;
            *at = (*at).clamp(-20_000, 20_000);
        }
        let mm = to.map(|steps| steps as f64 / 250.0);
        let [x, y, z] = mm;
        let line = match self.random.below(8) {
            0 => format!("G0X{x:.3}Y{y:.3}Z{z:.3}"),
            _ => {
                let feed = 500 + self.random.below(5000);
                format!("G1X{x:.3}Y{y:.3}Z{z:.3}F{feed}")
            }
        };
        self.targets.push(to);
        self.send(&line);
    }

    /// The state in a report, and its position in steps.
    fn report(&mut self) -> (String, [i64; 3]) {
        self.pass(2);
        self.heard.clear();
        self.realtime(b'?');
        for _ in 0..1000 {
            self.emulated.pass(200, |_, _, _, _| {});
            while let Some(byte) = self.emulated.transmit() {
                let before = self.heard.clone();
                self.hear(byte);
                let text = String::from_utf8_lossy(&before).into_owned();
                let text = text.trim();
                if byte == b'\n' && text.starts_with('<') {
                    let place = &text[text.find("MPos:").unwrap() + 5..];
                    let place = place.split('|').next().unwrap().split(',');
                    let steps = place.map(|mm| (mm.parse::<f64>().unwrap() * 250.0).round() as i64);
                    let steps: Vec<i64> = steps.collect();
                    let state = text[1..].split('|').next().unwrap().to_owned();
                    return (state, steps.try_into().unwrap());
                }
            }
        }
        panic!("no report");
    }

    /// Waits until all lines are answered and the machine is at rest.
    fn settle(&mut self) {
        let end = self.tally.ms + PATIENCE_MS;
        let mut quiet = 0;
        let mut pulses = [0; 3];
        while quiet < 100 {
            self.pass(1);
            let is_busy = !self.there.is_empty() || !self.open.is_empty();
            let now = self.rig().pulses();
            quiet = if is_busy || now != pulses {
                0
            } else {
                quiet + 1
            };
            pulses = now;
            assert!(self.tally.ms < end, "not at rest: {:?}", self.report());
        }
    }

    /// The position of an axis after a number of pulses along the lines sent.
    fn walked(&self, axis: usize, mut pulses: u64) -> i64 {
        let mut at = self.base[axis];
        for target in &self.targets {
            let way = target[axis] - at;
            let part = way.unsigned_abs().min(pulses);
            at += way.signum() * part as i64;
            pulses -= part;
            if pulses == 0 {
                break;
            }
        }
        assert_eq!(pulses, 0, "more pulses than the lines have, axis {axis}");
        at
    }

    /// Checks that no step is lost or doubled. `is_complete`: all lines must be made.
    fn check(&mut self, is_complete: bool) {
        let (steps, pulses) = (self.rig().steps(), self.rig().pulses());
        let kept = self.emulated.controller().position_steps().map(i64::from);
        assert_eq!(kept, steps, "the controller knows where its axes are");
        assert_eq!(self.rig().lost_steps(), [0; 3]);
        for (axis, at) in steps.iter().enumerate() {
            let count = pulses[axis] - self.base_pulses[axis];
            assert_eq!(
                self.walked(axis, count),
                *at,
                "axis {axis} after {count} pulses"
            );
        }
        if is_complete {
            assert_eq!(steps, self.last(), "the end of the last line");
        }
        let (_, reported) = self.report();
        assert_eq!(reported, steps);
    }

    /// Takes the present position as the start of the lines that follow.
    fn rebase(&mut self) {
        self.base = self.rig().steps();
        let pulses = self.rig().pulses();
        self.tally.pulses += (0..3)
            .map(|axis| pulses[axis] - self.base_pulses[axis])
            .sum::<u64>();
        self.base_pulses = pulses;
        self.targets.clear();
    }

    /// Resets the controller, unlocks it, and goes on from its position.
    fn reset(&mut self) {
        let banners = self.banners;
        // The host drops what it has not sent yet.
        self.there.clear();
        self.realtime(0x18);
        self.pass(700);
        assert_eq!(self.banners, banners + 1, "one banner for one reset");
        self.open.clear();
        self.check(false);
        self.rebase();
        self.refused.clear();
        self.send("$X");
        self.settle();
        let (state, _) = self.report();
        assert_eq!(state, "Idle");
        assert_eq!(self.refused, [""; 0]);
    }

    fn hold(&mut self) {
        self.realtime(b'!');
        let wait = self.random.below(400);
        self.pass(wait);
        self.tally.holds += 1;
        if self.random.below(4) == 0 {
            self.reset();
            self.tally.resets += 1;
            return;
        }
        self.resume();
    }

    /// Resumes after a hold or a door. The button has no effect while the axes brake.
    fn resume(&mut self) {
        for _ in 0..100 {
            let (state, _) = self.report();
            if !state.starts_with("Hold") && !state.starts_with("Door") {
                return;
            }
            self.realtime(b'~');
            self.pass(60);
        }
        panic!("it does not resume");
    }

    fn jog(&mut self) {
        self.settle();
        self.check(true);
        self.rebase();
        for _ in 0..1 + self.random.below(6) {
            let mut to = self.last();
            for at in &mut to {
                *at += self.random.below(1001) as i64 - 500;
            }
            let [x, y, z] = to.map(|steps| steps as f64 / 250.0);
            self.targets.push(to);
            self.send(&format!("$J=G90G21X{x:.3}Y{y:.3}Z{z:.3}F3000"));
        }
        let wait = self.random.below(900);
        self.pass(wait);
        // The jogs that were not taken yet end with the line before the next byte.
        while !self.there.is_empty() {
            self.pass(1);
        }
        let is_hold = self.random.below(4) == 0;
        self.realtime(if is_hold { b'!' } else { 0x85 });
        self.tally.jogs += 1;
        self.settle();
        self.check(false);
        self.rebase();
        // A hold after the last jog is a hold.
        self.resume();
    }

    /// The cable is pulled for a while. Bytes of both sides are lost. The host resets then, because
    /// it does not know what has arrived.
    fn pull_cable(&mut self) {
        self.there.clear();
        for _ in 0..self.random.below(3000) {
            self.emulated.pass(1000, |_, _, _, _| {});
            while self.emulated.transmit().is_some() {}
            self.tally.ms += 1;
        }
        self.heard.clear();
        self.tally.cables += 1;
        self.reset();
    }

    fn disturb(&mut self) {
        match self.random.below(40) {
            0 => self.hold(),
            1 => {
                self.realtime(0x84);
                let wait = self.random.below(500);
                self.pass(wait);
                self.tally.doors += 1;
                self.resume();
            }
            2..=4 => {
                let byte = 0x90 + self.random.below(8) as u8;
                self.realtime(byte);
                self.tally.overrides += 1;
            }
            5 if self.random.below(3) == 0 => {
                self.reset();
                self.tally.resets += 1;
            }
            6 if self.random.below(3) == 0 => self.pull_cable(),
            7 if self.random.below(3) == 0 => self.jog(),
            8 => {
                self.settle();
                self.check(true);
                self.rebase();
            }
            _ => {}
        }
    }
}

fn soak(seed: u64, lines: u64, options: GrblOptions) -> Tally {
    let mut session = Session::new(seed, options);
    while session.tally.lines < lines {
        session.send_move();
        session.disturb();
        assert_eq!(session.refused, [""; 0]);
    }
    session.settle();
    session.check(true);
    session.rebase();
    session.tally
}

#[test]
fn no_step_is_lost_or_doubled() {
    for options in [GrblOptions::FULL, GrblOptions::HAL] {
        let tally = soak(1, 2000, options);
        println!("{tally:?}");
        assert!(tally.resets > 3 && tally.holds > 10 && tally.jogs > 3 && tally.cables > 3);
    }
}

#[test]
#[ignore = "takes minutes, optimised"]
fn no_step_is_lost_or_doubled_in_200_000_lines() {
    for options in [GrblOptions::FULL, GrblOptions::HAL] {
        println!("{:?}", soak(2, 200_000, options));
    }
}
