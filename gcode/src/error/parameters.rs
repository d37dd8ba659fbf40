//! Errors of parameters, expressions and the flow of a program.

use core::fmt;

/// Errors of programs with parameters. [`Fault::code`] is the number of the message of the host.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Fault {
    /// No number, parameter, bracket or function where a value is expected.
    NoValue,
    /// Neither an operator nor a closing bracket after a value.
    NoOperator,
    /// A bracket without its counterpart.
    OpenBracket,
    /// A function that does not exist.
    UnknownFunction,
    /// A function or an O-word without `[`.
    NoBracket,
    /// `ATAN[y]` without `/[x]`.
    NoSecondValue,
    /// A parameter name without its `>`, or an empty one.
    MalformedName,
    /// An expression with more than 24 unfinished operations.
    TooNested,
    /// `#n` without `=` where a word is expected.
    NoAssignment,
    /// Division by zero, or zero to a negative power.
    DivisionByZero,
    /// An argument outside the domain of the function.
    OutsideDomain,
    /// A result beyond 9.2 * 10^18.
    ResultTooLarge,
    /// A parameter number that is not whole, or not from 1 to 5602.
    NoSuchParameter,
    /// A named parameter that was never assigned.
    UndefinedName,
    /// A system parameter, which is read-only.
    ReadOnly,
    /// No room for another parameter.
    ParametersFull,
    /// More than ten assignments on a line.
    TooManyAssignments,
    /// An O-word without a known keyword.
    UnknownKeyword,
    /// An O-word label that is neither a whole number nor a name.
    MalformedLabel,
    /// Other text on the line of an O-word.
    NotAlone,
    /// More than 30 arguments.
    TooManyArguments,
    /// A call of a subroutine that is not in the program.
    NoSuchSubroutine,
    /// The opening line is missing: `endwhile` without `while`.
    NotOpened,
    /// The closing line is missing.
    NotClosed,
    /// A subroutine inside another.
    NestedSubroutine,
    /// `break` or `continue` outside a loop with this label.
    NoLoop,
    /// `return` outside a subroutine.
    NoCall,
    /// Too many nested calls or loops.
    TooDeep,
    /// The program took more than the permitted number of steps.
    OutOfSteps,
    /// O-words, which this dialect does not have.
    FlowNotOfDialect,
    /// M72 without M70, or modes of a system that has none.
    NothingSaved,
    /// M99 to a line number that does not exist.
    NoSuchLine,
    /// Subroutines of more files than there is room for.
    TooManyFiles,
}

impl Fault {
    /// The number of the message: 610 for E0610.
    pub const fn code(self) -> u16 {
        match self {
            Fault::NoValue | Fault::NoOperator | Fault::NoBracket | Fault::NoSecondValue => 610,
            Fault::OpenBracket => 611,
            Fault::UnknownFunction => 612,
            Fault::MalformedName => 613,
            Fault::TooNested => 614,
            Fault::NoAssignment | Fault::TooManyAssignments => 615,
            Fault::DivisionByZero => 620,
            Fault::OutsideDomain => 621,
            Fault::ResultTooLarge => 622,
            Fault::NoSuchParameter => 623,
            Fault::UndefinedName => 624,
            Fault::ReadOnly => 625,
            Fault::ParametersFull => 626,
            Fault::UnknownKeyword | Fault::MalformedLabel => 630,
            Fault::NotAlone => 631,
            Fault::TooManyArguments => 632,
            Fault::NoSuchSubroutine => 633,
            Fault::NotOpened | Fault::NotClosed => 634,
            Fault::NestedSubroutine => 635,
            Fault::NoLoop | Fault::NoCall => 636,
            Fault::TooDeep => 637,
            Fault::OutOfSteps => 638,
            Fault::FlowNotOfDialect => 639,
            Fault::NothingSaved => 641,
            Fault::TooManyFiles => 642,
            Fault::NoSuchLine => 643,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Fault::NoValue => "value missing",
            Fault::NoOperator => "operator or `]` missing",
            Fault::OpenBracket => "bracket without its counterpart",
            Fault::UnknownFunction => "unknown function",
            Fault::NoBracket => "`[` missing",
            Fault::NoSecondValue => "`ATAN[y]` without `/[x]`",
            Fault::MalformedName => "malformed parameter name",
            Fault::TooNested => "expression nested too deep",
            Fault::NoAssignment => "parameter without `=`",
            Fault::DivisionByZero => "division by zero",
            Fault::OutsideDomain => "no such value of this function",
            Fault::ResultTooLarge => "result too large",
            Fault::NoSuchParameter => "no such parameter",
            Fault::UndefinedName => "parameter has no value yet",
            Fault::ReadOnly => "system parameter is only read",
            Fault::ParametersFull => "too many parameters",
            Fault::TooManyAssignments => "too many assignments on a line",
            Fault::UnknownKeyword => "unknown O-word",
            Fault::MalformedLabel => "malformed label of an O-word",
            Fault::NotAlone => "O-word with other words on its line",
            Fault::TooManyArguments => "more than 30 arguments",
            Fault::NoSuchSubroutine => "no such subroutine",
            Fault::NotOpened => "O-word without the one that opens",
            Fault::NotClosed => "O-word without the one that closes",
            Fault::NestedSubroutine => "subroutine inside of a subroutine",
            Fault::NoLoop => "no loop of this label here",
            Fault::NoCall => "return outside of a subroutine",
            Fault::TooDeep => "calls or loops nested too deep",
            Fault::OutOfSteps => "program took too many steps",
            Fault::FlowNotOfDialect => "O-words are not of this dialect",
            Fault::NothingSaved => "no modes are saved here",
            Fault::NoSuchLine => "no line has this number",
            Fault::TooManyFiles => "subroutines of too many files",
        })
    }
}
