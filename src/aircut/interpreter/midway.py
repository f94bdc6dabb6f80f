"""Compile modes, and starting in the middle: from a line, or where a run was stopped.

Everything before the line is interpreted for its state, with nobody to ask and
without motion; then the machine is told the state and brought to the place.
Sources: 000 section 2.2.3; decisions AMB-EXE-2, AMB-NAM-8.
"""

from __future__ import annotations

from aircut.canon import ROW
from aircut.canon.record import Events
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.motion import FEED, TRAVERSE, apart
from aircut.interpreter.offsets import tell_shift, tell_system
from aircut.interpreter.path import Place
from aircut.interpreter.running import Arrival, Start
from aircut.interpreter.state import INCH, PLANES, State
from aircut.interpreter.table import Group

CUTTING = ("G1", "G2", "G3")


class Midway:
    """The way of one run to its start: what it did before is only watched."""

    def __init__(self, start: Start, standing: Place) -> None:
        self.start = start
        self.standing = list(start.stop.place) if start.stop else standing
        self.highest = self.standing[2]
        self.last: Place | None = None

    def drop(self, m: State) -> None:
        """Forget the motion so far, but for its height and its end."""
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
        tell(m)
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


def tell(m: State) -> None:
    """Write down the modes in force, as far as they differ from those at the start of a run."""
    out = m.out
    if m.unit == INCH:
        out.event("USE_LENGTH_UNITS", "INCHES")
    tell_system(m)
    tell_shift(m)
    if m.plane:
        out.event("SELECT_PLANE", PLANES[m.plane])
    if m.tool:
        out.event("CHANGE_TOOL_NUMBER", m.tool)
    if m.selected_tool != m.tool:
        out.event("SELECT_TOOL", m.selected_tool)
    if any(m.tool_offset):
        out.event("USE_TOOL_LENGTH_OFFSET", *m.tool_offset, 0.0, 0.0, 0.0)
    if m.speed:
        out.event("SET_SPINDLE_SPEED", 0, m.speed)
    if m.spindle != 5:
        turning = {3: "START_SPINDLE_CLOCKWISE", 4: "START_SPINDLE_COUNTERCLOCKWISE"}
        out.event(turning[m.spindle], 0)
    if m.mist:
        out.event("MIST_ON")
    if m.flood:
        out.event("FLOOD_ON")
    if m.feed and not m.inverse_time:
        out.event("SET_FEED_RATE", m.feed)
