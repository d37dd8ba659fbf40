"""The command line of all checks: `firmware/check NAME ...`, `firmware/qemu PRODUCT ...`,
`firmware/image PRODUCT BOARD` and `firmware/cycles SOURCE`."""

from __future__ import annotations

import argparse
import os
import sys
from importlib import import_module

from husillo_firmware import boards, build, image, qemu
from proofs.cycles import table

CHECKS = {
    "micromill": "products.micromill.check",
    "drill": "products.drill.check",
    "microfactory": "products.microfactory.check",
    "servo_module": "products.servo_module.check",
    "grbl": "products.grbl.check",
    "simulated": "products.grbl.simulated",
    "counts": "proofs.counts.check",
    "cycles": "proofs.cycles.check",
    "sizes": "proofs.sizes.check",
}


def run(arguments: list[str]) -> None:
    """Builds a firmware and runs it in QEMU."""
    options = argparse.ArgumentParser(prog="firmware/qemu", description=run.__doc__)
    options.add_argument("product", choices=[name for name in CHECKS if is_product(name)])
    options.add_argument("board", nargs="?", type=boards.named, default=boards.MPS2)
    options.add_argument("port", nargs="?", type=int, default=7000)
    options.add_argument("--features", default="", help="of the firmware, for example faithful")
    options.add_argument(
        "--slow", action="store_true", help="keep to wall-clock time, without jumps"
    )
    options.add_argument("qemu", nargs="*", help="further arguments of QEMU, after --")
    chosen = options.parse_args(arguments)
    elf = build.firmware(chosen.product, chosen.board, chosen.features)
    port = f"--port tcp:127.0.0.1:{chosen.port}"
    if chosen.product == "servo_module":
        print(f"husillo measure -m cmm {port} home x goto 1200 touch + touch -", flush=True)
    elif chosen.product == "grbl":
        print(f"husillo send PROGRAM -m grbl {port}, or any sender of Grbl", flush=True)
    else:
        print(f"husillo send PROGRAM -m {chosen.product} {port}", flush=True)
    command = qemu.command(elf, chosen.board, chosen.port, "none", chosen.slow) + chosen.qemu
    os.execvp(command[0], command)


def is_product(name: str) -> bool:
    """Whether the check of this name is that of a product, in QEMU."""
    return CHECKS[name] == f"products.{name}.check"


def main(arguments: list[str]) -> int:
    """Runs a check by its name. Returns the exit status."""
    if arguments[:1] == ["qemu"]:
        run(arguments[1:])
    if arguments[:1] == ["image"]:
        return image.main(arguments[1:])
    if arguments[:1] == ["cycles-table"]:
        return table.main(arguments[1:])
    if not arguments or arguments[0] not in CHECKS:
        print(f"firmware/check {'|'.join(CHECKS)} [--help]", file=sys.stderr)
        return 2
    status: int = import_module(CHECKS[arguments[0]]).main(arguments[1:])
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
