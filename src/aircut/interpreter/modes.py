"""Codes that set a mode: plane, units, distance, feed, path, overrides; and the F, S and T words.

Sources: 000 sections 1.1 to 1.3; decisions AMB-COD-14, AMB-FEED-2, AMB-FEED-8, AMB-MODE-1, AMB-VAR-10.
"""

from __future__ import annotations

from functools import partial

from aircut.canon import EXACT_PATH, EXACT_STOP
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.state import INCH, PLANES, State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words

FASTEST = 1e9  # program units a minute


def comment(m: State, text: str) -> None:
    m.out.event("COMMENT", f"interpreter: {text}")


def feed_mode(inverse_time: bool, m: State, w: Words) -> None:
    """G93, G94: how F is meant. G94 sets the feed to zero; so does a change to G93."""
    comment(m, f"feed mode set to {'inverse time' if inverse_time else 'units per minute'}")
    m.out.event("SET_FEED_MODE", 0, 0)
    if not inverse_time:
        m.out.event("SET_FEED_RATE", 0.0)
    m.inverse_time = inverse_time
    m.feed = m.feed_told = 0.0


def feed_word(m: State, w: Words) -> None:
    """F: program units a minute; under G93 the moves a minute."""
    value = w["f"]
    if value < 0.0:
        raise out_of_range(w, "f", "feed rates are not negative")
    if value > FASTEST:
        raise out_of_range(w, "f", "no machine is that fast")
    if m.inverse_time:
        m.feed = value
        return
    m.feed = m.feed_told = value * m.unit
    m.out.event("SET_FEED_RATE", m.feed)


def speed_word(m: State, w: Words) -> None:
    """S: revolutions a minute."""
    speed = w["s"]
    if speed < 0.0:
        raise out_of_range(w, "s", "spindle speeds are not negative")
    limit = m.machine.spindle.max_speed
    if speed > limit:
        m.warn(F.SPINDLE_LIMIT, "s", speed=speed, limit=limit)
        speed = limit
    m.speed = speed
    m.out.event("SET_SPINDLE_SPEED", 0, speed)


def plane(number: int, m: State, w: Words) -> None:
    """G17, G18, G19."""
    if m.compensating and number != m.plane:
        raise Refusal(F.COMPENSATING, code=f"a change to the {PLANES[number]} plane")
    m.plane = number
    m.out.event("SELECT_PLANE", PLANES[number])


def units(unit: float, m: State, w: Words) -> None:
    """G20, G21: program units. Positions, offsets and feed keep their physical values."""
    m.unit = unit
    m.out.event("USE_LENGTH_UNITS", "INCHES" if unit == INCH else "MM")


def distance(absolute: bool, m: State, w: Words) -> None:
    """G90, G91."""
    if m.absolute != absolute:
        comment(m, f"distance mode changed to {'absolute' if absolute else 'incremental'}")
    m.absolute = absolute


def polar(on: bool, m: State, w: Words) -> None:
    """G15, G16: whether the plane's words are radius and angle."""
    m.polar = on


def arc_distance(absolute: bool, m: State, w: Words) -> None:
    """G90.1, G91.1."""
    if m.arc_absolute != absolute:
        comment(m, f"IJK distance mode changed to {'absolute' if absolute else 'incremental'}")
    m.arc_absolute = absolute


def retract(text: str, m: State, w: Words) -> None:
    """G98, G99: where canned cycles return to."""
    comment(m, f"retract mode set to {text}")


def exact_path(m: State, w: Words) -> None:
    """G61."""
    m.flags = EXACT_PATH
    m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_PATH")


def exact_stop(m: State, w: Words) -> None:
    """G61.1."""
    m.flags = EXACT_PATH | EXACT_STOP
    m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_STOP")


def continuous(m: State, w: Words) -> None:
    """G64 P Q: blend within P, drop points within Q; words left out keep their values."""
    for letter in "pq":
        if w.get(letter, 0.0) < 0.0:
            raise out_of_range(w, letter, "tolerances are not negative")
    m.flags = 0
    m.blend = w["p"] * m.unit if "p" in w else m.blend
    m.thinning = w["q"] * m.unit if "q" in w else m.thinning
    m.out.event("SET_MOTION_CONTROL_BLEND", m.blend)
    m.out.event("SET_NAIVECAM_TOLERANCE", m.thinning)


