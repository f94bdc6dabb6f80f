"""The fast lane and the general lane mean the same, to the last bit; so do the kernel and its twin."""

from __future__ import annotations

import importlib.util
import random
from array import array
from pathlib import Path
from typing import Any

import msgspec
import pytest

import aircut
from aircut.interpreter import lane
from aircut.kernels import holes as holes_kernel
from aircut.kernels import plain, scan
from aircut.machine import built_in
from aircut.source import POWERS, Batch, Source

OTHERS = (
    "G20", "G21", "G90", "G91", "G17", "G18", "G19", "G90.1", "G91.1", "G93", "G94", "G94 F300", "G61", "G64 P0.1",
    "G54", "G55", "G52 X1 Y2", "G92 X0 Y0 Z0", "G92.1", "G80", "G81 X1 Y1 Z-1 R2 F100", "X3 Y4", "M3 S1000", "M5",
    "#1=[1+2] G1 X#1", "(a remark)", "G1 X1 (a remark)", "G53 G0 X1", "G9 G1 X2", "G4 P0.1", "T1 M6", "G43 H1", "G49",
    "/G0 X9", "IF [1 EQ 1] THEN G0 X2", "M98 P100", "G0 A10", "G16", "G15", "G68 R30", "G69", "", "  ", "; remark",
)  # fmt: skip
FAULTS = ("X1 X2", "G1 Q3", "G2 X9999", "X", "1.5", "G1 X1..2", "X1e5", "G7 X1", "F-3", "F0", "X99999999999", "N1N2")


def word(rng: random.Random, letter: str) -> str:
    number = rng.choice((f"{rng.uniform(-50, 50):.3f}", f"{rng.randint(-9, 9)}", f".{rng.randint(0, 9)}", "-0", "+2."))
    return (letter.lower() if rng.random() < 0.1 else letter) + (" " if rng.random() < 0.05 else "") + number


def plain_line(rng: random.Random) -> str:
    words = [word(rng, axis) for axis in rng.sample("XYZ", rng.randint(1, 3))]
    pick = rng.random()
    if pick < 0.15:
        words.insert(0, rng.choice(("G0", "G1", "G01", "G 1", "g0")))
    elif pick < 0.3:
        words.insert(0, rng.choice(("G2", "G3")))
        words = words[:2] + (
            [f"R{rng.uniform(-90, 90):.3f}"] if rng.random() < 0.5 else [word(rng, "I"), word(rng, "J")]
        )
    elif pick < 0.4:  # a full circle, or a half one that fits
        words = [rng.choice(("G2", "G3")), rng.choice(("I5", "J-2.5 Z1", "X10 I5 G91", "I1 J1"))]
    if rng.random() < 0.1:
        words.append(f"F{rng.uniform(1, 900):.1f}")
    if rng.random() < 0.1:
        words.insert(0, f"N{rng.randint(0, 999)}")
    return rng.choice(("", "", " ")).join(words) + rng.choice(("", "", "", " ", "\r", " ; end"))


def holes(rng: random.Random) -> list[str]:
    """A canned cycle and the places of its holes."""
    cycle = rng.choice(("G81 Z-3 R2", "G82 Z-3 R2 P0.5", "G83 Z-9 R2 Q2", "G73 Z-9 R2 Q2", "G85 Z-4 R3",
                        "G86 Z-4 R2 P0", "G89 Z-3 R2 P1", "G88 Z-3 R2 P1"))  # fmt: skip
    lines = [f"M3 S500 {rng.choice(('G98', 'G99'))}", f"G0 Z{rng.choice((2, 5, -1))}", f"{cycle} X1 Y1 F100"]
    for _ in range(rng.randint(1, 12)):
        x, y = rng.randint(-3, 3), rng.choice((rng.randint(-2, 2), 900))
        place = rng.choice(
            (f"X{x}", f"Y{y % 9}", f"X{x} Y{y}", f"N7 X{x}.5 Y{y % 5} ; a hole", f"x{x}y{y % 7}", "", "X1 Y1")
        )
        lines.append(place + rng.choice(("",) * 12 + (" Z-5", " L2", " F50", " G91", " R1", " G99", " M8", " A3")))
    return [*lines, rng.choice(("G80", "G0", "X1", "G1 Z5"))]


def program(rng: random.Random) -> bytes:
    lines = ["G21 G90 F500" if rng.random() < 0.8 else "G90"]
    for _ in range(rng.randint(1, 8)):
        lines += [plain_line(rng) for _ in range(rng.randint(1, 25))]
        if rng.random() < 0.2:
            lines += [rng.choice(("G1", "G0", "F200", "G1 F70", "G1 A3"))] * rng.randint(1, 5)
        if rng.random() < 0.3:
            lines += holes(rng)
        lines.append(rng.choice(FAULTS) if rng.random() < 0.15 else rng.choice(OTHERS))
    lines += ["M2", "O100", *(plain_line(rng) for _ in range(5)), "M99"]
    return "\n".join(lines).encode() + rng.choice((b"", b"\n"))


def run(text: bytes, letters: str, fast: bool, monkeypatch: pytest.MonkeyPatch, keep_going: bool) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        patch.setattr(lane, "FEW", 6)
        if not fast:
            patch.setattr(lane.Lane, "open", lambda self, m: False)
        machine = built_in(letters)
        if len(text) % 2:  # odd ones find the limits near
            machine.axes = {
                letter: msgspec.structs.replace(axis, min=-60.0, max=45.0) for letter, axis in machine.axes.items()
            }
        result = aircut.loads(text).run(machine, keep_going=keep_going)
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    state = result.state
    return result.toolpath.to_numpy().tobytes(), events, result.diagnostics, state, result._interpreter.unit.seen


