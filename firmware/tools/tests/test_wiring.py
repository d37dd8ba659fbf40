"""Compares the wiring tables of `docs/hardware/` with the source of boards and products."""

from __future__ import annotations

import re
import unittest
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[3]
PAGES = ROOT / "docs/hardware"
BOARDS = ROOT / "firmware/board/src"
PRODUCTS = ROOT / "firmware/products"
MOTORS, OUTPUTS, INPUTS = 8, 4, 5
# Pins of the chip of a micro:bit, version 1, at the pads of its edge connector.
PADS = {1: 2, 2: 1, 3: 0, 4: 3, 5: 4, 6: 10, 10: 9, 11: 7, 12: 6, 16: 16, 17: 5, 18: 8}
PADS |= {20: 12, 21: 15, 22: 14, 23: 13, 26: 11}
# Pins of the module Raspberry Pi Pico for GP2 to GP22.
PICO_PINS = (4, 5, 6, 7, 9, 10, 11, 12, 14, 15, 16, 17, 19, 20, 21, 22, 24, 25, 26, 27, 29)
# GitHub shows a page in this width.
WIDEST, SMALLEST_TEXT = 900, 12


def found(pattern: str, text: str) -> str:
    """The first group of the only match."""
    matches: list[str] = re.findall(pattern, text, re.DOTALL)
    assert len(matches) == 1, f"{len(matches)} matches of {pattern}"
    return matches[0]


def value(expression: str, **names: int) -> int:
    """The value of an expression of Rust that only has integers, names, shifts, and masks.

    Rust and Python have the same precedence of these operators.
    """
    expression = re.sub(r"(?:u32::from|bits)\((\w+)\)", r"\1", expression)
    assert re.fullmatch(r"[\w\s<>&|()]+", expression), expression
    return int(eval(expression, {"__builtins__": {}}, names))


def bit(mask: int) -> int:
    """The number of the only bit that is set."""
    assert mask.bit_count() == 1, f"{mask:#x} is not one pin"
    return mask.bit_length() - 1


def pins(board: str) -> dict[str, int]:
    """The pin of each line of a board, from the code that writes and reads it."""
    text = (BOARDS / board).read_text()
    motors = found(r"pub fn write\(.*?let high = (.*?);", text)
    outputs = found(r"pub fn switch\(.*?let high = (.*?);", text)
    mask = value(found(r"const OUTPUTS: u32 = (.*?);", text))
    lines = {f"motor {n}": bit(value(motors, levels=1 << n)) for n in range(MOTORS)}
    for n in range(OUTPUTS):
        lines[f"output {n}"] = bit(value(outputs, outputs=1 << n, OUTPUTS=mask))
    inputs = found(r"\nconst INPUTS: [^=]* = \[?(.*?)\]?;", text).split(", ")
    if len(inputs) == 1:
        inputs = [str(int(inputs[0]) + n) for n in range(INPUTS)]
    return lines | {f"input {n}": int(pin) for n, pin in enumerate(inputs)}


def microbit() -> dict[str, str]:
    """The names of the micro:bit's pins in the tables."""
    text = (BOARDS / "microbit.rs").read_text()
    lines = pins("microbit.rs")
    lines["pwm"] = int(found(r"const PWM: u32 = (\d+);", text))
    encoder = found(r"const ENCODER: \[usize; 2\] = \[(.*?)\];", text).split(", ")
    lines |= {f"encoder {name}": int(pin) for name, pin in zip("AB", encoder, strict=True)}
    names = {line: f"pad {PADS[pin]}, P0.{pin:02}" for line, pin in lines.items()}
    for line in ("TXD", "RXD"):
        pin = int(found(rf"set\(UART \+ PSEL{line}, (\d+)\);", text))
        names[f"link {line}"] = f"USB, P0.{pin:02}"
    return names


def pico() -> dict[str, str]:
    """The names of the Pico's pins in the tables."""
    names = {line: f"GP{pin}, pin {PICO_PINS[pin - 2]}" for line, pin in pins("rp2.rs").items()}
    return names | {"link TXD": "USB", "link RXD": "USB"}


