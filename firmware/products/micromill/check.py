"""The host cuts a program: every step, wait, phase and byte must be as in the host's files.

Then stops, jogs, hosts that are asked to end and hostile bytes are checked, and instructions are
counted.
"""

from __future__ import annotations

from collections.abc import Iterator

from husillo_firmware import boards, product
from husillo_firmware.boards import Board
from husillo_firmware.build import FIRMWARE

from products.micromill import count, hostile, interrupt, jog, limits, modes, program, stop

PROGRAM = FIRMWARE / "products/micromill/program.nc"
# Half a million steps.
CIRCLES = FIRMWARE.parent / "examples/circles.nc"
HOSTILE_BYTES = 5000


def all_of(board: Board, hostile_bytes: int) -> Iterator[tuple[str, int]]:
    """Checks the firmware on a board. Yields the figures."""
    yield from program.cut(board, PROGRAM, is_traced=True)
    stop.check(board)
    jog.check(board)
    interrupt.check(board)
    hostile.check(board, hostile_bytes)
    modes.check(board)
    yield from count.count(board)


def main(arguments: list[str]) -> int:
    """Checks the firmware on all boards."""
    parser = product.parser("micromill", __doc__)
    parser.add_argument("--circles", action="store_true", help="only cut examples/circles.nc")
    parser.add_argument(
        "--hostile",
        type=int,
        default=HOSTILE_BYTES,
        metavar="BYTES",
        help="how many hostile bytes are sent",
    )
    options = parser.parse_args(arguments)
    chosen = options.boards or boards.ALL
    if options.circles:
        product.measure(
            "micromill", chosen, lambda board: program.cut(board, CIRCLES, is_traced=False)
        )
        return 0
    figures = product.measure("micromill", chosen, lambda board: all_of(board, options.hostile))
    exceeded = limits.exceeded(figures)
    for one in exceeded:
        print(one)
    return 1 if exceeded else product.settle("micromill", options, figures)
