"""The steps are those of the program `husillo`, bit by bit."""

from __future__ import annotations

import husillo
import numpy as np
import pytest
from conftest import EXAMPLES, Program

# Arcs and helices in all planes, reversals with backlash, a dwell, inches.
HELIX = """\
G21 G90 G17 G94 F60
G0 X4 Y3
G3 X6 Y3 Z0.4 I1 J0
G2 X6 Y3 Z0 I-1 J0 F90
G4 P0.25
G18 G2 X5 Z0.4 I-0.5 K0.2
G19 G3 Y2.8 Z0.6 J-0.2 K0
G17 G20 G1 X0.2 Y0.11 F3
G21 G91 G1 X-0.5 Y-0.3
M2
"""

PAIRS = [
    ("circles.nc", "micromill"),
    ("gear.nc", "micromill"),
    ("ornament.nc", "micromill"),
    ("spirograph.nc", "router"),
    ("turning.nc", "lathe"),
    ("thread.nc", "lathe"),
    ("helix.nc", "micromill"),
    ("helix.nc", "router"),
    ("helix.nc", "free6"),
]


def text_of(name: str) -> str:
    return HELIX if name == "helix.nc" else (EXAMPLES / name).read_text()


def zero_of(name: str) -> str | None:
    return "fit" if name == "helix.nc" else None


def listed(steps: husillo.Steps) -> str:
    """Steps as `husillo steps` lists them."""
    rows = np.column_stack([steps.event, steps.wait_ticks, steps.delta]).tolist()
    return "".join(",".join(map(str, row)) + "\n" for row in rows)


@pytest.mark.parametrize(("name", "machine"), PAIRS)
def test_steps_and_figures(husillo_program: Program, name: str, machine: str) -> None:
    text, zero = text_of(name), zero_of(name)
    words = [husillo_program.file(name, text), "-m", machine, *(["--zero", zero] if zero else [])]
    run = husillo.simulate(text, machine, name=name, zero=zero)
    heading, expected = husillo_program.prints("steps", *words, "-o", "-").split("\n", 1)
    assert heading.split(",")[2:] == [f"d{letter}" for letter in run.axes.lower()]
    assert listed(run.steps) == expected

    figures = husillo_program.json("run", *words)
    assert run.events == figures["events"] == run.steps.event[-1]
    assert run.duration_s == figures["duration_s"]
    for key in ("end_nm", "min_nm", "max_nm", "reversals"):
        assert getattr(run, key) == tuple(figures[key]), key
    for key in ("max_deviation_nm", "rms_deviation_nm", "feed_nm", "rapid_nm", "lost_steps"):
        assert getattr(run, key) == figures[key], key
    assert [finding.code for finding in run.findings] == [of["code"] for of in figures["findings"]]


@pytest.mark.parametrize(("name", "machine"), [("gear.nc", "micromill"), ("helix.nc", "free6")])
def test_parts_are_the_whole(name: str, machine: str) -> None:
    text, zero = text_of(name), zero_of(name)
    whole = husillo.simulate(text, machine, zero=zero).steps
    for size in (997, 10_000, 10**9):
        with husillo.stream(text, machine, zero=zero, size=size) as parts:
            all_parts = list(parts)
        assert {len(part) for part in all_parts[:-1]} <= {size}
        assert 0 < len(all_parts[-1]) <= size
        columns = ("event", "ticks", "kind", "line", "delta", "commanded", "tool")
        for column in columns:
            joined = np.concatenate([getattr(part, column) for part in all_parts])
            np.testing.assert_array_equal(joined, getattr(whole, column), column)
        # Each part knows where it begins: positions at a time are those of the whole.
        for part in all_parts:
            begin = part.start_ticks / part.ticks_per_second
            np.testing.assert_array_equal(part.at([begin]), whole.at([begin]))


def test_tool_is_that_of_the_trace(husillo_program: Program) -> None:
    name = husillo_program.file("circles.nc", text_of("circles.nc"))
    husillo_program.prints("run", name, "-m", "micromill", "--trace", "trace.csv", "-o", "run.html")
    rows = (husillo_program.folder / "trace.csv").read_text().splitlines()[1:]
    steps = husillo.simulate(text_of(name), "micromill", name=name).steps
    kinds = {"feed": 1, "rapid": 2, "take-up": 3, "rest": 4}
    expected = np.array([[*row.split(",")[:-1], kinds[row.split(",")[-1]]] for row in rows], int)
    made = steps.is_step
    nanometres = np.rint(steps.tool[made] * steps.nm_per_step).astype(int)
    np.testing.assert_array_equal(nanometres, expected[:, 2:-1])
    np.testing.assert_array_equal(steps.kind[made], expected[:, -1])
    micros = steps.ticks[made] * 1_000_000 // steps.ticks_per_second
    np.testing.assert_array_equal(micros, expected[:, 1])


def test_lines_are_those_of_the_moves() -> None:
    run = husillo.simulate("G21 G90 F60\nG0 X1\n\nG1 X2\nG4 P1\nG1 Y1\nM2\n", "router")
    steps = run.steps
    moved = steps.line[steps.is_step]
    assert list(dict.fromkeys(moved.tolist())) == [2, 4, 6]
    x_of_line_4 = steps.commanded_mm[steps.line == 4][-1, 0]
    start = steps.start_commanded[0] * steps.nm_per_step[0] / 1e6
    assert x_of_line_4 - start == pytest.approx(2, abs=steps.nm_per_step[0] / 1e6)
    waits = steps.wait_ticks[steps.kind == husillo.Kind.WAIT]
    assert waits.sum() == steps.ticks_per_second


def test_positions_and_speeds_over_time() -> None:
    run = husillo.simulate("G21 G90 F600\nG1 X30\nM2\n", "free")
    steps = run.steps
    before, after = steps.at([0, run.duration_s + 1])
    assert (before == steps.start_tool * steps.nm_per_step / 1e6).all()
    assert (after == steps.tool_mm[-1]).all()
    np.testing.assert_array_equal(steps.at(steps.time_s[:1000]), steps.tool_mm[:1000])
    times, speeds = steps.speed(window_s=0.1)
    assert len(times) == len(speeds) == int(np.ceil(run.duration_s / 0.1 - 1e-9))
    middle = speeds[len(speeds) // 2]
    assert middle == pytest.approx(10, rel=0.01)
    distance_mm = speeds.sum() * 0.1
    assert distance_mm == pytest.approx(30, rel=1e-6)
    with pytest.raises(ValueError, match="tick"):
        steps.speed(0)


def test_columns_have_a_row_for_each_entry_and_cannot_be_written() -> None:
    steps = husillo.simulate("G21 F60\nG1 X1\nM2\n", "micromill").steps
    columns = steps.columns()
    assert {len(column) for column in columns.values()} == {len(steps)}
    assert list(columns)[5:7] == ["dx", "x_mm"]
    for array in (steps.delta, steps.ticks, steps.tool):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_a_program_that_moves_nothing_has_no_steps() -> None:
    run = husillo.simulate("G21\nM2\n")
    assert (len(run.steps), run.events, run.duration_s) == (0, 0, 0)
    assert run.steps.delta.shape == (0, 3)
    assert len(run.steps.time_s) == 0
    assert (run.steps.at(0.5) == run.steps.start_tool).all()
