"""Where a run on a machine was stopped: what RESUME starts from. The store keeps that of the last run.

Lengths mm, angles degrees.
"""

from __future__ import annotations

from typing import NamedTuple


class Stop(NamedTuple):
    """Where a run was stopped."""

    program: str
    line: int  # of the main program, from 1
    moves: int  # made before it, since the program's start
    place: tuple[float, ...]  # machine coordinates of the controlled point, mm and degrees
