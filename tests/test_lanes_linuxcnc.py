"""LinuxCNC's language: the fast lane and the general lane mean the same, to the last bit."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import msgspec
import pytest

import aircut
import aircut.api
import oracle
from aircut.interpreter import lane as house
from aircut.interpreter.linuxcnc import lane
from aircut.interpreter.linuxcnc.interpreter import Interpreter
from aircut.machine import built_in
from test_lanes import holes, plain_line, word

OTHERS = (
    "G20", "G21", "G90", "G91", "G17", "G18", "G19", "G18.1", "G90.1", "G91.1", "G93", "G94 F300", "G95 S100 F0.2",
    "G7", "G8", "G54", "G55", "G10 L2 P1 X1.1 Y-2.7", "G10 L2 P2 R30", "G10 L20 P1 X0 Y0", "G52 X1 Y2",
    "G92 X0 Y0 Z0.3", "G92 X-0", "G92.1", "G80", "G81 X1 Y1 Z-1 R2 F100", "X3 Y4", "M3 S1000", "M5",
    "#1=[1+2] G1 X#1", "(a remark)",
    "G1 X1 (a remark)", "(print,#5420 #5421 #5422 #5423)", "G53 G0 X1", "T1 M6", "T2 M6 G43", "G43", "G43.1 Z1",
    "G49",
    "/G0 X9", "G0 A10", "G1 B1 C-2", "G41.1 D2", "G40", "G40 G0 X1 Y1", "G38.2 X1", "G28", "G0 @3 ^30", "I5 J1",
    "G2 I3", "M70", "M72", "M2", "#5600=1", "G2 X#1 Y3 R50", "#2=#5420", "#<_a>=#5422", "G0 X#<_motion_mode>", "",
    "  ", "; remark", "F0", "G1", "o1 if [#5600 EQ 1]\nG1 X7\no1 endif",
    "o2 repeat [3]\nG91\nX1\nY1 Z-2\nX.1\nG1 F90\no2 endrepeat",
    "G61", "G64 P0.1", "G95", "G10 L2 P1 X3", "G4 P0.1", "G43 H1", "M6 T2", "G38.3 Z-7", "G41.1 D1", "#5161=1", "M73",
    "o1 if [0]\nX1\nX2\nX3\nX4\nX5\no1 endif", "(debug,#<_motion_mode> #<_feed> #<_x> #5420 #<_line>)", "G0", "F60",
    "G5.1 X1 Y1 I2 J2", "G33 Z1 K1", "G10 L2 P2 X1 Y2 R30", "M70\nG91\nM72",
    "o9 call", "X1" + "0" * 240, "X1" + " " * 248, "X1" + " " * 250, "X1" + " " * 251,
    "X2 ;" + "x" * 248, "X2 ;" + "x" * 249,
)  # fmt: skip
FAULTS = (
    "X1 X2", "G1 Q3", "G2 X9999 Y1 I1", "G2 X1 Y1 R.1", "X", "1.5", "G1 X1..2", "X1e5", "G1 U3", "F-3",
    "X99999999999", "N1N2",
    "G3 X1", "G1 I3", "N1.5 X1", "X1 N5", "G2 K1 X1", "G2 X1 I0 J0", "G4 X1", "N+5X1", "G3.0X1",
    "M3.2", "M3 M8 M48 M53 M62 P1", "T1.5", "T-1",
    "H-2 G43", "S-1", "G4 P-1", "G2 X1 R5 P1.5", "G64 P-1 Q-1", "W1", "G5.10 X1", "G59.30", "G54.25", "M98", "M99",
    "G10 L2.5 P1", "T99999", "M62 P3", "G03X1", "G+1X3",
)  # fmt: skip
SUB = "o9 sub\nG1 X1 F50\nX2\nY3\nG2 X3 Y4 R9\nY9\no9 endsub\n"


def line(rng: random.Random) -> str:
    """A plain line, with arcs near this language's own tolerances."""
    pick = rng.random()
    if pick < 0.05:
        gap = rng.choice((0.02, 0.028, 0.0283, 0.0284, 0.03, 0.0718, 0.072, 2.82, 2.83))
        return f"G91 G{rng.choice('23')} X{20 + gap} I10 J{rng.choice((0, 0.1))}\n{rng.choice(('G90', 'G91'))} G1"
    if pick < 0.08:
        radius = rng.choice((0.001, 0.0012, 0.00127, 0.0013, 0.00005, 0.002))
        return f"G91 G3 X{2 * radius:.6f} I{radius:.6f} J0\nG90 G1"
    if pick < 0.2:
        back = rng.choice(("G90", "G91"))
        first, second, i, j = rng.choice(("XYIJ", "XYIJ", "ZXKI", "YZJK"))
        if rng.random() < 0.5:
            radius = rng.choice((-1, 1)) * rng.uniform(15, 90)
            step = f"{word(rng, first)[0]}{rng.uniform(-20, 20):.3f} {second}{rng.uniform(-20, 20):.3f} R{radius:.3f}"
        else:
            radius = rng.uniform(0.01, 20)
            step = f"{first}{radius:.3f} {second}{radius:.3f} {i}{radius:.3f} {rng.choice(('', f'{j}0'))}"
        return f"G91\nG{rng.choice('23')} {step}{rng.choice(('', ' F90'))}\n{rng.choice(('', 'G1'))}\n{back}"
    text = plain_line(rng)
    if "G2" in text or "G3" in text:  # most of them are faults
        text = (text if rng.random() < 0.3 else f"G{rng.randint(0, 1)} F60") + rng.choice(("\nG1", "\nG0", ""))
    return text


