"""run.py BOARD HUSILLO: starts the firmware in QEMU, measures with it, compares with the simulator, prints flash, static RAM and the deepest stack."""
import json, os, socket, struct, subprocess, sys, tempfile, time

board, husillo = sys.argv[1:3]
target, start = {
    "microbit": ("thumbv6m-none-eabi", 0x2000_0000),
    "mps2-an386": ("thumbv7em-none-eabihf", 0x2000_0000),
    "virt": ("riscv32imac-unknown-none-elf", 0x8010_0000),
}[board]
RAM = 3840
# Home on the index, trapezoids, the probe both ways, a jog, the state at the end.
ACTIONS = "home x goto 1200 goto -777 goto 3 touch + touch - --repeat 3 goto 0 zero goto 250 jog -x 1s slow status".split()


def measure(*where):
    return subprocess.run([husillo, "measure", "-m", "cmm", *ACTIONS, *where, "--format", "json"], capture_output=True, text=True, timeout=300)


simulated = measure("--contact", "1:1500", "--contact", "1:..-1500")
with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
qemu = subprocess.Popen(["./qemu", "cmm", board, str(port)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "MONITOR": "1"})
assert qemu.stdout.readline().startswith(b"husillo measure")
try:
    for _ in range(10):
        time.sleep(1)
        measured = measure("--port", f"tcp:127.0.0.1:{port}")
        if "refused" not in measured.stderr:
            break
    if simulated.returncode or measured.returncode:
        sys.exit(simulated.stderr + measured.stdout + measured.stderr)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "ram")
        # As the processor sees it: the microbit's RAM is on no other bus.
        qemu.stdin.write(f'memsave {start:#x} {RAM} "{path}"\nquit\n'.encode())
        qemu.stdin.flush()
        qemu.wait(20)
        ram = open(path, "rb").read()
finally:
    qemu.kill()

# A motor rests within a count of its goal, here and there; where contacts are is latched, to the count. A jog is as long as the host's clock says.
TOLERANCES = {"trigger": 0, "corrected": 0, "pre_travel": 0, "spread": 0, "touches": 0, "position": 2}
rows = [json.loads(run.stdout) for run in (simulated, measured)]
assert len(rows[0]) == len(rows[1]) == 11, rows
for expected, found in zip(*rows):
    is_jog = expected["action"].startswith(("jog", "status"))
    for key, tolerance in TOLERANCES.items():
        if isinstance(expected.get(key), (int, float)) and not (is_jog and key == "position"):
            assert abs(expected[key] - found[key]) <= tolerance, f"{board}: {found} instead of {expected}"
print(board, "results", len(rows[1]))

# Sections of the program, read from its headers: what is loaded, and what RAM holds from the start.
data = open(os.path.join(os.environ.get("CARGO_TARGET_DIR", "target"), target, "release/cmm"), "rb").read()
offset, = struct.unpack_from("<I", data, 0x20)
size, count, names = struct.unpack_from("<HHH", data, 0x2E)
names, = struct.unpack_from("<I", data, offset + names * size + 16)
flash = static = 0
for index in range(count):
    name, kind, flags, address, _, length = struct.unpack_from("<6I", data, offset + index * size)
    name = data[names + name:data.index(b"\0", names + name)]
    if flags & 2 and kind != 8:
        flash += length
    if flags & 2 and name in (b".data", b".bss", b".uninit"):
        static = max(static, address + length - start)
# RAM is zero when QEMU starts: the stack came down to the lowest byte above the statics that is not.
deepest = next((place for place in range(static, RAM) if ram[place]), RAM)
for name, value in (("flash", flash), ("static", static), ("stack", RAM - deepest)):
    print(board, name, value)
