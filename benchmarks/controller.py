"""Measures `aircut time` against LinuxCNC's own motion controller, which runs the same programs in real time.

    python benchmarks/controller.py [-o table.md] [name ...]

Needs the Debian package linuxcnc-uspace, and to be root or a user that may run it (root runs it as nobody).
It makes a simulated machine with the limits below, no hardware, no display; a script in place of the display
starts each program, and every cycle (1 ms) of the commanded position is written down by HAL's sampler.
The measured time is from the first to the last cycle in which something moves.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

VELOCITY, ACCELERATION = 100.0, 500.0  # mm/s, mm/s² of each axis
CYCLE = 0.001
JUMPS = 0.0002  # s: at a joint LinuxCNC leaves a tenth of the acceleration of a cycle to jumps, aircut a half
OWNER = 65534  # nobody

# --- programs


def polygon(sides: int, radius: float, x: float = 0.0, y: float = 0.0) -> str:
    angles = [math.tau * i / sides for i in range(1, sides + 1)]
    return "\n".join(f"G1 X{x + radius * math.cos(a):.4f} Y{y + radius * math.sin(a):.4f}" for a in angles)


def wave(step: float, length: float, height: float = 5.0) -> str:
    count = round(length / step)
    xs = [step * i for i in range(1, count + 1)]
    return "\n".join(f"G1 X{x:.4f} Y{height * math.sin(x / 5):.4f} Z{2 * math.cos(x / 3):.4f}" for x in xs)


def zigzag(count: int, side: float) -> str:
    return "\n".join(f"G1 X{side * (i // 2 + i % 2):.3f} Y{side * (i % 2):.3f}" for i in range(1, count + 1))


def pocket(size: float, step: float) -> str:
    lines = []
    for i in range(int(size / 2 / step)):
        a, b = i * step, size - i * step
        lines += [f"G1 X{a} Y{a}", f"G1 X{b} Y{a}", f"G1 X{b} Y{b}", f"G1 X{a} Y{b}", f"G1 X{a} Y{a}"]
    return "\n".join(lines)


SQUARES = "G1 " + 3 * "X40\nY40\nX0\nY0\nX20\nY20\nX0\nY0\n"
ROUNDED = 2 * "G1 X30\nG3 X40 Y10 J10\nG1 Y30\nG3 X30 Y40 I-10\nG1 X10\nG3 X0 Y30 J-10\nG1 Y10\nG3 X10 Y0 I10\n"
CONTOURS = "".join(
    f"G0 X{25 * i} Y0\nG0 Z1\nG1 Z-2 F600\nG1 X{25 * i + 20} F2400\nG1 Y15\nG1 X{25 * i} Y20\nG1 Y0\nG1 Z1\nG0 Z10\n"
    for i in range(4)
)
HOLES = "\n".join(f"G0 X{10 * i} Y{7 * (i % 3)}\nG0 Z1\nG1 Z-8\nG4 P0.5\nG0 Z10" for i in range(1, 9))
HELICES = "G0 X10 Z0\nG2 X10 Y0 I-10 Z-5 P5\nG3 X10 Y0 I-10 Z0 P5\nG2 X-10 Y0 I-10 Z-1\nG18 G2 X10 Z-1 I10\nG17"
RAPIDS = "\n".join(f"G0 X{(37 * i) % 90} Y{(53 * i) % 70} Z{(11 * i) % 30}" for i in range(1, 16))

PROGRAMS = {
    "squares, exact stop (G61.1)": f"G61.1 F3000\n{SQUARES}",
    "squares, exact path (G61)": f"G61 F3000\n{SQUARES}",
    "squares, G64 P0.05": f"G64 P0.05 Q0 F3000\n{SQUARES}",
    "squares, G64 P0.5": f"G64 P0.5 Q0 F3000\n{SQUARES}",
    "squares, G64 P2": f"G64 P2 Q0 F5000\n{SQUARES}",
    "rounded square, G61": f"G61 F2400\nG0 X10\n{ROUNDED}",
    "rounded square, G64 P0.1": f"G64 P0.1 Q0 F2400\nG0 X10\n{ROUNDED}",
    "circles, G61": "G61 F4000\nG2 I20\nG3 I5\nG2 I2\nG3 I40 F6000",
    "helices in two planes, G64 P0.01": f"G64 P0.01 Q0 F2000\n{HELICES}",
    "rapids, G61.1": f"G61.1\n{RAPIDS}",
    "drilling with dwells, G61.1": f"G61.1 F600\nG0 Z10\n{HOLES}",
    "rapids, G64 P0.2": f"G64 P0.2 Q0\n{RAPIDS}",
    "drilling with dwells, G64 P0.1": f"G64 P0.1 Q0 F600\nG0 Z10\n{HOLES}",
    "contours with retracts, G64 P0.1": f"G64 P0.1 Q0\nG0 Z10\n{CONTOURS}",
    "zigzag, G64 P0.1": f"G64 P0.1 Q0 F3000\n{zigzag(40, 4)}",
    "pocket of squares, G64 P0.05": f"G64 P0.05 Q0 F2400\n{pocket(40, 4)}",
    "polygon of 90 sides, G61": f"G61 F600\nG0 X20\n{polygon(90, 20)}",
    "polygon of 24 sides, G64 P0.02": f"G64 P0.02 Q0 F3000\nG0 X20\n{polygon(24, 20)}\n{polygon(24, 20)}",
    "dense: circle of 360 sides, G64 P0.01": f"G64 P0.01 Q0 F3000\nG0 X20\n{polygon(360, 20)}",
    "dense: wave of 0.5 mm, G64 P0.02": f"G64 P0.02 Q0 F2400\nG0 Z2\n{wave(0.5, 150)}",
    "dense: wave of 0.2 mm, G64 P0.01": f"G64 P0.01 Q0 F1800\nG0 Z2\n{wave(0.2, 100)}",
}


def program(body: str) -> str:
    return f"G21 G17 G90 G94 G40 G49 G54\n{body}\nM2\n"


# --- the controller

INI = """[EMC]
VERSION = 1.1
MACHINE = measure
[DISPLAY]
DISPLAY = {display}
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[RS274NGC]
PARAMETER_FILE = {folder}/measure.var
[EMCMOT]
EMCMOT = motmod
SERVO_PERIOD = 1000000
[HAL]
HALFILE = {folder}/measure.hal
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = {v}
MAX_LINEAR_VELOCITY = {path_v}
DEFAULT_LINEAR_ACCELERATION = {path_a}
MAX_LINEAR_ACCELERATION = {path_a}
NO_FORCE_HOMING = 1
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.01
TOOL_TABLE = {folder}/measure.tbl
[KINS]
KINEMATICS = trivkins
JOINTS = 3
"""
AXIS = """[AXIS_{letter}]
MIN_LIMIT = -1000
MAX_LIMIT = 1000
MAX_VELOCITY = {v}
MAX_ACCELERATION = {a}
[JOINT_{number}]
TYPE = LINEAR
MIN_LIMIT = -1000
MAX_LIMIT = 1000
MAX_VELOCITY = {v}
MAX_ACCELERATION = {a}
FERROR = 100
MIN_FERROR = 100
HOME = 0
HOME_SEQUENCE = 0
"""
HAL = """loadrt trivkins
loadrt motmod servo_period_nsec=1000000 num_joints=3
loadrt sampler depth=16000 cfg=fff
addf motion-command-handler servo-thread
addf motion-controller servo-thread
addf sampler.0 servo-thread
net j0 joint.0.motor-pos-cmd joint.0.motor-pos-fb sampler.0.pin.0
net j1 joint.1.motor-pos-cmd joint.1.motor-pos-fb sampler.0.pin.1
net j2 joint.2.motor-pos-cmd joint.2.motor-pos-fb sampler.0.pin.2
net estop iocontrol.0.user-enable-out iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare iocontrol.0.tool-prepared
net change iocontrol.0.tool-change iocontrol.0.tool-changed
"""


def configure(folder: Path) -> Path:
    """Write the simulated machine; returns its INI file."""
    display = folder / "display.sh"
    display.write_text(f"#!/bin/sh\nexec /usr/bin/python3 {folder}/controller.py --display {folder}\n")
    display.chmod(0o755)
    shutil.copy(__file__, folder / "controller.py")
    # The path's own limits are out of the way: only those of the axes hold.
    ini = INI.format(folder=folder, display=display, v=VELOCITY, path_v=10 * VELOCITY, path_a=10 * ACCELERATION)
    for number, letter in enumerate("XYZ"):
        ini += AXIS.format(letter=letter, number=number, v=VELOCITY, a=ACCELERATION)
    (folder / "measure.ini").write_text(ini)
    (folder / "measure.hal").write_text(HAL)
    (folder / "measure.tbl").write_text("T1 P1 D1 ;\n")
    return folder / "measure.ini"


def display(folder: Path) -> None:
    """Runs in place of LinuxCNC's display, under the system's Python: runs the programs one after the other."""
    import linuxcnc

    command, status = linuxcnc.command(), linuxcnc.stat()

    def settled(mode: int) -> None:
        command.mode(mode)
        command.wait_complete()

    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete()
    command.state(linuxcnc.STATE_ON)
    command.wait_complete()
    command.teleop_enable(0)
    command.wait_complete()
    for joint in range(3):
        command.home(joint)
    started = time.time()
    while time.time() - started < 10:
        status.poll()
        if all(status.homed[:3]):
            break
        time.sleep(0.1)
    sampler = subprocess.Popen(["halsampler", "-t"], stdout=(folder / "samples.txt").open("w"))
    try:
        for number, _ in enumerate(json.loads((folder / "programs.json").read_text())):
            settled(linuxcnc.MODE_MDI)
            for text in ("G21 G90 G61.1 G54", "G0 Z0", "G0 X0 Y0"):
                command.mdi(text)
                command.wait_complete(60)
            time.sleep(0.3)
            settled(linuxcnc.MODE_AUTO)
            command.program_open(str(folder / f"{number}.ngc"))
            begin = (folder / "samples.txt").stat().st_size
            command.auto(linuxcnc.AUTO_RUN, 0)
            time.sleep(0.2)
            while True:
                status.poll()
                idle = status.interp_state == linuxcnc.INTERP_IDLE and status.exec_state == linuxcnc.EXEC_DONE
                if idle and status.inpos and status.queue == 0:
                    break
                time.sleep(0.02)
            time.sleep(0.5)
            (folder / f"{number}.json").write_text(json.dumps([begin, (folder / "samples.txt").stat().st_size]))
    finally:
        sampler.terminate()


def measure(names: list[str]) -> dict[str, list[list[float]]]:
    """Positions that LinuxCNC commanded in each cycle of each program, from the start of motion to its end."""
    folder = Path(tempfile.mkdtemp(prefix="linuxcnc-"))
    try:
        ini = configure(folder)
        (folder / "programs.json").write_text(json.dumps(names))
        for number, name in enumerate(names):
            (folder / f"{number}.ngc").write_text(program(PROGRAMS[name]))
        settings: dict[str, object] = {}
        if os.getuid() == 0:
            for path in [folder, *folder.iterdir()]:
                os.chown(path, OWNER, OWNER)
            settings = {"user": OWNER, "group": OWNER, "extra_groups": []}
        surroundings = {"PATH": "/usr/bin:/bin", "HOME": str(folder), "LANG": "C"}
        done = subprocess.run(
            ["linuxcnc", "-r", str(ini)], cwd=folder, env=surroundings, capture_output=True, text=True, **settings
        )  # type: ignore[call-overload]
        if not (folder / f"{len(names) - 1}.json").exists():
            raise SystemExit(f"LinuxCNC did not run:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
        found = {}
        text = (folder / "samples.txt").read_bytes()
        for number, name in enumerate(names):
            begin, end = json.loads((folder / f"{number}.json").read_text())
            rows = [line.split() for line in text[begin:end].decode().splitlines()[1:-1]]
            if any("overrun" in row for row in rows):
                raise SystemExit(f"{name}: samples were lost; is the machine busy?")
            numbers = [int(row[0]) for row in rows]
            if numbers != list(range(numbers[0], numbers[0] + len(numbers))):
                raise SystemExit(f"{name}: samples were lost; is the machine busy?")
            places = [[float(value) for value in row[1:4]] for row in rows]
            moves = [i for i in range(1, len(places)) if places[i] != places[i - 1]]
            found[name] = places[moves[0] - 1 : moves[-1] + 1]
        return found
    finally:
        shutil.rmtree(folder, ignore_errors=True)


# --- aircut


def planned(name: str) -> object:
    import aircut
    from aircut.machine import Machine
    from aircut.machine.config import Axis, File, Motion

    axis = Axis(velocity=60 * VELOCITY, acceleration=ACCELERATION)
    made = Machine(File("sim", axes=dict.fromkeys("xyz", axis), motion=Motion("trapezoidal", JUMPS)), {}, False)
    result = aircut.loads(program(PROGRAMS[name])).run(made)
    assert result.ok, result.diagnostics
    return result.plan()


def table(names: list[str]) -> str:
    lines = ["| program | LinuxCNC s | aircut s | difference |", "| --- | ---: | ---: | ---: |"]
    for name, places in measure(names).items():
        real, ours = (len(places) - 1) * CYCLE, planned(name).duration  # type: ignore[attr-defined]
        lines.append(f"| {name} | {real:.3f} | {ours:.3f} | {100 * (ours / real - 1):+.2f} % |")
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> None:
    if arguments[:1] == ["--display"]:
        display(Path(arguments[1]))
        return
    output = None
    if arguments[:1] == ["-o"]:
        output, arguments = Path(arguments[1]), arguments[2:]
    text = table(arguments or list(PROGRAMS))
    print(text, end="")
    if output:
        output.write_text(text)


if __name__ == "__main__":
    main(sys.argv[1:])
