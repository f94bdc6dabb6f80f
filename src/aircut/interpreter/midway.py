"""Compile modes, and starting in the middle: from a line, or where a run was stopped.

Everything before the line is interpreted for its state, with nobody to ask and
without motion; then the machine is told the state and brought to the place.
Sources: 000 section 2.2.3; decisions AMB-EXE-2, AMB-NAM-8.
"""

from __future__ import annotations

from typing import Any

from aircut.canon import ROW
from aircut.canon.commands import MANY, SETS
from aircut.canon.record import Events
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.motion import FEED, TRAVERSE, apart
from aircut.interpreter.path import Place
from aircut.interpreter.running import Arrival, Start
from aircut.interpreter.state import State
from aircut.interpreter.table import Group

CUTTING = ("G1", "G2", "G3")


class Midway:
    """The way of one run to its start: what it did before is only watched."""

    def __init__(self, start: Start, standing: Place) -> None:
        self.start = start
        self.standing = list(start.stop.place) if start.stop else standing
        self.highest = self.standing[2]
        self.last: Place | None = None
        self.told: dict[tuple[Any, ...], tuple[str, tuple[Any, ...]]] = {}  # the last event of each thing set

    def drop(self, m: State) -> None:
        """Forget the motion so far, but for its height and its end; of the events, what they set stays known."""
        import numpy as np

        from aircut.canon.toolpath import Toolpath

        out = m.out
        if out.rows:
            ends = Toolpath.of_rows([bytes(out.rows)]).ends()
            self.highest = max(self.highest, float(np.max(ends[:, 2])))
            self.last = ends[-1].tolist()
        out.first += len(out.rows) // ROW.size
        out.place = out.end()
        out.rows = bytearray()
        out.contour = bytearray()
        for event in out.events:
            what = SETS.get(event.name)
            if what is not None:
                key = (what, event.values[0]) if what in MANY else (what,)
                self.told.pop(key, None)  # the last comes last
                self.told[key] = event.name, event.values
        out.events = Events()
        out.marks = [0] * len(out.marks)

    def arrived(self, m: State, line: int) -> bool:
        return line >= self.start.line and m.out.moves >= self.start.moves

    def begin(self, m: State, line: int) -> Arrival:
        """Tell the state, and go to the place. Raises Refusal under radius compensation."""
        cutter = m.modal[Group.CUTTER]
        if cutter.name != "G40":
            raise Refusal(F.START_COMPENSATED, line=line, code=cutter.name)
        path.flush(m)
        self.drop(m)
        m.out.first = 0
        m.restarted = [*m.position]
        self.tell(m)
        goal = self.last if "rtcp" in m.stages and self.last is not None else m.to_space(m.position)
        top = max(self.highest, goal[2])
        above = [*goal[:2], top, *goal[3:]]
        feeding = m.motion is not None and m.motion.name in CUTTING and m.feed > 0.0 and goal[2] < top
        way = [
            ("G0", [*self.standing[:2], top, *self.standing[3:]]),
            ("G0", above),
            ("G1" if feeding else "G0", goal),
        ]
        approach: list[tuple[str, tuple[float, ...]]] = []
        here = self.standing
        for code, end in way:
            if apart(here, end):
                kind, speed = (FEED, m.feed) if code == "G1" else (TRAVERSE, 0.0)
                path.record_line(m, kind, end, speed, m.flags)
                approach.append((code, tuple(end)))
                here = end
        modes = tuple(row.name for row in m.modal.values())
        told = f"T{m.tool} F{m.feed / m.unit:g} S{m.speed:g}"
        return Arrival(line, tuple(m.position), modes, told, tuple(approach))

    def tell(self, m: State) -> None:
        """Write down what is in force; the tool is in the spindle already."""
        for name, values in self.told.values():
            m.out.event(name, *values)
        if m.tool:
            m.out.event("CHANGE_TOOL_NUMBER", m.tool)
        if m.selected_tool != m.tool:
            m.out.event("SELECT_TOOL", m.selected_tool)
