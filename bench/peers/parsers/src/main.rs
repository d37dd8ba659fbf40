#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod clock;
mod parsers;
mod printed;

use std::hint::black_box;

use parsers::Sink;

/// Counts words and folds their numbers, so that none can be optimised away.
#[derive(Default)]
struct Fold {
    words: u32,
    sum: u64,
}

impl Sink for Fold {
    #[inline]
    fn exact(&mut self, letter: u8, digits: i64, places: u32) {
        self.words += 1;
        self.sum = self
            .sum
            .wrapping_add(digits as u64 ^ u64::from(places) ^ u64::from(letter));
    }
    #[inline]
    fn double(&mut self, letter: u8, value: f64) {
        self.words += 1;
        self.sum = self.sum.wrapping_add(value.to_bits() ^ u64::from(letter));
    }
    #[inline]
    fn single(&mut self, letter: u8, value: f32) {
        self.words += 1;
        self.sum = self
            .sum
            .wrapping_add(u64::from(value.to_bits()) ^ u64::from(letter));
    }
}

/// Keeps the words.
#[derive(Default)]
struct List(Vec<(u8, f64)>);

impl Sink for List {
    fn exact(&mut self, letter: u8, digits: i64, places: u32) {
        self.0
            .push((letter, digits as f64 / 10_f64.powi(places as i32)));
    }
    fn double(&mut self, letter: u8, value: f64) {
        self.0.push((letter, value));
    }
}

/// The words of a text by the simplest means, for comparison: comments removed, split at letters,
/// `str::parse`.
fn reference(text: &str) -> Vec<(u8, f64)> {
    let mut words = Vec::new();
    for line in text.lines() {
        let code = line.split([';', '(']).next().unwrap_or("");
        let starts: Vec<usize> = code
            .match_indices(|c: char| c.is_ascii_alphabetic())
            .map(|(at, _)| at)
            .collect();
        for (index, &at) in starts.iter().enumerate() {
            let end = starts.get(index + 1).copied().unwrap_or(code.len());
            if let Ok(value) = code[at + 1..end].trim().parse() {
                words.push((code.as_bytes()[at].to_ascii_uppercase(), value));
            }
        }
    }
    words
}

struct Parser {
    name: &'static str,
    fold: fn(&str, &mut Fold),
    list: fn(&str, &mut List),
}

macro_rules! parser {
    ($name:literal, $function:path) => {
        Parser {
            name: $name,
            fold: $function,
            list: $function,
        }
    };
}

const PARSERS: [Parser; 8] = [
    parser!("husillo tokens", parsers::slice),
    parser!("husillo lines + words", parsers::lines),
    parser!("husillo byte push", parsers::push),
    parser!("async-gcode 0.3", parsers::async_gcode),
    parser!("gcode 0.7 core", parsers::gcode_core),
    parser!("gcode 0.6", parsers::gcode_old),
    parser!("nom-gcode 0.1", parsers::nom_gcode),
    parser!("g-code 0.6", parsers::g_code),
];

fn programs(bytes: usize) -> [(&'static str, String); 4] {
    [
        ("seg", husillo_bench::segments(bytes)),
        ("arc", husillo_bench::arcs(bytes)),
        ("mix", husillo_bench::mixed(bytes)),
        ("print", printed::printed(bytes)),
    ]
}

/// The share of the words of the reference that was delivered, in percent, and the worst error of
/// those in millionths of a unit.
fn quality(parser: &Parser, text: &str) -> (f64, Option<f64>) {
    let right = reference(text);
    let mut list = List::default();
    (parser.list)(text, &mut list);
    let delivered = 100.0 * list.0.len() as f64 / right.len() as f64;
    if list.0.len() != right.len() {
        return (delivered, None);
    }
    let mut worst = 0.0_f64;
    for ((letter, value), (right_letter, right)) in list.0.iter().zip(&right) {
        if letter != right_letter {
            return (delivered, None);
        }
        worst = worst.max((value - right).abs() * 1e6);
    }
    (delivered, Some(worst))
}

/// MB per CPU second: the median of five runs of at least 80 ms, in rounds over all parsers.
fn speeds(text: &str) -> Vec<f64> {
    let mut samples = vec![Vec::new(); PARSERS.len()];
    for _ in 0..5 {
        for (parser, samples) in PARSERS.iter().zip(&mut samples) {
            let (begin, mut turns) = (clock::seconds(), 0);
            let taken = loop {
                let mut fold = Fold::default();
                (parser.fold)(black_box(text), &mut fold);
                black_box((fold.words, fold.sum));
                turns += 1;
                let taken = clock::seconds() - begin;
                if taken >= 0.08 {
                    break taken;
                }
            };
            samples.push((turns * text.len()) as f64 / taken / 1e6);
        }
    }
    samples
        .into_iter()
        .map(|mut runs| {
            runs.sort_by(f64::total_cmp);
            runs[runs.len() / 2]
        })
        .collect()
}

fn table() {
    for (name, text) in programs(1_000_000) {
        println!(
            "\n{name}: {} bytes, {} words",
            text.len(),
            reference(&text).len()
        );
        println!(
            "| parser | words | worst error, 1e-6 units | MB per CPU second \
             | relative to async-gcode |"
        );
        println!("| --- | --- | --- | --- | --- |");
        let speeds = speeds(&text);
        let base = speeds[3];
        for (parser, speed) in PARSERS.iter().zip(speeds) {
            let (delivered, worst) = quality(parser, &text);
            let worst = worst.map_or("-".into(), |worst| format!("{worst:.1}"));
            println!(
                "| {} | {delivered:.1} % | {worst} | {speed:.0} | {:.2} |",
                parser.name,
                speed / base
            );
        }
    }
}

/// One run of one parser on one program, for callgrind: `--once PARSER PROGRAM`, both counted
/// from 0.
fn once(parser: usize, program: usize) -> Option<()> {
    let programs = programs(1_000_000);
    let (name, text) = programs.get(program)?;
    let parser = PARSERS.get(parser)?;
    let mut fold = Fold::default();
    (parser.fold)(black_box(text), &mut fold);
    println!(
        "{} {name} {} bytes {} words {:x}",
        parser.name,
        text.len(),
        fold.words,
        fold.sum
    );
    Some(())
}

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .filter_map(|word| word.parse().ok())
        .collect();
    match numbers[..] {
        [parser, program] if once(parser, program).is_some() => {}
        _ => table(),
    }
}
