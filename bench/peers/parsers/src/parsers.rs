//! Every parser with the same task: pass each word of a program to a sink.

use gcode::core::ControlFlow;

use futures::stream;
use husillo_gcode::{Token, WordReader, tokens};

/// Takes words.
pub trait Sink {
    /// A word whose number is exactly `digits / 10^places`.
    fn exact(&mut self, letter: u8, digits: i64, places: u32);
    /// A word with its number in double precision.
    fn double(&mut self, letter: u8, value: f64);
    /// A word with its number in single precision.
    fn single(&mut self, letter: u8, value: f32) {
        self.double(letter, f64::from(value));
    }
}

/// The parser of husillo on a whole text.
#[inline(never)]
pub fn slice(text: &str, sink: &mut impl Sink) {
    for token in tokens(text.as_bytes()) {
        if let Ok(Token::Word(word)) = token {
            sink.exact(
                word.letter,
                word.value.digits(),
                u32::from(word.value.places()),
            );
        }
    }
}

/// The parser of husillo, one line at a time.
#[inline(never)]
pub fn lines(text: &str, sink: &mut impl Sink) {
    for line in text.as_bytes().split(|byte| *byte == b'\n') {
        for word in husillo_gcode::words(line).flatten() {
            sink.exact(
                word.letter,
                word.value.digits(),
                u32::from(word.value.places()),
            );
        }
    }
}

/// The parser of husillo byte by byte, with one call per byte.
#[inline(never)]
pub fn push(text: &str, sink: &mut impl Sink) {
    let mut reader = WordReader::new();
    for &byte in text.as_bytes() {
        if let Some(Ok(word)) = reader.push(byte) {
            sink.exact(
                word.letter,
                word.value.digits(),
                u32::from(word.value.places()),
            );
        }
    }
    if let Some(Ok(word)) = reader.finish() {
        sink.exact(
            word.letter,
            word.value.digits(),
            u32::from(word.value.places()),
        );
    }
}

/// async-gcode 0.3.
#[inline(never)]
pub fn async_gcode(text: &str, sink: &mut impl Sink) {
    use async_gcode::{Error, GCode, Literal, Parser, RealValue};
    let bytes = text.bytes().map(Result::<_, Error>::Ok);
    futures::executor::block_on(async {
        let mut parser = Parser::new(stream::iter(bytes));
        while let Some(found) = parser.next().await {
            match found {
                Ok(GCode::Word(letter, RealValue::Literal(Literal::RealNumber(value)))) => {
                    sink.double(letter.to_ascii_uppercase() as u8, value);
                }
                Ok(GCode::LineNumber(number)) => sink.exact(b'N', i64::from(number), 0),
                _ => {}
            }
        }
    });
}

struct Visitor<'a, S>(&'a mut S, gcode::core::Noop);

impl<S> gcode::core::HasDiagnostics for Visitor<'_, S> {
    fn diagnostics(&mut self) -> &mut dyn gcode::core::Diagnostics {
        &mut self.1
    }
}

impl<S: Sink> gcode::core::ProgramVisitor for Visitor<'_, S> {
    fn start_block(&mut self) -> ControlFlow<impl gcode::core::BlockVisitor + '_> {
        ControlFlow::Continue(Visitor(&mut *self.0, gcode::core::Noop))
    }
}

impl<S: Sink> Visitor<'_, S> {
    fn code(&mut self, letter: u8, number: gcode::core::Number) -> ControlFlow<Visitor<'_, S>> {
        let (major, minor) = (i64::from(number.major()), number.minor());
        match minor {
            None => self.0.exact(letter, major, 0),
            Some(minor) => self.0.exact(letter, major * 10 + i64::from(minor.get()), 1),
        }
        ControlFlow::Continue(Visitor(&mut *self.0, gcode::core::Noop))
    }

    fn value(&mut self, letter: char, value: gcode::core::Value<'_>) {
        if let gcode::core::Value::Literal(value) = value {
            self.0.single(letter.to_ascii_uppercase() as u8, value);
        }
    }
}

