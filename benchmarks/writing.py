"""From a program to its canonical listing on disk, whole processes, beside LinuxCNC's `rs274 -g FILE >/dev/null`."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from measure import oracle, process


def rows(finishing: Callable[[int], bytes], lines: int = 1_000_000) -> list[tuple[str, str]]:
    """What is to be told: processor times of both sides, and how many times faster ours is."""
    table = []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "part.ngc")
        file.write_bytes(finishing(lines))
        theirs = oracle(file, 2)
        for dialect in ("rosetta", "linuxcnc"):
            output = str(Path(folder, "part.txt"))
            command = [sys.executable, "-m", "aircut", "run", str(file), "--dialect", dialect]
            ours = process([*command, "--format", "canon", "-o", output], 3)
            beside = f", {theirs / ours:.1f} times as fast as rs274" if theirs else ""
            table.append((f"listing on disk, {dialect}", f"{lines / ours:,.0f} lines/s{beside}"))
    return table


if __name__ == "__main__":
    from run import finishing

    for row in rows(finishing):
        print("|", *row, "|", sep=" ")
