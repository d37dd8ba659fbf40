"""Runs a firmware in QEMU with its UART at a port, and reads its state by QEMU's monitor."""

from __future__ import annotations

import re
import socket
import subprocess
import tempfile
from pathlib import Path

from husillo_firmware import build
from husillo_firmware.boards import Board
from husillo_firmware.elf import Elf
from husillo_firmware.waiting import Lines, fail, pipe_of, until

# No answer of QEMU takes longer, even if it logs every instruction on a busy computer.
ANSWER_S = 120
BOOT_S = 60


def command(elf: Path, board: Board, port: int, monitor: str, in_wall_time: bool) -> list[str]:
    """The command that starts QEMU with a firmware and its UART at a TCP port.

    Virtual time advances with the executed instructions. It jumps while the chip sleeps, so a move
    takes only as long as its computation. With `in_wall_time`, it keeps to wall-clock time.
    """
    sleep = "on" if in_wall_time else "off"
    return [
        *board.qemu,
        *("-icount", f"shift=6,sleep={sleep}", "-M", board.machine or board.name),
        # There is no network: on virt, its timers alone could keep virtual time running while the
        # monitor and the line wait forever.
        *("-nic", "none", "-display", "none", "-monitor", monitor),
        *(["-serial", "null"] * board.serial),
        *("-serial", f"tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"),
        *("-kernel", str(elf)),
    ]


def free_port() -> int:
    """A free TCP port of this computer."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
        return number


class Firmware:
    """A running firmware. Further arguments are passed to QEMU."""

    def __init__(
        self,
        program: str,
        board: Board,
        *arguments: str,
        features: str = "",
        in_wall_time: bool = False,
    ) -> None:
        self.program, self.board, self.port = program, board, free_port()
        self.elf = Elf(build.firmware(program, board, features))
        started = command(self.elf.path, board, self.port, "stdio", in_wall_time)
        self.qemu = subprocess.Popen(
            [*started, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self.said = Lines(self.qemu)
        self.socket: socket.socket | None = None

    def __enter__(self) -> Firmware:
        return self

    def __exit__(self, *_: object) -> None:
        if self.socket:
            self.socket.close()
        self.qemu.kill()
        self.qemu.communicate()

    @property
    def tcp(self) -> str:
        """The port, as an option of the host program."""
        return f"tcp:127.0.0.1:{self.port}"

    def booted(self) -> None:
        """Waits until the firmware sleeps, because it then waits for bytes."""
        until(self.sleeps, BOOT_S, f"{self.board}: {self.program} does not sleep")

    def sleeps(self) -> bool:
        """Whether the processor is at an instruction that waits for interrupts."""
        for line in self.monitor("info registers"):
            if found := re.search(r"(?:R15=|\bpc +)([0-9a-f]{8})", line):
                return self.is_sleep(int(found[1], 16) - (4 if self.board.name == "virt" else 2))
        fail(f"{self.board}: QEMU reports no program counter")

    def is_sleep(self, address: int) -> bool:
        """Whether the instruction at this address is `wfi`."""
        code = self.elf.halfword(address)
        if self.board.name == "virt":
            return code == 0x0073 and self.elf.halfword(address + 2) == 0x1050
        return code == 0xBF30

    def ram(self) -> bytes:
        """The contents of RAM, read by the processor: the microbit's RAM is on no other bus."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "ram"
            self.monitor(f'memsave {self.board.ram_start:#x} {self.board.ram} "{path}"')
            return path.read_bytes()

    def connect(self) -> None:
        """Opens the line. The firmware may still be booting."""
        until(self.connects, BOOT_S, f"{self.board}: QEMU does not listen")

    def connects(self) -> bool:
        """Tries to open the line. Returns whether it is open."""
        try:
            self.socket = socket.create_connection(("127.0.0.1", self.port))
        except ConnectionRefusedError:
            return False
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return True

    @property
    def line(self) -> socket.socket:
        """The line. `connect` must have opened it."""
        assert self.socket is not None, "connect comes first"
        return self.socket

    def receive(self, seconds: float) -> bytes:
        """Returns the next bytes. Returns none if no byte comes within that time."""
        self.line.settimeout(seconds)
        try:
            return self.line.recv(65536)
        except TimeoutError:
            return b""

    def monitor(self, asked: str) -> list[str]:
        """Has QEMU's monitor carry out a command. Returns the lines of its answer."""
        pipe = pipe_of(self.qemu.stdin)
        pipe.write(asked.encode() + b"\nprint 1234567\n")
        pipe.flush()
        lines = []
        # The prompt echoes the input. Only the answer, in hexadecimal, is a whole line.
        while (line := self.said.next(ANSWER_S)) != "0x12d687":
            lines.append(line)
        return lines

    def memory(self, ram: bytes) -> dict[str, int]:
        """The bytes of flash, of static RAM, and of the deepest stack.

        RAM is zero when QEMU starts. So the stack has reached the lowest byte above the static data
        that is not zero.
        """
        static = self.elf.static(self.board.ram_start)
        end = self.board.ram
        deepest = next((place for place in range(static, end) if ram[place]), end)
        return {"flash": self.elf.flash(), "static": static, "stack": end - deepest}
