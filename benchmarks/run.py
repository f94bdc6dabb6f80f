"""Benchmarks, printed as a table: `make bench`.

Every figure is also a ratio to a fixed piece of Python work timed in the same
run, so that tables of different machines can be compared.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import measure

import aircut

LINES = 1_000_000
GOALS = {"plan of the same": "1,000,000 moves/s",
         "general lane, 1 M lines of CAM": "150,000 lines/s", "memory beyond the file": "250 bytes a move",
         "file to toolpath, rosetta": "40 times", "file to toolpath, linuxcnc": "40 times",
         "aircut --help": "0.25 s", "aircut check, small file": "0.25 s"}  # fmt: skip


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


def macro(passes: int) -> bytes:
    """A WHILE loop with trigonometry: seven blocks a pass."""
    return f"""F500
#1=0
WHILE [#1 LT {passes}] DO1
#2=[COS[#1*0.1]*10+0.5]
#3=[SIN[#1*0.1]*10]
IF [#2 GT 5] THEN #4=1
G1 X#2 Y#3
#1=[#1+1]
END1
M2
""".encode()


def timed(work: Callable[[], object]) -> tuple[float, object]:
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def python_work() -> None:
    """The yardstick: a million turns of a simple loop."""
    total = 0.0
    for i in range(1_000_000):
        total += i * 0.5


def memory() -> float:
    """Bytes a move that a run takes beyond the file and its line table, at its peak, in a process of its own."""
    code = (
        "import re, sys, aircut\n"
        "peak = lambda: int(re.search(r'VmHWM:\\s+(\\d+)', open('/proc/self/status').read())[1]) * 1024\n"
        "import numpy\n"
        "program = aircut.load(sys.argv[1]); before = peak()\n"
        "toolpath = program.run().toolpath\n"
        "print((peak() - before) / len(toolpath))"
    )
    with tempfile.NamedTemporaryFile(suffix=".ngc") as file:
        file.write(finishing(LINES))
        file.flush()
        done = subprocess.run([sys.executable, "-c", code, file.name], capture_output=True, text=True, check=True)
    return float(done.stdout)


def ratios() -> list[tuple[str, str, float]]:
    """File to toolpath in memory, in each language, beside LinuxCNC's interpreter: processor time of both."""
    found: list[tuple[str, str, float]] = []
    with tempfile.NamedTemporaryFile(suffix=".ngc") as file:
        file.write(finishing(LINES))
        file.flush()
        for dialect in ("rosetta", "linuxcnc"):
            ours = measure.child(Path(file.name), dialect)[0]
            theirs = measure.oracle(Path(file.name), 2)
            text = (
                f"{ours:.3f} s" if theirs is None else f"{ours:.3f} s, rs274 {theirs:.2f} s: {theirs / ours:.0f} times"
            )
            found.append((f"file to toolpath, {dialect}", text, 0.0))
    return found


def process(*args: str) -> float:
    """Seconds of a whole process, best of five."""
    command = [sys.executable, "-m", "aircut", *args]
    return min(timed(lambda: subprocess.run(command, capture_output=True, check=True))[0] for _ in range(5))


def main() -> None:
    yard = min(timed(python_work)[0] for _ in range(3))
    rows: list[tuple[str, str, float]] = []
    data = finishing(LINES)
    loading, program = timed(lambda: aircut.loads(data))
    assert isinstance(program, aircut.Program)
    running, result = timed(lambda: program.run())
    assert isinstance(result, aircut.Result) and result.ok, result.diagnostics
    columns, _ = timed(lambda: result.toolpath)
    total = loading + running + columns
    rows.append(("general lane, 1 M lines of CAM", f"{LINES / total:,.0f} lines/s", total / yard))
    rows += ratios()
    rows.append(("memory beyond the file", f"{memory():.0f} bytes a move", 0.0))
    rows.append(("  line table and classes", f"{LINES / loading:,.0f} lines/s", loading / yard))
    checking, _ = timed(program.check)
    rows.append(("check of the same", f"{LINES / checking:,.0f} lines/s", checking / yard))
    planning, plan = timed(lambda: result.plan())
    rows.append(("plan of the same", f"{len(plan.times) / planning:,.0f} moves/s", planning / yard))  # type: ignore[attr-defined]
    loop = aircut.loads(macro(100_000))
    looping, _ = timed(loop.run)
    rows.append(("macro loop", f"{700_000 / looping:,.0f} blocks/s", looping / yard))
    seconds = process("--help")
    rows.append(("aircut --help", f"{seconds:.3f} s", seconds / yard))
    seconds = process("check", "examples/bracket.ngc")
    rows.append(("aircut check, small file", f"{seconds:.3f} s", seconds / yard))
    print(f"| work | result | goal | times the yardstick ({yard:.3f} s) |")
    print("| --- | --- | --- | --- |")
    for name, text, ratio in rows:
        print(f"| {name} | {text} | {GOALS.get(name, '')} | {f'{ratio:.2f}' if ratio else ''} |")


if __name__ == "__main__":
    main()
