"""Under tool center point control too, the fast lane and the general lane mean the same, to the last bit."""

from __future__ import annotations

import random
from array import array
from typing import Any

import msgspec
import pytest

import aircut
from aircut.geometry.kinematics import MODELS
from aircut.interpreter import lane
from aircut.interpreter.rtcp import control_of
from aircut.kernels import follow, twin
from test_rtcp import LETTERS, machine, setup

OTHERS = (
    "G20", "G21", "G90", "G91", "G94", "G93", "G94 F300", "G61", "G61.1", "G64 P0.1", "G55", "G54", "G52 X1 Y2 {o}5",
    "G52 X0 Y0 {o}0", "#1=[1+2] G1 X#1", "G9 G1 X2 {i}30", "G1 X1 (a remark)", "G53 G0 X1", "G49", "G43.4 H1",
    "G43.7 H1 X1 Z40", "M3 S1000", "G41 D1", "G40", "G68 R30", "G69", "", "; remark", "G2 X3 Y4 I1 J2 {o}9", "X9999",
    "{i}9999", "G10 L100 P5802 R1", "G10 L100 P5802 R0", "G92 X0", "G92.1", "Z", "G0",
)  # fmt: skip


def line(rng: random.Random, model: int) -> str:
    words = []
    for axis in rng.sample("xyz" + LETTERS[model], rng.randint(1, 5)):
        near = 60.0 if axis in "xyz" else rng.choice((3.0, 3.0, 50.0, 400.0))
        words.append(rng.choice((axis, axis.upper())) + f"{rng.uniform(-near, near):.3f}")
    pick = rng.random()
    if pick < 0.1:
        words.insert(0, rng.choice(("G0", "G1", "G1")))
    elif pick < 0.13:
        words = [rng.choice(("G2 X5 I3", "G3 I5", "G1 F70", "F1200", "G1"))]
    if rng.random() < 0.1:
        words.append(f"F{rng.uniform(1, 900):.1f}")
    if rng.random() < 0.1:
        words.insert(0, f"N{rng.randint(0, 999)}")
    return " ".join(words)


def program(rng: random.Random, model: int) -> bytes:
    o, i = LETTERS[model].upper()
    lines = ["G21 G90 F500", "G43.4 H1"]
    for _ in range(rng.randint(1, 7)):
        lines += [line(rng, model) for _ in range(rng.randint(4, 60))]
        lines.append(rng.choice(OTHERS).format(o=o, i=i))
    return "\n".join([*lines, "M2", ""]).encode()


def run(text: bytes, model: int, fast: bool, monkeypatch: pytest.MonkeyPatch, keep_going: bool) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        patch.setattr(lane, "FEW", 6)
        if not fast:
            patch.setattr(lane.Lane, "open", lambda self, m: False)
        made = machine(model, "ab" if len(text) % 3 == 0 else "")
        if len(text) % 2:  # odd ones find the limits near
            made.axes = {
                letter: msgspec.structs.replace(axis, min=-150.0, max=160.0) for letter, axis in made.axes.items()
            }
        result = aircut.loads(text).run(made, keep_going=keep_going)
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    return result.toolpath.to_numpy().tobytes(), events, result.diagnostics, result.state, result._interpreter.unit.seen


@pytest.mark.parametrize("seed", range(80))
def test_lanes_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    model = rng.choice(sorted(MODELS))
    text = program(rng, model)
    keep_going = rng.random() < 0.8
    fast = run(text, model, True, monkeypatch, keep_going)
    slow = run(text, model, False, monkeypatch, keep_going)
    for part, other in zip(fast, slow, strict=True):
        assert part == other, text.decode()


def test_long_stretches_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """More lines than are tried at once, and moves of more rows than a chunk has."""
    rng = random.Random(1)
    lines = [line(rng, 2) for _ in range(6000)]
    lines[5000] = "A0 C90000000"
    lines[5001] = "A0 C0 F100"
    text = "\n".join(["G43.4 H1", "F500", *lines, "M2", ""]).encode()
    fast, slow = (run(text, 2, fast, monkeypatch, True) for fast in (True, False))
    assert fast == slow


def test_the_fast_lane_runs_what_it_can(monkeypatch: pytest.MonkeyPatch) -> None:
    ran = 0
    real = lane.Lane.run

    def counted(self: Any, m: Any, source: Any, line: int, end: int) -> int:
        nonlocal ran
        after = real(self, m, source, line, end)
        ran += after - line
        return after

    monkeypatch.setattr(lane.Lane, "run", counted)
    text = "G43.4 H1\nG1 F100\n" + "X1 Y2 Z3 A4 C5\nA-5 F200\nN5 G0 Z9 ; up\nG1 X0\n" * 1000 + "M5\nM2\n"
    result = aircut.loads(text).run(machine(2))
    assert result.ok
    assert ran == 4000


@pytest.mark.parametrize("model", MODELS)
def test_the_kernel_and_its_twin_agree(model: int) -> None:
    rng = random.Random(model)
    rows = memoryview(bytearray(30 * 88))
    tips, marks = rows.cast("d"), rows.cast("q")
    for row in range(30):
        tips[11 * row : 11 * row + 6] = array("d", [rng.uniform(-9, 9) for _ in range(6)])
        tips[11 * row + 8] = 500.0
        marks[11 * row + 9], marks[11 * row + 10] = row + 1, 1 << 32 | 1 << 48
    marks[11 * 28 + 10] = 2 << 32  # an arc
    found = []
    for kernel in (follow, twin("follow", "follow_uncompiled")):
        facts, start = control_of(setup(model)).facts, array("d", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
        firsts, before = array("q", [0] * 31), array("d", [0.0] * 6)
        moves = kernel.share(facts, start, tips, marks, 30, 0.01, 1, 10_000, firsts)
        assert moves == 28
        assert kernel.share(facts, start, tips, marks, 30, 0.01, 1, firsts[20], array("q", [0] * 31)) == 20
        out = memoryview(bytearray(firsts[moves] * 88))
        bits = (16 << 48, 32 << 48, 1 << 48)
        kernel.stretch(facts, start, tips, marks, moves, firsts, *bits, before, out.cast("d"), out.cast("q"))
        found.append((bytes(out), list(firsts)))
    assert found[0] == found[1]