def mps2() -> dict[str, str]:
    """The names of the MPS2's pins in the tables."""
    text = (BOARDS / "mps2.rs").read_text()
    assert "set(GPIO0 + LOW_BYTE, levels.into());" in text
    assert "set(GPIO0 + PINS_8_TO_11, u32::from(outputs & 0xf) << 8);" in text
    assert "!read(GPIO1 + DATA) as u8 & 0x1f" in text
    names = {f"motor {n}": f"GPIO0, pin {n}" for n in range(MOTORS)}
    names |= {f"output {n}": f"GPIO0, pin {8 + n}" for n in range(OUTPUTS)}
    names |= {f"input {n}": f"GPIO1, pin {n}" for n in range(INPUTS)}
    return names | {"link TXD": "UART0", "link RXD": "UART0"}


def rows(page: str) -> Iterator[dict[str, str]]:
    """The rows of the page's tables whose first column is `line`."""
    columns: list[str] = []
    for text in (PAGES / page).read_text().splitlines():
        if not text.startswith("|"):
            columns = []
            continue
        cells = [cell.strip() for cell in text.strip("|").split("|")]
        if not columns:
            columns = cells
        elif columns[0] == "line" and "micro:bit" in columns and set(cells[0]) != set("-"):
            yield dict(zip(columns, cells, strict=True))


def constants(source: str) -> dict[str, int]:
    """The bytes that a source file names."""
    text = (PRODUCTS / source).read_text()
    return {
        name: value(number)
        for name, number in re.findall(r"^const (\w+): u8 = (\w+);", text, re.MULTILINE)
    }


def read_bits(source: str) -> dict[str, str]:
    """The inputs from the fields that a source file makes of their bits."""
    fields: dict[str, str] = {}
    text = (PRODUCTS / source).read_text()
    for name, several, one in re.findall(r"(\w+): (?:\[(bits & .*?)\]|bits & (\d+) != 0)", text):
        masks = re.findall(r"bits & (\d+)", several) or [one]
        for index, mask in enumerate(masks):
            field = f"{name}[{index}]" if several else name
            fields[f"input {bit(int(mask))}"] = field
    return fields


# The signals of a Grbl controller, in the order of the lines of a board.
GRBL_MOTORS = [f"{axis} {kind}" for kind in ("step", "direction") for axis in "XYZ"]
GRBL_MOTORS += ["mist coolant"]
GRBL_OUTPUTS = ["motors off", "spindle on", "spindle counter-clockwise", "flood coolant"]
GRBL_INPUTS = [*(f"{axis} limit" for axis in "XYZ"), "probe", "hold", "start", "reset", "door"]


def grbl_pins(board: str) -> tuple[dict[str, str], dict[str, str]]:
    """The pins of each signal, in the table of a board's file and in its code."""
    text = (BOARDS / board).read_text()
    table: dict[str, str] = {}
    columns: list[str] = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.removeprefix("//! |").strip("|").split("|")]
        if not line.startswith("//! |") or set(cells[0]) == {"-"}:
            continue
        columns = columns or cells
        signal = ""
        for column, cell in zip(columns, cells, strict=True):
            if column == "signal":
                signal = cell
            elif column == "pin" and cell != "pin":
                table[signal] = cell
    code: dict[str, str] = {}
    names = {"MOTORS": GRBL_MOTORS, "OUTPUTS": GRBL_OUTPUTS, "INPUTS": GRBL_INPUTS}
    names["PWM"] = ["PWM of the spindle"]
    for name, signals in names.items():
        array = found(rf"pub const {name}: .*?= (.*?);", text)
        pairs = zip(signals, re.findall(r"Pin\((\w), (\d+)\)", array), strict=False)
        code |= {signal: f"P{port}{pin}" for signal, (port, pin) in pairs}
    return table, code


