"""What a plan comes to: the figures of `aircut time`, as JSON and CSV.

Seconds, mm, mm/min; degrees where only rotary axes move. The fields are stable within their version.
"""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, Any

from aircut.canon import Kind
from aircut.planner import KINDS

if TYPE_CHECKING:
    from aircut.api import Result
    from aircut.planner import Plan

JSON_VERSION = 1
MOTION = ("rapid", "feed", "probing")


def figures(plan: Plan, result: Result, lines: int = 10) -> dict[str, Any]:
    """The numbers of a plan. lines: how many of those that cost most."""
    import numpy as np

    t = plan.toolpath
    spent = plan.seconds
    kinds = {
        "rapid": t.kind == Kind.TRAVERSE,
        "feed": (t.kind == Kind.FEED) | (t.kind == Kind.ARC),
        "probing": t.kind == Kind.PROBE,
    }
    by_kind = {name: float(spent[which].sum()) for name, which in kinds.items()}
    pauses = {name: [p for p in plan.pauses if p.kind == name and p.seconds] for name in KINDS}
    by_kind |= {name: sum(p.seconds for p in found) for name, found in pauses.items()}
    return {
        "total": plan.duration,
        "profile": "jerk-limited" if plan.limits.jerk_limited else "trapezoidal",
        "seconds": by_kind,
        "counts": {name: len(found) for name, found in pauses.items()},
        "tools": tools(plan, kinds),
        "distance": distances(plan, kinds),
        "speed": speeds(plan, kinds["feed"] | kinds["probing"]),
        "lines": costly(plan, result, lines) if np.size(spent) or plan.pauses else [],
    }


def tools(plan: Plan, kinds: dict[str, Any]) -> list[dict[str, Any]]:
    """Seconds of each tool, in the order of use; a tool change counts to the tool that it brings."""
    import numpy as np

    t = plan.toolpath
    numbers, at, which = np.unique(t.tool, return_index=True, return_inverse=True)
    rows: dict[int, dict[str, Any]] = {}
    order = {int(number): int(first) for number, first in zip(numbers, at, strict=True)}
    sums = {name: np.bincount(which, plan.seconds * mask, len(numbers)) for name, mask in kinds.items()}
    for i, number in enumerate(numbers.tolist()):
        rows[number] = {"tool": number, **{name: float(values[i]) for name, values in sums.items()}, "pauses": 0.0}
    for pause in plan.pauses:
        number = pause.tool
        if number < 0:
            number = int(t.tool[min(pause.at, len(t) - 1)]) if len(t) else 0
        row = rows.setdefault(number, {"tool": number, **dict.fromkeys(kinds, 0.0), "pauses": 0.0})
        row["pauses"] += pause.seconds
        order.setdefault(number, pause.at)
    for row in rows.values():
        row["total"] = sum(row[name] for name in (*kinds, "pauses"))
    return [rows[number] for number in sorted(rows, key=lambda number: order[number]) if rows[number]["total"]]


def distances(plan: Plan, kinds: dict[str, Any]) -> dict[str, float]:
    """Programmed lengths, mm; degrees of moves of rotary axes alone."""
    lengths, linear = plan.toolpath.lengths(), linear_moves(plan)
    rapid = kinds["rapid"]
    return {
        "rapid": float(lengths[rapid & linear].sum()),
        "feed": float(lengths[~rapid & linear].sum()),
        "rotation": float(lengths[~linear].sum()),
    }


def linear_moves(plan: Plan) -> Any:
    """Which moves move X, Y or Z."""
    import numpy as np

    step = np.zeros(len(plan.toolpath))
    for i, axis in enumerate("xyz"):
        column = plan.toolpath.columns[axis]
        step = np.maximum(step, np.abs(np.diff(column, prepend=plan.toolpath.start[i])))
    return (step > 1e-7) | (plan.toolpath.kind == Kind.ARC)


def speeds(plan: Plan, feeds: Any) -> dict[str, float | None]:
    """Mean and peak speed of the tool in feed moves, mm/min, and how far the programmed feed was reached."""
    import numpy as np

    lengths, linear = plan.toolpath.lengths(), linear_moves(plan)
    which = feeds & linear
    seconds = float(plan.seconds[which].sum())
    if not seconds:
        return {"mean": None, "peak": None, "programmed": None, "reached": None}
    length = float(lengths[which].sum())
    wanted = float((lengths[which] / plan.toolpath.feed[which]).sum()) * 60.0
    row = plan.path.move if plan.rows is None else plan.rows[plan.path.move]
    whole = np.bincount(plan.path.move, plan.path.length, len(plan.path.toolpath))
    share = np.divide(lengths[row], whole[plan.path.move], out=np.zeros(len(row)), where=whole[plan.path.move] > 0)
    peak = (plan.piece_tops() * np.minimum(share, 1.0))[which[row]]
    return {
        "mean": 60.0 * length / seconds,
        "peak": 60.0 * float(peak.max(initial=0.0)),
        "programmed": 60.0 * length / wanted,
        "reached": wanted / seconds,
    }


def costly(plan: Plan, result: Result, most: int) -> list[dict[str, Any]]:
    """The lines that cost most."""
    import numpy as np

    t = plan.toolpath
    line = np.concatenate([t.line, np.array([p.line for p in plan.pauses], np.int64)]).astype(np.int64)
    file = np.concatenate([t.file, np.array([p.file for p in plan.pauses], np.int64)]).astype(np.int64)
    spent = np.concatenate([plan.seconds, [p.seconds for p in plan.pauses]])
    size = int(line.max(initial=0)) + 1
    sums = np.bincount(file * size + line, spent)
    first = np.argsort(-sums, kind="stable")[:most]
    rows = []
    for key in first[sums[first] > 0].tolist():
        name, number = result.files[key // size], key % size
        text = result.sources[name].text(number - 1).strip() if number and name in result.sources else ""
        rows.append({"file": name, "line": number, "seconds": float(sums[key]), "text": text})
    return rows


def to_json(figures: dict[str, Any], program: str, dialect: str) -> str:
    """The JSON report."""
    units = {"time": "s", "length": "mm", "angle": "degrees", "speed": "mm/min"}
    return json.dumps({"version": JSON_VERSION, "program": program, "dialect": dialect, "units": units, **figures},
                      indent=2) + "\n"  # fmt: skip


def to_csv(figures: dict[str, Any], program: str) -> str:
    """One row: the program and all of its sums."""
    row = {"program": program, "total": figures["total"], "profile": figures["profile"], **figures["seconds"]}
    row |= {f"distance_{name}": value for name, value in figures["distance"].items()}
    row |= {f"speed_{name}": value for name, value in figures["speed"].items()}
    out = io.StringIO()
    writer = csv.DictWriter(out, row, lineterminator="\n")
    writer.writeheader()
    writer.writerow(row)
    return out.getvalue()
