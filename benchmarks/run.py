"""Benchmarks, printed as a table: `make bench`.

Where LinuxCNC's interpreter can do the same work it does it in the same run (Debian's
linuxcnc-uspace): processor time of both sides, and how many times faster ours is.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path

import macros
import measure
import rtcp
import streaming
import writing

import aircut

LINES = 1_000_000
CHECK = "load().check(); count = 0"
PLAN = "result = run(load()); result.toolpath; before = spent(); count = len(result.plan().times)"
AIRCUT = (sys.executable, "-m", "aircut")


def finishing(lines: int) -> bytes:
    """A three-axis finishing program: rows of short moves over a wavy surface, arcs at their ends."""
    text = ["G21 G17 G90 G94", "T1 M6", "S12000 M3", "G0 X0 Y0 Z10", "G1 Z0 F600"]
    x, y, step = 0.0, 0.0, 0.25
    while len(text) < lines - 3:
        for _ in range(400):
            x += step
            text.append(f"X{x:.3f} Y{y:.3f} Z{math.sin(x * 0.11) * math.cos(y * 0.07):.4f}")
        text.append(f"G{3 if step > 0 else 2} X{x:.3f} Y{y + 0.5:.3f} J0.25 F500")
        text.append("G1 F1800")
        y += 0.5
        step = -step
    return "\n".join([*text[: lines - 3], "G0 Z20", "M5", "M2", ""]).encode()


def row(*cells: str) -> None:
    print("|", " | ".join(cells), "|", flush=True)


def beside(title: str, ours: float, theirs: float | None, rate: str, goal: str) -> None:
    """A row of work that both sides did."""
    ratio = f"{theirs / ours:.1f}" if theirs else "not installed"
    row(title, f"{ours:.3f} s ({rate})", f"{theirs:.2f} s" if theirs else "", ratio, goal)


def plain(folder: Path) -> None:
    """A program of a CAM system, from its file to a toolpath, a listing, a check, a plan."""
    file = folder / "part.ngc"
    file.write_bytes(finishing(LINES))
    theirs = measure.oracle(file, 2)
    for dialect in ("rosetta", "linuxcnc"):
        ours, memory, count = measure.child(file, dialect, repeat=5)
        beside(f"1 M lines to a toolpath, {dialect}", ours, theirs, f"{LINES / ours:,.0f} lines/s", "≥ 40")
        row("  memory beyond the start", f"{memory / count:.0f} bytes a move", "", "", "≤ 160")
    for title, text in writing.rows(finishing):
        row(title, text, "", "", "≥ 8")
    seconds, _, _ = measure.child(file, "rosetta", CHECK)
    row("check of 1 M lines", f"{seconds:.3f} s", "", "", "")
    seconds, _, count = measure.child(file, "rosetta", PLAN)
    row("plan of them", f"{seconds:.3f} s ({count / seconds:,.0f} moves/s)", "", "", "≥ 1,000,000 moves/s")
    for command, goal in (("time", "≤ 3 s"), ("plot", "≤ 3 s")):
        output = ("-o", str(folder / "x.html")) if command == "plot" else ()
        seconds = measure.process([*AIRCUT, command, str(file), *output], 2)
        row(f"aircut {command}, whole process", f"{seconds:.2f} s", "", "", goal)


def language(folder: Path) -> None:
    """Macros, calls, cycles, compensation."""
    for make in macros.WORKS:
        work = make()
        theirs_file, ours_file = folder / "theirs.ngc", folder / "ours.ngc"
        theirs_file.write_bytes(work.linuxcnc)
        ours_file.write_bytes(work.rosetta)
        theirs = measure.oracle(theirs_file)
        for dialect, file in (("rosetta", ours_file), ("linuxcnc", theirs_file)):
            ours = measure.child(file, dialect, repeat=2)[0]
            rate = f"{work.count / ours:,.0f} {work.of}/s"
            beside(f"{work.title}, {dialect}", ours, theirs, rate, f"≥ {work.goal:g}")


def five_axes() -> None:
    program = aircut.loads(rtcp.five_axis())
    start = time.process_time()
    result = program.run(rtcp.machine())
    seconds = time.process_time() - start
    assert isinstance(result, aircut.Result) and result.ok
    row(
        "tool center point control",
        f"{seconds:.3f} s ({rtcp.LINES / seconds:,.0f} lines/s)",
        "",
        "",
        "≥ 300,000 lines/s",
    )


def main() -> None:
    row("work", "aircut", "rs274", "times as fast", "goal")
    row(*["---"] * 5)
    with tempfile.TemporaryDirectory() as name:
        plain(Path(name))
        language(Path(name))
    five_axes()
    for title, text in streaming.rows(finishing):
        row(title, text, "", "", "")
    for title, words, goal in (("--help", ["--help"], ""), ("check", ["check", "examples/bracket.ngc"], "≤ 0.20 s")):
        seconds = measure.process([*AIRCUT, *words], 5)
        row(f"aircut {title}, a small file", f"{seconds:.3f} s", "", "", goal)


if __name__ == "__main__":
    main()
