"""Files that a program writes: those of LOGOPEN and LOGAPPEND, and of PROBEOPEN.

They are kept until the run has ended: a simulated program writes nothing but where it is
told to (`aircut run --logs`). Source: 001 Logging, Probe Logging.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from aircut.interpreter.running import Log

PROBE_LOG = re.compile(r"[ \t]*probe(?:open[ \t]+(?P<name>.*)|close[ \t]*$)", re.IGNORECASE)


class Logs:
    """The files of a run, by name, and those that are open."""

    def __init__(self) -> None:
        self.files: dict[str, Log] = {}
        self.log: Log | None = None
        self.probes: Log | None = None

    def start(self, name: str, append: bool = False) -> Log:
        """A file that is written from here on."""
        name = name.strip(" \t")
        known = self.files.get(name)
        if known is None or not append:
            known = self.files[name] = Log(append, [])
        return known

    def forget(self) -> None:
        """What was written before the line that a run starts from."""
        for log in self.files.values():
            log.lines.clear()

    def comment(self, text: str) -> None:
        """PROBEOPEN and PROBECLOSE, which are comments like any other beside."""
        if found := PROBE_LOG.match(text):
            self.probes = None if found["name"] is None else self.start(found["name"])

    def probed(self, place: Sequence[float]) -> None:
        """A straight probe has succeeded here: nine axes, program units."""
        if self.probes is not None:
            self.probes.lines.append(" ".join(f"{value:f}" for value in place))
