"""Programs of nine axes in LinuxCNC's language, beside its own interpreter.

Its stand-alone `rs274` has no U, V and W whatever is configured; its Python module `gcode`, from
the same package, runs the same interpreter for a machine of any axes.
"""

import json
import random
import re
import subprocess
from pathlib import Path

import pytest

import aircut
from aircut import dialects
from aircut.api import Result
from aircut.interpreter.table import Dialect
from aircut.machine import Machine, MachineError, built_in
from aircut.planner import PlanError

PYTHON = Path("/usr/bin/python3")  # that LinuxCNC's package is for
PROGRAMS = 120
LETTERS = "XYZABCUVW"
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
#: Runs each program in a process of its own, and prints what the interpreter told: names and numbers.
ASK = """
import gcode, json, os, sys
class Canon:
    parameter_file = ""
    def __init__(self, mask):
        self.told = []
        self.mask = mask
    def get_axis_mask(self): return self.mask
    def get_external_length_units(self): return 1 / 25.4
    def get_external_angular_units(self): return 1.0
    def get_block_delete(self): return False
    def get_tool(self, number): return (-1,) + (0,) * 13
    def check_abort(self): return False
    def __getattr__(self, name):
        return lambda *values: self.told.append([name, *values])
for name, mask in json.loads(sys.argv[1]):
    sys.stdout.flush()
    if os.fork() == 0:
        canon = Canon(mask)
        canon.parameter_file = name + ".var"
        result, line = gcode.parse(name, canon, "", "", "")
        told = [row for row in canon.told if all(isinstance(value, (int, float)) for value in row[1:])]
        print(json.dumps([told, result <= gcode.MIN_ERROR]))
        sys.stdout.flush()
        os._exit(0)
    os.wait()
"""
#: Theirs, ours, and which of the values are lengths.
NAMES = {
    "straight_traverse": ("STRAIGHT_TRAVERSE", (0, 1, 2, 6, 7, 8)),
    "straight_feed": ("STRAIGHT_FEED", (0, 1, 2, 6, 7, 8)),
    "arc_feed": ("ARC_FEED", (0, 1, 2, 3, 5, 9, 10, 11)),
    "set_g5x_offset": ("SET_G5X_OFFSET", (1, 2, 3, 7, 8, 9)),
    "set_g92_offset": ("SET_G92_OFFSET", (0, 1, 2, 6, 7, 8)),
    "tool_offset": ("USE_TOOL_LENGTH_OFFSET", (0, 1, 2, 6, 7, 8)),
    "set_xy_rotation": ("SET_XY_ROTATION", ()),
    "set_feed_rate": ("SET_FEED_RATE", (0,)),
}
OURS = dict(NAMES.values())
Told = list[tuple[str, list[float]]]


def module_is_there() -> bool:
    return PYTHON.exists() and subprocess.run([PYTHON, "-c", "import gcode"], capture_output=True).returncode == 0


needs_module = pytest.mark.skipif(not module_is_there(), reason="LinuxCNC's Python module gcode is not installed")


def ask(folder: Path, programs: list[tuple[str, int]]) -> list[tuple[Told, bool]]:
    """What LinuxCNC tells of programs on machines of these axes (bits), in inches and degrees; whether they ran."""
    files = []
    for at, (text, mask) in enumerate(programs):
        (folder / f"{at}.ngc").write_text(text)
        (folder / f"{at}.ngc.var").write_text("")
        files.append((f"{at}.ngc", mask))
    environment = {"HOME": str(folder)}
    command = [str(PYTHON), "-c", ASK, json.dumps(files)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, timeout=120)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(answers) == len(programs), done.stderr[-500:]
    return [([(NAMES[n][0], values) for n, *values in told if n in NAMES], fine) for told, fine in answers]


def run(text: str, axes: str = LETTERS) -> tuple[Told, bool, Result]:
    """The same of aircut."""
    dialect: Dialect = dialects.load("linuxcnc")
    machine: Machine = dialects.machine(dialect, axes)
    result = aircut.loads(text, "linuxcnc").run(machine=machine)
    told: Told = []
    unit = 25.4
    for piece in result.canon():
        for line in piece.splitlines():
            name, _, rest = line[13:].partition("(")
            if name == "USE_LENGTH_UNITS":
                unit = 25.4 if "MM" in rest else 1.0
            if name in OURS:
                values = [float(number) for number in re.findall(r"-?\d+\.?\d*", rest)]
                told.append((name, [v / unit if i in OURS[name] else v for i, v in enumerate(values)]))
    return told, result.ok, result


