"""What a program asks of the world, and what the world may answer.

A handler that needs an answer is a generator: it yields a request and is sent
the reply. None means "not executed": nobody is there to ask, as in a check, and
the program goes on with what its document says of that.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple


class Probe(NamedTuple):
    """Move straight until the probe changes. Reply: Probed.

    start, target: positions of the machine's axes, mm and degrees. offset: tool offset in force, mm.
    toward: until contact; else until contact is lost.
    """

    start: tuple[float, ...]
    target: tuple[float, ...]
    toward: bool
    tool: int
    feed: float  # mm/min


class Probed(NamedTuple):
    """How a probing ended. state: 1 changed, -1 did not, -2 was so before the start."""

    state: int
    position: tuple[float, ...]  # of the machine's axes where it stopped


class Wait(NamedTuple):
    """Wait for an input. Reply: Waited."""

    input: int
    mode: int  # the L word without its alarm: 0 low, 1 high, 2 fall, 3 rise, 4 at once
    timeout: float | None  # seconds
    analog: bool


class Waited(NamedTuple):
    """How a wait ended. value: of the input, 0 or 1, or percent."""

    value: float
    success: bool


class Inputs(NamedTuple):
    """Read a run of inputs. Reply: a tuple of values, or None."""

    first: int
    number: int
    analog: bool


class Output(NamedTuple):
    """Set an output. value: 0 or 1, or percent. No reply."""

    output: int
    value: float
    analog: bool


class Ask(NamedTuple):
    """Show something to the operator and wait for an answer. Reply: Answer.

    kind: the Q word. defaults: what the values asked for begin with, one each.
    picture: the file that M120 shows, where there is one.
    """

    text: str
    media: bool
    kind: int
    defaults: tuple[float | None, ...] = ()
    picture: Path | None = None


class Overlay(NamedTuple):
    """Show something over the picture of the machine without waiting (Q4); empty clears it. No reply."""

    text: str
    media: bool
    picture: Path | None = None


class Answer(NamedTuple):
    """What the operator did. stop: pressed Stop. values: one an input, None where left empty."""

    stop: bool
    values: tuple[float | None, ...] = ()


class Pause(NamedTuple):
    """M0, M1: wait for the operator. No reply."""

    optional: bool


class Plc(NamedTuple):
    """G100: a function of the PLC. function: the P word. No reply."""

    function: str
    arguments: dict[str, float]


Request = Probe | Wait | Inputs | Output | Ask | Overlay | Pause | Plc
