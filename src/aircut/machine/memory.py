"""Which numbered variables outlive a run, and LinuxCNC's parameter files that hold them.

A machine's folder has them in state.db (see store); a parameter file (lines of a
number and a value) can be read and written in its place. Values are kept as the
machine stores them: mm and degrees.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from aircut.files import replacing
from aircut.machine.config import MachineError

#: Numbered variables that outlive a run (AMB-VAR-3, AMB-VAR-20).
PERSISTENT = (
    *range(4000, 5000),
    *range(5161, 5167),
    *range(5181, 5187),
    *range(5210, 5217),
    *(5220 + 20 * system + axis for system in range(9) for axis in range(1, 7)),
    5220,
)
#: A line of a parameter file, as LinuxCNC reads it: what follows the second number does not count.
ENTRY = re.compile(r"\s*([+-]?\d{1,9})(?!\d)\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)", re.ASCII | re.IGNORECASE)
#: Tables that the user fills in and programs read.
GIVEN = (*range(100, 500), *range(6000, 7000))

#: Those among them that change with the machine's password only.
PROTECTED = range(6000, 7000)


def read_parameters(path: Path, known: Iterable[int]) -> dict[int, float]:
    """Variables of a parameter file. A missing file is as good as an empty one. Raises MachineError.

    Lines that do not start with a whole number and a number are passed over;
    numbers must ascend and be among `known`.
    """
    known = set(known)
    variables: dict[int, float] = {}
    try:
        text = path.read_text("utf-8", "replace")
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    last = 0
    for at, line in enumerate(text.splitlines(), 1):
        found = ENTRY.match(line)
        if found is None:
            continue
        number, value = int(found[1]), float(found[2])
        if number <= last:
            raise MachineError(f"{path}:{at}: variable {number} is out of order")
        if number not in known:
            raise MachineError(f"{path}:{at}: variable {number} cannot be set from a file")
        last = number
        variables[number] = value
    return variables


def write_parameters(path: Path, variables: dict[int, float]) -> None:
    """Write a parameter file; the old one stays beside it with the suffix .bak. Raises OSError."""
    text = "".join(f"{number}\t{value:.6f}\n" for number, value in sorted(variables.items()))
    with replacing(path) as file:
        file.write(text)
        if path.exists():
            backup = path.with_name(path.name + ".bak")
            backup.unlink(missing_ok=True)
            os.link(path, backup)
