//! `husillo serve`, as a page calls it.

mod access;
mod broker;
mod control;
mod drill;
#[path = "../emulated/mod.rs"]
mod emulated;
mod going_on;
mod hostile;
mod jogging;
mod lines;
mod links;
mod macros;
mod measuring;
mod microfactory;
mod micromill;
mod mqtt;
mod mqtt_jobs;
mod mtconnect;
mod page;
mod probing;
mod programs;
mod relay;
mod reports;
mod settings;
mod slow_line;
mod watching;
