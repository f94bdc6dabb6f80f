"""Still pictures of a toolpath: a parallel view from the front right, and views along the axes.

Drawn with matplotlib's figures, never with pyplot, so that nothing outside the
picture changes. Every view is flat: points are turned into the view by one
matrix, thinned to what its pixels can show, and drawn as a few long lines.
"""

from __future__ import annotations

from math import ceil, floor, log10
from typing import IO, TYPE_CHECKING, Any, Literal, NamedTuple

from aircut.canon import Kind, Recording
from aircut.export.page import Frame, frames
from aircut.export.seen import Seen, box, finite, programmed, seen

if TYPE_CHECKING:
    from os import PathLike

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from aircut.planner import Plan

INK, SOFT, GRID = "#1d2530", "#5f6c7b", "#dde3ea"
FEED, RAPID, PROBE, CONTOUR = "#0b62c4", "#d9660a", "#a328c9", "#a08a00"
TOOL = "#16867a"
TOOLS = 60  # lines along the tool
AXIS = ("#d32f2f", "#1b8a3e", "#1f5fd6")
PAPER = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.8}
LOW, HIGH = (
    (0.07, 0.2, 0.58),
    (0.25, 0.75, 1.0),
)  # red, green, blue of a dense path's depths and heights
DPI = 100
MANY = 100_000  # points from which short segments are drawn as pixels, also in SVG
SPARE = 1_000_000  # points that arcs may add


class View(NamedTuple):
    """A way of looking: where machine X, Y, Z point on the paper."""

    title: str
    right: tuple[float, float, float]
    up: tuple[float, float, float]
    axes: tuple[int, int] | None  # machine axes along the paper's sides, if any


def sight(azimuth: float, height: float) -> View:
    """A parallel view. azimuth: degrees of the eye from -Y towards +X; height: degrees above the XY plane."""
    from math import cos, radians, sin

    a, h = radians(azimuth), radians(height)
    up = (-sin(a) * sin(h), cos(a) * sin(h), cos(h))
    return View("Overview", (cos(a), sin(a), 0.0), up, None)


OVERVIEW = sight(38, 30)
TOP = View("Top (XY)", (1, 0, 0), (0, 1, 0), (0, 1))
FRONT = View("Front (XZ)", (1, 0, 0), (0, 0, 1), (0, 2))
SIDE = View("Right (YZ)", (0, 1, 0), (0, 0, 1), (1, 2))


class Path(NamedTuple):
    """What every view draws."""

    seen: Seen
    kinds: NDArray[np.uint8]  # of the segment that ends at each point
    low: NDArray[np.float64]  # box of all that is shown, mm
    high: NDArray[np.float64]
    origins: list[tuple[str, NDArray[np.float64]]]
    what: str  # of which moves the box is, as a word before the numbers
    contour: NDArray[np.float64]  # (k, 3) mm, what compensation led the tool beside; NaN between stretches
    corners: NDArray[np.float64] | None = None  # (k, 3) mm, programmed, where the points are of the blended path

    @property
    def points(self) -> NDArray[np.float64]:
        """Points of the path, (m, 3) mm."""
        return self.seen.points


