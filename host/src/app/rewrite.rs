//! `format`: programs written back in one form.

use super::{ERRORS, Failure, OK, create, displayed, to_stderr, verdict};
use crate::cli::FormatArgs;
use crate::diagnostics::Format;
use crate::{format, setup, source};
use std::io::{self, BufWriter, Write};

pub(super) fn format_files(args: &FormatArgs) -> Result<u8, Failure> {
    if args.files.len() > 1 && !args.check {
        let message = "several programs are for --check only".to_owned();
        return Err(Failure::Usage(message));
    }
    let mut code = OK;
    for file in &args.files {
        if format_file(args, file)? {
            code = ERRORS;
        }
    }
    Ok(code)
}

/// Whether a program has errors or, where it is only looked at, another form.
fn format_file(args: &FormatArgs, file: &str) -> Result<bool, Failure> {
    let form = format::Form {
        dialect: setup::dialect(args.dialect.as_deref(), file, None)?,
        line_end: if args.crlf { b"\r\n" } else { b"\n" },
    };
    let name = displayed(file);
    let usage = |error| Failure::Usage(format!("{name}: {error}"));
    let mut reader = source::open(file).map_err(usage)?;
    let mut findings = to_stderr(Format::Text);
    let mut write =
        |out: &mut dyn Write| format::write(&mut *reader, name, &form, &mut findings, out);
    let changed = match args.output.as_deref() {
        _ if args.check => write(&mut io::sink())?,
        Some(path) if path != "-" => replace(path, write)?,
        _ => {
            let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
            let changed = write(&mut out)?;
            out.flush()?;
            changed
        }
    };
    if findings.errors > 0 {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines stay as they are");
    }
    if args.check && changed {
        writeln!(io::stdout(), "{name}: would change")?;
    }
    Ok(findings.errors > 0 || (args.check && changed))
}

/// Writes a file beside its old self and then puts it in its place, so that it can be its own source and is whole at any time.
/// What is no plain file is written as it is.
fn replace<T>(
    path: &str,
    write: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<T, Failure> {
    let usage = |error| Failure::Usage(format!("{path}: {error}"));
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let mut out = BufWriter::with_capacity(1 << 18, create(path)?);
        let made = write(&mut out)?;
        out.flush()?;
        return Ok(made);
    }
    // Behind a link, the file itself.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let mut beside = place.clone().into_os_string();
    beside.push(format!(".{}.new", std::process::id()));
    let made = (|| {
        let mut out = BufWriter::with_capacity(1 << 18, create(&beside.to_string_lossy())?);
        let made = write(&mut out)?;
        out.flush()?;
        if let Some(old) = old {
            std::fs::set_permissions(&beside, old.permissions()).map_err(usage)?;
        }
        std::fs::rename(&beside, &place).map_err(usage)?;
        Ok(made)
    })();
    if made.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    made
}
