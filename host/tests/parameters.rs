//! Programs with parameters and O-words, as a user calls them.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;

const LOOP: &str =
    "G21 G90 F100\n#1=0\no1 while [#1 lt 3]\nG1 X[#1*2.5] Y#1\n#1=[#1+1]\no1 endwhile\nM2\n";

fn husillo(args: &[&str], program: &str) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.args(args).write_stdin(program).assert()
}

#[test]
fn commands_come_in_the_order_of_execution() {
    husillo(&["commands", "-m", "free", "-"], LOOP)
        .success()
        .stdout(
            "     4  linear X0 Y0 Z0 F100\n     4  linear X2.5 Y1 Z0 F100\n     4  linear X5 Y2 Z0 \
         F100\n     7  end\n",
        );
}

#[test]
fn the_machine_makes_them() {
    husillo(&["steps", "-m", "free", "-", "-o", "-"], LOOP)
        .success()
        .stdout(contains("\n5000,"));
}

#[test]
fn an_error_in_a_loop_is_reported_once() {
    let program = LOOP.replace("Y#1", "Y[1/0]");
    husillo(&["check", "-m", "free", "--format", "short", "-"], &program)
        .failure()
        .stdout(contains("<input>:4:16: error[E0620]: division by zero").count(1));
}

#[test]
fn an_endless_program_ends() {
    husillo(
        &["check", "-m", "free", "--format", "short", "-"],
        "o1 sub\no1 call\no1 endsub\no1 call\n",
    )
    .failure()
    .stdout(contains("error[E0637]").count(1));
}

#[test]
fn a_dialect_without_parameters_says_so() {
    husillo(
        &["check", "-m", "free", "--dialect", "grbl", "-"],
        "G0 X#1\n",
    )
    .failure()
    .stdout(contains("E0102").and(contains("this dialect does not have them")));
}

/// Subroutines in files of their own: of the folder of the program, and of `--include`.
#[test]
fn subroutines_are_found_in_folders() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("subroutines");
    let (own, more) = (folder.join("own"), folder.join("more"));
    std::fs::create_dir_all(&own).unwrap();
    std::fs::create_dir_all(&more).unwrap();
    let write = |path: &std::path::Path, text: &str| std::fs::write(path, text).unwrap();
    write(
        &own.join("slot.ngc"),
        "o<slot> sub\nG0 X#1\nM98 P77\no<slot> endsub\n",
    );
    write(&more.join("77.nc"), "O77\nG1 Y1\nM99\n");
    write(&folder.join("outer.ngc"), "o<outer> sub\no<outer> endsub\n");
    let program = own.join("part.nc");
    write(&program, "F100\no<slot> call [3]\nM2\n");
    let run = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("husillo").unwrap();
        command.args(["commands", program.to_str().unwrap()]);
        command.args(arguments).assert()
    };
    let missing = run(&[]).code(1).get_output().stderr.clone();
    let missing = String::from_utf8(missing).unwrap();
    assert!(missing.contains("E0633"), "{missing}");
    assert!(missing.contains("slot.ngc:3"), "{missing}");
    let found = run(&["--include", more.to_str().unwrap()]).success();
    let found = String::from_utf8(found.get_output().stdout.clone()).unwrap();
    assert!(found.contains("rapid X3 Y0 Z0"), "{found}");
    assert!(found.contains("linear X3 Y1 Z0"), "{found}");
    // No name leads out of the folders.
    write(&program, "o<../outer> call\nM2\n");
    run(&[]).code(1);
}
