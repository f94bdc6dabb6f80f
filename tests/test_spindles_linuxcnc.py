"""Several spindles in LinuxCNC's language: `[TRAJ]SPINDLES` of the INI file, as `rs274 -i` runs them."""

import random
from pathlib import Path

import pytest

import aircut
import oracle
from aircut import dialects
from aircut.machine import inifile
from aircut.machine.config import Spindle
from aircut.planner import plan
from planning import machine as limited

GAIN = 1200.0  # rpm a second
PROGRAMS = 150
SHOWN = "#<_spindle_on> #<_spindle_cw> #<_rpm> #<_spindle_rpm_mode> #<_spindle_css_mode> #<_speed_override>"


@pytest.fixture
def ini(tmp_path: Path) -> Path:
    file = tmp_path / "machine.ini"
    file.write_text("[TRAJ]\nSPINDLES = 3\n")
    return file


def of(ini: Path, machine=None):
    """A machine, by default the language's own, with the INI file."""
    machine = machine or dialects.machine(dialects.load("linuxcnc"))
    machine.ini = inifile.load(ini)
    return machine


def run(text: str, ini: Path, machine=None):
    return aircut.loads(text, "linuxcnc").run(machine=of(ini, machine))


def told(text: str, ini: Path, *names: str) -> list[str]:
    result = run(text, ini)
    assert result.ok, result.diagnostics
    lines = [line.split(None, 2)[2].strip() for line in result.canon()]
    return [line for line in lines if line.startswith(names)]


SPEEDS = ("SET_SPINDLE_SPEED", "START_SPINDLE", "STOP_SPINDLE")


def test_a_dollar_chooses_the_spindle_and_minus_one_all(ini):
    """001, M3 M4 M5 and S: without $ it is spindle 0."""
    assert told("S100 M3\nS200 M4 $2\nS300 $-1\nM2\n", ini, *SPEEDS)[:7] == [
        "SET_SPINDLE_SPEED(0, 100.0000)",
        "START_SPINDLE_CLOCKWISE(0)",
        "SET_SPINDLE_SPEED(2, 200.0000)",
        "START_SPINDLE_COUNTERCLOCKWISE(2)",
        "SET_SPINDLE_SPEED(0, 300.0000)",
        "SET_SPINDLE_SPEED(1, 300.0000)",
        "SET_SPINDLE_SPEED(2, 300.0000)",
    ]


@pytest.mark.parametrize(
    "block",
    [
        "M3 $3",
        "M3 $-2",
        "S5 $3",
        "M19 R5 $-1",
        "G95 F1 S5 $3",
        "G96 D5 S5 $-1",
        "G33 Z1 K1 $3",
        "M51 P0 $0",
        "M51 P0 $3",
    ],
)
def test_a_spindle_that_is_not_there_is_refused(block, ini):
    result = run(f"M3 S100 $-1\n{block}\nM2\n", ini)
    assert [(d.code, d.span.line) for d in result.diagnostics] == [("bad-value", 2)]


def test_a_thread_needs_its_own_spindle_turning(ini):
    assert run("S100 M3 $1\nG33 Z1 K.1 $1\nM2\n", ini).ok
    assert not run("S100 M3 $1\nG33 Z1 K.1\nM2\n", ini).ok


def test_a_feed_a_revolution_goes_with_the_spindle_of_g95(ini):
    """F0.5 at S600 is 5 mm/s, at S1200 10 mm/s; 500 mm/s²; the spindles come up one after the other."""
    on = limited(spindle=Spindle(60_000.0, GAIN))
    result = run("G21 G90 G61.1\nS1200 M3 $1\nS600 M3 $0\nG95 F0.5 S1200 $1\nG1 X30\nM2\n", ini, on)
    assert result.ok, result.diagnostics
    made = plan(result.recording, on)
    assert made.times[-1] == pytest.approx(1800 / GAIN + 30 / 10 + 10 / 500, rel=1e-9)


@pytest.mark.parametrize(("turn", "warned"), [("M3 S100 $1", False), ("M3 $1", True), ("M3 S100 $1\nM5 $1", True)])
def test_a_cut_is_warned_of_when_no_spindle_turns(turn, warned, ini):
    found = aircut.loads(f"G21\n{turn}\nS50 $0\nG1 X5 F100\nM2\n", "linuxcnc").check(machine=of(ini))
    assert [d.code for d in found] == ["spindle-off"] * warned


def random_program(seed: int) -> str:
    chance = random.Random(seed)

    def which() -> str:
        return chance.choice(("", "", "$0", "$1", "$2", "$1", "$2", "$1.7", "$-1" if chance.random() < 0.3 else "$0"))

    def speed() -> str:
        return chance.choice(("", f"S{chance.randrange(90)}"))

    def tapping() -> str:
        return chance.choice(("", f"S5 {which()}"))

    blocks = (
        lambda: f"{chance.choice(('M3', 'M4', 'M5'))} {speed()} {which()}",
        lambda: f"S{chance.randrange(90)} {which()}",
        lambda: f"G96 D{chance.randrange(50)} S{chance.randrange(90)} {which()}",
        lambda: f"G97 S{chance.randrange(90)} {which()}",
        lambda: (
            f"{chance.choice(('G93', 'G94', 'G94', 'G95'))} F{chance.randrange(1, 9)} S{chance.randrange(90)} {which()}"
        ),
        lambda: f"M19 R{chance.randrange(360)} {chance.choice(('', 'Q2'))} {which()}",
        lambda: chance.choice(("M48", "M49", "M50 P0", "M51 P0", "M51 P1 $1", "M51 P0 $2", f"M49 S5 {which()}")),
        lambda: f"{chance.choice(('G33', 'G33.1'))} Z{chance.randrange(9)} K.5 {which()}",
        lambda: f"G76 P.1 Z-3 I-.1 J.1 K.25 {which()}",
        lambda: f"{chance.choice(('G84', 'G74'))} X{chance.randrange(9)} Z-1 R0 F5 {tapping()}\nG80",
        lambda: f"{chance.choice(('G86 P1', 'G88 P1', 'G87 I1 J1 K1'))} X{chance.randrange(9)} Z-1 R0 F5\nG80",
        lambda: chance.choice(("M70", "M72", "M73")),
        lambda: "T1 M6",
        lambda: f"G1 X{chance.randrange(9)} F5 {speed()}",
        lambda: f"(debug,{SHOWN})",
    )
    lines = [chance.choice(blocks)() for _ in range(chance.randrange(4, 30))]
    return "\n".join((*chance.choice(((), ("M3 S50 $-1", "G94 F7"))), *lines, "M2", ""))


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (linuxcnc-uspace) is not installed")
def test_random_programs_equal_the_oracle(ini, tmp_path):
    for seed in range(PROGRAMS):
        text = random_program(seed)
        theirs = oracle.answer(text, tmp_path, ["-i", str(ini)])
        result = run(text, ini)
        ours = [line.rstrip("\n") for line in result.canon()]
        assert not oracle.differ(ours, [line for line in theirs.listing if line != "executing"]), f"seed {seed}\n{text}"
        assert result.ok == theirs.accepted, f"seed {seed}\n{text}{theirs.message}"
