"""A five-axis program, and the machine that it is for: a table of A and C under tool center point control."""

from __future__ import annotations

import math

from aircut.machine import Machine, Tool
from aircut.machine.config import File, Options, RotaryTable, axis_of

LINES = 200_000


def five_axis(lines: int = LINES) -> bytes:
    """Finishing a dome along its circles, the tool normal to it: five words a line, a feed here and there."""
    text = ["G21 G17 G90 G94", "T1 M6", "S12000 M3", "G0 X0 Y0 Z80", "G43.4 H1", "G1 F1800"]
    round_ = 180
    for n in range(lines - len(text) - 4):
        turn, ring = n % round_, n // round_
        tilt = math.radians(2.0 + 60.0 * ring * round_ / lines)
        angle = math.radians(turn * 360.0 / round_)
        r, z = 50.0 * math.sin(tilt), 50.0 * math.cos(tilt)
        feed = "F1500" if turn == 0 else ""
        text.append(
            f"X{r * math.cos(angle):.4f} Y{r * math.sin(angle):.4f} Z{z:.4f} "
            f"A{math.degrees(tilt):.3f} C{ring * 360.0 + math.degrees(angle):.3f} {feed}"
        )
    return "\n".join([*text, "G49", "G0 Z200", "M5", "M2", ""]).encode()


def machine() -> Machine:
    """A machine with a table that tilts and turns, wide travel, and a ball cutter as tool 1."""
    limits = {"a": (-120.0, 120.0), "c": (-1e7, 1e7)}
    axes = {
        letter: axis_of(letter, {"min": low, "max": high})
        for letter, (low, high) in (dict.fromkeys("xyz", (-10000.0, 10000.0)) | limits).items()
    }
    file = File(
        kinematics="rotary_table_ac", axes=axes, rotary_table=RotaryTable(0.0, 0.0, -50.0), options=Options(rtcp=True)
    )
    return Machine(file, {1: Tool(1, z=120.0)}, own_tools=True)
