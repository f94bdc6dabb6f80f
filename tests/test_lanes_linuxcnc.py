"""The fast lane of LinuxCNC's language and its general lane mean the same, to the last bit."""

import random
from typing import Any

import msgspec
import pytest

import aircut
import oracle
from aircut.interpreter import lane as house
from aircut.interpreter.linuxcnc.lane import Lane
from aircut.machine import built_in
from test_lanes import plain_line

OTHERS = (
    "G20", "G21", "G90", "G91", "G17", "G18", "G19", "G90.1", "G91.1", "G93", "G94", "G94 F300", "G95", "G61",
    "G64 P0.1", "G54", "G55", "G10 L2 P2 X1 Y2 R30", "G10 L2 P1 X3", "G52 X1 Y2", "G92 X0 Y0 Z0", "G92.1", "G80",
    "G81 X1 Y1 Z-1 R2 F100",
    "X3 Y4", "M3 S1000", "M5", "#1=[1+2] G1 X#1", "(a remark)", "G1 X1 (a remark)", "G53 G0 X1", "G4 P0.1", "T1 M6",
    "G43 H1", "G49", "/G0 X9", "o1 if [1]\nG0 X2\no1 endif", "o1 repeat [2]\nG1 X1\nX2\nY3\nX4\nX5\no1 endrepeat",
    "o1 if [0]\nX1\nX2\nX3\nX4\nX5\no1 endif", "o100 call", "G0 A10", "G7", "G8", "G38.3 Z-7", "M6 T2",
    "G41.1 D1", "G40", "(debug,#<_motion_mode> #<_feed> #<_x> #5420 #<_line>)", "", "  ", "; remark", "G0", "G1", "G2",
    "F60", "M70", "M72", "G28", "#5161=1", "M73", "G5.1 X1 Y1 I2 J2", "G33 Z1 K1", "G0 @5 ^30",
)  # fmt: skip
FAULTS = ("X1 X2", "G1 Q3", "X", "1.5", "G1 X1..2", "X1e5", "G6 X1", "F-3", "F0", "N1N2", "X1" + " " * 260)


def program(rng: random.Random) -> bytes:
    lines = ["G21 G90 F500" if rng.random() < 0.8 else "G90"]
    for _ in range(rng.randint(1, 8)):
        lines += [plain_line(rng) for _ in range(rng.randint(1, 25))]
        if rng.random() < 0.2:
            lines += [rng.choice(("G1", "G0", "F200", "G1 F70", "G1 A3"))] * rng.randint(1, 5)
        lines.append(rng.choice(FAULTS) if rng.random() < 0.1 else rng.choice(OTHERS))
    subroutine = ["o100 sub", *(plain_line(rng) for _ in range(6)), "o100 endsub"]
    return "\n".join([*subroutine, *lines, "M2", ""]).encode()


def run(text: bytes, fast: bool, monkeypatch: pytest.MonkeyPatch, keep_going: bool) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        patch.setattr(house, "FEW", 6)
        if not fast:
            patch.setattr(Lane, "open", lambda self, m: False)
        machine = built_in("XYZABC")
        if len(text) % 2:  # odd ones find the limits near
            machine.axes = {
                letter: msgspec.structs.replace(axis, min=-60.0, max=45.0) for letter, axis in machine.axes.items()
            }
        result = aircut.loads(text, "linuxcnc").run(machine, keep_going=keep_going)
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    m = result._interpreter.state
    state = (m.position, m.told, m.gave_feed, m.motion_name, m.numbered, m.shift, m.origin, m.stale, m.line)
    return result.toolpath.to_numpy().tobytes(), events, result.diagnostics, state


@pytest.mark.parametrize("seed", range(150))
def test_lanes_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    text = program(rng)
    keep_going = rng.random() < 0.7
    fast = run(text, True, monkeypatch, keep_going)
    slow = run(text, False, monkeypatch, keep_going)
    for part, other in zip(fast, slow, strict=True):
        assert part == other, text.decode()


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
def test_the_fast_lane_equals_the_oracle(tmp_path: Any) -> None:
    """Programs of plain lines, of which most are its own."""
    for seed in range(20):
        rng = random.Random(seed)
        lines = [
            line for _ in range(400) if "G2" not in (line := plain_line(rng)) and "G3" not in line and "\r" not in line
        ]
        rows = "\n".join(["G21 G90 F500", "X1", *lines, "G2 X3 Y4 R9", "G3 I2 J-1", "M2", ""])
        theirs, accepted = oracle.ask(rows, tmp_path)
        result = aircut.loads(rows, "linuxcnc").run()
        assert result.ok == accepted
        assert not oracle.differ([line.rstrip("\n") for line in result.canon()], theirs)