def program(rng: random.Random) -> bytes:
    lines = [rng.choice(("G21 G90 F500", "G20 G90 F20", "G21 G90 F100\nG55\nG92 X1.7 Z.3")), rng.choice(("G1", "G0"))]
    calm = rng.random() < 0.5
    for _ in range(rng.randint(1, 8)):
        lines += [line(rng) for _ in range(rng.randint(1, 25))]
        if rng.random() < 0.2:
            lines += [rng.choice(("G1", "G0", "F200", "G1 F70", "G1 A3"))] * rng.randint(1, 5)
        if rng.random() < 0.3:
            lines += [text for text in holes(rng) if "G88" not in text]
        fault = rng.random() < (0.0 if calm else 0.15)
        lines.append(rng.choice(FAULTS if fault else OTHERS[:-6] if calm else OTHERS))
        if rng.random() < 0.6:
            lines.append(f"G94 F{rng.randint(1, 900)} G8 {rng.choice(('G17', 'G17', 'G18'))} G54 G{rng.randint(0, 1)}")
    text = SUB + "\n".join(lines) + "\n(print,#5420 #5421 #5422 #5423 #<_feed> #<_motion_mode>)\nM2"
    return text.encode() + rng.choice((b"", b"\n"))


def run(text: bytes, fast: int, monkeypatch: pytest.MonkeyPatch, keep_going: bool, near: bool) -> tuple[Any, ...]:
    """What comes of a program. fast: 2 with the fast lane; 1 with plain lines by their shapes; 0 as blocks only."""
    with monkeypatch.context() as patch:
        patch.setattr(house, "FEW", 6)
        if fast < 2:
            patch.setattr(lane.Lane, "open", lambda self, m: False)
        if fast < 1:
            patch.setattr(Interpreter, "plain", lambda self, text: False)
        machine = None
        if near:
            machine = built_in("XYZABC")
            machine.axes = {
                letter: msgspec.structs.replace(axis, min=-60.0, max=45.0) for letter, axis in machine.axes.items()
            }
        result = aircut.loads(text, "linuxcnc").run(machine, keep_going=keep_going)
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    interpreter: Any = result._interpreter
    m = interpreter.state
    kept = [list(map(repr, values)) for values in (m.position, m.told, m.numbered, (m.gave_feed,))]
    return (
        result.toolpath.to_numpy().tobytes(), events, [str(d) for d in result.diagnostics], kept,
        m.motion_name, interpreter.modal.name, interpreter.line, m.line,
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(200))
def test_lanes_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    text = program(rng)
    keep_going, near = rng.random() < 0.7, rng.random() < 0.2
    fast, shaped, slow = (run(text, way, monkeypatch, keep_going, near) for way in (2, 1, 0))
    for part, middle, other in zip(fast, shaped, slow, strict=True):
        assert part == other, text.decode()
        assert middle == other, text.decode()


def test_the_fast_lane_runs_what_it_can(monkeypatch: pytest.MonkeyPatch) -> None:
    """All lines but the first two, which set the modes and start the motion, and the last two; G1 alone is a move."""
    ran = 0
    real = lane.Lane.run

    def counted(self: Any, m: Any, source: Any, line: int, end: int) -> int:
        nonlocal ran
        after = real(self, m, source, line, end)
        ran += after - line
        return after

    monkeypatch.setattr(lane.Lane, "run", counted)
    text = "G20 G90 G17\nG0 X0\n" + "G1 F100\n" * 3 + "X1 Y2\n\nG2 X3 Y2 I1\nN5 G0 Z9 ; up\n" * 1000 + "M5\nM2\n"
    result = aircut.loads(text, "linuxcnc").run()
    assert result.ok
    assert ran == 4003
    assert len(result.toolpath) == 3004


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
@pytest.mark.parametrize("seed", range(1000, 1030))
def test_listing_equals_the_oracle(seed: int, tmp_path: Path) -> None:
    """Programs that are mostly plain, so mostly of the fast lane."""
    rng = random.Random(seed)
    lines = [rng.choice(("G21 G90 F500", "G20 G90 F20", "G21 G90 F100\nG55\nG92 X1.7 Z.3")), "G1"]
    for _ in range(rng.randint(1, 4)):
        lines += [line(rng) for _ in range(rng.randint(1, 25))]
        lines.append(rng.choice(("G91", "G90", "G20", "G21", "(remark)", "M3 S10", "G55", "G54", "G17", "G92.1")))
    text = "\n".join([*lines, "M2", ""])
    theirs, accepted = oracle.ask(text, tmp_path)
    result = aircut.loads(text, "linuxcnc").run()
    ours = [text.rstrip("\n") for text in result.canon()]
    assert not oracle.differ(ours, theirs), text
    assert result.ok == accepted


def test_more_moves_than_are_kept() -> None:
    """The limit stops the run where a chunk is full, in either lane, with a diagnostic."""
    text = "G21 G90\nF100\nG1 X1\n" + "X2\nX3\n" * 40_000 + "M2\n"
    result = aircut.loads(text, "linuxcnc").run(limits=aircut.api.Limits(moves=50))
    assert [diagnostic.code for diagnostic in result.diagnostics] == ["output-limit"]
    assert result.state["position"]["x"] in (2.0, 3.0)
