//! Explains the errors of parameters, expressions and O-words to the user.

use crate::diagnostics::Finding;
use husillo_gcode::parameters::Fault;

/// Adds labels, notes and help.
pub fn finding(fault: Fault, finding: Finding) -> Finding {
    match fault {
        Fault::NoValue => finding.label("a number, `#`, `[` or a function belongs here"),
        Fault::NoOperator => finding
            .label("an operator or a closing bracket belongs here")
            .note("operators: ** * / MOD + - EQ NE GT GE LT LE AND OR XOR"),
        Fault::OpenBracket => finding
            .label("has no counterpart on this line")
            .note("LinuxCNC: \"Unclosed expression\""),
        Fault::UnknownFunction => finding.label("not a function").note(
            "functions: ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN; \
                 angles in degrees",
        ),
        Fault::NoBracket => finding.label("`[` belongs here"),
        Fault::NoSecondValue => finding
            .label("ATAN takes the two coordinates of a point")
            .help("write ATAN[y]/[x], or ATAN[y]/[1] for one value"),
        Fault::MalformedName => finding.label("a name must be between `<` and `>`"),
        Fault::TooNested => finding
            .label("more than 24 operations wait for their right side")
            .help("split it over two lines"),
        Fault::NoAssignment => finding
            .label("nothing uses it")
            .help("write a letter before it, or `=` and a value after it"),
        Fault::TooManyAssignments => finding
            .label("the eleventh assignment of this line")
            .help("continue on the next line"),
        Fault::DivisionByZero => finding
            .label("the divisor is zero")
            .note("LinuxCNC: \"Attempt to divide by zero\""),
        Fault::OutsideDomain => finding.label("has no value for this argument").note(
            "SQRT of less \
             than 0, LN of 0 or less, ASIN and ACOS beyond 1, TAN of 90 degrees, ATAN[0]/[0]",
        ),
        Fault::ResultTooLarge => finding.label("beyond 9.2 * 10^18"),
        Fault::NoSuchParameter => finding
            .label("whole numbers from 1 to 5602")
            .note("LinuxCNC: \"Parameter number out of range\""),
        Fault::UndefinedName => finding
            .label("read before its first assignment")
            .note("LinuxCNC: \"Named parameter not defined\"")
            .help("give it a value before, or ask EXISTS[#<name>]"),
        Fault::ReadOnly => finding
            .label("the machine sets this parameter")
            .help("G10 L2 and G92 set frames, G28.1 and G30.1 positions"),
        Fault::ParametersFull => finding.label("too many parameters; the program ends here"),
        Fault::UnknownKeyword => finding
            .label("not a keyword of an O-word")
            .note(
                "sub endsub call return if elseif else endif while endwhile do repeat endrepeat \
                 break continue",
            )
            .help("`O1234` alone is the number of a program"),
        Fault::MalformedLabel => finding.label("a number or `<name>` belongs here"),
        Fault::NotAlone => finding.label("must be alone on its line"),
        Fault::TooManyArguments => finding.label("at most 30"),
        Fault::NoSuchSubroutine => finding
            .label("no `sub` with this label in the file")
            .note("searched: this file, its folder, and the folders of `--include`"),
        Fault::NotOpened => finding.label("no counterpart with this label before it"),
        Fault::NotClosed => finding.label("no counterpart with this label after it"),
        Fault::NestedSubroutine => finding
            .label("another `sub` comes before its `endsub`")
            .note("LinuxCNC: \"Nested subroutine definition\""),
        Fault::NoLoop => finding.label("not inside a loop with this label"),
        Fault::NoCall => finding.label("not inside a subroutine"),
        Fault::TooDeep => finding.label("at most 128 calls and 128 loops"),
        Fault::OutOfSteps => finding
            .label("an endless loop")
            .note("nothing has changed since the last pass, or 10 million lines were carried out"),
        Fault::FlowNotOfDialect => finding
            .label("this dialect has no O-words")
            .help("choose another dialect with `--dialect`"),
        _ => finding,
    }
}
