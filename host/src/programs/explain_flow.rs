//! What the errors of parameters, expressions and O-words look like to a person.

use crate::diagnostics::Finding;
use husillo_gcode::parameters::Fault;

/// Adds labels, notes and help.
pub fn finding(fault: Fault, finding: Finding) -> Finding {
    match fault {
        Fault::NoValue => finding.label("a number, `#`, `[` or a function belongs here"),
        Fault::NoOperator => finding
            .label("does not go on here")
            .note("operators: ** * / MOD + - EQ NE GT GE LT LE AND OR XOR"),
        Fault::OpenBracket => finding
            .label("no counterpart on this line")
            .note("LinuxCNC: \"Unclosed expression\""),
        Fault::UnknownFunction => finding.label("not a function").note(
            "functions: ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN; \
                 angles in degrees",
        ),
        Fault::NoBracket => finding.label("`[` belongs here"),
        Fault::NoSecondValue => finding
            .label("the angle of a point takes two values")
            .help("write ATAN[y]/[x]; ATAN[y]/[1] for one"),
        Fault::MalformedName => finding.label("a name stands between `<` and `>`"),
        Fault::TooNested => finding
            .label("more than 24 operations wait for their right side")
            .help("split it over two lines"),
        Fault::NoAssignment => finding
            .label("nothing uses it")
            .help("write a letter before it, or `=` and a value behind it"),
        Fault::TooManyAssignments => finding.label("the eleventh").help("go on on the next line"),
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
            .label("the machine gives it")
            .help("G10 L2 and G92 set frames, G28.1 and G30.1 positions"),
        Fault::ParametersFull => finding.label("no room for another one; the program ends here"),
        Fault::UnknownKeyword => finding
            .label("no keyword of an O-word")
            .note(
                "sub endsub call return if elseif else endif while endwhile do repeat endrepeat \
                 break continue",
            )
            .help("`O1234` alone is the number of a program in `--dialect iso`"),
        Fault::MalformedLabel => finding.label("a number or `<name>` belongs here"),
        Fault::NotAlone => finding.label("belongs on a line of its own"),
        Fault::TooManyArguments => finding.label("30 at most"),
        Fault::NoSuchSubroutine => finding
            .label("no `sub` of this label in the file")
            .note("subroutines in files of their own are not looked for"),
        Fault::NotOpened => {
            finding.label("its counterpart is not before it, or not with this label")
        }
        Fault::NotClosed => {
            finding.label("its counterpart is not behind it, or not with this label")
        }
        Fault::NestedSubroutine => finding
            .label("another `sub` comes before its `endsub`")
            .note("LinuxCNC: \"Nested subroutine definition\""),
        Fault::NoLoop => finding.label("no loop with this label is under way"),
        Fault::NoCall => finding.label("no subroutine is under way"),
        Fault::TooDeep => finding.label("128 calls and 128 loops at most"),
        Fault::OutOfSteps => finding
            .label("an endless loop?")
            .note("10 million lines, those passed over included"),
        Fault::FlowNotOfDialect => finding
            .label("this dialect has no O-words")
            .help("choose another dialect with `--dialect`"),
        _ => finding,
    }
}
