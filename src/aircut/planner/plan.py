"""A plan: where the tool is at which time.

Columns throughout. A piece of the path is followed in a ramp up, a stretch at one speed and a ramp down.
Times s, lengths mm and degrees.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon.toolpath import AXES
from aircut.planner import ramps
from aircut.planner.joints import Joints
from aircut.planner.path import FILLET

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    import pyarrow
    from numpy.typing import NDArray

    from aircut.canon import Toolpath
    from aircut.planner.clock import Pause
    from aircut.planner.limits import Limits
    from aircut.planner.path import Path

    Array = NDArray[np.float64]


class Samples(NamedTuple):
    """The motion at some times: columns of one length."""

    time: Array  # (m,) s
    position: Array  # (m, 6) mm, degrees: X Y Z A B C
    velocity: Array  # (m, 6) of the axes, a second
    acceleration: Array  # (m, 6)
    speed: Array  # (m,) along the path
    move: NDArray[np.int64]  # (m,) index into the toolpath; where the tool stands, of the move before

    @property
    def tool_speed(self) -> Array:
        """Speed of X, Y and Z together, mm/s."""
        import numpy as np

        return np.sqrt((self.velocity[:, :3] ** 2).sum(axis=1))


class Profile(NamedTuple):
    """How the path is followed: stretches, each a ramp, a constant speed and a ramp. Columns, (k,)."""

    start: Array  # s, without pauses
    way: Array  # of the path's parameter at the start
    length: Array
    first: Array  # speeds
    top: Array
    last: Array
    accel: Array
    decel: Array
    jerk: Array

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Way, speed and acceleration along the path at times without pauses."""
        import numpy as np

        k = np.clip(np.searchsorted(self.start, time, side="right") - 1, 0, len(self.start) - 1)
        since = time - self.start[k]
        first, top, last, jerk = self.first[k], self.top[k], self.last[k], self.jerk[k]
        ends, middle, _ = ramps.phases(first, top, self.accel[k], jerk)
        up = 2 * ends + middle
        ends, middle, _ = ramps.phases(top, last, self.decel[k], jerk)
        down = 2 * ends + middle
        rise, fall = (first + top) / 2 * up, (top + last) / 2 * down
        flat = np.maximum(self.length[k] - rise - fall, 0.0)
        cruise = np.divide(flat, top, out=np.zeros_like(top), where=top > 0)
        way, speed, slope, _ = ramps.at(np.minimum(since, up), first, top, self.accel[k], jerk)
        level = since > up
        slope = np.where(level, 0.0, slope)
        way = np.where(level, rise + top * np.minimum(since - up, cruise), way)
        falling = since > up + cruise
        left = np.clip(since - up - cruise, 0.0, down)
        way2, speed2, slope2, _ = ramps.at(left, top, last, self.decel[k], jerk)
        way = np.where(falling, rise + flat + way2, way)
        speed = np.where(falling, speed2, np.where(level, top, speed))
        slope = np.where(falling, slope2, slope)
        return self.way[k] + np.clip(way, 0.0, self.length[k]), speed, slope


