"""The way of a move from the program to the recorder.

A move is programmed in the program's frame. `State.to_space` takes its points
through the offsets and the frame (scaling, rotation, tilt) into space: machine
coordinates of the controlled point, without the tool's offset. In space, stages
may work on it (radius compensation, then the tool center point), and the last
of them hands it to the recorder. Lengths mm, angles degrees, speeds mm/min.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from aircut.canon import ROW, Kind
from aircut.interpreter import travel

if TYPE_CHECKING:
    from aircut.interpreter.state import State

pack = ROW.pack
ARC = int(Kind.ARC)
SLOTS = ("compensation", "rtcp")  # in the order in which moves meet them

Place = list[float]  # six axes


class Onward(NamedTuple):
    """Where a stage sends its moves: the line and the arc function of the next one."""

    line: Callable[[State, int, Place, float, int], None]
    arc: Callable[[State, Place, tuple[float, float], int, float, int], None]


class Stage(Protocol):
    """Works on moves in space. It remembers by itself what it needs of the moves before."""

    def line(self, m: State, kind: int, end: Place, speed: float, flags: int, *, onward: Onward) -> None:
        """A straight move."""

    def arc(
        self, m: State, end: Place, center: tuple[float, float], turns: int, speed: float, flags: int, *, onward: Onward
    ) -> None:
        """An arc or helix in the active plane: center in the plane's axes, turns counterclockwise if positive."""

    def flush(self, m: State, *, onward: Onward) -> None:
        """Hold no move back any longer: the program ends, or the world is asked."""


def record_line(m: State, kind: int, end: Place, speed: float, flags: int) -> None:
    """Write a straight move down. Raises Refusal, Stopped where it leaves the travel of an axis."""
    travel.check_line(m, end)
    out = m.out
    out.rows += pack(
        end[0], end[1], end[2], end[3], end[4], end[5],
        0.0, 0.0, speed, out.line, m.tool, 0, out.file, kind, m.plane, flags,
    )  # fmt: skip


def record_arc(m: State, end: Place, center: tuple[float, float], turns: int, speed: float, flags: int) -> None:
    """Write an arc down. Raises as above."""
    travel.check_arc(m, end, center, turns)
    out = m.out
    out.rows += pack(
        end[0], end[1], end[2], end[3], end[4], end[5],
        center[0], center[1], speed, out.line, m.tool, turns, out.file, ARC, m.plane, flags,
    )  # fmt: skip


RECORDER = Onward(record_line, record_arc)


def ways(m: State) -> list[tuple[Stage, Onward]]:
    """The stages in force, each with where it sends to."""
    onward = RECORDER
    found: list[tuple[Stage, Onward]] = []
    for slot in reversed(SLOTS):
        stage: Any = m.stages.get(slot)
        if stage is not None:
            found.insert(0, (stage, onward))
            onward = Onward(partial(stage.line, onward=onward), partial(stage.arc, onward=onward))
    m.way = onward
    return found


def set_stage(m: State, slot: str, stage: Stage | None) -> None:
    """Put a stage in force, or (None) out of force. The stage before it has flushed."""
    if stage is None:
        m.stages.pop(slot, None)
    else:
        m.stages[slot] = stage
    ways(m)


def flush(m: State) -> None:
    """Let no stage hold anything back."""
    for stage, onward in ways(m):
        stage.flush(m, onward=onward)
