"""Reads G-code, checks it, and simulates stepper machines to the step.

Lengths that end with ``_nm`` are exact, in nanometres; of a rotary axis in millionths of a degree.
Those that end with ``_mm`` are millimetres or degrees. Tuples and the last axis of an array are by
axis of the machine, in the order of its letters.
"""

from ._boards import Board, holes
from ._commands import Command, Commands, commands
from ._comparing import Arc, Circle, Comparison, Line, Method, compare
from ._findings import Error, Finding, Fix, MachineError, ProgramError
from ._machines import Axis, Machine, machines
from ._programs import Checked, check
from ._runs import Results, Run, Stream, Touch, simulate, stream
from ._steps import Kind, Steps
from ._tuning import Trace, Tuned, tune

__all__ = [
    "Arc",
    "Axis",
    "Board",
    "Checked",
    "Circle",
    "Command",
    "Commands",
    "Comparison",
    "Error",
    "Finding",
    "Fix",
    "Kind",
    "Line",
    "Machine",
    "MachineError",
    "Method",
    "ProgramError",
    "Results",
    "Run",
    "Steps",
    "Stream",
    "Touch",
    "Trace",
    "Tuned",
    "check",
    "commands",
    "compare",
    "holes",
    "machines",
    "simulate",
    "stream",
    "tune",
]
