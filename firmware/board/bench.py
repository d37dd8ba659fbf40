"""A firmware in QEMU: started, talked to at its UART, looked into at QEMU's monitor."""
import os
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time

TARGETS = {
    "microbit": "thumbv6m-none-eabi",
    "mps2-an386": "thumbv7em-none-eabihf",
    "virt": "riscv32imac-unknown-none-elf",
}

# Of every board.
RAM = 16384


def elf(program, board):
    """The path of the program."""
    return os.path.join(os.environ.get("CARGO_TARGET_DIR", "target"), TARGETS[board], "release", program)


class Elf:
    """Sections of a program of 32 bits, read from its headers: no tool for the target is needed."""

    def __init__(self, path):
        self.data = data = open(path, "rb").read()
        offset, = struct.unpack_from("<I", data, 0x20)
        size, count, names = struct.unpack_from("<HHH", data, 0x2E)
        raw = [struct.unpack_from("<10I", data, offset + index * size) for index in range(count)]

        def text(place):
            return data[place:data.index(b"\0", place)].decode()

        # Name to kind, flags, address, offset, length.
        self.sections = {text(raw[names][4] + section[0]): section[1:6] for section in raw}

    def flash(self):
        """Bytes that are loaded."""
        return sum(length for kind, flags, _, _, length in self.sections.values() if flags & 2 and kind != 8)

    def static(self, start):
        """Bytes from the start of RAM to the end of what is there from the start."""
        ends = [self.sections[name] for name in (".data", ".bss", ".uninit") if name in self.sections]
        return max(address + length for _, _, address, _, length in ends) - start

    def halfword(self, address):
        """The code there."""
        for kind, flags, begin, place, length in self.sections.values():
            if kind == 1 and flags & 2 and begin <= address < begin + length:
                return struct.unpack_from("<H", self.data, place + address - begin)[0]
        return 0


def figures(program, bench, ram):
    """Prints flash, static RAM and the deepest stack: RAM is zero when QEMU starts, so it came down to the lowest byte above the statics that is not."""
    image = Elf(elf(program, bench.board))
    static = image.static(bench.start)
    deepest = next((place for place in range(static, RAM) if ram[place]), RAM)
    for name, value in (("flash", image.flash()), ("static", static), ("stack", RAM - deepest)):
        print(bench.board, name, value)


def send(husillo, file, machine, port, *arguments, answer=r"Steps +(\d+), each as in the simulator"):
    """Has the host send a file; the groups of its answer."""
    sent = subprocess.run([husillo, "send", file, "-m", machine, "--port", port, *arguments], capture_output=True, text=True, timeout=300)
    found = re.findall(answer, sent.stdout)
    if sent.returncode or not found:
        sys.exit(sent.stdout + sent.stderr)
    return found


class Bench:
    """A firmware that runs, its UART as a socket."""

    def __init__(self, program, board, *arguments):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.qemu = subprocess.Popen(
            ["./qemu", program, board, str(self.port), *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "MONITOR": "1"})
        assert self.qemu.stdout.readline().startswith(b"husillo")
        self.line, self.board = None, board
        self.start = 0x8010_0000 if board == "virt" else 0x2000_0000

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.line:
            self.line.close()
        self.qemu.kill()
        self.qemu.wait()

    def booted(self):
        """Waits until it listens and the firmware has begun."""
        self.monitor("info status")
        time.sleep(1)

    def ram(self):
        """What is in it, as the processor sees it: the microbit's is on no other bus."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "ram")
            self.monitor(f'memsave {self.start:#x} {RAM} "{path}"')
            return open(path, "rb").read()

    def connect(self):
        """Opens the line; the firmware may be booting still."""
        for _ in range(100):
            try:
                self.line = socket.create_connection(("127.0.0.1", self.port))
                self.line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                return
            except ConnectionRefusedError:
                time.sleep(0.1)
        raise SystemExit("QEMU does not listen")

    def receive(self, seconds):
        """What comes within that time, at least a byte; nothing then is an empty string."""
        self.line.settimeout(seconds)
        try:
            return self.line.recv(65536)
        except TimeoutError:
            return b""

    def monitor(self, command):
        """A command to QEMU's monitor, carried out when this returns: the lines it says."""
        self.qemu.stdin.write(command.encode() + b"\nprint 1234567\n")
        self.qemu.stdin.flush()
        lines = []
        # The prompt repeats what is typed: only the answer, in hexadecimal, is a line of its own.
        while (line := self.qemu.stdout.readline().strip()) != b"0x12d687":
            lines.append(line.decode())
        return lines

    def word(self, address):
        """What the processor reads there."""
        for line in self.monitor(f"x /1xw {address:#x}"):
            if found := re.fullmatch(r"[0-9a-f]+: 0x([0-9a-f]+)", line):
                return int(found[1], 16)
        raise SystemExit(f"nothing at {address:#x}")