impl<S: Sink> gcode::core::BlockVisitor for Visitor<'_, S> {
    fn line_number(&mut self, number: u32, _: gcode::core::Span) {
        self.0.exact(b'N', i64::from(number), 0);
    }
    fn word_address(&mut self, letter: char, value: gcode::core::Value<'_>, _: gcode::core::Span) {
        self.value(letter, value);
    }
    fn start_general_code(
        &mut self,
        number: gcode::core::Number,
    ) -> ControlFlow<impl gcode::core::CommandVisitor + '_> {
        self.code(b'G', number)
    }
    fn start_miscellaneous_code(
        &mut self,
        number: gcode::core::Number,
    ) -> ControlFlow<impl gcode::core::CommandVisitor + '_> {
        self.code(b'M', number)
    }
    fn start_tool_change_code(
        &mut self,
        number: gcode::core::Number,
    ) -> ControlFlow<impl gcode::core::CommandVisitor + '_> {
        self.code(b'T', number)
    }
}

impl<S: Sink> gcode::core::CommandVisitor for Visitor<'_, S> {
    fn argument(&mut self, letter: char, value: gcode::core::Value<'_>, _: gcode::core::Span) {
        self.value(letter, value);
    }
}

/// The core of gcode 0.7, without allocation.
#[inline(never)]
pub fn gcode_core(text: &str, sink: &mut impl Sink) {
    gcode::core::parse(text, &mut Visitor(sink, gcode::core::Noop));
}

/// gcode 0.6.
#[inline(never)]
pub fn gcode_old(text: &str, sink: &mut impl Sink) {
    for line in gcode_0_6::full_parse_with_callbacks(text, gcode_0_6::Nop) {
        if let Some(number) = line.line_number() {
            sink.single(b'N', number.value);
        }
        for code in line.gcodes() {
            let letter = match code.mnemonic() {
                gcode_0_6::Mnemonic::General => b'G',
                gcode_0_6::Mnemonic::Miscellaneous => b'M',
                gcode_0_6::Mnemonic::ProgramNumber => b'O',
                gcode_0_6::Mnemonic::ToolChange => b'T',
            };
            match code.minor_number() {
                0 => sink.exact(letter, i64::from(code.major_number()), 0),
                minor => sink.exact(letter, i64::from(code.major_number() * 10 + minor), 1),
            }
            for word in code.arguments() {
                sink.single(word.letter.to_ascii_uppercase() as u8, word.value);
            }
        }
    }
}

/// nom-gcode 0.1.
#[inline(never)]
pub fn nom_gcode(text: &str, sink: &mut impl Sink) {
    use nom_gcode::{GCodeLine, Mnemonic, parse_gcode};
    for line in text.lines() {
        let Ok((_, Some(GCodeLine::GCode(code)))) = parse_gcode(line) else {
            continue;
        };
        if let Some(number) = code.line_number {
            sink.exact(b'N', i64::from(number), 0);
        }
        let letter = match code.mnemonic {
            Mnemonic::General => b'G',
            Mnemonic::Miscellaneous => b'M',
            Mnemonic::ToolChange => b'T',
            _ => b'O',
        };
        match code.minor {
            0 => sink.exact(letter, i64::from(code.major), 0),
            minor => sink.exact(letter, i64::from(code.major * 10 + minor), 1),
        }
        for (letter, value) in code.arguments() {
            if let Some(value) = value {
                sink.single(letter.to_ascii_uppercase() as u8, *value);
            }
        }
    }
}

/// g-code 0.6.
#[inline(never)]
pub fn g_code(text: &str, sink: &mut impl Sink) {
    use g_code::emit::{Field, Value};
    let Ok(file) = g_code::parse::file_parser(text) else {
        return;
    };
    for field in file.iter_fields() {
        let field = Field::from(field);
        let letter = field.letters.as_bytes().first().copied().unwrap_or(b'?');
        let letter = letter.to_ascii_uppercase();
        match field.value {
            Value::Rational(value) => sink.exact(letter, value.mantissa() as i64, value.scale()),
            Value::Integer(value) => sink.exact(letter, value as i64, 0),
            _ => {}
        }
    }
}
