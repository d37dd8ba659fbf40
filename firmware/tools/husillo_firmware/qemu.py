"""A firmware in QEMU: started, talked to at its UART, looked into at QEMU's monitor."""

from __future__ import annotations

import re
import socket
import subprocess
import tempfile
from pathlib import Path

from husillo_firmware import build
from husillo_firmware.boards import RAM, Board
from husillo_firmware.elf import Elf
from husillo_firmware.waiting import Lines, fail, pipe_of, until

# Longer than QEMU takes for any answer where it logs every instruction on a busy computer.
ANSWER_S = 120
BOOT_S = 60


def command(elf: Path, board: Board, port: int, monitor: str, in_wall_time: bool) -> list[str]:
    """How QEMU is started with a firmware, its UART at a TCP port.

    Virtual time goes by executed instructions. It jumps where the chip sleeps, so moves take as
    long as they are computed; or else it keeps to the clock on the wall.
    """
    sleep = "on" if in_wall_time else "off"
    return [
        *board.qemu,
        *("-icount", f"shift=6,sleep={sleep}", "-M", board.name),
        # Without a network: on virt its timers alone could keep virtual time running, and the
        # monitor and the line waiting for ever.
        *("-nic", "none", "-display", "none", "-monitor", monitor),
        *("-serial", f"tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"),
        *("-kernel", str(elf)),
    ]


def free_port() -> int:
    """A TCP port of this computer that nobody has."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
        return number


class Firmware:
    """A firmware that runs. Further arguments are QEMU's."""

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
        """The port as the host's program takes it."""
        return f"tcp:127.0.0.1:{self.port}"

    def booted(self) -> None:
        """Waits until it sleeps: it listens, and waits for bytes."""
        until(self.sleeps, BOOT_S, f"{self.board}: {self.program} does not sleep")

    def sleeps(self) -> bool:
        """Whether the processor stands behind an instruction that waits for interrupts."""
        for line in self.monitor("info registers"):
            if found := re.search(r"(?:R15=|\bpc +)([0-9a-f]{8})", line):
                return self.is_sleep(int(found[1], 16) - (4 if self.board.name == "virt" else 2))
        fail(f"{self.board}: QEMU names no program counter")

    def is_sleep(self, address: int) -> bool:
        """Whether the instruction there is `wfi`."""
        code = self.elf.halfword(address)
        if self.board.name == "virt":
            return code == 0x0073 and self.elf.halfword(address + 2) == 0x1050
        return code == 0xBF30

    def ram(self) -> bytes:
        """What is in it, as the processor sees it: the microbit's is on no other bus."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "ram"
            self.monitor(f'memsave {self.board.ram_start:#x} {RAM} "{path}"')
            return path.read_bytes()

    def connect(self) -> None:
        """Opens the line; the firmware may be booting still."""
        until(self.connects, BOOT_S, f"{self.board}: QEMU does not listen")

    def connects(self) -> bool:
        """Tries to open the line."""
        try:
            self.socket = socket.create_connection(("127.0.0.1", self.port))
        except ConnectionRefusedError:
            return False
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return True

    @property
    def line(self) -> socket.socket:
        """The line, which was opened."""
        assert self.socket is not None, "connect comes first"
        return self.socket

    def receive(self, seconds: float) -> bytes:
        """What comes within that time, at least a byte; nothing then is an empty string."""
        self.line.settimeout(seconds)
        try:
            return self.line.recv(65536)
        except TimeoutError:
            return b""

    def monitor(self, asked: str) -> list[str]:
        """A command to QEMU's monitor, carried out when this returns: the lines it says."""
        pipe = pipe_of(self.qemu.stdin)
        pipe.write(asked.encode() + b"\nprint 1234567\n")
        pipe.flush()
        lines = []
        # The prompt repeats what is typed: only the answer, in hexadecimal, is a line of its own.
        while (line := self.said.next(ANSWER_S)) != "0x12d687":
            lines.append(line)
        return lines

    def memory(self, ram: bytes) -> dict[str, int]:
        """Bytes of flash, of static RAM, and of the deepest stack.

        RAM is zero when QEMU starts: the stack came down to the lowest byte above the statics that
        is not.
        """
        static = self.elf.static(self.board.ram_start)
        deepest = next((place for place in range(static, RAM) if ram[place]), RAM)
        return {"flash": self.elf.flash(), "static": static, "stack": RAM - deepest}
