"""Programs larger than memory should have to be: checked in bounded memory, at a cost that grows with the lines."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

CHILD = """
import re, resource, sys
import aircut
aircut.loads("G0 X1\\nG1 X0 F1\\nM2\\n").check()
def spent():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
def peak():
    return int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1]) * 1024
before = spent()
{work}
print(spent() - before, peak())
"""
CHECK = "found = aircut.load(sys.argv[1]).check(); assert not found, found"
RUN = "toolpath = aircut.load(sys.argv[1]).run().toolpath"


def measured(file: Path, work: str, repeat: int = 3) -> tuple[float, int]:
    """Least processor time, s, and bytes of memory at the peak, of a process that does this with a file."""
    found = []
    for _ in range(repeat):
        command = [sys.executable, "-c", CHILD.format(work=work), str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        seconds, memory = done.stdout.split()
        found.append((float(seconds), int(memory)))
    return min(found)


def longer(part: bytes, times: int) -> bytes:
    """The same part so many times over, without its last three lines between."""
    lines = part.splitlines(keepends=True)
    return b"".join(lines[:-3]) * times + b"".join(lines[-3:])


def rows(finishing: Callable[[int], bytes], lines: int = 1_000_000, times: int = 10) -> list[tuple[str, str]]:
    """What is to be told: growth of cost from `lines` lines to so many times as many, and memory."""
    with tempfile.TemporaryDirectory() as folder:
        small, large = Path(folder, "small.ngc"), Path(folder, "large.ngc")
        part = finishing(lines)
        small.write_bytes(part)
        large.write_bytes(longer(part, times))
        size = large.stat().st_size
        table = []
        for name, work in (("check", CHECK), ("run", RUN)):
            (one, _), (many, memory) = measured(small, work), measured(large, work, 2)
            table.append((f"{name}: cost a line, {times} times the lines", f"{many / times / one:.2f} times"))
            told = f"{memory / size:.2f} of the file" if work is CHECK else f"{memory / lines / times:.0f} bytes a line"
            table.append((f"{name}: memory at its peak", told))
    return table


if __name__ == "__main__":
    from run import finishing

    for row in rows(finishing):
        print("|", *row, "|", sep=" ")
