"""Where the tool's tip is on the part, and how the tool stands, on a machine of five axes.

A run that used tool center point control tells the machine's kinematics. With them every
move can be seen from the part, those without the control too. Lengths mm, angles degrees.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aircut.geometry.kinematics import Setup, array_of, direction, forward

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from aircut.canon.record import Events
    from aircut.canon.toolpath import Toolpath

    Array = NDArray[Any]

OFFSET, CONTROL = "USE_TOOL_LENGTH_OFFSET", "TOOL_CENTER_POINT"


def setups_of(events: Events) -> list[tuple[int, Setup]]:
    """The tool offsets of a run and, where it was under control, the kinematics: from which move on."""
    found: list[tuple[int, Setup]] = []
    for event in events.named(OFFSET, CONTROL):
        setup = Setup(0, *event.values[:3]) if event.name == OFFSET else Setup(*event.values)
        if event.name == OFFSET or setup.model:
            found.append((event.at, setup))
    return found


def kinematics(toolpath: Toolpath) -> Setup | None:
    """Of the machine, without a tool; None where the run did not tell them."""
    setup = next((setup for _, setup in toolpath.setups if setup.model), None)
    return setup and setup._replace(tool_x=0.0, tool_y=0.0, tool_z=0.0)


def offsets(toolpath: Toolpath) -> Array:
    """The tool's offset in each move, (n, 3)."""
    import numpy as np

    of_moves = np.zeros((len(toolpath), 3))
    for first, setup in toolpath.setups:
        of_moves[first:] = setup.tool
    return of_moves


def with_tools(setup: Setup, tools: Array) -> Setup:
    """The setup with an offset for each of many places, (n, 3)."""
    x, y, z = tools.T
    return Setup(*(setup.model, x, y, z), *setup[4:])


def axes(toolpath: Toolpath) -> tuple[Array, Array]:
    """Positions of the machine's axes, the tool's offset included, at the starts and ends of the moves, (n, 6)."""
    import numpy as np

    ends = toolpath.ends()
    ends[:, :3] += offsets(toolpath)
    return np.vstack([np.asarray(toolpath.start)[None, :], ends[:-1]])[: len(ends)], ends


def tips(toolpath: Toolpath) -> tuple[Array, Array]:
    """Starts and ends of the moves as the part sees them, (n, 3). Without kinematics: in machine coordinates."""
    starts, ends = axes(toolpath)
    tools, setup = offsets(toolpath), kinematics(toolpath)
    if setup is None:
        return starts[:, :3] - tools, ends[:, :3] - tools
    made = with_tools(setup, tools)
    first, last = (array_of(forward(made, places[:, :3].T, places[:, 3:].T)) for places in (starts, ends))
    return first, last


def directions(toolpath: Toolpath) -> Array:
    """The tool's axis at the ends of the moves as the part sees it: unit vectors from tip to holder, (n, 3)."""
    import numpy as np

    setup = kinematics(toolpath)
    if setup is None:
        return np.tile((0.0, 0.0, 1.0), (len(toolpath), 1))
    return array_of(direction(setup, toolpath.ends()[:, 3:].T))


def on_part(toolpath: Toolpath, points: Array, move: Array) -> tuple[Array, Array]:
    """A polyline of the toolpath (geometry.polylines.polyline) as the part sees it: points, and the tool's axis there.

    points: (m, 3) machine coordinates. move: (m,) the move that each ends or lies on, -1 for the start.
    """
    import numpy as np

    setup = kinematics(toolpath)
    assert setup is not None
    count = np.bincount(move + 1, minlength=len(toolpath) + 1)
    nth = np.arange(1, len(move) + 1) - (np.cumsum(count) - count)[move + 1]
    part = (nth / count[move + 1])[:, None]  # of the move: its points lie evenly
    places = np.vstack([np.asarray(toolpath.start)[None, :], toolpath.ends()])[:, 3:]
    angles = places[np.maximum(move, 0)] * (1.0 - part) + places[move + 1] * part
    tools = np.vstack([np.zeros((1, 3)), offsets(toolpath)])[move + 1]
    seen = forward(with_tools(setup, tools), (points + tools).T, angles.T)
    return array_of(seen), array_of(direction(setup, angles.T))
