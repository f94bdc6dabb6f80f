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
#: Moves to plan at a time, where the axes stand often enough.
MOVES = 1 << 15


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
    path, profile, until = stretches(path_moves, limits, regimes, at, stops)
    return Plan(toolpath, path, profile, until, rows, list(pauses), limits)


def check(toolpath: Toolpath, limits: Limits) -> None:
    """Refuse what cannot be planned. Raises PlanError."""
    import numpy as np

    if any(place != toolpath.told_auxiliary[0][1] for _, place in toolpath.told_auxiliary):
        line = toolpath.line[min(toolpath.told_auxiliary[1][0], len(toolpath) - 1)]
        raise PlanError(f"line {line}: moves of U, V and W cannot be planned in this version")
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


def stretches(
    toolpath: Toolpath, limits: Limits, regimes: Sequence[Regime], regime_at: NDArray[Any], stops: NDArray[Any]
) -> tuple[Path, Profile, NDArray[np.float64]]:
    """The path, how it is followed, and when each piece ends, s. Raises PlanError.

    Worked out stretch by stretch, each from a place at which the axes stand to another: what lies between such
    places hangs on nothing else. So only the result takes memory for the whole.
    """
    import numpy as np

    smooth = limits.jerk_limited
    settings = np.array([regime.row for regime in regimes])
    found: list[list[NDArray[Any]]] = []
    first, most, pieces, seconds = 0, MOVES, 0, 0.0
    while first < len(toolpath):
        last = min(first + most, len(toolpath))
        ruling = slice(max(int(np.searchsorted(regime_at, first, "right")) - 1, 0), np.searchsorted(regime_at, last))
        laid = lay(
            toolpath, first, last, limits, regime_at[ruling] - first, settings[ruling],
            stops[np.searchsorted(stops, first) : np.searchsorted(stops, last)] - first,
        )  # fmt: skip
        count = len(laid["length"])
        if last < len(toolpath) and count:  # up to the last place where they stand, that at the start left out
            count = int(np.flatnonzero(laid["enter"] == 0.0)[-1])
            if not count:
                del laid
                most *= 8
                continue
            last = first + int(laid["move"][count])
            laid = {name: column[:count] for name, column in laid.items()}
        most = MOVES
        if count:
            made, begins, until = (jerk_limited if smooth else trapezoids)(laid)
            made[0] += seconds
            until += seconds
            laid["move"] += np.int32(first)
            columns = [*(laid[name] for name in ("length", "move", "shape", "offset")), until, begins + pieces, *made]
            if first or last < len(toolpath):
                columns = [column.copy() for column in columns]  # and let go what is around them
            found.append(columns)
            pieces += count
            seconds = float(until[-1])
        first = last
    columns = found[0] if found else [np.empty(0, kind) for kind in ("f8", "i4", "u1", "f8", "f8", "i8", *["f8"] * 8)]
    if len(found) > 1:
        parts = [list(column) for column in zip(*found, strict=True)]
        found.clear()
        for i in range(len(columns)):
            columns[i] = np.concatenate(parts[i])
            parts[i].clear()
    length, move, shape, offset, until, begins, start, *rest = columns
    path = Path(toolpath, length, move, shape, offset, smooth)
    return path, Profile(start, path.ways[begins], *rest), until


def lay(
    toolpath: Toolpath, first: int, last: int, limits: Limits, regime_at: NDArray[Any], settings: NDArray[Any],
    stops: NDArray[Any],
) -> dict[str, NDArray[Any]]:  # fmt: skip
    """The pieces of some moves with their bounds, as columns named as in kernels.pieces.lay. Raises PlanError.

    They start at rest. regime_at, settings, stops: as there, counted from the first move.
    """
    import numpy as np

    smooth, room = limits.jerk_limited, 4 * (last - first) + 1
    names = ("length", "speed", "accel", "decel", "jerk", "enter", "offset")
    out = np.empty((len(names), room))
    move, shape = np.empty(room, np.int32), np.empty(room, np.uint8)
    bounds = [value if value is not None else 1.0 for value in (*limits.velocity, *limits.acceleration)]
    bounds += [value if smooth and value is not None and isfinite(value) else 1e300 for value in limits.jerk]
    order = ("x", "y", "z", "a", "b", "c", "u", "v", "feed", "turns", "kind", "plane", "flags")
    start = [float(toolpath.columns[axis][first - 1]) for axis in AXES] if first else toolpath.start
    got = kernel.lay(
        *[toolpath.columns[name][first:last] for name in order],
        np.array([*start, *[0.0] * 6]),
        np.array(bounds),
        limits.cycle,
        SHARE,
        PARTS,
        smooth,
        stops.astype(np.int64),
        regime_at.astype(np.int64),
        settings.ravel(),
        np.zeros(72),
        out.ravel(),
        move,
        shape,
    )
    if got < 0:
        row = first - 1 - got
        kind = Kind(int(toolpath.kind[row])).name.lower()
        raise PlanError(f"line {toolpath.line[row]}: a {kind} move at a feed of {toolpath.feed[row]:g} never ends")
    columns: dict[str, NDArray[Any]] = {**dict(zip(names, out, strict=True)), "move": move, "shape": shape}
    return {name: column[:got] for name, column in columns.items()}


def limited(laid: dict[str, NDArray[Any]]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Speeds with limited acceleration: at the joints, and the highest of each piece; and the seconds that it takes."""
    import numpy as np

    length, count = laid["length"], len(laid["length"])
    joint, top, time = np.empty(count + 1), np.empty(count), np.empty(count)
    lookahead.brake(length, laid["speed"], laid["decel"], laid["enter"], joint)
    lookahead.trapezoids(length, laid["speed"], laid["accel"], laid["decel"], joint, top, time)
    return joint, top, time


def trapezoids(laid: dict[str, NDArray[Any]]) -> tuple[list[NDArray[Any]], NDArray[Any], NDArray[Any]]:
    """How a stretch is followed: Profile's columns but `way`, the first piece of each row, and when each piece ends."""
    import numpy as np

    joint, top, time = limited(laid)
    until, count = np.cumsum(time), len(time)
    ramps = [laid["accel"].copy(), laid["decel"].copy(), np.full(count, np.inf)]
    return [until - time, laid["length"].copy(), joint[:-1], top, joint[1:], *ramps], np.arange(count), until


def jerk_limited(laid: dict[str, NDArray[Any]]) -> tuple[list[NDArray[Any]], NDArray[Any], NDArray[Any]]:
    """As `trapezoids`, under what limited acceleration allows."""
    import numpy as np

    joint, top, until = limited(laid)
    count = len(top)
    way = np.empty(count + 1)
    way[0] = 0.0
    np.cumsum(laid["length"], out=way[1:])
    out, first_of = np.empty(6 * count + 2), np.empty(count, np.int64)
    bounds = [laid[name] for name in ("speed", "accel", "decel", "jerk", "enter")]
    got = scurve.spans(way, *bounds, joint, top, np.empty(count + 1, np.int64), out, first_of, until)
    first, peak, last, accel, decel, jerk = (column[:got] for column in out[: 6 * count].reshape(6, count))
    begins = first_of[:got]
    start = np.concatenate([[0.0], until[begins[1:] - 1]])
    length = np.diff(way[np.append(begins, count)])
    return [start, length, first, peak, last, accel, decel, jerk], begins, until
