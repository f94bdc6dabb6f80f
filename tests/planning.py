"""What the tests of the planner share: toolpaths by hand, and random programs."""

from __future__ import annotations

import numpy as np

import aircut
from aircut.canon import ROW, Toolpath
from aircut.machine import Machine, built_in
from aircut.machine.config import Axis, File, Motion
from aircut.planner import Plan, plan


def machine(velocity=6000.0, acceleration=500.0, jerk=0.0, axes="xyzabc", cycle=0.001, **more) -> Machine:
    """A machine whose axes are all alike. Velocity mm/min, acceleration mm/s², jerk mm/s³."""
    made = {}
    for letter in axes:
        kind = "linear" if letter in "xyz" else "rotary_table"
        made[letter] = Axis(type=kind, min=-1e9, max=1e9, velocity=velocity, acceleration=acceleration, jerk=jerk)
    return Machine(File("test", axes=made, motion=Motion(cycle=cycle), **more), {}, own_tools=False)


def planned(text: str, on: Machine | None = None, **options) -> Plan:
    """The plan of a program."""
    on = on or machine()
    result = aircut.loads(text).run(on)
    assert result.ok, result.diagnostics
    return plan(result.recording, on, **options)


def toolpath(points, feed=6000.0, kind=1, flags=0) -> Toolpath:
    """Straight moves to points of up to six axes. feed: mm/min."""
    rows = b""
    for i, point in enumerate(points, 1):
        place = (*point, *[0.0] * (6 - len(point)))
        rows += ROW.pack(*place, 0.0, 0.0, 0.0 if kind == 0 else feed, i, 0, 0, 0, kind, 0, flags)
    return Toolpath.of_rows([rows])


def derivatives(plan: Plan, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Largest sampled velocity, acceleration and jerk of each axis: differences of positions dt apart."""
    count = int(plan.duration / dt) + 5
    place = plan.samples((np.arange(-4, count)) * dt).position
    tops = []
    for order in (1, 2, 3):
        tops.append(np.abs(np.diff(place, order, axis=0)).max(axis=0) / dt**order)
    return tuple(tops)


def default() -> Machine:
    return built_in("XYZABC")
