"""Modes of LinuxCNC's language: feed, units, planes, distances, path, coolant, overrides.

Sources: 001; the canonical listing, sections 4, 5 and 14.
"""

from __future__ import annotations

from functools import partial

from aircut.canon import EXACT_PATH, EXACT_STOP
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.spindles import choose, overridden
from aircut.interpreter.linuxcnc.state import LINEAR, State
from aircut.interpreter.linuxcnc.turning import tell_blending
from aircut.interpreter.state import INCH
from aircut.interpreter.table import Code, Group, Order, Words

PLANES = {170: (0, "XY"), 180: (1, "XZ"), 190: (2, "YZ"), 171: (0, "UNKNOWN"), 181: (1, "UNKNOWN"), 191: (2, "UNKNOWN")}


def said(m: State, text: str) -> None:
    """A comment of the interpreter's own."""
    m.out.event("COMMENT", "interpreter: " + text)


# --- feed


def set_feed_mode(mode: int, m: State, w: Words) -> None:
    """G93, G94, G95: F is due again."""
    text = {93: "inverse time", 94: "units per minute", 95: "units per revolution"}[mode]
    spindle = choose(m, w)
    said(m, f"feed mode set to {text}")
    m.feed_mode = mode
    m.inverse_time = mode == 93
    if mode == 93:
        m.out.event("SET_FEED_MODE", 0, 0)
        return
    m.out.event("SET_FEED_MODE", spindle if mode == 95 else 0, int(mode == 95))
    set_rate(m, 0.0)


def set_rate(m: State, feed: float) -> None:
    m.gave_feed = feed
    m.feed = feed * m.unit
    m.out.event("SET_FEED_RATE", m.feed)


def feed_word(m: State, w: Words) -> None:
    """F; under G93 it belongs to the move."""
    if m.feed_mode != 93:
        set_rate(m, w["f"])


# --- planes, units, distances


def set_plane(code: int, m: State, w: Words) -> None:
    """G17 to G19.1. Raises Refusal."""
    if m.cutter and code != m.plane_code and code % 10 == 0:
        raise Refusal(F.UNDER_COMPENSATION, what="another plane")
    m.plane_code = code
    m.plane, name = PLANES[code]
    m.out.event("SELECT_PLANE", name)


def set_units(unit: float, m: State, w: Words) -> None:
    """G20, G21: lengths are kept in mm, so nothing is turned.

    But the tool's offset and G64's tolerances keep their numbers, not their lengths: LinuxCNC forgets to turn them.
    It turns the position, and the last bit that this costs can decide whether a cycle moves to its height again.
    """
    if unit > m.unit:
        m.position = [p * (1.0 / INCH) * INCH if i in LINEAR else p for i, p in enumerate(m.position)]
    m.blend = m.blend / m.unit * unit
    m.thinning = m.thinning / m.unit * unit
    m.tool_offset = [t / m.unit * unit if i in LINEAR else t for i, t in enumerate(m.tool_offset)]
    m.fence()
    m.unit = unit
    m.feed = m.gave_feed * unit
    m.out.event("USE_LENGTH_UNITS", "MM" if unit == 1.0 else "INCHES")


def set_distance(absolute: bool, m: State, w: Words) -> None:
    """G90, G91."""
    if m.absolute != absolute:
        said(m, f"distance mode changed to {'absolute' if absolute else 'incremental'}")
    m.absolute = absolute


def set_arc_distance(absolute: bool, m: State, w: Words) -> None:
    """G90.1, G91.1."""
    if m.arc_absolute != absolute:
        said(m, f"IJK distance mode changed to {'absolute' if absolute else 'incremental'}")
    m.arc_absolute = absolute


def set_diameter(diameter: bool, m: State, w: Words) -> None:
    """G7, G8."""
    if m.diameter != diameter:
        said(m, f"Lathe diameter mode changed to {'diameter' if diameter else 'radius'}")
        if m.out.marks:  # this comment does not wait behind a compensated move
            m.out.hurry()
    m.diameter = diameter


def set_retract(mode: int, m: State, w: Words) -> None:
    """G98, G99. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G98 or G99")
    m.retract = mode
    said(m, f"retract mode set to {'old_z' if mode == 98 else 'r_plane'}")


# --- path


def exact(mode: int, m: State, w: Words) -> None:
    """G61, G61.1. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G61")
    m.path_mode = mode
    m.flags = EXACT_PATH if mode == 61 else EXACT_STOP
    m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_PATH" if mode == 61 else "EXACT_STOP")


