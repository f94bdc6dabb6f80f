"""What the axes can do, in seconds: limits from a machine or given by hand, checked once for all."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, isfinite, isnan
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from aircut.machine import Machine

AXES = "xyzabc"


class PlanError(ValueError):
    """The motion cannot be planned; the text says why."""


class Limits(NamedTuple):
    """Limits of the axes X Y Z A B C: mm/s, mm/s², mm/s³, degrees for rotary ones.

    None for an axis that the machine does not have; an infinite jerk is not limited.
    cycle: seconds, the controller's period. jerk_limited: whether jerk is heeded.
    """

    velocity: tuple[float | None, ...]
    acceleration: tuple[float | None, ...]
    jerk: tuple[float | None, ...]
    cycle: float = 0.001
    jerk_limited: bool = False


def limits(
    velocity: Iterable[float | None],
    acceleration: Iterable[float | None],
    jerk: Iterable[float | None] | None = None,
    cycle: float = 0.001,
) -> Limits:
    """Limits given by hand, for some first ones of X Y Z A B C. Raises PlanError.

    velocity: mm/s. acceleration: mm/s². jerk: mm/s³, None where it is not limited.
    """
    speeds, accelerations, jerks = filled(velocity), filled(acceleration), filled(jerk or ())
    for axis, v, a, j in zip(AXES.upper(), speeds, accelerations, jerks, strict=True):
        if v is None and a is None:
            continue
        for name, value in (("velocity", v), ("acceleration", a), ("jerk", inf if j is None else j)):
            if value is None:
                wanted = "a jerk needs an acceleration" if j is not None else "it must be given"
                raise PlanError(f"axis {axis} has no {name}: {wanted}")
            if isnan(value) or value <= 0.0:
                raise PlanError(f"axis {axis}: a {name} of {value:g} is no limit: it must be above zero")
            if not isfinite(value) and name != "jerk":
                raise PlanError(f"axis {axis}: the {name} must be finite")
    if not 0.0 <= cycle < inf:
        raise PlanError(f"a cycle of {cycle:g} s: it must be zero or more")
    jerks = tuple(inf if j is None else float(j) for j in jerks)
    return Limits(speeds, accelerations, jerks, cycle, any(isfinite(j) for j in jerks))  # type: ignore[arg-type]


def filled(values: Iterable[float | None]) -> tuple[float | None, ...]:
    """Six values, None for those that are not given. Raises PlanError."""
    given = [None if value is None else float(value) for value in values]
    if len(given) > len(AXES):
        raise PlanError(f"limits of {len(given)} axes: there are {len(AXES)}")
    return (*given, *[None] * (len(AXES) - len(given)))


def of_machine(machine: Machine, profile: str | None = None) -> Limits:
    """The limits of a machine. Raises PlanError.

    profile: auto, trapezoidal or jerk-limited; None for the machine's own.
    """
    axes = [machine.axes.get(letter) if letter in machine.letters else None for letter in AXES]
    profile = profile or machine.motion.profile
    jerks = [axis.jerk or None if axis else None for axis in axes]
    if profile == "jerk-limited" and not any(jerks):
        raise PlanError("a jerk-limited profile needs a jerk: set axes.X.jerk and its like in machine.toml")
    return limits(
        [axis.velocity / 60.0 if axis else None for axis in axes],
        [axis.acceleration if axis else None for axis in axes],
        None if profile == "trapezoidal" else jerks,
        machine.motion.cycle,
    )
