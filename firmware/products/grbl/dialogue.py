"""Recorded dialogues of Grbl 1.1h: the firmware must answer every line as Grbl has."""

from __future__ import annotations

import json

from husillo_firmware.build import FIRMWARE
from husillo_firmware.emulated import same

from products.grbl.link import Edges, Grbl

FOLDER = FIRMWARE.parent / "controllers/tests/data/grbl"
# Dialogues of lines and answers, without reports that depend on time.
NAMES = ("parser_state", "parser_state_b", "g10_forms")
# Dialogues of grblHAL, and how many lines of each do not depend on time.
HAL = {"hal_params": 9, "hal_error_lock": 14, "hal_store": 6}


def play(grbl: Grbl, name: str, lines: int | None = None) -> Edges:
    """Plays a dialogue from its first line on, or so many of its lines. Returns the recorded
    steps, which are those of the whole dialogue."""
    text = (FOLDER / f"{name}.jsonl").read_text()
    records = [json.loads(line) for line in text.splitlines()]
    sent = [place for place, record in enumerate(records) if "send" in record]
    played = records if lines is None else records[: sent[lines]]
    expected: list[str] = []
    found: list[str] = []
    for record in played[1:]:
        if "send" in record:
            same_lines(grbl, name, found, expected)
            expected, found = [], grbl.ask(record["send"].rstrip("\n"))
        elif "wait" in record:
            grbl.reports("Idle")
        elif "recv" in record:
            expected.append(record["recv"].strip())
    same_lines(grbl, name, found, expected)
    end = records[-1].get("end", {})
    return Edges(end.get("pulses", []), end.get("net_steps", []))


def same_lines(grbl: Grbl, name: str, found: list[str], expected: list[str]) -> None:
    """Compares answers. What comes before the first line is the banner."""
    if found:
        place = f"{grbl.board}: {name}"
        same(f"{place}: {expected}: lines", len(found), len(expected))
        for one, other in zip(found, expected, strict=True):
            if one != other:
                raise SystemExit(f"{place}: {one!r} instead of {other!r}")
