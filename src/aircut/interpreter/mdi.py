"""MDI: commands run one by one, with the modes and variables that the ones before left.

Each command has named variables of its own (AMB-NAM-15) and its own #1 to #33;
faults stop that command only.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

from aircut.canon import Chunk
from aircut.diagnostics import Diagnostic
from aircut.interpreter import starting
from aircut.interpreter.inputs import switched_off
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.requests import Request
from aircut.interpreter.running import Mode, Settings, Stopped
from aircut.interpreter.table import Dialect
from aircut.interpreter.unit import Unit
from aircut.machine import Machine
from aircut.source import Source

NAME = "mdi"  # the file that diagnostics name


class Session:
    """A machine under manual data input."""

    def __init__(self, dialect: Dialect, machine: Machine, settings: Settings | None = None) -> None:
        settings = (settings or Settings())._replace(mode=Mode.MDI)
        self.interpreter = Interpreter(Source(NAME, b""), dialect, machine, settings)
        self.interpreter.state.compile_mode = Mode.MDI
        starting.begin(self.interpreter.state)
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
        unit = Unit(Source(NAME, command.encode()), running.dialect, running.settings.block_delete,
                    running.settings.limits.line)  # fmt: skip
        running.enter_command(unit)
        if not running.failed and any(unit.source.classes):
            try:
                yield from running.blocks()
            except Stopped:
                pass
            yield from switched_off(running.state)
        running.leave_command()
        yield running.state.out.take()
