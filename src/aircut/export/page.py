"""The 3D page: one HTML file that carries the viewer, the path and the program texts.

The viewer is built from web/ and committed in viewer/viewer.html; here its
markers are filled in. Numbers travel as columns of quantized integers, told by
their differences, byte planes apart and deflated, because that is small, quick
on both sides and never a list of a million numbers in JSON.
"""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from html import escape
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import Kind, Recording
from aircut.export.seen import box, finite, programmed, seen

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from aircut.planner import Plan

TITLE_MARK = "<!--aircut:title-->"
DATA_MARK = "<!--aircut:data-->"
QUANTUM = 1e-4  # mm, degrees, mm/min: the digits that the page shows
REACH = 2**30  # quanta that fit a column; a wider path gets a coarser quantum
LEVEL = 1  # of deflate: higher ones take longer than they spare
TOOLS = 300  # lines along the tool
SPARE_POINTS = 2_000_000  # points that arcs may add to a path's moves
FRAMES = 10_000  # changes of work offsets that are told; more are a runaway program's


class Frame(NamedTuple):
    """Work offsets in force from a move on; machine = rotated(work + g92) + g5x."""

    at: int  # move
    system: int  # 1: G54 …
    g5x: tuple[float, ...]  # mm and degrees, six axes
    g92: tuple[float, ...]
    rotation: float  # of XY, degrees


REST = Frame(0, 1, (0.0,) * 6, (0.0,) * 6, 0.0)


def frames(recording: Recording) -> list[Frame]:
    """The work offsets along a run, one entry a change; the first is in force at the start."""
    import numpy as np

    from aircut.canon.record import NUMBERS

    changes: dict[int, Callable[[Frame, tuple[Any, ...]], Frame]] = {
        NUMBERS["SET_G5X_OFFSET"]: lambda frame, got: frame._replace(system=int(got[0]), g5x=six(got[1:])),
        NUMBERS["SET_G92_OFFSET"]: lambda frame, got: frame._replace(g92=six(got)),
        NUMBERS["SET_XY_ROTATION"]: lambda frame, got: frame._replace(rotation=float(got[0])),
    }
    events = recording.events
    names = np.array(events.name, np.uint8)
    found = [REST]
    for index in np.flatnonzero(np.isin(names, list(changes)))[:FRAMES].tolist():
        frame = changes[names[index]](found[-1], events.values[index])._replace(at=events.at[index])
        if frame[1:] == found[-1][1:]:
            continue
        if frame.at == found[-1].at:
            found[-1] = frame
        else:
            found.append(frame)
    return found


def six(values: tuple[Any, ...]) -> tuple[float, ...]:
    """Six numbers, whatever a program has set."""
    return tuple(float(value) for value in (*values, *(0.0,) * 6)[:6])


def planes(integers: NDArray[np.int32]) -> bytes:
    """Differences, zigzag coded (so that small ones have high bytes of 0), byte planes apart, deflated."""
    import numpy as np

    step = np.diff(integers, prepend=np.int32(0))
    zigzag = (step << 1) ^ (step >> 31)
    apart = zigzag.astype("<i4").view(np.uint8).reshape(-1, 4).T
    return zlib.compress(np.ascontiguousarray(apart).tobytes(), LEVEL)


def column(name: str, values: NDArray[Any], quantum: float = 1.0) -> tuple[dict[str, Any], bytes]:
    """One column for the page: how to read it, and its bytes. Error: half a quantum."""
    import numpy as np

    if not len(values):
        return {"name": name, "count": 0, "base": 0, "quantum": 1}, b""
    low, high = float(values.min()), float(values.max())
    if low == high:
        return {"name": name, "count": len(values), "base": low, "quantum": 0}, b""
    if quantum == 1.0 and values.dtype.kind != "f":
        return {"name": name, "count": len(values), "base": 0, "quantum": 1}, planes(values.astype(np.int32))
    base = round((low + high) / 2 / quantum) * quantum
    quantum = max(quantum, (high - low) / REACH)
    integers = np.rint((values - base) / quantum).astype(np.int32)
    return {"name": name, "count": len(values), "base": base, "quantum": quantum}, planes(integers)


