"""What a machine remembers between runs: numbered variables, and tools that programs have changed.

In its own folder they lie in state.db; a LinuxCNC parameter file (lines of a
number and a value) can be read and written in its place. Values are kept as the
machine stores them: mm and degrees.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

import msgspec

from aircut.files import replacing
from aircut.machine.config import MachineError
from aircut.machine.tools import Tool

#: Numbered variables that outlive a run (AMB-VAR-3, AMB-VAR-20).
PERSISTENT = (
    *range(4000, 5000),
    *range(5161, 5167),
    *range(5181, 5187),
    *range(5210, 5217),
    *(5220 + 20 * system + axis for system in range(9) for axis in range(1, 7)),
    5220,
)
#: Tables that the user fills in and programs read.
GIVEN = (*range(100, 500), *range(6000, 7000))

SCHEMA = (
    "CREATE TABLE IF NOT EXISTS variables (number INTEGER PRIMARY KEY, value REAL NOT NULL)",
    "CREATE TABLE IF NOT EXISTS tools (id INTEGER PRIMARY KEY, tool TEXT NOT NULL)",  # as JSON
)


def recall(folder: Path) -> tuple[dict[int, float], dict[int, Tool]]:
    """Variables, and tools that programs have changed, of a machine's folder; none without a state.db.

    Raises MachineError.
    """
    import sqlite3

    path = folder / "state.db"
    if not path.exists():
        return {}, {}
    try:
        with closing(sqlite3.connect(path)) as database, database:
            for statement in SCHEMA:
                database.execute(statement)
            variables = dict(database.execute("SELECT number, value FROM variables").fetchall())
            rows = database.execute("SELECT tool FROM tools").fetchall()
        tools = [msgspec.json.decode(text, type=Tool) for (text,) in rows]
    except (sqlite3.Error, msgspec.MsgspecError) as error:
        raise MachineError(f"{path}: {error}") from None
    return variables, {tool.id: tool for tool in tools}


def remember(folder: Path, variables: dict[int, float], tools: dict[int, Tool]) -> None:
    """Write variables and changed tools to state.db, in one transaction; what is not given is dropped.

    Raises MachineError.
    """
    import sqlite3

    path = folder / "state.db"
    rows = [(tool.id, msgspec.json.encode(tool).decode()) for tool in tools.values()]
    try:
        with closing(sqlite3.connect(path)) as database, database:
            for statement in SCHEMA:
                database.execute(statement)
            database.execute("DELETE FROM variables")
            database.executemany("INSERT INTO variables VALUES (?, ?)", sorted(variables.items()))
            database.execute("DELETE FROM tools")
            database.executemany("INSERT INTO tools VALUES (?, ?)", rows)
    except sqlite3.Error as error:
        raise MachineError(f"{path}: {error}") from None


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
        words = line.split()
        try:
            number, value = int(words[0]), float(words[1])
        except (IndexError, ValueError):
            continue
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