class Wiring(unittest.TestCase):
    def test_the_signals_of_boards_with_an_stm32_are_those_of_the_code(self) -> None:
        for board in ("nucleo.rs", "pill.rs"):
            with self.subTest(board):
                table, code = grbl_pins(board)
                self.assertEqual(table, code)

    """The tables name the pins and lines of the source."""

    def test_pins(self) -> None:
        boards = {"micro:bit": microbit(), "Pico": pico(), "MPS2": mps2()}
        for page in sorted(PAGES.glob("*.md")):
            for row in rows(page.name):
                for board, names in boards.items():
                    with self.subTest(page=page.name, line=row["line"], board=board):
                        # The Pico has no PWM and no encoder, so it does not drive this machine.
                        is_none = page.name == "cmm.md" and board == "Pico"
                        if board in row:
                            expected = "none" if is_none else names[row["line"]]
                            self.assertEqual(row[board], expected)

    def test_the_list_of_lines_is_complete(self) -> None:
        lines = [row["line"] for row in rows("README.md")]
        self.assertEqual(lines, [*pins("rp2.rs"), "link TXD", "link RXD"])

    def lines_of(self, page: str, name: str) -> list[str]:
        """The lines of the rows that contain a name of the source."""
        return [row["line"] for row in rows(page) if f"`{name}`" in row["signal"]]

    def test_servo_module(self) -> None:
        names = constants("servo_module/src/servo.rs")
        outputs = ("TRANSMIT", "AMPLIFIER", "REVERSE", "ADDR_OUT")
        inputs = ("LIMIT_1", "LIMIT_2", "INDEX", "ADDR_IN", "SUPPLY")
        self.assertEqual(set(names), {*outputs, *inputs})
        for kind, group in (("output", outputs), ("input", inputs)):
            for name in group:
                expected = [f"{kind} {bit(names[name])}"]
                self.assertEqual(self.lines_of("cmm.md", name), expected, name)

    def test_microfactory(self) -> None:
        names = constants("microfactory/src/main.rs")
        self.assertEqual(set(names), {"CLOCKS", "ENABLE", "NOT_RESET"})
        clocks = [f"motor {n}" for n in range(MOTORS) if names["CLOCKS"] >> n & 1]
        self.assertEqual(self.lines_of("microfactory.md", "CLOCKS"), clocks)
        for name in ("ENABLE", "NOT_RESET"):
            expected = [f"output {bit(names[name])}"]
            self.assertEqual(self.lines_of("microfactory.md", name), expected, name)
        text = (PRODUCTS / "microfactory/src/main.rs").read_text()
        pulse = found(r"const PULSE_US: u32 = (\d+);", text)
        page = (PAGES / "microfactory.md").read_text()
        self.assertIn(f"high for {pulse} us (`PULSE_US`)", page)

    def test_drill(self) -> None:
        names = constants("drill/src/lights.rs")
        self.assertEqual(list(names), ["SPINDLE", "DATA", "CLOCK", "LATCH"])
        for name, mask in names.items():
            self.assertEqual(self.lines_of("drill.md", name), [f"output {bit(mask)}"], name)
        # The lamps in the order of their bits.
        source = (ROOT / "controllers/src/drill/lights.rs").read_text()
        docs = found(r"pub struct DrillLights \{(.*?)\n\}", source)
        named = {
            field: re.findall(r"[AD]\d", comment)
            for comment, field in re.findall(r"((?:    ///[^\n]*\n)+)    pub (\w+):", docs)
        }
        order = found(r"let lamps = \[(.*?)\];", source).replace("self.", "").split(",")
        fields = [name.split()[0] for name in order if name.strip()]
        ports = [port for field in fields for port in named.get(field, [])]
        ports = [*named["moves"], *ports]
        page = (PAGES / "drill.md").read_text()
        self.assertEqual(re.findall(r"^\| \d+, Q\w \|.*\| (\w+) \|$", page, re.MULTILINE), ports)

    def test_switches(self) -> None:
        for product in ("drill", "microfactory"):
            fields = read_bits(f"{product}/src/switches.rs")
            self.assertEqual(len(fields), 4, product)
            for line, field in fields.items():
                self.assertEqual(self.lines_of(f"{product}.md", field), [line], product)


class Drawings(unittest.TestCase):
    """The drawings are readable on any background, and each is on a page."""

    def test_drawings(self) -> None:
        shown = "".join(page.read_text() for page in PAGES.glob("*.md"))
        for drawing in PAGES.glob("*.svg"):
            with self.subTest(drawing=drawing.name):
                text = drawing.read_text()
                picture = ElementTree.fromstring(text)
                self.assertLessEqual(int(picture.attrib["width"]), WIDEST)
                for size in re.findall(r"font-size[:=]\W*(\d+)", text):
                    self.assertGreaterEqual(int(size), SMALLEST_TEXT)
                self.assertIn('class="page"', text)
                self.assertIn(f"({drawing.name})", shown)


if __name__ == "__main__":
    unittest.main()
