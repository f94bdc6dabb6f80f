"""Seconds of processor time: of a part of aircut in a process of its own, and of LinuxCNC's interpreter.

Processor time of both sides, user and system, so that other work on the machine shifts a ratio less.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

ORACLE = shutil.which("rs274")

# What a child does with the file; the clock starts behind the imports, as they are told in a row of their own.
CHILD = """
import re, resource, sys
import numpy, aircut
from aircut import dialects
file, dialect, machine = sys.argv[1:4]
aircut.loads("G0 X1\\nG1 X0 F1\\nM2\\n", dialect).run()  # what a first run loads
def spent():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
def peak():
    return int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1]) * 1024
def load():
    return aircut.load(file, dialect)
def run(program):
    result = program.run(machine=machine or None)
    assert result.ok, result.diagnostics
    return result
before, memory = spent(), peak()
count = 0
{work}
print(spent() - before, peak() - memory, count)
"""
TOOLPATH = "count = len(run(load()).toolpath)"


def child(file: Path, dialect: str, work: str = TOOLPATH, machine: str = "", repeat: int = 3) -> tuple[float, int, int]:
    """Least processor time (s) of so many processes, bytes of memory it took more at its peak, and what it counted."""
    found = []
    for _ in range(repeat):
        command = [sys.executable, "-c", CHILD.format(work=work), str(file), dialect, machine]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)
        seconds, memory, count = done.stdout.split()
        found.append((float(seconds), int(memory), int(count)))
    return min(found)


def process(command: Sequence[str], repeat: int = 1) -> float:
    """Least processor time of a whole process, s. Raises RuntimeError when it fails."""
    found = []
    with tempfile.TemporaryDirectory() as home:
        for _ in range(repeat):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            done = subprocess.run(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env={**os.environ, "HOME": home}
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            if done.returncode:
                raise RuntimeError(done.stderr.decode())
            found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(found)


def oracle(file: Path, repeat: int = 1) -> float | None:
    """Processor time of `rs274 -g FILE`, its listing thrown away, s; None where it is not installed."""
    return process([ORACLE, "-g", str(file)], repeat) if ORACLE else None
