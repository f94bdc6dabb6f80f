"""Probing: G38.2 to G38.5.

Sources: 000 section 11; decisions AMB-PRB-1 to AMB-PRB-10.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from math import dist
from typing import Any

from aircut.diagnostics import Fault, Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.motion import PROBE, at_axes, target, write_axes
from aircut.interpreter.requests import Probe, Probed, Request
from aircut.interpreter.state import State
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.interpreter.transforming import refuse_tilted

NEAREST = 0.254  # mm: a shorter way is refused
SUCCESS = 1
FAILURES = {-1: "the probe did not change before the target", -2: "the probe had changed before the start"}


def check(m: State, w: Words, goal: list[float]) -> None:
    """The compile errors, in the order of AMB-PRB-3. Raises Refusal."""
    refuse_tilted(m, "probing")
    faults: tuple[tuple[bool, Fault], ...] = (
        (m.modal[Group.CUTTER].name != "G40", F.PROBE_COMPENSATION),
        (m.inverse_time, F.PROBE_INVERSE_TIME),
        (m.feed <= 0.0, F.PROBE_NO_FEED),
        (goal[3:] != m.position[3:], F.PROBE_ROTARY),
        (dist(goal[:3], m.position[:3]) < NEAREST - 1e-9, F.PROBE_TOO_CLOSE),
    )
    for wrong, fault in faults:
        if wrong:
            raise Refusal(fault)


def probe(toward: bool, alarm: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """G38.x: straight on until the probe changes, or to the target. Raises Refusal for a failure under alarm."""
    goal = target(m, w)
    assert goal is not None
    m.machine_frame = False
    check(m, w, goal)
    aim = m.to_axes(m.to_space(goal))
    m.out.event("TURN_PROBE_ON")
    reply: Probed | None = yield Probe(tuple(m.machine_position()), tuple(aim), toward, m.tool, m.feed)
    stop = aim if reply is None else list(reply.position)
    write_axes(m, PROBE, at_axes(m, dict(enumerate(stop))), m.feed, m.flags)
    m.out.event("TURN_PROBE_OFF")
    m.probe_state = None if reply is None else float(reply.state)
    if reply is None or reply.state == SUCCESS:
        m.probed_machine = list(stop)
        m.probed = list(m.to_program(list(stop)))
    elif alarm:
        raise Refusal(F.PROBE_FAILED, reason=FAILURES[reply.state])


codes = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True, needs_axes=True, modal=True)

CODES = (
    codes("G38.2", "Probe toward contact, or fail", partial(probe, True, True)),
    codes("G38.3", "Probe toward contact", partial(probe, True, False)),
    codes("G38.4", "Probe away from contact, or fail", partial(probe, False, True)),
    codes("G38.5", "Probe away from contact", partial(probe, False, False)),
)
