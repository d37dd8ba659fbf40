//! `format`: writes programs in one form.

use super::job::displayed;
use super::reporting::{verdict, with_findings};
use super::{ERRORS, Failure, OK};
use crate::cli::{FormatArgs, TargetDialect};
use crate::console;
use crate::output::Outputs;
use crate::programs::format;
use crate::programs::library::Folders;
use crate::programs::setup;
use crate::programs::source::{self, Source};
use crate::programs::translate;
use husillo_gcode::Dialect;
use std::io::{self, Write};

pub(super) fn format_files(args: &FormatArgs) -> Result<u8, Failure> {
    if args.files.len() > 1 && !args.check {
        let message = "several programs are for --check only".to_owned();
        return Err(Failure::Usage(message));
    }
    if let Some(to) = args.to {
        let [file] = &args.files[..] else {
            return Err(Failure::Usage("--to takes one program".to_owned()));
        };
        return translate_file(args, file, to);
    }
    let mut code = OK;
    for file in &args.files {
        if format_file(args, file)? {
            code = ERRORS;
        }
    }
    Ok(code)
}

/// Whether a program has errors or, with `--check`, another form.
fn format_file(args: &FormatArgs, file: &str) -> Result<bool, Failure> {
    let form = format::Form {
        dialect: setup::dialect(args.dialect.as_deref(), file, None)?,
        line_end: if args.crlf { b"\r\n" } else { b"\n" },
    };
    let name = displayed(file);
    let usage = |error| Failure::Usage(format!("{name}: {error}"));
    let mut reader = source::open(file).map_err(usage)?;
    let (changed, findings) = with_findings(|findings| {
        let mut write =
            |out: &mut dyn Write| format::write(&mut *reader, name, &form, findings, out);
        if args.check {
            return Ok(write(&mut io::sink())?);
        }
        let mut outputs = Outputs::rewriting();
        let mut out = outputs.create(args.output.as_deref().unwrap_or("-"))?;
        let changed = write(&mut out)?;
        out.flush()?;
        outputs.finish()?;
        Ok(changed)
    })?;
    if findings.errors > 0 {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines stay as they are");
    }
    if args.check && changed {
        writeln!(console::stdout(), "{name}: would change")?;
    }
    Ok(findings.errors > 0 || (args.check && changed))
}

/// `format --to`.
fn translate_file(args: &FormatArgs, file: &str, to: TargetDialect) -> Result<u8, Failure> {
    let from = setup::dialect(args.dialect.as_deref(), file, None)?;
    let form = format::Form {
        dialect: match to {
            TargetDialect::Grbl => Dialect::GRBL,
            TargetDialect::Linuxcnc => Dialect::RS274,
            TargetDialect::Iso => Dialect::ISO,
        },
        line_end: if args.crlf { b"\r\n" } else { b"\n" },
    };
    let name = displayed(file);
    let usage = |error| Failure::Usage(format!("{name}: {error}"));
    let source = Source::open(file).map_err(usage)?;
    let mut source = source.with_folders(Folders::of(file, &args.include));
    let ((), findings) = with_findings(|findings| {
        let mut outputs = Outputs::rewriting();
        let mut out = outputs.create(args.output.as_deref().unwrap_or("-"))?;
        translate::write(&mut source, name, from, &form, findings, &mut out)?;
        out.flush()?;
        Ok(outputs.finish()?)
    })?;
    if findings.errors > 0 {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines are left out");
        return Ok(ERRORS);
    }
    Ok(OK)
}
