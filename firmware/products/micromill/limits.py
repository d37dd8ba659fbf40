"""Upper limits of the micro mill's figures: memory, and instructions per event."""

from __future__ import annotations

from husillo_firmware.golden import Figures

# The memory of the original controller, in bytes.
FLASH, RAM = 32768, 3840
# The most instructions of an event and of the step interrupt.
MOST = {
    "microbit count slope_event_untold": 460,
    "microbit count take_up_event_untold": 460,
    "microbit count circle_event_untold": 460,
    "microbit count arc_event_untold": 460,
    "microbit count step_interrupt": 90,
    "mps2-an386 count slope_event_untold": 220,
    "mps2-an386 count take_up_event_untold": 220,
    "mps2-an386 count circle_event_untold": 220,
    "mps2-an386 count step_interrupt": 60,
}
# The least rate of arc events, which are the slowest ones. For each board: the processor, its
# clock, cycles per instruction, cycles of an interrupt's entry and return, events per second.
LEAST = {
    "microbit": ("Cortex-M0 at 48 MHz", 48e6, 1.5, 32, 50_000),
    "mps2-an386": ("Cortex-M4F at 168 MHz", 168e6, 1.3, 24, 380_000),
}


def exceeded(figures: Figures) -> list[str]:
    """Returns the figures beyond their limits, for the boards that were measured."""
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
        print(f"{processor}: {rate} events of an arc per second")
        if rate < limit:
            said.append(f"{processor}: at least {limit} events of an arc per second")
    return said