def blending(m: State, w: Words) -> None:
    """G64: P the tolerance of blending, Q of thinning. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G64")
    m.path_mode = 64
    m.flags = 0
    m.blend = max(m.length(w, "p"), 0.0)
    m.thinning = m.length(w, "q") if w.get("q", -1.0) >= 0.0 else m.blend
    tell_blending(m)


# --- coolant, overrides, stops


def coolant(mist: bool | None, m: State, w: Words) -> None:
    """M7 (mist), M8 (flood), M9 (neither)."""
    if mist is None:
        m.mist = m.flood = False
        m.out.event("MIST_OFF")
        m.out.event("FLOOD_OFF")
    elif mist:
        m.mist = True
        m.out.event("MIST_ON")
    else:
        m.flood = True
        m.out.event("FLOOD_ON")


def override(feed: bool, speed: bool, on: bool, m: State, w: Words) -> None:
    """M48, M49; M50 and M51 with P. Raises Refusal."""
    barred(m)
    if feed:
        m.feed_override = int(on)
        m.follow_feed(on)
    if speed:
        for number in overridden(m, {} if feed else w):
            if number == 0:
                m.speed_override = int(on)
            m.follow_speed(on, number)


def by_p(feed: bool, m: State, w: Words) -> None:
    """M50, M51: P0 is off; without P, on. Raises Refusal."""
    override(feed, not feed, w.get("p", 1.0) != 0.0, m, w)


def barred(m: State) -> None:
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="M48 to M53")


def adaptive(m: State, w: Words) -> None:
    """M52."""
    barred(m)
    m.adaptive = w.get("p", 1.0) != 0.0
    m.out.event("ENABLE_ADAPTIVE_FEED" if m.adaptive else "DISABLE_ADAPTIVE_FEED")


def hold(m: State, w: Words) -> None:
    """M53."""
    barred(m)
    m.hold = w.get("p", 1.0) != 0.0
    m.out.event("ENABLE_FEED_HOLD" if m.hold else "DISABLE_FEED_HOLD")


def dwell(m: State, w: Words) -> None:
    """G4. Raises Refusal."""
    m.out.event("DWELL", w["p"])


def check_dwell(m: State, w: Words) -> None:
    """Raises Refusal."""
    if not given(w, "p"):
        raise Refusal(F.MISSING_WORD, code="G4", word="P", meaning="seconds")


def stop(event: str, m: State, w: Words) -> None:
    """M0, M1."""
    m.out.event(event)


def shuttle(m: State, w: Words) -> None:
    """M60."""
    m.out.event("PALLET_SHUTTLE")
    m.out.event("PROGRAM_STOP")


def end(pallet: bool, m: State, w: Words) -> None:
    """M2, M30: the interpreter closes the run."""
    m.finished = True
    m.stop_code = 30.0 if pallet else 2.0


plane = partial(Code, group=Group.PLANE, order=Order.PLANE)
COOLANT = Group.MIST | Group.FLOOD
OVERRIDE = Group.FEED_OVERRIDE | Group.SPEED_OVERRIDE
stopping = partial(Code, group=Group.STOP, order=Order.STOP)

CODES = (
    Code("G93", "Inverse time feed", partial(set_feed_mode, 93), Group.FEED_MODE, Order.FEED_MODE),
    Code("G94", "Units a minute", partial(set_feed_mode, 94), Group.FEED_MODE, Order.FEED_MODE),
    Code("G95", "Units a revolution", partial(set_feed_mode, 95), Group.FEED_MODE, Order.FEED_MODE),
    *(plane(f"G{n / 10:g}", "Plane", partial(set_plane, n)) for n in (170, 180, 190, 171, 181, 191)),
    Code("G20", "Inches", partial(set_units, INCH), Group.UNITS, Order.UNITS),
    Code("G21", "Millimeters", partial(set_units, 1.0), Group.UNITS, Order.UNITS),
    Code("G7", "Diameters", partial(set_diameter, True), Group.DIAMETER, Order.DIAMETER),
    Code("G8", "Radii", partial(set_diameter, False), Group.DIAMETER, Order.DIAMETER),
    Code("G61", "Exact path", partial(exact, 61), Group.PATH, Order.PATH),
    Code("G61.1", "Exact stop", partial(exact, 611), Group.PATH, Order.PATH),
    Code("G64", "Continuous path", blending, Group.PATH, Order.PATH, takes="pq"),
    Code("G90", "Absolute positions", partial(set_distance, True), Group.DISTANCE, Order.DISTANCE),
    Code("G91", "Incremental positions", partial(set_distance, False), Group.DISTANCE, Order.DISTANCE),
    Code("G90.1", "Absolute centers", partial(set_arc_distance, True), Group.ARC_DISTANCE, Order.ARC_DISTANCE),
    Code("G91.1", "Incremental centers", partial(set_arc_distance, False), Group.ARC_DISTANCE, Order.ARC_DISTANCE),
    Code("G98", "Retract to the start", partial(set_retract, 98), Group.RETRACT, Order.RETRACT),
    Code("G99", "Retract to R", partial(set_retract, 99), Group.RETRACT, Order.RETRACT),
    Code("G4", "Dwell", dwell, Group.NON_MODAL, Order.DWELL, takes="p", bars=("G2", "G3"), check=check_dwell),
    Code("M7", "Mist", partial(coolant, True), COOLANT, Order.COOLANT),
    Code("M8", "Flood", partial(coolant, False), COOLANT, Order.COOLANT),
    Code("M9", "Coolant off", partial(coolant, None), COOLANT, Order.COOLANT),
    Code("M48", "Overrides on", partial(override, True, True, True), OVERRIDE, Order.OVERRIDE),
    Code("M49", "Overrides off", partial(override, True, True, False), OVERRIDE, Order.OVERRIDE),
    Code("M50", "Feed override", partial(by_p, True), OVERRIDE, Order.OVERRIDE, takes="p"),
    Code("M51", "Speed override", partial(by_p, False), OVERRIDE, Order.OVERRIDE, takes="p$"),
    Code("M52", "Adaptive feed", adaptive, OVERRIDE, Order.OVERRIDE, takes="p"),
    Code("M53", "Feed hold", hold, OVERRIDE, Order.OVERRIDE, takes="p"),
    stopping("M0", "Stop", partial(stop, "PROGRAM_STOP")),
    stopping("M1", "Optional stop", partial(stop, "OPTIONAL_PROGRAM_STOP")),
    stopping("M60", "Pallet shuttle and stop", shuttle),
    stopping("M2", "End of program", partial(end, False)),
    stopping("M30", "End of program, pallet shuttle", partial(end, True)),
)  # fmt: skip

ITEMS = (Code("F", "Feed", feed_word, Group(0), Order.FEED),)
