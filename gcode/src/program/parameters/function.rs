//! The functions of expressions.

use super::elementary;
use super::value::Value;
use crate::error::parameters::Fault;

/// A function of RS-274/NGC. Angles are in degrees.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Function {
    Abs,
    Acos,
    Asin,
    /// `ATAN[y]/[x]`
    Atan,
    Cos,
    /// `EXISTS[#<name>]`
    Exists,
    Exp,
    Fix,
    Fup,
    Ln,
    Round,
    Sin,
    Sqrt,
    Tan,
}

/// Names in capitals.
const NAMES: [(&[u8], Function); 14] = [
    (b"ABS", Function::Abs),
    (b"ACOS", Function::Acos),
    (b"ASIN", Function::Asin),
    (b"ATAN", Function::Atan),
    (b"COS", Function::Cos),
    (b"EXISTS", Function::Exists),
    (b"EXP", Function::Exp),
    (b"FIX", Function::Fix),
    (b"FUP", Function::Fup),
    (b"LN", Function::Ln),
    (b"ROUND", Function::Round),
    (b"SIN", Function::Sin),
    (b"SQRT", Function::Sqrt),
    (b"TAN", Function::Tan),
];

impl Function {
    /// The function of this name, in capitals.
    pub(super) fn by_name(name: &[u8]) -> Option<Function> {
        let found = NAMES.iter().find(|(known, _)| *known == name)?;
        Some(found.1)
    }

    /// Its value, for functions with one argument; ATAN and EXISTS have their own forms.
    pub(super) fn of(self, x: Value) -> Result<Value, Fault> {
        let result = match self {
            Function::Abs => Some(x.magnitude()),
            Function::Fix => Some(x.floor()),
            Function::Fup => Some(x.ceiling()),
            Function::Round => Some(x.rounded_half()),
            Function::Sin => elementary::sine(x),
            Function::Cos => elementary::cosine(x),
            Function::Exp => return elementary::exponential(x).ok_or(Fault::ResultTooLarge),
            Function::Tan => elementary::tangent(x),
            Function::Asin => elementary::arc_sine(x),
            Function::Acos => elementary::arc_cosine(x),
            Function::Ln => elementary::logarithm(x),
            Function::Sqrt => elementary::square_root(x),
            Function::Atan | Function::Exists => None,
        };
        result.ok_or(Fault::OutsideDomain)
    }
}

/// An operator between two values.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Operator {
    Power,
    Times,
    DividedBy,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    And,
    Or,
    ExclusiveOr,
}

/// The operators that are words, in capitals.
const WORDS: [(&[u8], Operator); 10] = [
    (b"MOD", Operator::Modulo),
    (b"EQ", Operator::Equal),
    (b"NE", Operator::NotEqual),
    (b"GT", Operator::Greater),
    (b"GE", Operator::GreaterOrEqual),
    (b"LT", Operator::Less),
    (b"LE", Operator::LessOrEqual),
    (b"AND", Operator::And),
    (b"OR", Operator::Or),
    (b"XOR", Operator::ExclusiveOr),
];

impl Operator {
    /// The operator at the start of this text, given in capitals.
    pub(super) fn by_word(name: &[u8]) -> Option<Operator> {
        let found = WORDS.iter().find(|(known, _)| *known == name)?;
        Some(found.1)
    }

    /// Higher binds tighter. Equal ones, including powers, are evaluated from left to right.
    pub(super) const fn precedence(self) -> u8 {
        match self {
            Operator::Power => 5,
            Operator::Times | Operator::DividedBy | Operator::Modulo => 4,
            Operator::Plus | Operator::Minus => 3,
            Operator::Equal
            | Operator::NotEqual
            | Operator::Greater
            | Operator::GreaterOrEqual
            | Operator::Less
            | Operator::LessOrEqual => 2,
            Operator::And | Operator::Or | Operator::ExclusiveOr => 1,
        }
    }

    /// The value of `left operator right`.
    pub(super) fn of(self, left: Value, right: Value) -> Result<Value, Fault> {
        let order = || left.compare(right);
        let truth = match self {
            Operator::Power => return power(left, right),
            Operator::Times => return left.times(right).ok_or(Fault::ResultTooLarge),
            Operator::Plus => return left.plus(right).ok_or(Fault::ResultTooLarge),
            Operator::Minus => return left.plus(right.negated()).ok_or(Fault::ResultTooLarge),
            Operator::DividedBy | Operator::Modulo if right.is_zero() => {
                return Err(Fault::DivisionByZero);
            }
            Operator::DividedBy => return left.divided_by(right).ok_or(Fault::ResultTooLarge),
            Operator::Modulo => return left.modulo(right).ok_or(Fault::ResultTooLarge),
            Operator::Equal => order().is_eq(),
            Operator::NotEqual => order().is_ne(),
            Operator::Greater => order().is_gt(),
            Operator::GreaterOrEqual => order().is_ge(),
            Operator::Less => order().is_lt(),
            Operator::LessOrEqual => order().is_le(),
            Operator::And => !left.is_zero() && !right.is_zero(),
            Operator::Or => !left.is_zero() || !right.is_zero(),
            Operator::ExclusiveOr => left.is_zero() != right.is_zero(),
        };
        Ok(Value::truth(truth))
    }
}

fn power(base: Value, exponent: Value) -> Result<Value, Fault> {
    if base.is_zero() {
        return match exponent {
            _ if exponent.is_negative() => Err(Fault::DivisionByZero),
            _ => Ok(Value::truth(exponent.is_zero())),
        };
    }
    if let Some(whole) = exponent.whole() {
        return base.to_whole_power(whole).ok_or(Fault::ResultTooLarge);
    }
    if base.is_negative() {
        return Err(Fault::OutsideDomain);
    }
    elementary::general_power(base, exponent).ok_or(Fault::ResultTooLarge)
}
