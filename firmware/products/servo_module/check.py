"""A measuring machine of one servo module: every result must equal that of the simulator.

The host homes on the index, moves in trapezoids, probes in both directions, jogs, and reads the
final state.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from husillo_firmware import boards, host, product
from husillo_firmware.boards import Board
from husillo_firmware.qemu import Firmware
from husillo_firmware.waiting import fail, require

from products.servo_module import count

ACTIONS = (
    *("home", "x", "goto", "1200", "goto", "-777", "goto", "3"),
    *("touch", "+", "touch", "-", "--repeat", "3", "goto", "0", "zero", "goto", "1200"),
    *("jog", "-x", "0.05s", "slow", "status"),
)
RESULTS = 11
# Each motor, real or simulated, rests within one count of its goal, so positions differ by at most
# two. Contacts are latched to the count. The length of a jog depends on the host's clock:
# it begins 2700 counts, 0.3 s, before the contact.
TOLERANCES = {
    "trigger": 0,
    "corrected": 0,
    "pre_travel": 0,
    "spread": 0,
    "touches": 0,
    "position": 2,
}


def results(*where: str) -> list[dict[str, Any]]:
    """Has the host measure. Returns its results."""
    said = host.says("measure", "-m", "cmm", *ACTIONS, *where, "--format", "json")
    rows: list[dict[str, Any]] = json.loads(said)["results"]
    require(len(rows) == RESULTS, rows)
    return rows


def measure(board: Board) -> Iterator[tuple[str, int]]:
    """Measures with the firmware and with the simulator, and compares. Yields the figures."""
    simulated = results("--contact", "1:1500", "--contact", "1:..-1500")
    with Firmware("servo_module", board) as firmware:
        firmware.booted()
        measured = results("--port", firmware.tcp)
        ram = firmware.ram()
    for expected, found in zip(simulated, measured, strict=True):
        is_jog = expected["action"].startswith(("jog", "status"))
        for key, tolerance in TOLERANCES.items():
            if not isinstance(expected.get(key), (int, float)) or (is_jog and key == "position"):
                continue
            if abs(expected[key] - found[key]) > tolerance:
                fail(f"{board}: {found} instead of {expected}")
    yield "results", len(measured)
    yield from firmware.memory(ram).items()


def main(arguments: list[str]) -> int:
    """Checks the firmware on all boards."""
    parser = product.parser("servo_module", __doc__)
    parser.add_argument("--count", action="store_true", help=count.__doc__)
    options = parser.parse_args(arguments)
    chosen = options.boards or boards.ALL
    if options.count:
        for board in chosen:
            for name, value in count.ticks(board):
                print(board, name, value)
        return 0
    return product.settle("servo_module", options, product.measure("servo_module", chosen, measure))
