//! Single keys of the operator while a machine works.

use std::io::{self, IsTerminal, Read};
use std::sync::mpsc::{self, Receiver};

/// The keys typed at the terminal. Dropped, it gives the terminal back as it was.
#[derive(Debug)]
pub struct Keys {
    typed: Receiver<u8>,
    #[cfg(unix)]
    before: nix::sys::termios::Termios,
}

impl Keys {
    /// From now on each key arrives at once, without Enter and without an echo. Ctrl-C stays a
    /// request to stop. `None`: standard input is no terminal.
    #[cfg(unix)]
    pub fn new() -> Option<Self> {
        use nix::sys::termios::{LocalFlags, SetArg, tcgetattr, tcsetattr};
        let terminal = io::stdin();
        if !terminal.is_terminal() {
            return None;
        }
        let before = tcgetattr(&terminal).ok()?;
        let mut single = before.clone();
        single
            .local_flags
            .remove(LocalFlags::ICANON | LocalFlags::ECHO);
        tcsetattr(&terminal, SetArg::TCSANOW, &single).ok()?;
        let typed = typed();
        Some(Self { typed, before })
    }

    /// Keys need Enter on this system. `None`: standard input is no terminal.
    #[cfg(not(unix))]
    pub fn new() -> Option<Self> {
        let typed = typed();
        io::stdin().is_terminal().then_some(Self { typed })
    }

    /// The next key, if one was typed.
    pub fn next(&self) -> Option<u8> {
        self.typed.try_recv().ok()
    }
}

#[cfg(unix)]
impl Drop for Keys {
    fn drop(&mut self) {
        use nix::sys::termios::{SetArg, tcsetattr};
        // A terminal that has gone needs nothing back.
        let _ = tcsetattr(io::stdin(), SetArg::TCSANOW, &self.before);
    }
}

fn typed() -> Receiver<u8> {
    let (sender, receiver) = mpsc::sync_channel(16);
    std::thread::spawn(move || {
        let mut key = [0];
        while let Ok(1) = io::stdin().read(&mut key) {
            if sender.send(key[0]).is_err() {
                break;
            }
        }
    });
    receiver
}
