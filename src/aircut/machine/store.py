"""state.db: what a machine remembers between runs, in its own folder (SQLite).

Numbered variables (mm and degrees, as the machine stores them), tools that programs have
changed, and the password of the protected variables. Null is kept by leaving a variable
out. Each change is one transaction, so that the state is always a whole one, whenever the
process ends; a digest of all that is stored tells a damaged file, which is never written to.
Sources: decisions AMB-VAR-2, AMB-VAR-3, AMB-VAR-20; 000 section 2 (protected variables).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from aircut.machine.config import MachineError
from aircut.machine.memory import GIVEN, PERSISTENT, PROTECTED
from aircut.machine.stops import Stop
from aircut.machine.tools import Tool

if TYPE_CHECKING:
    import sqlite3

FILE = "state.db"
APPLICATION = 0x41434E43  # "ACNC": whose database it is, in SQLite's header
VERSION = 1
PATIENCE = 30.0  # seconds to wait for another process
SCHEMA = {
    "variables": "CREATE TABLE variables (number INTEGER PRIMARY KEY, value REAL NOT NULL)",
    "tools": "CREATE TABLE tools (id INTEGER PRIMARY KEY, tool TEXT NOT NULL)",  # as JSON
    "password": "CREATE TABLE password (salt BLOB NOT NULL, hash BLOB NOT NULL, log_n INTEGER NOT NULL)",
    "stop": "CREATE TABLE stop (id INTEGER PRIMARY KEY CHECK (id = 0), stop TEXT NOT NULL)",  # as JSON
    "digest": "CREATE TABLE digest (value TEXT NOT NULL)",
}
LEFT_BY_RUNS = frozenset(PERSISTENT)
KNOWN = frozenset((*PERSISTENT, *GIVEN))


class Password(NamedTuple):
    """A password as it is kept."""

    salt: bytes
    hash: bytes
    log_n: int


class Stored(NamedTuple):
    """All of a state.db."""

    variables: dict[int, float]
    tools: dict[int, Tool]
    password: Password | None = None
    stop: Stop | None = None  # where the last run was stopped


def recall(folder: Path) -> Stored:
    """What a machine's folder remembers; nothing without a state.db. Raises MachineError."""
    if not (folder / FILE).exists():
        return Stored({}, {})
    with opened(folder) as database:
        return read(database, folder)


def remember(folder: Path, variables: Mapping[int, float], tools: Mapping[int, Tool], stop: Stop | None = None) -> None:
    """Write what a run leaves behind: the variables that outlive it, the changed tools, and where it was stopped.

    What is not given is null from now on; tables that programs only read stay as they are.
    Raises MachineError.
    """
    with changing(folder) as (database, stored):
        kept = {number: value for number, value in stored.variables.items() if number not in LEFT_BY_RUNS}
        kept |= {number: value for number, value in variables.items() if number in LEFT_BY_RUNS}
        write(database, stored._replace(variables=kept, tools=dict(tools), stop=stop))


def change(folder: Path, values: Mapping[int, float | None], password: str = "") -> None:
    """Set variables by hand; None makes one null. Raises MachineError.

    password: needed where a protected variable is among them.
    """
    for number, value in values.items():
        if number not in KNOWN:
            raise MachineError(f"variable {number} does not outlive a run")
        if value is not None and not math.isfinite(value):
            raise MachineError(f"variable {number}: give a finite number, or null")
    with changing(folder) as (database, stored):
        if any(number in PROTECTED for number in values):
            check(stored.password, password, folder)
        kept = {**stored.variables, **values}
        write(database, stored._replace(variables={n: v for n, v in kept.items() if v is not None}))


def set_password(folder: Path, new: str, old: str = "") -> None:
    """Set the password of the protected variables, or change it. Raises MachineError."""
    with changing(folder) as (database, stored):
        if stored.password is not None:
            check(stored.password, old, folder)
        write(database, stored._replace(password=made(new)))


# --- passwords


def made(password: str) -> Password:
    """A password to be kept. Raises MachineError for an empty one."""
    import os

    from aircut.machine import ngx

    salt = os.urandom(16)
    try:
        return Password(salt, ngx.derive(ngx.encoded(password), salt, ngx.LOG_N, ngx.R, ngx.P), ngx.LOG_N)
    except ngx.NgxError as error:
        raise MachineError(str(error).replace("key", "password")) from None


