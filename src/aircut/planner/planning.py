"""From a recording to a plan."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from aircut.canon import Kind, Toolpath
from aircut.canon.toolpath import AXES
from aircut.kernels import lookahead, scurve
from aircut.kernels import pieces as kernel
from aircut.planner.clock import Clock, Overrides, Regime
from aircut.planner.limits import Limits, PlanError, of_machine
from aircut.planner.path import Path
from aircut.planner.plan import Plan, Profile

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from aircut.canon import Recording
    from aircut.machine import Machine
    from aircut.planner.clock import Pause

#: Part of what an axis can do that a jump at a joint may take. The rest is for the motion on both sides.
SHARE = 0.5
#: mm by which a move that is told in short parts, as under tool center point control, may round their corners:
#: as much as its chords may stray (AMB-RTCP-6).
PARTS = 0.01


def plan(
    recording: Recording,
    machine: Machine,
    profile: str | None = None,
    overrides: Overrides | None = None,
    limits: Limits | None = None,
    optional_stop: bool = False,
) -> Plan:
    """Plan a run on a machine.

    profile: auto, trapezoidal, jerk-limited; None as the machine says. limits: in place of the machine's.
    Raises PlanError.
    """
    overrides = overrides or Overrides()
    for name, value in zip(overrides._fields, overrides, strict=True):
        if not (isfinite(value) and value > 0.0):
            raise PlanError(f"{name} override of {100 * value:g} %: it must be above zero, or nothing ever ends")
    clock = Clock(machine, overrides, optional_stop)
    clock.read(recording.events)
    limits = limits or of_machine(machine, profile)
    return plan_moves(recording.toolpath, limits, clock.regimes, clock.halts, clock.pauses)


def plan_moves(
    toolpath: Toolpath,
    limits: Limits,
    regimes: Sequence[Regime] = (Regime(0),),
    halts: Sequence[int] = (),
    pauses: Sequence[Pause] = (),
) -> Plan:
    """Plan moves under settings that change on the way. Raises PlanError."""
    import numpy as np

    check(toolpath, limits)
    rows = None
    path_moves = toolpath
    at = np.array([regime.at for regime in regimes], np.int64)
    stops = np.sort(np.array(halts, np.int64))
    if any(regime.thinning > 0.0 for regime in regimes):
        from aircut.planner.thinning import thinned

        rows = thinned(toolpath, regimes, stops)
        columns = {name: column[rows] for name, column in toolpath.columns.items()}
        path_moves = Toolpath(columns, toolpath.start)
        at, stops = np.searchsorted(rows, at), np.searchsorted(rows, stops)
    smooth = limits.jerk_limited
    laid = lay(path_moves, limits, regimes, at, stops, smooth)
    path = Path(path_moves, laid["length"], laid["move"], laid["shape"], laid["offset"], smooth)
    profile, until = speeds(laid, smooth)
    return Plan(toolpath, path, profile, until, rows, list(pauses), limits)


def check(toolpath: Toolpath, limits: Limits) -> None:
    """Refuse what cannot be planned. Raises PlanError."""
    import numpy as np

    for i, axis in enumerate(AXES):
        column = toolpath.columns[axis]
        if not len(column):
            continue
        low, high = float(column.min()), float(column.max())
        if not (isfinite(low) and isfinite(high)):
            line = toolpath.line[np.flatnonzero(~np.isfinite(column))[0]]
            raise PlanError(f"line {line}: a position that is not finite on axis {axis.upper()}")
        if (low != toolpath.start[i] or high != low) and limits.velocity[i] is None:
            line = toolpath.line[np.flatnonzero(column != toolpath.start[i])[0]]
            raise PlanError(f"line {line}: axis {axis.upper()} moves, and the machine has no limits for it")


def lay(
    toolpath: Toolpath,
    limits: Limits,
    regimes: Sequence[Regime],
    regime_at: NDArray[Any],
    stops: NDArray[Any],
    smooth: bool,
) -> dict[str, NDArray[Any]]:
    """The pieces of the path with their bounds, as columns named as in kernels.pieces.lay. Raises PlanError."""
    import numpy as np

    count = len(toolpath)
    room = 4 * count
    names = ("length", "speed", "accel", "decel", "jerk", "enter", "offset")
    out = np.empty((len(names), room))
    move, shape = np.empty(room, np.int32), np.empty(room, np.uint8)
    bounds = [value if value is not None else 1.0 for value in (*limits.velocity, *limits.acceleration)]
    bounds += [value if smooth and value is not None and isfinite(value) else 1e300 for value in limits.jerk]
    order = ("x", "y", "z", "a", "b", "c", "u", "v", "feed", "turns", "kind", "plane", "flags")
    got = kernel.lay(
        *[np.require(toolpath.columns[name], requirements=["C", "W"]) for name in order],
        np.array([*toolpath.start, *[0.0] * 6]),
        np.array(bounds),
        limits.cycle,
        SHARE,
        PARTS,
        smooth,
        stops.astype(np.int64),
        regime_at.astype(np.int64),
        np.array([regime.row for regime in regimes]).ravel(),
        np.zeros(72),
        out.ravel(),
        move,
        shape,
    )
    if got < 0:
        row = -1 - got
        kind = Kind(int(toolpath.kind[row])).name.lower()
        raise PlanError(f"line {toolpath.line[row]}: a {kind} move at a feed of {toolpath.feed[row]:g} never ends")
    columns: dict[str, NDArray[Any]] = {**dict(zip(names, out, strict=True)), "move": move, "shape": shape}
    return {name: column[:got] for name, column in columns.items()}


def speeds(laid: dict[str, NDArray[Any]], jerk_limited: bool) -> tuple[Profile, NDArray[np.float64]]:
    """Speeds with limited acceleration, and jerk; and when each piece ends, s."""
    import numpy as np

    length, count = laid["length"], len(laid["length"])
    joint, top, time = np.empty(count + 1), np.empty(count), np.empty(count)
    if count:
        lookahead.brake(length, laid["speed"], laid["decel"], laid["enter"], joint)
        lookahead.trapezoids(length, laid["speed"], laid["accel"], laid["decel"], joint, top, time)
    if jerk_limited and count:
        return jerk_limited_speeds(laid, joint, top)
    until = np.cumsum(time)
    way = np.cumsum(length) - length
    jerk = np.full(count, np.inf)
    profile = Profile(until - time, way, length, joint[:-1], top, joint[1:], laid["accel"], laid["decel"], jerk)
    return profile, until


def jerk_limited_speeds(
    laid: dict[str, NDArray[Any]], joint: NDArray[np.float64], top: NDArray[np.float64]
) -> tuple[Profile, NDArray[np.float64]]:
    """As `speeds`, from what limited acceleration allows at the joints and in the pieces."""
    import numpy as np

    count = len(top)
    way = np.concatenate([[0.0], np.cumsum(laid["length"])])
    out, first_of, until = np.empty(7 * count + 2), np.empty(count, np.int64), np.empty(count)
    bounds = [laid[name] for name in ("speed", "accel", "decel", "jerk", "enter")]
    got = scurve.spans(
        way, *bounds, joint, top, np.empty(count + 1, np.int64), np.empty(count + 1), out, first_of, until
    )
    first, peak, last, accel, decel, jerk, seconds = (column[:got] for column in out[: 7 * count].reshape(7, count))
    begins = np.append(first_of[:got], count)
    start = np.concatenate([[0.0], np.cumsum(seconds)[:-1]])
    length = way[begins[1:]] - way[begins[:-1]]
    return Profile(start, way[begins[:-1]], length, first, peak, last, accel, decel, jerk), until
