"""What a firmware does at the registers of its board, by QEMU's trace of every access to them."""
import re

# To be given to QEMU, with `-D` and the file: enough for the pins, and for the times, too.
PINS = ["-trace", "memory_region_ops_write"]
ARGUMENTS = [*PINS, "-trace", "memory_region_ops_read", "-d", "int"]

ACCESS = re.compile(r"memory_region_ops_(write|read) .* addr 0x([0-9a-f]+) value 0x([0-9a-f]+) ")


class Microbit:
    """TIMER0 in microseconds; OUTCLR, then OUTSET tell all pins of a kind."""

    CLOCKS_PER_US = 1
    SENT, HEARD = 0x4000_251C, 0x4000_2518
    NOW = 0x4000_8544

    def __init__(self):
        self.low = 0

    @staticmethod
    def now(value):
        return value

    def write(self, address, value):
        if address == 0x4000_8540:
            return "due", value
        if address == 0x5000_050C:
            self.low = value
        if address == 0x5000_0508:
            if self.low | value == 0xF << 20:
                return "outputs", value >> 20
            return "motors", value >> 1 & 0x3F | value >> 5 & 0xC0
        return None


class Mps2:
    """TIMER1 counts down at 25 MHz; TIMER0 is given how long it takes from what was read there last."""

    CLOCKS_PER_US = 25
    SENT = HEARD = 0x4000_4000
    NOW = 0x4000_1004

    def __init__(self):
        self.at = 0

    def now(self, value):
        self.at = ~value & 0xFFFF_FFFF
        return self.at

    def write(self, address, value):
        if address == 0x4000_0004 and value not in (0, 0xFFFF_FFFF):
            return "due", self.at + value
        if address == 0x4001_07FC:
            return "motors", value
        if address == 0x4001_083C:
            return "outputs", value >> 8
        return None


class Virt:
    """mtime at 10 MHz, mtimecmp; the pins are those of the UART."""

    CLOCKS_PER_US = 10
    SENT = HEARD = 0x1000_0000
    NOW = 0x0200_BFF8

    @staticmethod
    def now(value):
        return value

    def write(self, address, value):
        # 0 is what it is set to when it is switched on.
        if address == 0x0200_4000 and value:
            return "due", value
        if address == 0x1000_0007:
            return "motors", value
        if address == 0x1000_0004:
            return "outputs", value
        return None


BOARDS = {"microbit": Microbit, "mps2-an386": Mps2, "virt": Virt}


def waits(board):
    """To be given to QEMU like those: enough for when pins are to be written. What is written says it, but on `mps2-an386`."""
    return ARGUMENTS[:4] if board == "mps2-an386" else PINS


class Made:
    """The motors' pins were written."""

    def __init__(self, levels, outputs, due, asked):
        self.levels, self.outputs = levels, outputs
        # When that was to be, and when it was read that it had been: clocks of the board, of 32 bits. `None`: nothing was waited for; that interrupt did
        # not read it, or there is no telling (`virt`, where QEMU does not log its end).
        self.due, self.at = due, None
        # The time that was read last before that wait began.
        self.asked = asked


class Switched:
    """The other outputs have changed."""

    def __init__(self, outputs):
        self.outputs = outputs


def read(board, lines, with_outputs=False):
    """All that was written to the motors' pins, and the bytes that were sent, in order: `Made` and numbers. Of the lines of a log.

    Where asked for, what has switched outputs, too: `Switched`.
    """
    registers = BOARDS[board]()
    happened, outputs, now, due, asked, last = [], 0, None, None, None, None
    for line in lines:
        found = ACCESS.search(line)
        if not found:
            if "successful exception return" in line:
                last = None
            continue
        address, value = int(found[2], 16), int(found[3], 16)
        if found[1] == "read":
            if address == registers.NOW:
                now = registers.now(value)
                if last:
                    last.at, last = now, None
            continue
        if address == registers.SENT:
            happened.append(value)
        written = registers.write(address, value)
        if not written:
            continue
        kind, value = written
        if kind == "due":
            due, asked = value & 0xFFFF_FFFF, now
        elif kind == "outputs":
            if with_outputs and value != outputs:
                happened.append(Switched(value))
            outputs = value
        else:
            made = Made(value, outputs, due, asked)
            due, last = None, None if board == "virt" else made
            happened.append(made)
    return happened