def overrides(on: bool, m: State, w: Words) -> None:
    """M48, M49: both overrides."""
    set_feed_override(m, int(on))
    set_speed_override(m, int(on))
    m.feed_override_code = m.speed_override_code = 48.0 if on else 49.0


def set_feed_override(m: State, mode: int) -> None:
    m.feed_override = mode
    m.out.event("ENABLE_FEED_OVERRIDE" if mode else "DISABLE_FEED_OVERRIDE")


def set_speed_override(m: State, mode: int) -> None:
    m.speed_override = mode
    m.out.event("ENABLE_SPEED_OVERRIDE" if mode else "DISABLE_SPEED_OVERRIDE", 0)


def feed_override(m: State, w: Words) -> None:
    """M50 P: 0 off (as without P), 1 on, 2 and 3 custom (AMB-IO-7)."""
    mode = whole(w, "p") if "p" in w else 0
    if not 0 <= mode <= 3:
        raise out_of_range(w, "p", "0, 1, 2 or 3")
    set_feed_override(m, mode)
    m.feed_override_code = 50.0


def speed_override(m: State, w: Words) -> None:
    """M51 P: 0 off, 1 on (as without P)."""
    mode = whole(w, "p") if "p" in w else 1
    if not 0 <= mode <= 1:
        raise out_of_range(w, "p", "0 or 1")
    set_speed_override(m, mode)
    m.speed_override_code = 51.0


def mode(name: str, title: str, run: object, group: Group, **more: object) -> Code:
    """A modal code whose place in the order has its group's name."""
    assert group.name
    return Code(name, title, run, group, Order[group.name], modal=True, **more)  # type: ignore[arg-type]


CODES = (
    mode("G15", "Cartesian coordinates", partial(polar, False), Group.POLAR),
    mode("G16", "Polar coordinates", partial(polar, True), Group.POLAR),
    mode("G17", "XY plane", partial(plane, 0), Group.PLANE),
    mode("G18", "XZ plane", partial(plane, 1), Group.PLANE),
    mode("G19", "YZ plane", partial(plane, 2), Group.PLANE),
    mode("G20", "Inches", partial(units, INCH), Group.UNITS),
    mode("G21", "Millimeters", partial(units, 1.0), Group.UNITS),
    mode("G61", "Exact path", exact_path, Group.PATH),
    mode("G61.1", "Exact stop", exact_stop, Group.PATH),
    mode("G64", "Continuous path", continuous, Group.PATH, takes="pq"),
    mode("G90", "Absolute distances", partial(distance, True), Group.DISTANCE),
    mode("G91", "Incremental distances", partial(distance, False), Group.DISTANCE),
    mode("G90.1", "Absolute arc centers", partial(arc_distance, True), Group.ARC_DISTANCE),
    mode("G91.1", "Arc centers from the start", partial(arc_distance, False), Group.ARC_DISTANCE),
    mode("G93", "Inverse time feed", partial(feed_mode, True), Group.FEED_MODE),
    mode("G94", "Feed per minute", partial(feed_mode, False), Group.FEED_MODE),
    mode("G98", "Cycles return to the initial level", partial(retract, "old_z"), Group.RETRACT),
    mode("G99", "Cycles return to R", partial(retract, "r_plane"), Group.RETRACT),
    Code("M48", "Overrides on", partial(overrides, True),
         Group.FEED_OVERRIDE | Group.SPEED_OVERRIDE, Order.OVERRIDE),
    Code("M49", "Overrides off", partial(overrides, False),
         Group.FEED_OVERRIDE | Group.SPEED_OVERRIDE, Order.OVERRIDE),
    Code("M50", "Feed override", feed_override, Group.FEED_OVERRIDE, Order.OVERRIDE, takes="p"),
    Code("M51", "Spindle override", speed_override, Group.SPEED_OVERRIDE, Order.OVERRIDE, takes="p"),
)  # fmt: skip

ITEMS = (
    Code("F", "Feed rate", feed_word, Group(0), Order.FEED, needs="f"),
    Code("S", "Spindle speed", speed_word, Group(0), Order.SPEED, needs="s"),
)