def check(kept: Password | None, given: str, folder: Path) -> None:
    """Raises MachineError unless the password is right."""
    import hmac

    from aircut.machine import ngx

    if kept is None:
        raise MachineError(f"{folder}: protected variables need a password, and none is set: aircut machine password")
    if not given:
        raise MachineError(f"{folder}: protected variables need the machine's password")
    try:
        hash = ngx.derive(ngx.encoded(given), kept.salt, kept.log_n, ngx.R, ngx.P)
    except ngx.NgxError as error:
        raise MachineError(str(error).replace("key", "password")) from None
    if not hmac.compare_digest(hash, kept.hash):
        raise MachineError(f"{folder}: wrong password")


# --- the file


@contextmanager
def opened(folder: Path) -> Iterator[sqlite3.Connection]:
    """The database, outside any transaction. Raises MachineError for whatever SQLite finds."""
    import sqlite3

    path = folder / FILE
    try:
        with closing(sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)) as database:
            yield database
    except sqlite3.Error as error:
        raise MachineError(f"{path}: {error}") from None


@contextmanager
def changing(folder: Path) -> Iterator[tuple[sqlite3.Connection, Stored]]:
    """One transaction: what is stored now, and the database to write to. Nothing is written if it raises."""
    with opened(folder) as database:
        database.execute("PRAGMA synchronous = FULL")
        database.execute("BEGIN IMMEDIATE")
        try:
            yield database, read(database, folder)
            database.execute("COMMIT")
        except BaseException:
            if database.in_transaction:
                database.execute("ROLLBACK")
            raise


def read(database: sqlite3.Connection, folder: Path) -> Stored:
    """All of the database, checked. Raises MachineError, sqlite3.Error."""
    path = folder / FILE
    tables = {name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    (application,) = database.execute("PRAGMA application_id").fetchone()
    (version,) = database.execute("PRAGMA user_version").fetchone()
    if not tables and not application:
        return Stored({}, {})
    if (application or APPLICATION) != APPLICATION or not tables <= SCHEMA.keys():
        raise MachineError(f"{path}: this is not a machine's memory")
    if version > VERSION:
        raise MachineError(f"{path}: written by a newer aircut")
    for (problem,) in database.execute("PRAGMA quick_check(1)"):
        if problem != "ok":
            raise MachineError(f"{path}: damaged: {problem}")
    rows = {name: database.execute(f"SELECT * FROM {name}").fetchall() if name in tables else [] for name in SCHEMA}
    try:
        variables = msgspec.convert(dict(rows["variables"]), dict[int, float])
        tools = [msgspec.json.decode(text, type=Tool) for _, text in rows["tools"]]
        password = Password(*rows["password"][0]) if rows["password"] else None
        stop = msgspec.json.decode(rows["stop"][0][1], type=Stop) if rows["stop"] else None
    except (msgspec.MsgspecError, TypeError, ValueError) as error:
        raise MachineError(f"{path}: damaged: {error}") from None
    stored = Stored(variables, {tool.id: tool for tool in tools}, password, stop)
    if version and rows["digest"] != [(digest(stored),)]:
        raise MachineError(f"{path}: damaged: its values are not those that aircut wrote")
    return stored


def write(database: sqlite3.Connection, stored: Stored) -> None:
    """Put all of a state in place of what is there. Within a transaction."""
    rows: dict[str, list[Any]] = {
        "variables": list(numbers(stored)),
        "tools": [(tool.id, msgspec.json.encode(tool).decode()) for tool in stored.tools.values()],
        "password": [tuple(stored.password)] if stored.password else [],
        "stop": [(0, msgspec.json.encode(stored.stop).decode())] if stored.stop else [],
        "digest": [(digest(stored),)],
    }
    for name, statement in SCHEMA.items():
        database.execute(f"DROP TABLE IF EXISTS {name}")
        database.execute(statement)
        if rows[name]:
            places = ", ".join("?" * len(rows[name][0]))
            database.executemany(f"INSERT INTO {name} VALUES ({places})", rows[name])
    database.execute(f"PRAGMA application_id = {APPLICATION}")
    database.execute(f"PRAGMA user_version = {VERSION}")


def numbers(stored: Stored) -> Iterator[tuple[int, float]]:
    """The variables as they are written: NaN is null, and SQLite knows no negative zero."""
    return ((number, value + 0.0) for number, value in sorted(stored.variables.items()) if not math.isnan(value))


def digest(stored: Stored) -> str:
    """A checksum of all that is stored."""
    import hashlib

    text = repr((
        [(number, value.hex()) for number, value in numbers(stored)],
        [msgspec.json.encode(tool) for _, tool in sorted(stored.tools.items())],
        stored.password and tuple(stored.password),
        stored.stop and msgspec.json.encode(stored.stop),
    ))  # fmt: skip
    return hashlib.sha256(text.encode()).hexdigest()
