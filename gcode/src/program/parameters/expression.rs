//! Values in the text of a line: numbers, parameters, brackets, functions.

use super::cursor::Cursor;
use super::function::{Function, Operator};
use super::table::{Capitals, Key};
use super::value::Value;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};

/// Largest number of operations that wait for their right operand.
const DEPTH: usize = 24;

/// Reads values from a line. `lookup` returns the value of a parameter, `None` for one without a
/// value.
///
/// There is no recursion: operations that wait for their right operand are on a stack of 24
/// entries, however deeply the text is nested.
pub(super) struct Reader<'t, F> {
    cursor: Cursor<'t>,
    lookup: F,
}

/// An entry of the stack.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
enum Waits {
    Bracket,
    Function(Function),
    /// `ATAN[y]/[`: the second bracket; `left` is y.
    SecondBracket,
    Negative,
    Index,
    Binary(Operator),
}

#[derive(Copy, Clone, Debug)]
struct Pending {
    what: Waits,
    /// First byte of the operation.
    at: usize,
    left: Value,
}

/// A stack of fixed size.
struct Stack {
    /// Empty entries are `None`: only one byte each has to be initialised.
    entries: [Option<Pending>; DEPTH],
    count: usize,
}

impl Stack {
    const fn new() -> Stack {
        Stack {
            entries: [None; DEPTH],
            count: 0,
        }
    }

    fn push(&mut self, what: Waits, at: usize, left: Value) -> Result<(), Fault> {
        let slot = self.entries.get_mut(self.count).ok_or(Fault::TooNested)?;
        *slot = Some(Pending { what, at, left });
        self.count = self.count.wrapping_add(1);
        Ok(())
    }

    fn top(&self) -> Option<Pending> {
        self.entries
            .get(self.count.checked_sub(1)?)
            .copied()
            .flatten()
    }

    fn pop(&mut self) -> Option<Pending> {
        let top = self.top()?;
        self.count = self.count.wrapping_sub(1);
        Some(top)
    }
}

impl<'t, F> core::ops::Deref for Reader<'t, F> {
    type Target = Cursor<'t>;

    fn deref(&self) -> &Cursor<'t> {
        &self.cursor
    }
}

impl<F> core::ops::DerefMut for Reader<'_, F> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.cursor
    }
}

