"""What the micro mill's figures may be at most, and what they have to leave room for."""

from __future__ import annotations

from husillo_firmware.golden import Figures

# The memory of the original controller, in bytes.
FLASH, RAM = 32768, 3840
# Instructions an event may take on it and on a faster one.
MOST = {
    "microbit count slope_event_untold": 450,
    "microbit count take_up_event_untold": 450,
    "microbit count circle_event_untold": 450,
    "microbit count arc_event_untold": 450,
    "microbit count step_interrupt": 90,
    "mps2-an386 count slope_event_untold": 220,
    "mps2-an386 count take_up_event_untold": 220,
    "mps2-an386 count circle_event_untold": 220,
    "mps2-an386 count step_interrupt": 60,
}
# Events of an arc, the slowest ones, that have to be sustained a second. Of each board its
# processor, its clock, cycles an instruction, and those of an interrupt's entry and return.
LEAST = {
    "microbit": ("Cortex-M0 at 48 MHz", 48e6, 1.5, 32, 50_000),
    "mps2-an386": ("Cortex-M4F at 168 MHz", 168e6, 1.3, 24, 380_000),
}


def exceeded(figures: Figures) -> list[str]:
    """What is beyond the limits, of the boards that were measured."""
    found = dict(figures)
    most: dict[str, float] = dict(MOST)
    if "microbit flash" in found:
        most["microbit flash"] = FLASH
        found["microbit RAM"] = found["microbit static"] + found["microbit bound"]
        most["microbit RAM"] = RAM
    said = [
        f"{name}: {found[name]:g}, at most {limit}"
        for name, limit in most.items()
        if name in found and found[name] > limit
    ]
    for board, (processor, hertz, cycles, entry, limit) in LEAST.items():
        if f"{board} count arc_event_untold" not in found:
            continue
        event = found[f"{board} count arc_event_untold"] + found[f"{board} count step_interrupt"]
        rate = int(hertz / (cycles * event + entry))
        print(f"{processor}: {rate} events of an arc a second")
        if rate < limit:
            said.append(f"{processor}: at least {limit} events of an arc a second")
    return said