def text(name: str, source: str) -> tuple[dict[str, Any], bytes]:
    """One program text for the page, its line ends as the language counts them."""
    if "\n" not in source:
        source = source.replace("\r", "\n")
    data = source.removeprefix("\ufeff").encode("utf-8", "replace")
    return {"name": name, "bytes": len(data)}, zlib.compress(data, LEVEL)


def script(name: str, data: bytes) -> str:
    """A block of data in the page. Base64 has no character that could end it."""
    return f'<script type="application/octet-stream" id="{name}">{b64encode(data).decode("ascii")}</script>\n'


def written(facts: Any) -> str:
    """JSON that may stand inside a script element, whatever the strings hold."""
    plain = json.dumps(facts, ensure_ascii=True, allow_nan=False)
    return plain.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def html(recording: Recording, sources: dict[str, str], title: str, plan: Plan | None = None) -> str:
    """The complete page, with no reference to anything outside it.

    plan: where it blends corners, the path is shown as followed, and the programmed one beside it.
    sources: text of each file by its name in recording.files; a name without a text is shown without one.
    """
    import numpy as np

    toolpath = recording.toolpath
    shown = seen(toolpath, SPARE_POINTS, TOOLS)
    contour, drawn = programmed(recording, SPARE_POINTS)
    if plan is not None and plan.blends and not shown.part and not len(contour):
        points, move = plan.polyline()
        if move[-1] == len(toolpath) - 1 and (np.diff(move) <= 1).all():  # the viewer wants a point of each move
            contour, drawn = shown.points, toolpath.kind[np.maximum(shown.move, 0)] != Kind.TRAVERSE
            drawn[0] = False
            shown = shown._replace(points=finite(points[:, :3]), move=move)
    points, move = shown.points, shown.move
    names = list(recording.files) or list(sources)
    jobs: list[tuple[Callable[..., tuple[dict[str, Any], bytes]], tuple[Any, ...]]] = [
        (text, (name, sources.get(name, ""))) for name in names
    ]
    jobs += [(column, (axis, points[:, index], QUANTUM)) for index, axis in enumerate("xyz")]
    jobs += [(column, (axis, finite(toolpath.columns[axis]), QUANTUM)) for axis in "abc"]
    jobs += [(column, ("feed", finite(toolpath.feed), QUANTUM))]
    jobs += [(column, (name, toolpath.columns[name])) for name in ("line", "file", "tool", "kind")]
    jobs += [(column, ("move", move))]
    jobs += [(column, (f"contour-{axis}", contour[:, index], QUANTUM)) for index, axis in enumerate("xyz")]
    jobs += [(column, ("contour-drawn", drawn.astype(np.int32)))]
    with ThreadPoolExecutor() as pool:
        boxes = [pool.submit(box, toolpath, shown, rapid) for rapid in (None, False)]
        done = list(pool.map(lambda job: job[0](*job[1]), jobs))
    facts = {
        "title": title,
        "moves": len(toolpath),
        "start": finite(toolpath.start).tolist(),
        "extents": [box.result() for box in boxes],
        "tools": shown.tools.round(4).reshape(-1).tolist(),
        "frames": frames(recording),
        "files": [told for told, _ in done[: len(names)]],
        "columns": [told for told, _ in done[len(names) :]],
    }
    blocks = [f'<script type="application/json" id="facts">{written(facts)}</script>\n']
    blocks += [script(f"file-{index}", data) for index, (_, data) in enumerate(done[: len(names)])]
    blocks += [script(f"column-{told['name']}", data) for told, data in done[len(names) :]]

    viewer = resources.files("aircut.export").joinpath("viewer/viewer.html").read_text("utf-8")
    before, _, rest = viewer.partition(TITLE_MARK)
    between, _, after = rest.partition(DATA_MARK)
    return "".join([before, escape(title), between, *blocks, after])