class Writer:
    """Random lines over nine axes."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def words(self, least: int = 1, letters: str = LETTERS) -> str:
        chosen = self.random.sample(letters, self.random.randint(least, min(5, len(letters))))
        return " ".join(f"{letter}{self.random.uniform(-40, 40):.3f}" for letter in chosen)

    def line(self) -> str:
        pick = self.random.choice
        radius = self.random.randint(1, 30)
        return pick((
            f"G0 {self.words()}", f"G1 {self.words()}", f"G1 {self.words()}", f"{self.words()}",
            f"G0 {self.words(1, 'UVW')}", f"G1 {self.words(1, 'UVW')} F{self.random.randint(5, 900)}",
            pick(("G90", "G91")), pick(("G20", "G21")), pick(SYSTEMS),
            f"{pick(('G92', 'G52'))} {self.words()}", pick(("G92.1", "G92.2", "G92.3")),
            f"G10 L2 P{self.random.randint(0, 9)} {self.words(0)}{pick(('', ' R30', ' R-12.5'))}",
            f"G10 L20 P{self.random.randint(0, 9)} {self.words()}",
            f"G43.1 {self.words()}", "G49", f"G90 G53 G0 {self.words()}",
            f"G28 {self.words(0)}", f"G30 {self.words(0)}", pick(("G28.1", "G30.1")),
            f"G91 {pick(('G2', 'G3'))} X{radius} Y{radius} I{radius} J0 {self.words(0, 'ZABCUVW')}\nG90 G1",
            f"G93 G1 {self.words()} F2\nG94 F100", f"G93 G1 {self.words(1, 'UVWABC')} F3\nG94 F50",
            f"#{pick((5161, 5167, 5169, 5187, 5217, 5227, 5248))}={self.random.uniform(-3, 3):.3f}",
            f"G81 {self.words(1, 'XY')} Z-3 R2\nG80 G1",
            f"G17.1 G81 {self.words(1, 'UV')} W-3 R2\n{self.words(1, 'UV')}\nG80 G1 G17",
            f"G18.1 {pick(('G98', 'G99'))} G82 {self.words(1, 'UW')} V-5 R7 P1\n{self.words(1, 'UVWX')}\nG80 G1 G17",
            f"G19.1 G83 {self.words(1, 'VW')} U-8 R-2 Q3\n{self.words(1, 'VW')}\nG80 G1 G17",
            f"G17.1 M3 S9 G87 {self.words(1, 'UV')} W-3 R2 I1 J-2 K-1\nG80 G1 G17",
        ))  # fmt: skip

    def program(self) -> str:
        body = "\n".join(self.line() for _ in range(self.random.randint(3, 15)))
        return f"G21 G90\nF200 G1 X1 Y2 Z3\n{body}\nM2\n"


@needs_module
def test_nine_axes_are_told_as_linuxcnc_tells_them(tmp_path: Path) -> None:
    programs = [Writer(seed).program() for seed in range(PROGRAMS)]
    for seed, (text, (theirs, fine)) in enumerate(
        zip(programs, ask(tmp_path, [(text, 0x1FF) for text in programs]), strict=True)
    ):
        ours, ok, result = run(text)
        ending = text.rindex("M2")
        said = f"seed {seed}\n{text[:ending]}\n{[str(d) for d in result.diagnostics]}"
        assert ok == fine, said
        for at, (a, b) in enumerate(zip(ours, theirs, strict=False)):
            assert a[0] == b[0], f"{said}\n{at}: {a} {b}"
            assert a[1] == pytest.approx(b[1], abs=1.1e-4), f"{said}\n{at}: {a} {b}"


@needs_module
@pytest.mark.parametrize("axes", ["XYZABCUVW", "XYZ", "XYZA", "XYUV", "XYZUVW"])
def test_axes_that_a_machine_lacks_are_refused_as_linuxcnc_refuses_them(axes: str, tmp_path: Path) -> None:
    mask = sum(1 << LETTERS.index(letter) for letter in axes)
    lines = [f"G0 {letter}1" for letter in LETTERS] + ["G92 W1", "G10 L2 P1 A3", "G43.1 V2", "G52 C1", "G28 U1"]
    answers = ask(tmp_path, [(f"{line}\nM2\n", mask) for line in lines])
    for line, (_, fine) in zip(lines, answers, strict=True):
        assert run(f"{line}\nM2\n", axes)[1] == fine, line


SIX = "G21 F100\nG0 X1 U5\nG1 X2 U9 V-3\nX3\nG2 X5 I1 W2\nG41.1 D1\nG1 X20 U1\nX30 Y10 U2\nG40\nX40 U3\nM2\n"


def test_toolpath_holds_them_beside_its_columns() -> None:
    """Ends by hand from the words; moves that compensation holds back take theirs along."""
    toolpath = run(SIX)[2].toolpath
    wanted = [(5, 0, 0), (9, -3, 0), (9, -3, 0), (9, -3, 2), (1, -3, 2), (2, -3, 2), (3, -3, 2)]
    assert list(map(tuple, toolpath.auxiliary().tolist())) == wanted
    assert toolpath.ends().shape == (len(wanted), 6)


def test_programs_of_six_axes_have_none() -> None:
    toolpath = run("G0 X1\nG0 X2 A3\nM2\n", "XYZABC")[2].toolpath
    assert toolpath.auxiliary().tolist() == [[0.0] * 3] * 2
    assert not toolpath.told_auxiliary


def test_time_of_their_moves_is_refused() -> None:
    result = run("F100\nG1 X1\nG1 U5\nM2\n")[2]
    with pytest.raises(PlanError, match=r"line 3: .* U, V and W"):
        result.plan()
    assert run("F100\nG1 X1\nM2\n")[2].plan().duration > 0.0


def test_their_travel_has_limits() -> None:
    """A machine's own; a tool's offset counts. The interpreter's machine has none."""

    def accepted(text: str) -> bool:
        program = aircut.loads(f"G21\n{text}\nM2\n", "linuxcnc")
        assert program.run(dialects.machine(dialects.load("linuxcnc"), LETTERS)).ok
        return program.run(built_in(LETTERS, LETTERS.lower())).ok

    assert accepted("G0 U10000")
    assert not accepted("G0 U10000.001")
    assert not accepted("G43.1 U1\nG0 U10000")
    assert accepted("G43.1 U1\nG0 U9999")


def test_rosetta_has_no_such_axes() -> None:
    with pytest.raises(MachineError, match="give some of XYZABC"):
        dialects.machine(dialects.load("rosetta"), "XYZU")
