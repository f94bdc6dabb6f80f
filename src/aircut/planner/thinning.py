"""G64 Q: points of a run of straight feed moves that lie within Q of their chord are left out.

Source: 000 section 5; decision AMB-MODE-2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aircut.canon import EXACT_PATH, EXACT_STOP, Kind
from aircut.kernels import thin as kernel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from aircut.canon import Toolpath
    from aircut.planner.clock import Regime

LONGEST = 10_000  # moves considered together, which bounds the work


def thinned(toolpath: Toolpath, regimes: Sequence[Regime], stops: NDArray[Any]) -> NDArray[Any]:
    """Indices of the moves that stay; each then begins where the one before it, of those, ends."""
    import numpy as np

    count = len(toolpath)
    still = np.ones(count, bool)
    for axis in "abc":
        column = toolpath.columns[axis]
        still[1:] &= column[1:] == column[:-1]
        if count:
            still[0] &= column[0] == toolpath.start["xyzabc".index(axis)]
    within = (toolpath.kind == Kind.FEED) & (toolpath.flags & (EXACT_STOP | EXACT_PATH) == 0) & still
    # The end of move i may go when i and i + 1 are alike and nothing happens between.
    joined = np.zeros(count, bool)
    joined[:-1] = within[:-1] & within[1:] & (toolpath.feed[:-1] == toolpath.feed[1:])
    for fixed in (stops, np.array([regime.at for regime in regimes], np.int64)):
        joined[fixed[(fixed > 0) & (fixed < count)] - 1] = False
    joined[LONGEST - 1 :: LONGEST] = False
    tolerance = np.zeros(count)
    for regime in regimes:
        tolerance[regime.at :] = regime.thinning
    joined &= tolerance > 0.0

    edges = np.flatnonzero(np.diff(np.concatenate([[False], joined, [False]]).astype(np.int8)))
    points = np.vstack([toolpath.start[:3], np.column_stack([toolpath.x, toolpath.y, toolpath.z])]).ravel()
    keep = np.ones(count + 1, np.uint8)
    stack = np.zeros(kernel.STACK, np.int64)
    for first, last in edges.reshape(-1, 2).tolist():
        # Moves first to last, that is points first to last + 1 (point i is the start of move i).
        keep[first : last + 2] = 0
        kernel.thin(points, first, last + 1, float(tolerance[first]), keep, stack)
    return np.flatnonzero(keep[1:])
