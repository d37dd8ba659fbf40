"""Findings, commands, machines, comparisons, drill files, tuning; errors as exceptions."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import threading
import time
from importlib import metadata
from pathlib import Path

import husillo
import numpy as np
import pytest
from conftest import EXAMPLES, Program


def test_findings_are_those_of_the_program(husillo_program: Program) -> None:
    good = (EXAMPLES / "circles.nc").read_text()
    wrong = "G21\nG1 X1 Q\nG0 X[\nG1 X1,5 F100\n"
    for name, text in [("circles.nc", good), ("wrong.nc", wrong)]:
        words = ["check", husillo_program.file(name, text), "-m", "micromill"]
        expected = husillo_program.json(*words)
        checked = husillo.check(text, "micromill", name=name)
        assert (checked.errors, checked.warnings) == (expected["errors"], expected["warnings"])
        assert checked.may_run == (expected["errors"] == 0)
        assert len(checked.findings) == len(expected["findings"])
        for made, of in zip(checked.findings, expected["findings"], strict=True):
            for key in ("code", "severity", "message", "file", "line", "column", "end", "help"):
                assert getattr(made, key) == of[key], key
            assert [vars(fix) for fix in made.fixes] == of["fixes"]
        lines = husillo_program.prints(*words, "--format", "short").splitlines()
        assert [str(finding) for finding in checked.findings] == lines


def test_a_path_has_the_name_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "wrong.nc"
    path.write_text("G21\nG1 X2 Q7\n")
    for checked in (husillo.check(path), husillo.check(path.read_bytes(), name=path.name)):
        finding = checked.findings[0]
        assert (finding.file, finding.line, finding.column) == ("wrong.nc", 2, 7)


def test_errors_have_their_place() -> None:
    with pytest.raises(husillo.ProgramError) as caught:
        husillo.simulate("G21\nG2 X1 R0.1\n", name="arc.nc")
    error = caught.value
    assert (error.line, error.code) == (2, error.findings[0].code)
    assert error.column is not None and f"arc.nc:2:{error.column}: error[" in str(error)
    with pytest.raises(husillo.ProgramError, match=r"arc\.nc:2"):
        husillo.stream("G21\nG2 X1 R0.1\n", name="arc.nc")
    with pytest.raises(husillo.ProgramError, match="klingon"):
        husillo.check("G0 X1\n", dialect="klingon")
    with pytest.raises(husillo.ProgramError, match="corner"):
        husillo.simulate("G0 X1\n", zero="M5")
    with pytest.raises(husillo.MachineError, match="nosuch"):
        husillo.check("G0 X1\n", "nosuch")
    with pytest.raises(husillo.MachineError) as mistaken:
        husillo.Machine.from_text("schema = 9\n", file="mine.toml")
    assert (mistaken.value.findings[0].file, mistaken.value.line) == ("mine.toml", 1)
    with pytest.raises(husillo.ProgramError):
        husillo.check(b"\xff\xfeG\0")
    with pytest.raises(FileNotFoundError):
        husillo.check(Path("nosuch.nc"))
    with pytest.raises(ValueError, match="part"):
        husillo.stream("G0 X1\n", size=0)
    assert issubclass(husillo.ProgramError, husillo.Error)


def test_an_error_while_it_runs_is_raised_by_the_part() -> None:
    # Nothing is where the probe looks for it.
    program = "G21 G90 F60\nG0 Z5\nG38.2 Z3\nM2\n"
    with pytest.raises(husillo.ProgramError):
        husillo.simulate(program, "router")


def test_commands_are_those_of_the_program(husillo_program: Program) -> None:
    text = (EXAMPLES / "circles.nc").read_text()
    made = husillo.commands(text, "micromill", name="circles.nc")
    name = husillo_program.file("circles.nc", text)
    lines = husillo_program.prints("commands", name, "-m", "micromill", "--format", "json")
    expected = [json.loads(line) for line in lines.splitlines()][:-1]
    assert len(made) == len(expected) > 3
    for command, of in zip(made, expected, strict=True):
        assert (command.line, command.kind) == (of["line"], of["kind"])
        assert command.to_nm == (tuple(of["to_nm"]) if "to_nm" in of else None)
    assert len(husillo.commands("")) == 0


def test_subroutines_come_from_the_given_files() -> None:
    files = {"bore.ngc": "o<bore> sub\nG0 X#1\no<bore> endsub\n"}
    program = "o<bore> call [3]\nM2\n"
    assert husillo.check(program, files=files).errors == 0
    assert husillo.check(program).errors > 0
    assert husillo.simulate(program, files=files).end_nm[0] == 3_000_000


def test_machines(tmp_path: Path) -> None:
    machines = husillo.machines()
    assert {"micromill", "router", "lathe"} <= {machine.name for machine in machines}
    for machine in machines:
        assert husillo.Machine.from_text(machine.text) == machine
        assert len(machine.letters) == len(machine.axes) >= 3
    micromill = husillo.Machine("micromill")
    assert (micromill.axes[0].letter, micromill.axes[0].step_nm) == ("X", 140)
    path = tmp_path / "own.toml"
    path.write_text(micromill.text.replace('name = "micromill"', 'name = "own"'))
    for own in (husillo.Machine(path), husillo.Machine(str(path))):
        assert (own.name, own.axes) == ("own", micromill.axes)
    assert husillo.simulate("G0 X1\n", path).machine == "own"
    assert husillo.Machine(path) != micromill
    assert len({husillo.Machine(path), husillo.Machine(str(path)), micromill}) == 2


def test_compensation_and_worn_screws() -> None:
    program = "G21 G90 F60\nG1 X2\nG1 X1\nM2\n"
    with_it = husillo.simulate(program, "micromill")
    without = husillo.simulate(program, "micromill", compensation=False)
    assert with_it.end_nm[0] == pytest.approx(1_000_000, abs=140)
    assert without.end_nm[0] > 1_100_000
    assert (with_it.steps.kind == husillo.Kind.TAKE_UP).any()
    assert not (without.steps.kind == husillo.Kind.TAKE_UP).any()
    # A finding of the check, and a machine without a description of its worn screws.
    assert with_it.warnings == len(with_it.findings) > 0
    with pytest.raises(husillo.ProgramError, match="simulated_backlash"):
        husillo.simulate(program, "free", worn=True)


def test_a_probe_reports_its_contact() -> None:
    run = husillo.simulate("G21 G90 F60\nG0 Z5\nG38.2 Z-1\nM2\n", "router")
    (touch,) = run.probes
    assert touch.is_touched and len(touch.position_nm) == len(run.axes)
    # The radius of its ball, less its pre-travel.
    assert touch.position_nm[2] == pytest.approx(990_000, abs=run.nm_per_step[2])


def test_interpolators_are_compared_as_by_the_program(husillo_program: Program) -> None:
    made = husillo.compare(husillo.Circle(30))
    expected = husillo_program.json("compare", "circle")
    assert [method.method for method in made.methods] == [
        of["method"] for of in expected["methods"]
    ]
    errors = [of["max_error_blu"] for of in expected["methods"]]
    assert [method.max_error_steps for method in made.methods] == pytest.approx(errors)
    line = husillo.compare(husillo.Line((40, 17)), only="dda")
    assert line.methods and len(line.methods) < len(made.methods)
    arc = husillo.compare(husillo.Arc((10, 0), (0, 10), (0, 0)))
    assert {method.moves for method in arc.methods} == {1}
    assert husillo.compare((EXAMPLES / "circles.nc"), "micromill").methods[0].moves > 1
    with pytest.raises(husillo.ProgramError):
        husillo.compare(husillo.Line((0, 0)))
    with pytest.raises(husillo.ProgramError, match="weights"):
        husillo.compare(husillo.Circle(30), weights=(0, 0, 0, 0))


def test_drill_files(husillo_program: Program) -> None:
    board = husillo.holes(EXAMPLES / "board.drl", depth_mm=1.8, shortest=True)
    name = husillo_program.file("board.drl", (EXAMPLES / "board.drl").read_text())
    expected = husillo_program.json("holes", name)
    assert board.holes_mm.shape == (len(expected["holes"]), 3)
    assert sorted(map(tuple, board.holes_mm)) == sorted(map(tuple, expected["holes"]))
    assert board.gcode is not None and husillo.check(board.gcode).errors == 0
    in_order = husillo.holes(EXAMPLES / "board.drl")
    assert in_order.gcode is None
    np.testing.assert_array_equal(in_order.holes_mm, np.array(expected["holes"], float))
    with pytest.raises(husillo.ProgramError):
        husillo.holes(EXAMPLES / "board.drl", depth_mm=-1)


def test_a_servo_is_tuned() -> None:
    step = husillo.tune(p=100, i=0, d=10000)
    assert step.values["step"]["goal"] and len(step.traces[0].time_us) > 100
    assert step.traces[0].position.dtype == np.int64
    found = husillo.tune("relay")
    assert found.gains_toml and "gains = " in found.gains_toml
    with pytest.raises(husillo.Error):
        husillo.tune("luck")


def test_other_threads_run_while_it_computes() -> None:
    turns = 0
    done = threading.Event()

    def count() -> None:
        nonlocal turns
        while not done.is_set():
            turns += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    text = (EXAMPLES / "gear.nc").read_text()
    thread.start()
    before = turns
    husillo.compare(text, "micromill")
    during = turns - before
    done.set()
    thread.join()
    assert during > 0


def test_results_come_after_the_last_part_and_a_closed_stream_ends() -> None:
    text = (EXAMPLES / "gear.nc").read_text()
    parts = husillo.stream(text, "micromill", size=1000)
    next(parts)
    with pytest.raises(husillo.Error, match="not ended"):
        _ = parts.results
    parts.close()
    assert list(parts) == []
    with husillo.stream(text, "micromill", size=1000) as whole:
        events = sum(int(part.is_step.sum()) for part in whole)
        assert whole.results.events == events
        assert whole.results == husillo.Results(
            **{
                key: value
                for key, value in vars(husillo.simulate(text, "micromill")).items()
                if key != "steps"
            }
        )


def test_threads_of_runs_end_with_their_readers() -> None:
    text = (EXAMPLES / "gear.nc").read_text()

    def count() -> int:
        return len(list(Path("/proc/self/task").iterdir()))

    before = count()
    for _ in range(20):
        next(husillo.stream(text, "micromill", size=1000))
    gc.collect()
    # A thread ends when it finds that nobody reads its next part.
    deadline = time.monotonic() + 20
    while count() > before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert count() <= before


# Three million steps on a machine without limits.
LONG = """
import husillo, resource
lines = "".join(f"G1 X{100 * (turn % 2)}\\n" for turn in range(31))
program = "G21 G90 F6000\\n" + lines + "M2\\n"
"""


def test_memory_does_not_grow_with_the_steps() -> None:
    code = """
