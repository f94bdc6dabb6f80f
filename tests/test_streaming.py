"""A program streamed in small chunks, from memory used again, says what it says as a whole."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import aircut
from aircut import rules
from aircut import source as source_module
from aircut.canon import ROW, Chunk
from aircut.canon.record import Events
from aircut.interpreter.running import Mode
from aircut.rules import Policy

PIECES = (
    "G21", "G20", "M3 S1000", "M5", "S0", "F300", "G0 Z5", "G0 Z-3", "G1 Z-4", "G0 Z1 X3", "G54", "G55", "G92 Z2",
    "G92.1",
    "G52 X1", "(aircut: off spindle-off)", "(aircut: on spindle-off)", "G1 X1 (aircut: ignore rapid-below-cut)",
    "(aircut: ignore nothing)", "#1 = #510", "#510 = 2", "WHILE [#1 LT 3] DO1\nG1 X#1\n#1 = [#1 + 1]\nEND1",
    "GOTO 900\nG0 X7\nN900",
    "M98 P7", "G81 X1 Y1 Z-1 R2 F100", "X1 X2", "G1 Q9", "T99 M6", "S99999 M3", "G53 G0 Z-9", "G28 Z0",
    "G68 R30", "G69",
    "IF [#2 EQ #0] THEN G0 Z-6", "", "; remark", "G9 G1 X2", "Z99999", "G43 H1",
)  # fmt: skip
ENDS = ("M2", "M30", "M99", "", "M2\nG0 X1", "M2\nO7\nG0 Z-8\nG1 X2\nM99\nO8\nM99", "M5\nM2\nO7\nM3 S5\nG1 X5 F9\nM99")


def program(seed: int) -> bytes:
    """Stretches of plain motion, with all sorts between them."""
    rng = random.Random(seed)
    lines = [rng.choice(("G21 F500", "F500", "G20", ""))]
    for _ in range(rng.randint(1, 10)):
        for _ in range(rng.choice((0, 2, 30, 150))):
            code = rng.choice(("", "", "", "", "G1 ", "G0 ", "N5 "))
            lines.append(f"{code}X{rng.uniform(-9, 9):.3f} Y{rng.randint(-9, 9)} Z{rng.uniform(-5, 20):.2f}")
        lines += rng.choices(PIECES, k=rng.randint(1, 4))
    return "\n".join([*lines, rng.choice(ENDS), ""]).encode()


def checked(source: Any, whole: bool) -> tuple[list[Any], bytes, list[Any], int]:
    """What a check tells, the rows and events that it saw, and in how many chunks."""
    run = aircut.Program(source).interpreter(keep_going=True, mode=Mode.ANALYSIS)
    stream, rows, events, count = run.run, bytearray(), Events(), 0

    def noted() -> Iterator[Chunk]:
        nonlocal count
        for chunk in stream():
            rows.extend(chunk.rows)
            events.extend(chunk.events)
            count += 1
            if not whole:
                yield chunk
        if whole:
            yield Chunk(0, bytes(rows), events)

    run.run = noted  # type: ignore[method-assign]
    for _ in rules.checked(run, Policy()):
        pass
    return run.diagnostics, bytes(rows), list(events), count


@pytest.mark.parametrize("seed", range(60))
def test_streamed_as_whole(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "part.ngc"
    path.write_bytes(program(seed))
    *whole, _ = checked(source_module.Source.load(path), True)
    for name, value in (("interpreter.FULL", 5 * ROW.size), ("lane.CHUNK", 16), ("lane.FEW", seed % 20)):
        monkeypatch.setattr(f"aircut.interpreter.{name}", value)
    monkeypatch.setattr("aircut.canon.record.CHUNK", 64 + seed)
    for name, value in (("LARGE", 1), ("MAPPED", 1 + seed % 2 * 10**9), ("WINDOW", 1 << 16), ("PIECE", 100)):
        monkeypatch.setattr(source_module, name, value)
    *streamed, count = checked(source_module.Source.load(path), False)
    assert streamed == whole
    assert count > (1 if seed % 20 < 16 and len(whole[1]) > 200 * ROW.size else 0)


def test_memory_given_back_is_used_again() -> None:
    text = b"G21 F500 G1\n" + b"X1\nX2\n" * 400_000 + b"M2\n"
    run = aircut.loads(text).interpreter()
    places = set()
    for chunk in run.run():
        if isinstance(chunk.rows, memoryview):
            places.add(id(chunk.rows.obj))
            run.state.out.give_back(chunk)
    assert len(places) == 1
    kept = [chunk for chunk in aircut.loads(text).stream() if chunk.rows]
    assert sum(len(chunk.rows) for chunk in kept) == 800_000 * ROW.size
    ends = [ROW.unpack_from(chunk.rows, len(chunk.rows) - ROW.size)[9] for chunk in kept]
    assert ends == [chunk.first + len(chunk.rows) // ROW.size + 1 for chunk in kept]  # what is kept stays as it was