def turned(view: View, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (m, 3) on the paper of a view, (m, 2) mm."""
    import numpy as np

    return points @ np.array([view.right, view.up]).T


def thinned(paper: NDArray[np.float64], pixel: float) -> NDArray[np.float64]:
    """A line of points (m, 2) without those that fall on the same pixel as the one before; the ends stay."""
    import numpy as np

    if len(paper) < 1000:
        return paper
    cell = np.floor(paper / pixel)
    keep = np.ones(len(paper), bool)
    keep[1:-1] = (cell[1:-1] != cell[:-2]).any(axis=1) | (cell[1:-1] != cell[2:]).any(axis=1)
    return paper[keep]


def stretches(path: Path, wanted: NDArray[np.bool_], view: View, pixel: float) -> NDArray[np.float64]:
    """The wanted segments as one line on the paper, (m, 2) mm, with NaN between stretches."""
    import numpy as np

    edge = np.flatnonzero(np.diff(np.concatenate([[False], wanted[1:], [False]]).astype(np.int8)))
    paper = turned(view, path.points)
    gap = np.full((1, 2), np.nan)
    parts: list[NDArray[np.float64]] = []
    for first, last in edge.reshape(-1, 2).tolist():
        parts += [thinned(paper[first : last + 1], pixel), gap]
    return np.concatenate(parts) if parts else np.empty((0, 2))


def nice(raw: float) -> float:
    """The least of 1, 2, 5 times a power of ten that is not below."""
    ten = 10.0 ** floor(log10(raw))
    return next((n * ten for n in (1, 2, 5) if n * ten >= raw * 0.999), 10 * ten)


def millimeters(value: float) -> str:
    """A length with up to three decimals."""
    return f"{round(value, 3) + 0.0:.3f}".rstrip("0").rstrip(".")


def gather(recording: Recording, plan: Plan | None = None) -> Path | None:
    """The path and its surroundings; None without moves. plan: to show blended corners as they are followed."""
    import numpy as np

    toolpath = recording.toolpath
    if not len(toolpath):
        return None
    shown = seen(toolpath, SPARE, TOOLS)
    corners = None
    if plan is not None and plan.blends and not shown.part:
        corners = shown.points
        points, move = plan.polyline()
        shown = shown._replace(points=finite(points[:, :3]), move=move)
    kinds = toolpath.kind[np.maximum(shown.move, 0)]
    found = frames(recording)
    zeros: list[tuple[str, NDArray[np.float64]]] = []
    for frame, until in zip(found, [*(each.at for each in found[1:]), len(toolpath)], strict=True):
        at = zero(frame)
        new = all(np.abs(at - other).max() > 1e-6 for _, other in zeros)
        if frame.at < until and new and len(zeros) < 12:
            zeros.append((system(frame.system), at))
    if all(np.abs(at).max() > 1e-6 for _, at in zeros):
        zeros.append(("machine zero", np.zeros(3)))
    else:
        zeros = [("0" if not at.any() and len(zeros) == 1 else name, at) for name, at in zeros]
    beside, drawn = programmed(recording, SPARE)
    beside = np.insert(beside, np.flatnonzero(~drawn), np.nan, axis=0)
    # The picture is of the cut where rapids reach far beyond it, as from a far machine zero.
    low, high = np.array(box(toolpath, shown, None))
    cut = box(toolpath, shown, False)
    if cut is not None:
        least, most = np.array(cut)
        if 0 < np.linalg.norm(most - least) < np.linalg.norm(high - low) / 2.5:
            return Path(shown, kinds, least, most, zeros, "cut ", beside, corners)
    return Path(shown, kinds, low, high, zeros, "", beside, corners)


def zero(frame: Frame) -> NDArray[np.float64]:
    """Machine X, Y, Z of a frame's zero, mm."""
    import numpy as np

    angle = np.radians(frame.rotation)
    cos, sin = np.cos(angle), np.sin(angle)
    x, y, z = frame.g92[:3]
    turned_g92 = np.array([x * cos - y * sin, x * sin + y * cos, z])
    return finite(np.array(frame.g5x[:3]) + turned_g92)


def system(number: int) -> str:
    """G54 … G59, G59.1 …; further systems by their number."""
    return f"G{53 + number}" if number <= 6 else f"G59.{number - 6}" if number <= 9 else f"G54.1 P{number}"


def show(axes: Axes, path: Path, view: View, pixels: tuple[float, float]) -> None:
    """Draw one view. pixels: width and height of its room."""
    import numpy as np

    corners = np.array(np.meshgrid(*zip(path.low, path.high, strict=True))).reshape(3, -1).T
    size = float(np.linalg.norm(path.high - path.low)) or 1.0
    near = [at for _, at in path.origins if box_distance(path, at) < 0.5 * size]
    shown = path.contour[np.isfinite(path.contour[:, 0])]
    seen = turned(view, np.vstack([corners, *near, shown]))
    low, high = seen.min(axis=0), seen.max(axis=0)
    scale = max(float(((high - low) / pixels).max()), size * 1e-6 / 100)  # mm a pixel
    axes.set_aspect("equal")
    middle, room = (low + high) / 2, np.array(pixels) * scale / 2 * (1.34 if view.axes is None else 1.2)
    axes.set_xlim(middle[0] - room[0], middle[0] + room[0])
    axes.set_ylim(middle[1] - room[1], middle[1] + room[1])
    axes.set_title(view.title, fontsize=11, color=SOFT, loc="left")

    if len(shown):
        contour = turned(view, path.contour)
        axes.plot(contour[:, 0], contour[:, 1], color=CONTOUR, linewidth=1.1, label="programmed", zorder=2.5)
    pixel = scale * 1.2  # the margins' share included
    if path.corners is not None:
        line = thinned(turned(view, path.corners), pixel / 2)
        axes.plot(line[:, 0], line[:, 1], color=SOFT, linewidth=0.7, label="before blending", alpha=0.7, zorder=2.5)
    feeds = (path.kinds == Kind.FEED) | (path.kinds == Kind.ARC)
    feeds[0] = False
    if len(path.points) > MANY:
        feeds = feeds & ~shade(axes, path, view, feeds, pixel)
        axes.plot([], [], color=FEED, label="" if feeds.any() else "feed")
    for name, wanted, color, width, dash in (
        ("feed", feeds, FEED, 1.2, "solid"),
        ("rapid", path.kinds == Kind.TRAVERSE, RAPID, 0.9, (0, (5, 3))),
        ("probe", path.kinds == Kind.PROBE, PROBE, 1.4, "solid"),
    ):
        line = stretches(path, wanted, view, pixel / 2)
        if len(line):
            axes.plot(
                line[:, 0],
                line[:, 1],
                color=color,
                linewidth=width,
                linestyle=dash,
                label=name,
                rasterized=len(line) > MANY // 4,
                zorder=3 if name == "feed" else 4,
            )
    if len(path.seen.tools):
        lines(axes, view, path.seen.tools.tolist(), color=TOOL, linewidth=0.9, alpha=0.75, zorder=5)
        axes.plot([], [], color=TOOL, label="tool")
    if view.axes is None:
        surround(axes, path, view, size)
    else:
        measure(axes, path, view)
    for name, at in path.origins:
        ((x, y),) = turned(view, at[None, :])
        if abs(x - middle[0]) <= room[0] and abs(y - middle[1]) <= room[1]:
            axes.plot([x], [y], marker="o", markersize=7, color=INK, markerfacecolor="white", zorder=6)
            axes.plot([x], [y], marker="+", markersize=12, color=INK, zorder=6)
            if view.axes is None and name == "0":
                continue  # the axes say it
            axes.annotate(name, (x, y), (7, -11), textcoords="offset points", fontsize=9, color=INK, zorder=7)


def shade(axes: Axes, path: Path, view: View, wanted: NDArray[np.bool_], pixel: float) -> NDArray[np.bool_]:
    """Draw those of the wanted segments that are shorter than a few pixels as an image, colored by height.

    So a surface of a million short moves has a shape, and costs what its pixels cost.
    Returns which segments were drawn. pixel: mm.
    """
    import numpy as np

    cell = pixel / 2  # two by two to a pixel
    x0, x1, y0, y1 = *axes.get_xlim(), *axes.get_ylim()
    columns, rows = ceil((x1 - x0) / cell), ceil((y1 - y0) / cell)
    u, v = ((turned(view, path.points) - (x0, y0)) / cell).astype(np.float32).T.copy()
    du, dv = np.diff(u, prepend=u[:1]), np.diff(v, prepend=v[:1])
    pieces = np.maximum(np.abs(du), np.abs(dv))  # of a segment, a cell each
    short = wanted & (pieces < 8)
    which = np.flatnonzero(short & (u >= 0) & (u < columns) & (v >= 0) & (v < rows))
    if not len(which):
        return short
    # The nearest to the eye are drawn last.
    depth = path.points[which] @ np.cross(view.right, view.up)
    low, high = float(depth.min()), float(depth.max())
    near = (depth - low) / ((high - low) or 1.0)
    which = which[np.argsort((near * 65535).astype(np.uint16), kind="stable")]
    height = path.points[which, 2].astype(np.float32)
    u, v, du, dv, level, pieces = u[which], v[which], du[which], dv[which], height, np.ceil(pieces[which])
    shown = np.full((rows + 1, columns + 1), np.nan, np.float32)
    for piece in range(8):
        if piece:
            long = np.flatnonzero(pieces > piece)
            u, v, du, dv, level, pieces = (each[long] for each in (u, v, du, dv, level, pieces))
        if not len(u):
            break
        back = piece / np.maximum(pieces, 1)
        column = np.clip((u - du * back).astype(np.int32), 0, columns)
        row = np.clip((v - dv * back).astype(np.int32), 0, rows)
        shown[row, column] = level
    for part in (shown, shown.T):  # segments as wide as a pixel: what is empty takes its neighbor's
        np.copyto(part[1:], part[:-1].copy(), where=np.isnan(part[1:]))
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    part = np.nan_to_num((shown - low) / ((high - low) or 1.0))[..., None]
    picture = np.empty((*shown.shape, 4), np.float32)
    picture[..., :3] = np.array(LOW) * (1 - part) + np.array(HIGH) * part
    picture[..., 3] = ~np.isnan(shown)
    limits = (x0, x0 + (columns + 1) * cell, y0, y0 + (rows + 1) * cell)
    axes.imshow(picture, extent=limits, origin="lower", zorder=3, interpolation="antialiased", aspect="equal")
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    return short


def box_distance(path: Path, at: NDArray[np.float64]) -> float:
    """Distance of a place from the box of the path, mm."""
    import numpy as np

    return float(np.linalg.norm(np.maximum(np.maximum(path.low - at, at - path.high), 0)))


def measure(axes: Axes, path: Path, view: View) -> None:
    """Scales along the sides, and the extents as dimension lines."""
    assert view.axes is not None
    across, upright = view.axes
    axes.set_xlabel(f"{'XYZ'[across]} (mm)", color=AXIS[across])
    axes.set_ylabel(f"{'XYZ'[upright]} (mm)", color=AXIS[upright])
    axes.grid(True, color=GRID, linewidth=0.7, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(colors=SOFT, labelsize=8)
    for spine in axes.spines.values():
        spine.set_color(GRID)
    x0, x1, y0, y1 = path.low[across], path.high[across], path.low[upright], path.high[upright]
    axes.plot([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], color=SOFT, linewidth=0.7, alpha=0.7, zorder=2)
    style: dict[str, Any] = {
        "textcoords": "offset points",
        "fontsize": 9,
        "fontweight": "bold",
        "color": INK,
        "bbox": PAPER,
        "zorder": 7,
    }
    if x1 > x0:
        axes.annotate(millimeters(x1 - x0), ((x0 + x1) / 2, y1), (0, 6), ha="center", va="bottom", **style)
    if y1 > y0:
        middle = (x1, (y0 + y1) / 2)
        axes.annotate(millimeters(y1 - y0), middle, (7, 0), ha="left", va="center", rotation=90, **style)


def surround(axes: Axes, path: Path, view: View, size: float) -> None:
    """Of the overview: a grid on the ground, the box with its sizes, the axes at the first origin."""
    import numpy as np

    axes.set_axis_off()
    low, high = path.low, path.high
    step = nice(max(float((high - low)[:2].max()), size * 0.3) / 8)
    x = step * np.arange(floor(low[0] / step), ceil(high[0] / step) + 1)
    y = step * np.arange(floor(low[1] / step), ceil(high[1] / step) + 1)
    if len(x) < 2:
        x = np.array([x[0] - step, x[0] + step])
    if len(y) < 2:
        y = np.array([y[0] - step, y[0] + step])
    ground = [[(at, y[0], low[2]), (at, y[-1], low[2])] for at in x]
    ground += [[(x[0], at, low[2]), (x[-1], at, low[2])] for at in y]
    lines(axes, view, ground, color=GRID, linewidth=0.8, zorder=0)
    for at in every(x):
        note(axes, view, (at, y[0], low[2]), millimeters(at), (0, -10), fontsize=8, color=SOFT)
    for at in every(y):
        note(axes, view, (x[-1], at, low[2]), millimeters(at), (12, -4), fontsize=8, color=SOFT)
    note(axes, view, ((x[0] + x[-1]) / 2, y[0], low[2]), "X (mm)", (-18, -26), fontsize=9, color=AXIS[0])
    note(axes, view, (x[-1], (y[0] + y[-1]) / 2, low[2]), "Y (mm)", (34, -16), fontsize=9, color=AXIS[1])

    box = np.array([low, high])
    edges = []
    for corner in np.ndindex(2, 2, 2):
        for axis in range(3):
            if not corner[axis]:
                start = [box[corner[i], i] for i in range(3)]
                edges.append([start, [*start[:axis], high[axis], *start[axis + 1 :]]])
    lines(axes, view, edges, color=SOFT, linewidth=0.6, alpha=0.55, zorder=1)
    middle = (low + high) / 2
    for axis, place, offset in (
        (0, (middle[0], high[1], high[2]), (6, 8)),
        (1, (low[0], middle[1], high[2]), (-10, 8)),
        (2, (low[0], low[1], middle[2]), (-8, 0)),
    ):
        length = high[axis] - low[axis]
        if length > 0:
            where = {"ha": "right"} if axis == 2 else {}
            note(
                axes,
                view,
                place,
                f"{'XYZ'[axis]} {millimeters(length)} mm",
                offset,
                fontsize=10,
                fontweight="bold",
                color=INK,
                bbox=PAPER,
                **where,
            )
    origin = path.origins[0][1]
    if box_distance(path, origin) < 0.5 * size:
        for axis in range(3):
            tip = origin.copy()
            tip[axis] += size * 0.13
            start, end = turned(view, np.array([origin, tip]))
            axes.annotate(
                "",
                end,
                start,
                zorder=6,
                annotation_clip=False,
                arrowprops={"arrowstyle": "-|>", "color": AXIS[axis], "linewidth": 2, "shrinkA": 0},
            )
            tip[axis] += size * 0.02
            note(axes, view, tip, "XYZ"[axis], (0, 0), fontsize=11, fontweight="bold", color=AXIS[axis])


def every(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Enough of the places to label."""
    return places[:: 1 if len(places) <= 12 else ceil(len(places) / 12)]


def lines(axes: Axes, view: View, pairs: list[Any], **style: Any) -> None:
    """Draw segments, each two machine points."""
    import numpy as np
    from matplotlib.collections import LineCollection

    paper = turned(view, np.array(pairs, float).reshape(-1, 3))
    axes.add_collection(LineCollection(list(paper.reshape(-1, 2, 2)), **style))


def note(axes: Axes, view: View, at: Any, words: str, offset: tuple[float, float], **style: Any) -> None:
    """Words at a machine point. offset: points."""
    import numpy as np

    (place,) = turned(view, np.array([at], float))
    style = {"ha": "center", "va": "center", "zorder": 7, "annotation_clip": False, **style}
    axes.annotate(words, tuple(place), offset, textcoords="offset points", **style)


def compose(figure: Figure, path: Path | None, title: str, moves: int) -> None:
    """Lay the views out as drawings do: top, below it front, beside that right; and the overview."""
    width, height = figure.get_size_inches() * DPI
    figure.text(0.02, 0.975, title, fontsize=15, fontweight="bold", color=INK, va="top", parse_math=False)
    if path is None:
        figure.text(0.5, 0.5, "This program makes no moves.", fontsize=16, color=SOFT, ha="center", va="center")
        return
    box = zip("XYZ", path.low, path.high, strict=True)
    told = [f"{name} {millimeters(low)} … {millimeters(high)}" for name, low, high in box]
    words = "    ".join([f"{moves:,} moves", path.what + told[0], *told[1:]])
    told_as = "as the part sees it" if path.seen.part else "machine coordinates"
    figure.text(0.02, 0.943, f"{words} mm, {told_as}", fontsize=10, color=SOFT, va="top")
    for view, room in (
        (TOP, (0.06, 0.425, 0.42, 0.45)),
        (OVERVIEW, (0.5, 0.38, 0.495, 0.52)),
        (FRONT, (0.06, 0.07, 0.42, 0.27)),
        (SIDE, (0.56, 0.07, 0.42, 0.27)),
    ):
        axes = figure.add_axes(room)
        show(axes, path, view, (room[2] * width, room[3] * height))
        if view is OVERVIEW:
            shown, names = axes.get_legend_handles_labels()
    figure.legend(
        shown,
        names,
        loc="upper right",
        ncols=4,
        frameon=False,
        fontsize=10,
        labelcolor=INK,
        bbox_to_anchor=(0.985, 0.985),
    )


def draw(
    recording: Recording,
    file: str | PathLike[str] | IO[bytes],
    format: Literal["png", "svg"],
    title: str,
    size_px: tuple[int, int] = (1600, 1200),
    plan: Plan | None = None,
) -> None:
    """Write a picture of a recording to a path or a binary file. size_px: width and height, pixels.

    plan: where it blends corners, the path is drawn as followed, and the programmed one thin beside it.

    A path of more than 100,000 points is thinned to what the pixels can show and, in
    SVG too, drawn as pixels; axes and texts remain shapes.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(size_px[0] / DPI, size_px[1] / DPI), dpi=DPI, facecolor="white")
    with rc_context({"agg.path.chunksize": 20_000, "svg.hashsalt": "aircut"}):  # the same picture, the same bytes
        compose(figure, gather(recording, plan), title, len(recording.toolpath))
        if format == "svg":
            FigureCanvasSVG(figure).print_svg(file, metadata={"Date": None, "Title": title})
        else:
            FigureCanvasAgg(figure).print_png(file, metadata={"Software": None, "Title": title})