impl<'t, F: Fn(Key<'t>) -> Option<Value>> Reader<'t, F> {
    /// Starts reading `text` at `at`.
    pub(super) const fn new(text: &'t [u8], at: usize, lookup: F) -> Self {
        Reader {
            cursor: Cursor::new(text, at),
            lookup,
        }
    }

    /// The parameter after a `#` that was taken at `from`: its number or name.
    pub(super) fn key(&mut self, from: usize) -> Result<Key<'t>, Error> {
        if self.peek() == Some(b'<') {
            return Ok(Key::Name(self.name(from)?));
        }
        let number = self.value()?;
        Key::numbered(number).ok_or_else(|| self.error(Fault::NoSuchParameter, from))
    }

    /// An expression that must stand in brackets.
    pub(super) fn bracketed(&mut self) -> Result<Value, Error> {
        if self.peek() != Some(b'[') {
            return Err(self.error_here(Fault::NoBracket));
        }
        self.value()
    }

    /// One value: a number, `#` parameter, `[ ]` or function, with leading signs. Takes one pass.
    pub(super) fn value(&mut self) -> Result<Value, Error> {
        match self.peek() {
            // Most values are plain numbers: they need no stack.
            Some(b'0'..=b'9' | b'.') => self.number(),
            _ => self.expression(),
        }
    }

    #[inline(never)]
    fn expression(&mut self) -> Result<Value, Error> {
        let mut stack = Stack::new();
        loop {
            let Some((value, from)) = self.operand(&mut stack)? else {
                continue;
            };
            if let Some(value) = self.behind(value, from, &mut stack)? {
                return Ok(value);
            }
        }
    }

    /// Begins an operand. Returns a complete operand with its position, or `None` if it is pushed
    /// on the stack and waits for more.
    fn operand(&mut self, stack: &mut Stack) -> Result<Option<(Value, usize)>, Error> {
        let Some(byte) = self.peek() else {
            return Err(self.error_here(Fault::NoValue));
        };
        let from = self.at();
        let waits = match byte {
            b'0'..=b'9' | b'.' => return Ok(Some((self.number()?, from))),
            b'+' | b'-' => {
                self.advance();
                if matches!(self.peek(), Some(b'+' | b'-')) {
                    let at = self.at();
                    return Err(Error {
                        kind: ErrorKind::MalformedNumber,
                        at,
                        end: at.wrapping_add(1),
                    });
                }
                if byte == b'+' {
                    return Ok(None);
                }
                Waits::Negative
            }
            b'#' => {
                self.advance();
                if self.peek() == Some(b'<') {
                    let name = self.name(from)?;
                    let value = (self.lookup)(Key::Name(name));
                    let value = value.ok_or_else(|| self.error(Fault::UndefinedName, from))?;
                    return Ok(Some((value, from)));
                }
                Waits::Index
            }
            b'[' => {
                self.advance();
                Waits::Bracket
            }
            b'A'..=b'Z' => return self.function(stack),
            _ => return Err(self.error_here(Fault::NoValue)),
        };
        stack
            .push(waits, from, Value::ZERO)
            .map_err(|fault| self.error(fault, from))?;
        Ok(None)
    }

    /// The name of a function and its `[`.
    fn function(&mut self, stack: &mut Stack) -> Result<Option<(Value, usize)>, Error> {
        let from = self.at();
        let name = self.letters();
        let function = Function::by_name(name.bytes())
            .ok_or_else(|| self.error(Fault::UnknownFunction, from))?;
        if !self.take(b'[') {
            return Err(self.error_here(Fault::NoBracket));
        }
        if function == Function::Exists {
            let hash = self.at();
            if !self.take(b'#') {
                return Err(self.error_here(Fault::NoValue));
            }
            if self.peek() == Some(b'<') {
                let name = self.name(hash)?;
                let exists = (self.lookup)(Key::Name(name)).is_some();
                if !self.take(b']') {
                    return Err(self.error_here(Fault::OpenBracket));
                }
                return Ok(Some((Value::truth(exists), from)));
            }
        }
        stack
            .push(Waits::Function(function), from, Value::ZERO)
            .map_err(|fault| self.error(fault, from))?;
        Ok(None)
    }

    /// Handles the text after a complete operand: returns the value when the stack is empty, `None`
    /// when another operand must follow.
    fn behind(
        &mut self,
        mut value: Value,
        mut from: usize,
        stack: &mut Stack,
    ) -> Result<Option<Value>, Error> {
        loop {
            while let Some(top) = stack.top() {
                match top.what {
                    Waits::Negative => value = value.negated(),
                    Waits::Index => value = self.parameter(value, top.at)?,
                    _ => break,
                }
                from = top.at;
                stack.pop();
            }
            let Some(top) = stack.top() else {
                return Ok(Some(value));
            };
            if self.peek() == Some(b']') {
                value = self.reduce(value, from, 0, stack)?.0;
                self.advance();
                let Some(opened) = stack.pop() else {
                    return Ok(Some(value));
                };
                from = opened.at;
                match opened.what {
                    Waits::Function(Function::Atan) => {
                        if !(self.take(b'/') && self.take(b'[')) {
                            return Err(self.error(Fault::NoSecondValue, from));
                        }
                        stack
                            .push(Waits::SecondBracket, from, value)
                            .map_err(|fault| self.error(fault, from))?;
                        return Ok(None);
                    }
                    Waits::Function(Function::Exists) => {
                        value = Value::truth(Key::numbered(value).is_some());
                    }
                    Waits::Function(function) => {
                        value = function
                            .of(value)
                            .map_err(|fault| self.error(fault, from))?;
                    }
                    Waits::SecondBracket => {
                        let angle = super::elementary::arc_tangent(opened.left, value);
                        value = angle.ok_or_else(|| self.error(Fault::OutsideDomain, from))?;
                    }
                    _ => {}
                }
                continue;
            }
            if top.what == Waits::Function(Function::Exists) {
                return Err(self.error_here(Fault::OpenBracket));
            }
            let operator = self.operator(stack)?;
            (value, from) = self.reduce(value, from, operator.precedence(), stack)?;
            stack
                .push(Waits::Binary(operator), from, value)
                .map_err(|fault| self.error(fault, from))?;
            return Ok(None);
        }
    }

    /// Evaluates the operators on top of the stack with at least this precedence.
    fn reduce(
        &self,
        mut value: Value,
        mut from: usize,
        precedence: u8,
        stack: &mut Stack,
    ) -> Result<(Value, usize), Error> {
        while let Some(top) = stack.top() {
            let Waits::Binary(operator) = top.what else {
                break;
            };
            if operator.precedence() < precedence {
                break;
            }
            value = operator
                .of(top.left, value)
                .map_err(|fault| self.error(fault, top.at))?;
            from = top.at;
            stack.pop();
        }
        Ok((value, from))
    }

    fn parameter(&self, number: Value, from: usize) -> Result<Value, Error> {
        let key = Key::numbered(number).ok_or_else(|| self.error(Fault::NoSuchParameter, from))?;
        Ok((self.lookup)(key).unwrap_or(Value::ZERO))
    }

    /// The operator that comes next.
    fn operator(&mut self, stack: &Stack) -> Result<Operator, Error> {
        let operator = match self.peek() {
            Some(b'+') => Operator::Plus,
            Some(b'-') => Operator::Minus,
            Some(b'/') => Operator::DividedBy,
            Some(b'*') => {
                self.advance();
                return Ok(if self.take(b'*') {
                    Operator::Power
                } else {
                    Operator::Times
                });
            }
            Some(b'A'..=b'Z') => {
                let from = self.at();
                // The longest has three letters; a function may follow directly, as in
                // `5 MOD ABS[..]` without blanks.
                let mut letters = Capitals::default();
                for _ in 0..3 {
                    let Some(byte) = self.peek().filter(u8::is_ascii_uppercase) else {
                        break;
                    };
                    letters.push(byte);
                    self.advance();
                    if let Some(operator) = Operator::by_word(letters.bytes()) {
                        return Ok(operator);
                    }
                }
                return Err(self.error(Fault::NoOperator, from));
            }
            None => {
                // At the open bracket.
                let waiting = stack.entries.iter().take(stack.count).rev().flatten();
                let opened = waiting
                    .copied()
                    .find(|entry| !matches!(entry.what, Waits::Binary(_)));
                let at = opened.map_or(self.at(), |entry| entry.at);
                return Err(self.error(Fault::OpenBracket, at.min(self.end())));
            }
            Some(b',') => {
                return Err(Error {
                    kind: ErrorKind::DecimalComma,
                    ..self.error_here(Fault::NoOperator)
                });
            }
            _ => return Err(self.error_here(Fault::NoOperator)),
        };
        self.advance();
        Ok(operator)
    }

    /// Digits, with an optional point; blanks anywhere.
    fn number(&mut self) -> Result<Value, Error> {
        let from = self.at();
        let (mut digits, mut places) = (0i64, None::<u8>);
        let mut any = false;
        let fail = |reader: &Self, kind| Error {
            kind,
            at: from,
            end: reader.end(),
        };
        loop {
            let byte = match self.peek() {
                Some(byte @ b'0'..=b'9') => byte,
                Some(b'.') if places.is_none() => {
                    self.advance();
                    places = Some(0);
                    continue;
                }
                Some(b'.') => {
                    self.advance();
                    return Err(fail(self, ErrorKind::MalformedNumber));
                }
                _ => break,
            };
            self.advance();
            any = true;
            let digit = i64::from(byte.wrapping_sub(b'0'));
            let next = digits
                .checked_mul(10)
                .and_then(|ten| ten.checked_add(digit));
            match (next, places) {
                (Some(next), None) => digits = next,
                (Some(next), Some(count)) if count < Value::MAX_PLACES => {
                    digits = next;
                    places = Some(count.wrapping_add(1));
                }
                (None, None) => return Err(fail(self, ErrorKind::NumberTooLarge)),
                _ if digit == 0 => {}
                _ => return Err(fail(self, ErrorKind::TooManyDigits)),
            }
        }
        match Value::new(digits, places.unwrap_or(0)) {
            Some(value) if any => Ok(value),
            _ => Err(fail(self, ErrorKind::Program(Fault::NoValue))),
        }
    }
}
