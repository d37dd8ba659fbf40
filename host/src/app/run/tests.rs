//! A program is checked once, and its report lists what that check found.

use super::*;
use crate::cli::{Cli, Command};
use clap::Parser;

/// Simulates a program and writes its report to a separate folder. Returns how often the program
/// was opened, and the page.
fn simulated(program: &str, more: &[&str]) -> (u32, String) {
    let folder = std::env::temp_dir().join(format!(
        "husillo-once-{}-{}",
        std::process::id(),
        more.len()
    ));
    std::fs::create_dir_all(&folder).unwrap();
    let page = folder.join("page.html");
    let words = ["husillo", "run", program, "-o", page.to_str().unwrap()];
    let cli = Cli::try_parse_from(words.iter().chain(more)).unwrap();
    let Command::Run(args) = &cli.command else {
        panic!("a run")
    };
    let mut job = Job::new(&args.file, &args.target, "micromill").unwrap();
    job.place(args.place.zero).unwrap();
    let before = job.opened.get();
    assert_eq!(simulate_job(&mut job, args).unwrap(), OK);
    let opened = job.opened.get() - before;
    let text = std::fs::read_to_string(&page).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    (opened, text)
}

/// Once for the check, once for the run: its warnings are listed without another check.
#[test]
fn a_program_with_warnings_is_checked_once() {
    let program = "../examples/circles.nc";
    let (opened, page) = simulated(program, &[]);
    assert_eq!(opened, 2);
    let args = ["husillo", "check", program, "-m", "micromill"];
    let Command::Check(args) = Cli::try_parse_from(args).unwrap().command else {
        panic!("a check")
    };
    let mut job = Job::new(program, &args.target, "micromill").unwrap();
    let mut findings = Findings::new(50);
    job.check(&mut findings).unwrap();
    assert_eq!(findings.warnings, 2);
    let listed: Vec<_> = page.split("<li><code>").skip(1).collect();
    let listed = listed.iter().map(|rest| rest.split('<').next().unwrap());
    let expected = findings.short();
    assert!(listed.eq(expected.iter().map(String::as_str)), "{page}");
}

/// The mirrored order is a new program: it is made from the first one, and checked too.
#[test]
fn a_program_in_another_order_is_checked_again() {
    let (opened, _) = simulated("../examples/circles.nc", &["--order", "mirrored"]);
    assert_eq!(opened, 4);
}