@pytest.mark.parametrize("seed", range(120))
def test_lanes_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    text = program(rng)
    letters = rng.choice(("XYZ", "XYZ", "XYZA"))
    keep_going = rng.random() < 0.7
    fast = run(text, letters, True, monkeypatch, keep_going)
    slow = run(text, letters, False, monkeypatch, keep_going)
    for part, other in zip(fast, slow, strict=True):
        assert part == other, text.decode()


def test_the_fast_lane_runs_what_it_can(monkeypatch: pytest.MonkeyPatch) -> None:
    """All lines but the first two, which set the modes, and the last two."""
    ran = 0
    real = lane.Lane.run

    def counted(self: Any, m: Any, source: Any, line: int, end: int) -> int:
        nonlocal ran
        after = real(self, m, source, line, end)
        ran += after - line
        return after

    monkeypatch.setattr(lane.Lane, "run", counted)
    text = "G21 G90 G17\n" + "G1 F100\n" * 3 + "X1 Y2\n\nG2 X3 Y2 I1\nN5 G0 Z9 ; up\n" * 1000 + "M5\nM2\n"
    assert aircut.loads(text).run().ok
    assert ran == 4002


def twin(name: str = "plain") -> Any:
    """The kernel's own source, not compiled."""
    path = Path(plain.__file__).with_name(f"{name}.py")
    spec = importlib.util.spec_from_file_location(f"{name}_twin", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("seed", range(40))
def test_the_kernel_and_its_twin_agree(seed: int) -> None:
    rng = random.Random(seed)
    text = "\n".join(plain_line(rng) for _ in range(200)).encode() + b"\n"
    source = Source("x", text)
    unit, zero = rng.choice((1.0, 25.4)), rng.choice((0.0, -0.0))
    shift = array("d", [rng.choice((0.0, -0.0, 1.1)) for _ in range(6)])
    states = []
    for kernel in (plain, twin()):
        numbers = array("q", [0] * plain.NUMBERS)
        reals = array("d", [0.0] * plain.REALS)
        numbers[plain.MOTION] = 1
        numbers[plain.ABSOLUTE] = seed % 2
        numbers[plain.ARC_ABSOLUTE] = seed % 3 == 0
        numbers[plain.PLANE] = seed % 3
        numbers[plain.AXES] = 7
        numbers[plain.RADIUS] = 1
        numbers[plain.ALONE] = seed % 5 % 3
        reals[plain.OFFSET] = 3.25
        reals[plain.LOW : plain.UNIT] = array("d", [-500.0] * 6 + [500.0] * 6)
        reals[plain.UNIT], reals[plain.FEED] = unit, 100.0
        reals[plain.LEAST], numbers[plain.LONGEST] = plain.SMALL, seed % 4 and 40
        reals[plain.ZERO], reals[plain.SHIFT : plain.REALS] = zero, shift
        rows = bytearray(64 * 88)
        feeds, places = array("d", [0.0] * 16), array("q", [0] * 32)
        seen = []
        while numbers[plain.LINE] < len(source):
            before = numbers[plain.LINE]
            kernel.run(
                source.data, len(source), numbers, reals, memoryview(rows).cast("d"),
                memoryview(rows).cast("q"), feeds, places, POWERS, plain.PLACES,
            )  # fmt: skip
            seen.append((bytes(rows), list(numbers), list(reals), list(feeds), list(places)))
            if numbers[plain.LINE] == before:
                numbers[plain.LINE] += 1
        states.append(seen)
    assert states[0] == states[1]


@pytest.mark.parametrize("seed", range(20))
def test_the_kernel_of_holes_and_its_twin_agree(seed: int) -> None:
    rng = random.Random(seed)
    pattern = array("d", [rng.uniform(-9, 9) for _ in range(holes_kernel.WIDTH * 3)])
    places = array("d", [float(rng.randint(0, 3)) for _ in range(holes_kernel.WIDTH * 30)])
    seen = []
    for kernel in (holes_kernel, twin("holes")):
        rows = bytearray(8 * len(pattern) * 30)
        count = kernel.repeat(
            places, memoryview(places).cast("B").cast("q"), 30, pattern, memoryview(pattern).cast("B").cast("q"), 2, 0,
            memoryview(rows).cast("d"), memoryview(rows).cast("q"),
        )  # fmt: skip
        seen.append((count, bytes(rows)))
    assert seen[0] == seen[1]


@pytest.mark.parametrize("seed", range(20))
def test_lines_are_found_as_their_words_say(seed: int) -> None:
    """By its characters a line is at most taken for plain; reading its words settles it."""
    rng = random.Random(seed)
    pieces = [
        *OTHERS,
        *FAULTS,
        "é",
        "\t",
        "XY",
        "IF [#1]",
        "GOTO 5",
        "END1",
        "%",
        "\x00",
        "X1.2.3",
        "(c)",
        "x1 y2",
        "\r",
    ]
    text = "\n".join(
        plain_line(rng) if rng.random() < 0.8 else rng.choice(pieces) for _ in range(rng.randint(1, 400))
    ).encode() + rng.choice((b"", b"\n"))
    source = Source("x", text)
    classes, batch = bytearray(len(source)), Batch(len(source))
    scan.scan(text, 0, len(source), classes, 0, batch.shapes, batch.shape_ends, batch.values, batch.value_ends, POWERS)
    starts = [0, *(at + 1 for at, byte in enumerate(text) if byte == 10)][: len(source)]
    lines = [*range(len(source)), *rng.sample(range(len(source)), len(source))]
    assert [source.start(line) for line in lines] == [starts[line] for line in lines]
    assert [source.line_at(at) for at in starts] == list(range(len(source)))
    for wanted, found in zip(classes, source.classes, strict=True):
        assert wanted == found or (wanted, found) == (scan.OTHER, scan.PLAIN)
