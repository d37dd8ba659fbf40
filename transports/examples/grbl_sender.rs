//! Sends a program to a Grbl controller as fast as its receive buffer allows.
//!
//! `cargo run -p husillo-transports --example grbl_sender`. The controller here answers each line
//! with `ok`, one after another. With a real port, write each line to it, and take an answer from
//! each line that it gives.

use husillo_transports::grbl::{Message, RECEIVE_BYTES, Window};
use std::collections::VecDeque;

fn main() {
    let program = (0..40).map(|number| format!("G1 X{number} Y{} F600\n", number % 7));
    let mut lines = program.collect::<VecDeque<String>>();
    let mut window = Window::new(RECEIVE_BYTES);
    let (mut sent, mut answered, mut most) = (0, 0, 0);
    while !lines.is_empty() || window.lines() > 0 {
        // As many lines as fit.
        while lines
            .front()
            .is_some_and(|line| window.send(line.len() as u8))
        {
            sent += lines.pop_front().map_or(0, |line| line.len());
        }
        most = most.max(window.bytes());
        // One answer.
        let answer = "ok";
        if Message::parse(answer.as_bytes()).is_some_and(|message| message.is_answer()) {
            window.answered();
            answered += 1;
        }
    }
    println!("{sent} bytes sent, {answered} lines answered, {most} bytes ahead at most");
    assert_eq!(answered, 40);
    assert!(most <= u16::from(RECEIVE_BYTES));
}
