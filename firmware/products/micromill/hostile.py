"""hostile.py BOARD BYTES [SEED]: random bytes, over-long lines, strings cut short and resets against the firmware.

It never hangs, the motors stay within the travel after homing and above the switches before it, and in the end a line is obeyed as ever.
"""
import random
import sys
import time

from link import DONE, NO_SWITCH, STEPS, STOPPED, TAKEN, Mill

board, wanted = sys.argv[1], int(sys.argv[2])
seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
random.seed(seed)
READY = b"\x88"
LASH = (1457, 1271, 0)
TRAVEL = (71_429, 50_000, None)
# Without `H`, `B` and `R`: the limits of a machine that homes anew, has another lash or does not tell all steps would not be known here.
BYTES = bytes(byte for byte in range(256) if byte not in b"HBR")
STRINGS = [
    b"JX-;", b"JX+;", b"&X-Y-;", b"&X+Y+Z-;", b"PX-9999;", b"PY+9999;", b"FY-390;", b"FX+390;", b"G00X10000Y07000;", b"G28X0Y0;", b"S1;", b"S0;",
    b"G01X00100Y00050F99;", b"G02X00300Y00000I00150J00000F9999;", b"W;", b"V;", b"L0100;", b"L;", b"Q;", b"G54;", b"A;", b"G04P01;", b"M03S1000;", b"M30;",
]


def attack():
    """Some bytes."""
    kind = random.randrange(8)
    if kind < 3:
        return bytes(random.choices(BYTES, k=random.randrange(1, 64)))
    if kind == 3:
        # Over-long, with an end or without.
        return bytes(random.choices(b"0123456789GXY.-", k=random.randrange(60, 400))) + random.choice((b"", b";"))
    string = random.choice(STRINGS)
    if kind == 4:
        return string[:random.randrange(len(string))]
    if kind == 5:
        place = random.randrange(len(string))
        return string[:place] + bytes([random.choice(BYTES)]) + string[place + 1:]
    return string


class Watch:
    """Where the motors are, by the steps told."""

    def __init__(self):
        self.steps = 0
        self.start(False)

    def start(self, is_homed):
        self.at, self.is_homed = [0, 0, 0], is_homed

    def hear(self, said):
        for byte in said:
            if byte in STEPS:
                self.steps += 1
                axis = byte >> 1 & 3
                self.at[axis] += 1 if byte & 1 else -1
        for axis, (at, lash, travel) in enumerate(zip(self.at, LASH, TRAVEL)):
            # A motor is behind its load by the lash at most. Before homing the switches close at -400.
            low = (-lash if travel else -10**9) if self.is_homed else -401
            high = travel if self.is_homed and travel else 10**9
            if not low <= at <= high:
                sys.exit(f"{board}, seed {seed}: axis {axis} at motor step {at}, homed: {self.is_homed}")


with Mill(board) as mill:
    watch = Watch()
    watch.hear(mill.receive(1))

    def calm():
        """All stops, and the line is free of what was begun."""
        for _ in range(50):
            mill.line.send(b"A;")
            said = mill.receive(2)
            # A run that goes on because its `A` was lost is not waited for.
            for _ in range(200):
                if not (more := mill.receive(0.1)):
                    break
                said += more
            watch.hear(said)
            # Bytes get lost where more come than there is room for, so it may be asked for again.
            if said:
                answer = mill.ask(b"S0;")
                watch.hear(answer)
                if answer[-1] == TAKEN:
                    return
        sys.exit(f"{board}, seed {seed}: no answer")

    def home():
        # On a busy host hostile bytes may still be on their way: they stop it.
        for _ in range(9):
            calm()
            said = mill.ask(b"H;", (DONE, NO_SWITCH, STOPPED))
            if said[-1] == DONE:
                watch.start(True)
                return
            watch.hear(said)
        sys.exit(f"{board}, seed {seed}: homing ended with {said[-1]:#x}")

    sent = resets = 0
    begin = time.time()
    home()
    while sent < wanted:
        burst = b"".join(attack() for _ in range(random.randrange(1, 20)))
        for place in range(0, len(burst), 256):
            part = burst[place:place + 256]
            mill.line.send(part)
            # As fast as it echoes them, lost ones left out: QEMU keeps what a UART has no room for, without end.
            echoes, end = 0, time.time() + 1
            while echoes < len(part) and time.time() < end and (said := mill.receive(0.02)):
                watch.hear(said)
                echoes += sum(byte not in STEPS for byte in said)
        sent += len(burst)
        if random.randrange(4) == 0:
            # Something moves for a while: in virtual time that is long, and all of its steps come.
            mill.line.send(b"A;" + random.choice((b"JX+;", b"&X+Y+;", b"FY+390;", b"JX-;", b"G28X0Y0;")))
            end = time.time() + 0.02
            while time.time() < end:
                watch.hear(mill.receive(0.002))
            mill.line.send(b"A;")
        if random.randrange(40) == 0:
            # In the middle of whatever it is.
            mill.monitor("system_reset")
            resets += 1
            said = b""
            while READY not in said:
                if not (more := mill.receive(10)):
                    sys.exit(f"{board}, seed {seed}: not ready after a reset")
                said += more
            # Bytes that were on their way may move it already.
            watch.start(False)
            watch.hear(said.rpartition(READY)[2])
            if random.randrange(2):
                home()
    home()
    said = mill.ask(b"PX+0071;")
    watch.hear(said)
    if said[-1] != DONE or watch.at != [71, 0, 0]:
        sys.exit(f"{board}, seed {seed}: the steps after it ended with {said[-1]:#x} at {watch.at}")
print(f"{board}: {sent} hostile bytes, {watch.steps} steps, {resets} resets, {time.time() - begin:.0f} s")
