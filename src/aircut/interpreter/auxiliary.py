"""Spindle, coolant, tools, dwell, stops and ends; and the T word.

Sources: 000 sections 1.1 to 1.3; decisions AMB-COD-7, AMB-IO-9 to AMB-IO-11, AMB-TC-1,
AMB-TC-5 to AMB-TC-7, AMB-VAR-10.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any, NamedTuple

from aircut.diagnostics import Refusal, Severity
from aircut.diagnostics import faults as F
from aircut.interpreter.calls import Call, go
from aircut.interpreter.requests import Pause, Request
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words

PALLET_SHUTTLE = "pallet_shuttle.ngc"


class End(NamedTuple):
    """The program ends. reset: with the machine put back to its start (M2, M30)."""

    reset: bool


class Restart(NamedTuple):
    """The program starts over (M47)."""


def spindle(code: int, command: str, m: State, w: Words) -> None:
    """M3, M4, M5."""
    m.spindle = code
    m.out.event(command, 0)


def coolant(mist: bool | None, flood: bool | None, m: State, w: Words) -> None:
    """M7, M8, M9; None leaves as it is."""
    if mist is not None:
        m.mist = mist
        m.out.event("MIST_ON" if mist else "MIST_OFF")
    if flood is not None:
        m.flood = flood
        m.out.event("FLOOD_ON" if flood else "FLOOD_OFF")


def dwell(m: State, w: Words) -> None:
    """G4 P: seconds, in any units."""
    if w["p"] < 0.0:
        raise out_of_range(w, "p", "seconds, not negative")
    m.out.event("DWELL", w["p"])


def known_tool(m: State, w: Words, letter: str) -> int:
    """The tool that a word names; one that is not in the library is told of. Raises Refusal."""
    tool = whole(w, letter)
    if not 0 <= tool < 2**31:
        raise out_of_range(w, letter, "tools are whole numbers from 0")
    if tool and tool not in m.tools:
        if m.machine.own_tools:
            raise Refusal(F.UNKNOWN_TOOL._replace(severity=Severity.ERROR, hint=""), letter, tool=tool)
        m.warn(F.UNKNOWN_TOOL, letter, tool=tool)
    return tool


def select_tool(m: State, w: Words) -> None:
    """T: the tool that the next M6 loads."""
    m.selected_tool = known_tool(m, w, "t")
    m.out.event("SELECT_TOOL", m.selected_tool)


def stop(number: int, command: str, m: State, w: Words) -> Generator[Request, Any, None]:
    """M0, M1: wait for the operator. #5150 does not know M1."""
    if number == 0:
        m.stop_code = 0.0
    m.out.event(command)
    yield Pause(optional=number == 1)


def shuttle(m: State, w: Words) -> None:
    """M60: the pallet shuttle, by the macro where the machine has one."""
    m.stop_code = 60.0
    m.out.event("PALLET_SHUTTLE")
    if m.machine.options.pallet_shuttle:
        go(m, Call(PALLET_SHUTTLE, False, 1, None, file=True))


def torch(on: bool, m: State, w: Words) -> None:
    """M17, M18: torch height control."""
    m.out.event("TORCH_HEIGHT_CONTROL", int(on))


def end(number: int, reset: bool, m: State, w: Words) -> None:
    """M2, M30, M102. #5150 does not know M102."""
    if reset:
        m.stop_code = float(number)
    m.transfer = End(reset)
    if number == 30 and m.machine.options.pallet_shuttle:
        m.transfer = Call(PALLET_SHUTTLE, False, 1, None, then=m.transfer, file=True)


def restart(m: State, w: Words) -> None:
    """M47."""
    m.stop_code = 47.0
    m.out.event("PROGRAM_RESTART")
    m.transfer = Restart()


spin = partial(Code, group=Group.SPINDLE, order=Order.SPINDLE)
halt = partial(Code, group=Group.STOP, order=Order.STOP)
cool = partial(Code, order=Order.COOLANT)

CODES = (
    Code("G4", "Dwell", dwell, Group.NON_MODAL, Order.DWELL, takes="p", needs="p"),
    spin("M3", "Spindle clockwise", partial(spindle, 3, "START_SPINDLE_CLOCKWISE")),
    spin("M4", "Spindle counterclockwise", partial(spindle, 4, "START_SPINDLE_COUNTERCLOCKWISE")),
    spin("M5", "Spindle off", partial(spindle, 5, "STOP_SPINDLE_TURNING")),
    cool("M7", "Mist on", partial(coolant, True, None), Group.MIST),
    cool("M8", "Flood on", partial(coolant, None, True), Group.FLOOD),
    cool("M9", "Mist and flood off", partial(coolant, False, False), Group.MIST | Group.FLOOD),
    halt("M0", "Stop", partial(stop, 0, "PROGRAM_STOP")),
    halt("M1", "Optional stop", partial(stop, 1, "OPTIONAL_PROGRAM_STOP")),
    halt("M2", "Program end", partial(end, 2, True)),
    halt("M60", "Pallet shuttle", shuttle),
    cool("M17", "Torch height control on", partial(torch, True), Group.TORCH),
    cool("M18", "Torch height control off", partial(torch, False), Group.TORCH),
    halt("M30", "Pallet shuttle and program end", partial(end, 30, True)),
    halt("M47", "Start the program over", restart),
    halt("M102", "Program end without a reset", partial(end, 102, False)),
)

ITEMS = (Code("T", "Select a tool", select_tool, Group(0), Order.TOOL, needs="t"),)