class Plan:
    """The motion of a run in time.

    times: (n,) seconds at which each move of the toolpath has ended; seconds: (n,) what each takes.
    pauses: where the axes stand. duration: of all.
    """

    def __init__(
        self,
        toolpath: Toolpath,
        path: Path,
        profile: Profile,
        until: Array,
        rows: NDArray[Any] | None,
        pauses: list[Pause],
        limits: Limits,
    ) -> None:
        """Made by `planning.plan`.

        until: (pieces,) seconds at which each piece ends, without pauses. rows: of the path's moves in the
        toolpath, where some were left out.
        """
        import numpy as np

        self.toolpath = toolpath
        self.path = path
        self.profile = profile
        self.pauses = pauses
        self.limits = limits
        self.until = until
        self.rows = rows
        self._joints: Joints | None = None  # made when the motion is looked at
        self.ways = path.ways
        ended = np.zeros(len(path.toolpath) + 1)
        ended[path.move + 1] = until  # the last piece of a move wins
        np.maximum.accumulate(ended, out=ended)
        self.moving = float(until[-1]) if len(until) else 0.0
        if rows is not None:
            ended = self._spread(ended, rows)
        # Pauses, each at the motion's time of the moves before it.
        self._pause_at = ended[[min(max(p.at, 0), len(toolpath)) for p in pauses]] if pauses else np.empty(0)
        self._paused = np.concatenate([[0.0], np.cumsum([p.seconds for p in pauses])])
        self.seconds: Array = np.diff(ended)
        self.times: Array = ended[1:]
        if pauses:
            before = np.zeros(len(toolpath) + 1)
            for pause in pauses:
                before[min(pause.at, len(toolpath))] += pause.seconds
            np.cumsum(before, out=before)
            before[: len(toolpath)] += self.times
            self.times = before[: len(toolpath)]
        self.duration = self.moving + float(self._paused[-1])

    def _spread(self, ended: Array, rows: NDArray[Any]) -> Array:
        """Times of all moves of the toolpath, where some were left out: they share by length."""
        import numpy as np

        full = np.concatenate([[0.0], np.cumsum(self.toolpath.lengths())])
        at = np.concatenate([[0], rows + 1])
        spread: Array = np.interp(full, full[at], ended)
        spread[at] = ended
        return np.maximum.accumulate(spread)

    def __repr__(self) -> str:
        return f"<Plan: {self.duration:.3f} s, {len(self.toolpath)} moves>"

    def _without_pauses(self, time: Array) -> Array:
        """Times of the motion alone."""
        import numpy as np

        if not len(self._pause_at):
            return time
        begins = self._pause_at + self._paused[:-1]
        k = np.searchsorted(begins, time, side="right")
        before = self._paused[np.maximum(k - 1, 0)]
        moving = time - self._paused[k]
        return np.where(k > 0, np.maximum(moving, np.minimum(self._pause_at[k - 1], time - before)), time)

    def samples(self, times: Iterable[float] | Array) -> Samples:
        """The motion at any times, s; before the start and after the end the tool stands."""
        import numpy as np

        time = np.atleast_1d(np.asarray(times, float))
        if not len(self.path):
            still = np.tile(np.asarray(self.toolpath.start, float), (len(time), 1))
            zero, none = np.zeros_like(still), np.full(len(time), len(self.toolpath) - 1)
            return Samples(time, still, zero, zero.copy(), zero[:, 0].copy(), none)
        inside = np.clip(time, 0.0, self.duration)
        moving = self._without_pauses(inside)
        way, speed, slope = self.profile.at(moving)
        piece = np.clip(np.searchsorted(self.ways, way, side="right") - 1, 0, len(self.path) - 1)
        place, first, second = self.path.at(piece, np.minimum(way - self.ways[piece], self.path.length[piece]))
        slope = np.where((time < 0) | (time > self.duration), 0.0, slope)
        velocity = first * speed[:, None]
        acceleration = first * slope[:, None] + second * (speed**2)[:, None]
        if self._joints is None:
            self._joints = Joints(self)
        aside, faster, harder = self._joints.spread(moving)
        harder[(time < 0) | (time > self.duration)] = 0.0
        move = self.path.move[piece].astype(np.int64)
        return Samples(
            time, place + aside, velocity + faster, acceleration + harder, speed,
            move if self.rows is None else self.rows[move],
        )  # fmt: skip

    def piece_tops(self) -> Array:
        """Highest speed in each piece of the path, by its parameter, (pieces,)."""
        import numpy as np

        k = np.searchsorted(self.profile.way, self.ways[:-1], side="right") - 1
        return self.profile.top[np.maximum(k, 0)]

    def at(self, time: float) -> tuple[float, ...]:
        """Position of X Y Z A B C at a time, mm and degrees."""
        return tuple(self.samples([time]).position[0].tolist())

    def sample(self, dt: float) -> Samples:
        """The motion every dt seconds from the start to the end. Raises ValueError for a dt that is not above zero."""
        import numpy as np

        if not 0.0 < dt < np.inf:
            raise ValueError(f"sampling every {dt:g} s: it must be above zero")
        count = int(np.floor(self.duration / dt * (1 + 1e-12)))
        times = np.arange(count + 1) * dt
        return self.samples(times if times[-1] >= self.duration else np.append(times, self.duration))

    def to_arrow(self, dt: float | None = None) -> pyarrow.Table:
        """A pyarrow Table: a row a move (line, seconds, end), or samples every dt seconds."""
        import pyarrow

        if dt is None:
            t = self.toolpath
            columns = {"line": t.line, "file": t.file, "tool": t.tool, "kind": t.kind}
            return pyarrow.table({**columns, "seconds": self.seconds, "end": self.times})
        s = self.sample(dt)
        axes = {axis: s.position[:, i] for i, axis in enumerate(AXES)}
        speeds = {f"v{axis}": s.velocity[:, i] for i, axis in enumerate(AXES)}
        accelerations = {f"a{axis}": s.acceleration[:, i] for i, axis in enumerate(AXES)}
        return pyarrow.table({"time": s.time, **axes, "speed": s.tool_speed, **speeds, **accelerations, "move": s.move})

    @property
    def blends(self) -> int:
        """How many corners are blended."""
        return int((self.path.shape >= FILLET).sum())

    def polyline(self, turn: float = 0.1) -> tuple[Array, NDArray[np.int64]]:
        """The path as followed, blends included: points of X Y Z A B C, (m, 6), and the move that each ends or lies on.

        turn: radians, about, between two points of arcs and blends. The first point is the start, of move -1.
        """
        import numpy as np

        pieces = np.arange(len(self.path))
        if not len(pieces):
            return np.array([self.toolpath.start], float), np.array([-1])
        _, _, bend = self.path.at(pieces, self.path.length / 2)
        bend = np.sqrt((bend**2).sum(axis=1)) * self.path.length
        count = np.clip(np.ceil(bend / turn), 1, 1000).astype(np.int64)
        count += (count % 2 == 1) & (self.path.shape >= FILLET)  # the place nearest to the corner is among them
        piece = np.repeat(pieces, count)
        nth = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count) + 1
        place, _, _ = self.path.at(piece, self.path.length[piece] * nth / count[piece])
        move = self.path.move[piece].astype(np.int64)
        move = move if self.rows is None else self.rows[move]
        return np.vstack([np.asarray(self.toolpath.start, float), place]), np.concatenate([[-1], move])
