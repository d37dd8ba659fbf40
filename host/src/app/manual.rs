//! `husillo completions` and `husillo man`.

use super::{Failure, OK};
use crate::console;
use crate::console::shown;
use crate::output::Outputs;
use std::io::{self, Write};

/// Prints the completions of a shell.
pub fn completions(shell: clap_complete::Shell) -> Result<u8, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut crate::cli::command(), "husillo", &mut text);
    console::stdout().write_all(&text)?;
    Ok(OK)
}

/// Writes a manual page of the program and of each command.
pub fn man_pages(folder: &str) -> Result<u8, Failure> {
    let mut command = crate::cli::command().disable_help_subcommand(true);
    command.build();
    let mut outputs = Outputs::new();
    write_page(&command, folder, &mut outputs)?;
    outputs.finish()?;
    writeln!(
        console::stdout(),
        "Wrote      {}/husillo.1 and others",
        shown(folder)
    )?;
    Ok(OK)
}

/// Writes the manual pages of a command and of those below it.
fn write_page(command: &clap::Command, folder: &str, outputs: &mut Outputs) -> io::Result<()> {
    let man = clap_mangen::Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    outputs.write(&format!("{folder}/{}", man.get_filename()), &page)?;
    let mut below = command
        .get_subcommands()
        .filter(|below| !below.is_hide_set());
    below.try_for_each(|below| write_page(below, folder, outputs))
}
