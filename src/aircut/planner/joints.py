"""What becomes of a jump at a joint of the path: no axis can change its velocity at once.

The planner lets velocities jump a little at gentle corners in exact path, and with limited jerk accelerations,
by no more than what the controller's cycle makes of them. Here they are spread over it: a correction beside the
path, gone a cycle away from the joint. It is less than A·T²/16, with limited jerk J·T³/20: some hundred-thousandths
of a millimeter. So limits hold however finely the motion is looked at.

Times s, `since` counted from the joint. Functions of `since` give position, velocity and acceleration, all (m,),
of a jump of one unit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from aircut.planner.plan import Plan

    Array = NDArray[np.float64]
    Three = tuple[Array, Array, Array]

#: Of a jump of acceleration: the part of a cycle in which acceleration rises to more than the jump, so that in the
#: rest, in which it falls back, neither way nor speed remain.
RISE = 0.79
FALL = RISE**2 / (2.0 * (1.0 - RISE**2))


def steady(since: Array, cycle: float) -> Three:
    """A jump of velocity, taken with one acceleration in one cycle."""
    import numpy as np

    half = cycle / 2.0
    left = np.maximum(half - np.abs(since), 0.0)
    inside = left > 0.0
    return left**2 / (4.0 * half), -np.sign(since) * left / (2.0 * half), np.where(inside, 1.0 / cycle, 0.0)


def bent(since: Array, cycle: float) -> Three:
    """A jump of velocity, taken with acceleration that rises for one cycle and falls for one."""
    import numpy as np

    left = np.maximum(cycle - np.abs(since), 0.0)
    return left**3 / (6.0 * cycle**2), -np.sign(since) * left**2 / (2.0 * cycle**2), left / cycle**2


def raised(since: Array, cycle: float) -> Three:
    """A jump of acceleration, taken with jerk up, and down again, from a cycle before the joint to one after it."""
    import numpy as np

    side = np.where(since < 0.0, -1.0, 1.0)
    part = np.minimum(np.abs(since) / cycle, 1.0)  # by symmetry: after the joint
    gone = 1.0 - part
    rise = (FALL * (1.0 - RISE) + 0.5) / RISE
    early = part < RISE
    over = np.where(early, rise * part - 0.5, FALL * gone)
    # Speed and way that are still to come of it, from the end of the cycle backward.
    at_rise = FALL * (1.0 - RISE) ** 2 / 2.0, FALL * (1.0 - RISE) ** 3 / 6.0
    to = RISE - part
    top = FALL * (1.0 - RISE)
    speed = np.where(early, at_rise[0] + top * to - rise * to**2 / 2.0, FALL * gone**2 / 2.0)
    way = np.where(early, at_rise[1] + at_rise[0] * to + top * to**2 / 2.0 - rise * to**3 / 6.0, FALL * gone**3 / 6.0)
    return side * way * cycle**2, -speed * cycle, side * over


class Joints:
    """The joints between the moves of a plan."""

    def __init__(self, plan: Plan) -> None:
        import numpy as np

        self.plan = plan
        self.piece = np.flatnonzero(np.diff(plan.path.move))  # before each joint
        self.time = plan.until[self.piece]

    def spread(self, time: Array) -> tuple[Array, Array, Array]:
        """Corrections of position, velocity and acceleration, (m, 6), at times without pauses."""
        import numpy as np

        total = tuple(np.zeros((len(time), 6)) for _ in range(3))
        cycle = self.plan.limits.cycle
        if not cycle or not len(self.time):
            return total  # type: ignore[return-value]
        onward = np.searchsorted(self.time, time)
        for joint in (onward - 1, onward):
            near = np.flatnonzero((joint >= 0) & (joint < len(self.time)))
            near = near[np.abs(time[near] - self.time[joint[near]]) < cycle]
            if not len(near):
                continue
            at = joint[near]
            since = time[near] - self.time[at]
            velocity, acceleration = self.jumps(at)
            smooth = self.plan.limits.jerk_limited
            parts: list[tuple[Array, Any]] = [(velocity, (bent if smooth else steady)(since, cycle))]
            if smooth:
                parts.append((acceleration, raised(since, cycle)))
            for jump, shares in parts:
                for sums, share in zip(total, shares, strict=True):
                    sums[near] += jump * share[:, None]
        return total  # type: ignore[return-value]

    def jumps(self, joint: NDArray[Any]) -> tuple[Array, Array]:
        """Of velocity and acceleration, (m, 6)."""
        import numpy as np

        path = self.plan.path
        before = self.piece[joint]
        _, speed, slope = self.plan.profile.at(self.time[joint])
        _, way, bend = path.at(before, path.length[before])
        _, onward, bending = path.at(before + 1, np.zeros(len(before)))
        turn = onward - way
        return turn * speed[:, None], (bending - bend) * (speed**2)[:, None] + turn * slope[:, None]
