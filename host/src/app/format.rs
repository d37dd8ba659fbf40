//! `format`: writes programs in one form.

use super::job::{displayed, load};
use super::reporting::{MOST_PRINTED, verdict, with_some_findings};
use super::{ERRORS, Failure, OK, own_output};
use crate::cli::{FormatArgs, Output, TargetDialect};
use crate::console;
use crate::input;
use crate::output::Outputs;
use husillo_gcode::Dialect;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::programs::format;
use husillo_simulator::programs::setup;
use husillo_simulator::programs::translate;
use husillo_simulator::text::json::write_found;
use serde_json::json;
use std::io::{self, Write};

pub(super) fn format_files(args: &FormatArgs) -> Result<u8, Failure> {
    if args.files.len() > 1 && !args.check {
        let message = "several programs are for --check only".to_owned();
        return Err(Failure::Usage(message));
    }
    if !args.check {
        own_output(args.output.as_deref(), args.format)?;
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
    let mut reader = input::open_bytes(file).map_err(usage)?;
    let (changed, findings) = with_some_findings(MOST_PRINTED, args.format, |findings| {
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
    let is_text = args.format == Output::Text;
    if !is_text {
        print(args, name, changed, &findings)?;
    }
    if findings.errors > 0 && is_text {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines stay as they are");
    }
    if args.check && changed && is_text {
        writeln!(console::stdout(), "{name}: would change")?;
    }
    Ok(findings.errors > 0 || (args.check && changed))
}

/// Prints what was done with a program as an object.
fn print(args: &FormatArgs, name: &str, changed: bool, findings: &Findings) -> io::Result<()> {
    let body = json!({
        "file": name,
        "output": args.output,
        "changed": changed,
        "errors": findings.errors,
        "warnings": findings.warnings,
    });
    write_found("husillo.format/1", &body, findings, &mut console::stdout())
}

/// `format --to`.
fn translate_file(args: &FormatArgs, file: &str, to: TargetDialect) -> Result<u8, Failure> {
    let machine = args.machine.as_deref().map(load).transpose()?;
    let from = setup::dialect(args.dialect.as_deref(), file, machine.as_ref())?;
    let to = match to {
        TargetDialect::Grbl => Dialect::GRBL,
        TargetDialect::Linuxcnc => Dialect::RS274,
        TargetDialect::Iso => Dialect::ISO,
    };
    let [from, to] = [from, to].map(|dialect| match &machine {
        Some(machine) => setup::on_axes(dialect, machine),
        None => dialect,
    });
    let form = format::Form {
        dialect: to,
        line_end: if args.crlf { b"\r\n" } else { b"\n" },
    };
    let name = displayed(file);
    let usage = |error| Failure::Usage(format!("{name}: {error}"));
    let source = input::program(file).map_err(usage)?;
    let mut source = source.with_subroutines(input::folders(file, &args.include));
    let ((), findings) = with_some_findings(MOST_PRINTED, args.format, |findings| {
        let mut outputs = Outputs::rewriting();
        let mut out = outputs.create(args.output.as_deref().unwrap_or("-"))?;
        translate::write(&mut source, name, from, &form, findings, &mut out)?;
        out.flush()?;
        Ok(outputs.finish()?)
    })?;
    if args.format == Output::Json {
        print(args, name, true, &findings)?;
    } else if findings.errors > 0 {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines are left out");
    }
    Ok(if findings.errors > 0 { ERRORS } else { OK })
}
