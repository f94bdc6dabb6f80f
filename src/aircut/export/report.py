"""What a run comes to: the figures of the summary, and the JSON report.

Lengths mm, angles degrees. The JSON report's fields are stable within its version.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from aircut.canon import Kind
from aircut.canon.toolpath import AXES, Extents
from aircut.export.diagnostics import as_dict

if TYPE_CHECKING:
    from aircut.api import Result

JSON_VERSION = 1
STOPS = ("PROGRAM_STOP", "OPTIONAL_PROGRAM_STOP")


def box(extents: Extents | None) -> dict[str, list[float]] | None:
    """Extents by axis, [low, high]; axes that stay at zero are left out, X, Y and Z never."""
    if extents is None:
        return None
    pairs = zip(AXES, extents.low, extents.high, strict=True)
    return {axis: [low, high] for axis, low, high in pairs if axis in "xyz" or low or high}


def figures(result: Result) -> dict[str, Any]:
    """The numbers of a run."""
    toolpath = result.toolpath
    lengths = toolpath.lengths()
    rapid = toolpath.kind == Kind.TRAVERSE
    linear = moves_linear(result)
    changes = [event.values[0] for event in result.events if event.name in ("CHANGE_TOOL", "CHANGE_TOOL_NUMBER")]
    stops = [event.name for event in result.events if event.name in STOPS]
    seconds = sum(event.values[0] for event in result.events if event.name == "DWELL")
    return {
        "extents": {
            "rapid": box(toolpath.extents(True)),
            "feed": box(toolpath.extents(False)),
            "all": box(toolpath.extents()),
        },
        "length": {
            "rapid": float(lengths[rapid & linear].sum()),
            "feed": float(lengths[~rapid & linear].sum()),
        },
        "rotation": {
            "rapid": float(lengths[rapid & ~linear].sum()),
            "feed": float(lengths[~rapid & ~linear].sum()),
        },
        "tools": list(dict.fromkeys(changes)),
        "counts": {
            "lines": len(next(iter(result.sources.values()))),
            "moves": len(toolpath),
            "rapids": int(rapid.sum()),
            "feeds": int((toolpath.kind == Kind.FEED).sum()),
            "arcs": int((toolpath.kind == Kind.ARC).sum()),
            "tool_changes": len(changes),
            "stops": sum(name == "PROGRAM_STOP" or result.optional_stop for name in stops),
        },
        "dwell_seconds": seconds,
    }


def moves_linear(result: Result) -> Any:
    """Which moves move X, Y or Z: their lengths are mm, the others' degrees."""
    import numpy as np

    toolpath = result.toolpath
    step = toolpath.ends()[:, :3] - toolpath.starts()[:, :3]
    return (np.abs(step) > 1e-7).any(axis=1) | (toolpath.kind == Kind.ARC)


def named(place: tuple[float, ...]) -> dict[str, float]:
    return dict(zip(AXES, place, strict=True))


def started(result: Result) -> dict[str, Any] | None:
    """Where a run from a line began: the place in the program's frame, the approach in machine coordinates."""
    arrival = result.arrival
    if arrival is None:
        return None
    approach = [{"code": code, "machine": named(place)} for code, place in arrival.approach]
    return {"line": arrival.line, "position": named(arrival.place), "modes": arrival.modes, "approach": approach}


def to_json(result: Result, program: str, dialect: str) -> str:
    """The JSON report of a run."""
    report = {
        "version": JSON_VERSION,
        "program": program,
        "dialect": dialect,
        "ok": result.ok,
        "units": {"length": "mm", "angle": "degrees", "feed": "mm/min"},
        **figures(result),
        "messages": [{"text": m.text, "file": m.file, "line": m.line} for m in result.messages],
        "diagnostics": [as_dict(d) for d in result.diagnostics],
        "state": result.state,
        "start": started(result),
        "stop": result.stop and {"line": result.stop.line, "machine": named(result.stop.place)},
    }
    return json.dumps(report, indent=2) + "\n"