def most():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
with husillo.stream(program, "free", size=10_000) as parts:
    next(parts)
    before = most()
    print(sum(len(part) for part in parts), most() - before)
"""
    done = subprocess.run([sys.executable, "-c", LONG + code], capture_output=True, check=True)
    entries, growth_mb = map(int, done.stdout.split())
    assert entries == 3_000_000 - 10_000
    # All entries take 108 MB.
    assert growth_mb < 20


@pytest.mark.parametrize(
    "call",
    [
        'simulate(program, "free")',
        "check(lines)",
        "commands(lines)",
        "compare(husillo.Circle(radius=1_000_000))",
    ],
)
def test_ctrl_c_ends_a_call(call: str) -> None:
    # The whole call takes long enough that its end cannot be mistaken for the end by Ctrl-C.
    code = f"""
import _thread, signal, threading, time
# A shell lets its background jobs ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
lines = "G21 G90 F60\\n" + "G1 X1 Y2\\nG1 X2 Y3\\n" * 400_000
begin = time.monotonic()
husillo.{call}
whole = time.monotonic() - begin
begin = time.monotonic()
threading.Timer(0.1 * whole, _thread.interrupt_main).start()
try:
    husillo.{call}
except KeyboardInterrupt:
    print(whole, time.monotonic() - begin)
"""
    done = subprocess.run([sys.executable, "-c", LONG + code], capture_output=True, check=True)
    whole, interrupted = map(float, done.stdout.split())
    assert whole > 0.4
    assert interrupted < 0.6 * whole


def test_the_wheel_has_its_types_and_licences() -> None:
    files = {str(file) for file in metadata.files("husillo") or ()}
    assert {"husillo/py.typed", "husillo/_native.pyi"} <= files
    for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
        assert any(file.endswith(licence) for file in files), licence
    about = metadata.metadata("husillo")
    assert about["License-Expression"] == "MIT OR Apache-2.0"
    assert about["Version"] == metadata.version("husillo")
    for name in husillo.__all__:
        assert getattr(husillo, name).__doc__, name
