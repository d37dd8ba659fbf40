"""run.py BOARD HUSILLO PROGRAM: starts the firmware in QEMU, sends a program to it, and prints steps, flash, static RAM and the deepest stack."""
import os, re, socket, struct, subprocess, sys, tempfile, time

board, husillo, program = sys.argv[1:4]
target, start = {
    "microbit": ("thumbv6m-none-eabi", 0x2000_0000),
    "mps2-an386": ("thumbv7em-none-eabihf", 0x2000_0000),
    "virt": ("riscv32imac-unknown-none-elf", 0x8010_0000),
}[board]
RAM = 3840

with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
qemu = subprocess.Popen(["./qemu", "micromill", board, str(port)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "MONITOR": "1"})
assert qemu.stdout.readline().startswith(b"husillo send")
try:
    for _ in range(5):
        time.sleep(1)
        sent = subprocess.run([husillo, "send", program, "-m", "micromill", "--port", f"tcp:127.0.0.1:{port}"], capture_output=True, text=True, timeout=200)
        # Not listening yet, or just booting.
        if not re.search("refused|was reset|stop:", sent.stderr):
            break
    if sent.returncode:
        sys.exit(sent.stdout + sent.stderr)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "ram")
        # As the processor sees it: the microbit's RAM is on no other bus.
        qemu.stdin.write(f'memsave {start:#x} {RAM} "{path}"\nquit\n'.encode())
        qemu.stdin.flush()
        qemu.wait(20)
        ram = open(path, "rb").read()
finally:
    qemu.kill()

# Sections of the program, read from its headers: what is loaded, and what RAM holds from the start.
data = open(os.path.join(os.environ.get("CARGO_TARGET_DIR", "target"), target, "release/micromill"), "rb").read()
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
steps, = re.findall(r"Steps +(\d+), each as in the simulator", sent.stdout)
for name, value in (("steps", steps), ("flash", flash), ("static", static), ("stack", RAM - deepest)):
    print(board, name, value)
