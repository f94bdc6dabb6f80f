"""Where the last run on a machine was stopped, in its state.db: what RESUME starts from.

Lengths mm, angles degrees.
"""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import msgspec

from aircut.machine.config import MachineError

SCHEMA = "CREATE TABLE IF NOT EXISTS stop (id INTEGER PRIMARY KEY CHECK (id = 0), stop TEXT NOT NULL)"


class Stop(NamedTuple):
    """Where a run was stopped."""

    program: str
    line: int  # of the main program, from 1
    moves: int  # made before it, since the program's start
    place: tuple[float, ...]  # machine coordinates of the controlled point, mm and degrees


def last(folder: Path) -> Stop | None:
    """The stop of the last run; None if it came to its end. Raises MachineError."""
    import sqlite3

    path = folder / "state.db"
    if not path.exists():
        return None
    try:
        with closing(sqlite3.connect(path)) as database, database:
            database.execute(SCHEMA)
            row = database.execute("SELECT stop FROM stop").fetchone()
        return msgspec.json.decode(row[0], type=Stop) if row else None
    except (sqlite3.Error, msgspec.MsgspecError) as error:
        raise MachineError(f"{path}: {error}") from None


def keep(folder: Path, stop: Stop | None) -> None:
    """Remember a stop, or (None) that there is none. Raises MachineError."""
    import sqlite3

    path = folder / "state.db"
    try:
        with closing(sqlite3.connect(path)) as database, database:
            database.execute(SCHEMA)
            if stop is None:
                database.execute("DELETE FROM stop")
            else:
                database.execute("INSERT OR REPLACE INTO stop VALUES (0, ?)", [msgspec.json.encode(stop).decode()])
    except sqlite3.Error as error:
        raise MachineError(f"{path}: {error}") from None
