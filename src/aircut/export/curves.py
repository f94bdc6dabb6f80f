"""Curves of the motion over time: speed, acceleration and jerk, positions of the axes."""

from __future__ import annotations

from math import isfinite
from typing import IO, TYPE_CHECKING, Any, Literal

from aircut.canon.toolpath import AXES

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from aircut.planner import Plan

    Array = NDArray[np.float64]

MOST = 200_000  # times at which the motion is looked at
BINS = 4000  # of which each shows its lowest and highest value
FINEST = 0.0005  # s
COLORS = ("#d32f2f", "#1b8a3e", "#1f5fd6", "#b26a00", "#6a3fb5", "#00838f")
INK, SOFT, GRID, PROGRAMMED = "#1d2530", "#5f6c7b", "#dde3ea", "#d9660a"
NAMES = {
    "speed": ("speed of the tool", "mm/min", ""),
    "acceleration": ("acceleration", "mm/s²", "°/s²"),
    "jerk": ("jerk", "mm/s³", "°/s³"),
    "axis": ("position", "mm", "°"),
}


def thinned(time: Array, values: Array) -> tuple[Array, Array]:
    """A curve as the lowest and highest value in each of so many stretches of time."""
    import numpy as np

    if len(time) <= 2 * BINS:
        return time, values
    edges = np.linspace(0, len(time), BINS + 1).astype(int)[:-1]
    low, high = np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)
    return np.repeat(time[edges], 2), np.column_stack([low, high]).ravel()


def draw(plan: Plan, what: str, file: IO[bytes], format: Literal["png", "svg"], title: str) -> None:
    """Write a curve of a plan to a binary file. what: one of NAMES.

    A long program is looked at in 200,000 moments, so the shortest peaks of one may be missed.
    """
    import numpy as np
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    name, unit, turning = NAMES[what]
    dt = max(plan.duration / MOST, FINEST)
    s = plan.sample(dt)
    moving = [i for i in range(6) if np.ptp(s.position[:, i]) > 1e-9] or [0]
    rows = 1 if what == "speed" else len(moving)
    figure = Figure(figsize=(16, 4 + 2.2 * (rows - 1) + 0.6), dpi=100, facecolor="white", layout="constrained")
    panels = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    figure.suptitle(f"{title}: {name}, {plan.duration:.2f} s", color=INK, fontsize=14, parse_math=False)
    if what == "speed":
        programmed = plan.toolpath.feed[np.maximum(s.move, 0)] if len(plan.toolpath) else np.zeros(len(s.time))
        shown = np.where((programmed > 0) & (s.speed > 0), programmed, np.nan)
        panels[0].plot(*gapless(s.time, shown), color=PROGRAMMED, linewidth=0.9, label="programmed feed")
        panels[0].plot(*thinned(s.time, 60.0 * s.tool_speed), color=COLORS[2], linewidth=1.0, label="tool")
        panels[0].legend(loc="upper right", frameon=False)
        decorate(panels[0], unit)
    else:
        values = {"acceleration": s.acceleration, "jerk": jerks(s.time, s.acceleration), "axis": s.position}[what]
        limits = {"acceleration": plan.limits.acceleration, "jerk": plan.limits.jerk, "axis": (None,) * 6}[what]
        for panel, i in zip(panels, moving, strict=True):
            panel.plot(*thinned(s.time, values[:, i]), color=COLORS[i], linewidth=1.0)
            limit = limits[i]
            if limit is not None and isfinite(limit):
                for side in (-limit, limit):
                    panel.axhline(side, color=SOFT, linewidth=0.8, linestyle=(0, (4, 3)))
            decorate(panel, f"{AXES[i].upper()}  {unit if i < 3 else turning}")
    panels[-1].set_xlabel("s", color=SOFT)
    with rc_context({"svg.hashsalt": "aircut"}):  # the same picture, the same bytes
        if format == "svg":
            FigureCanvasSVG(figure).print_svg(file, metadata={"Date": None, "Title": title})
        else:
            FigureCanvasAgg(figure).print_png(file, metadata={"Software": None, "Title": title})


def gapless(time: Array, values: Array) -> tuple[Array, Array]:
    """A stepped curve of few points: those at which it changes."""
    import numpy as np

    change = np.ones(len(values), bool)
    same = (values[1:] == values[:-1]) | (np.isnan(values[1:]) & np.isnan(values[:-1]))
    change[1:-1] = ~same[:-1] | ~same[1:]
    return time[change], values[change]


def jerks(time: Array, acceleration: Array) -> Array:
    """Differences of the acceleration over the time between two looks, (m, 6)."""
    import numpy as np

    found = np.zeros_like(acceleration)
    found[1:] = np.diff(acceleration, axis=0) / np.maximum(np.diff(time), 1e-12)[:, None]
    found[-1] = 0.0  # the last look comes sooner
    return found


def decorate(panel: Axes, label: str) -> Any:
    panel.set_ylabel(label, color=INK)
    panel.grid(color=GRID, linewidth=0.8)
    panel.tick_params(colors=SOFT)
    for side in ("top", "right"):
        panel.spines[side].set_visible(False)
