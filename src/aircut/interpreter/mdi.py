"""MDI: commands run one by one, with the modes and variables that the ones before left.

Faults stop that command only. In RosettaCNC's language each command has named variables of its own (AMB-NAM-15)
and its own #1 to #33; in LinuxCNC's they stay, as do all others.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

from aircut.canon import Chunk
from aircut.diagnostics import Diagnostic
from aircut.interpreter.midway import Marked
from aircut.interpreter.requests import Request
from aircut.interpreter.running import Mode, Settings
from aircut.interpreter.table import Dialect
from aircut.machine import Machine
from aircut.source import Source

NAME = "mdi"  # the file that diagnostics name


class Session:
    """A machine under manual data input."""

    def __init__(self, dialect: Dialect, machine: Machine, settings: Settings | None = None) -> None:
        settings = (settings or Settings())._replace(mode=Mode.MDI)
        made = dialect.interpreter(Source(NAME, b""), dialect, machine, settings)
        assert isinstance(made, Marked)
        self.interpreter = made
        self.interpreter.state.compile_mode = Mode.MDI
        self.interpreter.begin()
        self.opening = self.interpreter.state.out.take()

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Those of the last command."""
        return self.interpreter.diagnostics

    def run(self, command: str) -> Iterator[Chunk]:
        """Run one command (a line, or more) with nobody to ask."""
        for item in self.execute(command):
            if isinstance(item, Chunk):
                yield item

    def execute(self, command: str) -> Generator[Chunk | Request, Any, None]:
        """Run one command: yields motion and events, and requests, to be sent replies."""
        running = self.interpreter
        yield from running.command(Source(NAME, command.encode()))
        yield running.state.out.take()
