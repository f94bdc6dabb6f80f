"""The canonical commands: the machine's own verbs, each a row with the way it is written.

Names and layout are those that LinuxCNC's stand-alone interpreter prints. Motion
(STRAIGHT_TRAVERSE, STRAIGHT_FEED, ARC_FEED, STRAIGHT_PROBE) lives in the Toolpath;
all else is an event beside it. Offsets are in mm and degrees here and are
written in the program's units.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from aircut.geometry.kinematics import Setup


class Command(NamedTuple):
    """One canonical command that is not motion."""

    name: str
    form: str  # %-template of what stands between the parentheses
    meaning: str
    fields: tuple[str, ...] = ()  # names of its values
    listed: bool = True  # in the canonical listing; False: aircut's own, for other faces
    scale: Callable[[tuple[Any, ...], float], tuple[Any, ...]] | None = None  # values, mm per program unit
    bare: bool = False  # a line of its own without number and columns


SIX = ("x", "y", "z", "a", "b", "c")
SIX_FORM = ", ".join(["%.4f"] * 6)
NINE_FORM = "%.4f %.4f %.4f, %.4f %.4f %.4f, %.4f %.4f %.4f"


def lengths(*at: int) -> Callable[[tuple[Any, ...], float], tuple[Any, ...]]:
    """A scale that divides the values at these places (lengths) by the program's unit."""
    return lambda values, unit: tuple(v / unit if i in at else v for i, v in enumerate(values))


def command(name: str, form: str = "", meaning: str = "", fields: str = "", scale: Any = None) -> Command:
    return Command(name, form, meaning, tuple(fields.split()), True, scale)


def own(name: str, meaning: str, fields: str) -> Command:
    """A command of aircut's own: not in the listing."""
    return Command(name, "", meaning, tuple(fields.split()), False)


INCH = 25.4  # mm
SLOT_FORM = "%d, %d, %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f, %.4f, %.4f, %d"


def in_inches(values: tuple[Any, ...], unit: float) -> tuple[Any, ...]:
    """A tool table entry in the units of an inch machine, whatever the program's."""
    return tuple(v / INCH if i in (2, 3, 4, 8, 9, 10) else v for i, v in enumerate(values))


COMMANDS = {
    row.name: row
    for row in (
        command("USE_LENGTH_UNITS", "CANON_UNITS_%s", "lengths that follow are in MM or INCHES", "units"),
        command(
            "SET_G5X_OFFSET",
            "%d, " + SIX_FORM,
            "work coordinate system and its origin",
            "system x y z a b c",
            lengths(1, 2, 3),
        ),
        command("SET_G92_OFFSET", SIX_FORM, "offsets of G92 and G52 together", "x y z a b c", lengths(0, 1, 2)),
        command("SET_XY_ROTATION", "%.4f", "rotation of the XY plane, degrees", "angle"),
        command("SET_FEED_REFERENCE", "CANON_%s", "what the feed refers to", "reference"),
        command("SET_FEED_MODE", "%d, %d", "0: per minute, 1: per revolution", "spindle mode"),
        command("SET_FEED_RATE", "%.4f", "program units a minute", "feed", lengths(0)),
        command("SELECT_PLANE", "CANON_PLANE_%s", "plane of arcs: XY, XZ, YZ", "plane"),
        command("SET_MOTION_CONTROL_MODE", "CANON_%s", "EXACT_PATH or EXACT_STOP", "mode"),
        command(
            "SET_MOTION_CONTROL_BLEND",
            "CANON_CONTINUOUS, %f",
            "continuous path; blend tolerance",
            "tolerance",
            lengths(0),
        ),
        command(
            "SET_NAIVECAM_TOLERANCE",
            "%.4f",
            "points nearer than this to their chord may go",
            "tolerance",
            lengths(0),
        ),
        command("DWELL", "%.4f", "seconds", "seconds"),
        command("SET_SPINDLE_SPEED", "%d, %.4f", "revolutions a minute", "spindle speed"),
        command("START_SPINDLE_CLOCKWISE", "%d", "", "spindle"),
        command("START_SPINDLE_COUNTERCLOCKWISE", "%d", "", "spindle"),
        command("STOP_SPINDLE_TURNING", "%d", "", "spindle"),
        command("SET_SPINDLE_MODE", "%d %.4f", "0: constant revolutions", "spindle mode"),
        command("SELECT_TOOL", "%d", "tool that the next change loads", "tool"),
        command("START_CHANGE"),
        command("CHANGE_TOOL", "%d", "tool change to this slot or tool", "tool"),
        command("CHANGE_TOOL_NUMBER", "%d", "declare the loaded tool", "tool"),
        command(
            "USE_TOOL_LENGTH_OFFSET",
            NINE_FORM,
            "tool length compensation",
            "x y z a b c u v w",
            lengths(0, 1, 2, 6, 7, 8),
        ),
        command("MIST_ON"),
        command("MIST_OFF"),
        command("FLOOD_ON"),
        command("FLOOD_OFF"),
        command("ENABLE_FEED_OVERRIDE"),
        command("DISABLE_FEED_OVERRIDE"),
        command("ENABLE_SPEED_OVERRIDE", "%d", "", "spindle"),
        command("DISABLE_SPEED_OVERRIDE", "%d", "", "spindle"),
        command("PROGRAM_STOP", "", "wait for the operator"),
        command("OPTIONAL_PROGRAM_STOP", "", "wait for the operator if optional stop is on"),
        command("PROGRAM_RESTART", "", "start over from the first line (M47)"),
        command("PALLET_SHUTTLE"),
        command("PROGRAM_END"),
        command("FINISH"),
        command("ON_RESET"),
        command("COMMENT", '"%s"', "a comment of the program or of the interpreter", "text"),
        command(
            "MESSAGE",
            '"%s"',
            "a message to the operator; kind is the Q word, medium text or media",
            "text kind medium",
            lambda values, unit: values[:1],
        ),
        command("TURN_PROBE_ON"),
        command("TURN_PROBE_OFF"),
        command(
            "SET_TOOL_TABLE_ENTRY",
            "%d, %d, %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f, %.4f, %.4f, %d",
            "tool table entry: slot, tool, offsets, angles, orientation",
            "slot tool x y z a b c u v w front back orientation",
            lengths(2, 3, 4),
        ),
        command("SET_MOTION_OUTPUT_BIT", "%d", "output on", "output"),
        command("CLEAR_MOTION_OUTPUT_BIT", "%d", "output off", "output"),
        command("SET_AUX_OUTPUT_VALUE", "%d,%f", "analog output, percent", "output value"),
        command("NURBS_FEED", "%d, ...", "a spline of this many control points; its moves follow", "points"),
        command("RIGID_TAP", "%.4f, %.4f, %.4f", "tap to this point and back", "x y z", lengths(0, 1, 2)),
        command(
            "START_SPEED_FEED_SYNC",
            "%f,%d",
            "feed follows the spindle: length a revolution",
            "pitch velocity spindle",
            lambda v, unit: (v[0] / unit, v[1]),
        ),
        command("STOP_SPEED_FEED_SYNCH"),
        command("ORIENT_SPINDLE", "%d, %.4f, %d", "turn the spindle to degrees", "spindle angle mode"),
        command("WAIT_ORIENT_COMPLETE", "%.4f", "wait for it, seconds", "spindle seconds", lambda v, unit: v[1:]),
        command("RELOAD_TOOLDATA"),
        command(
            "STORE_TOOL",
            SLOT_FORM,
            "as SET_TOOL_TABLE_ENTRY, told in inches",
            "slot tool x y z a b c u v w front back orientation",
            in_inches,
        ),
        command("ENABLE_ADAPTIVE_FEED"),
        command("DISABLE_ADAPTIVE_FEED"),
        command("ENABLE_FEED_HOLD"),
        command("DISABLE_FEED_HOLD"),
        command("SET_AUX_OUTPUT_BIT", "%d", "output on, not waiting for the motion", "output"),
        command("CLEAR_AUX_OUTPUT_BIT", "%d", "output off, not waiting for the motion", "output"),
        command("SET_MOTION_OUTPUT_VALUE", "%d,%f", "analog output with the motion", "output value"),
        command("LOG", '"%s"', "a line for the log file", "text"),
        command("LOGOPEN", '"%s"', "open a log file anew", "name"),
        command("LOGAPPEND", '"%s"', "open a log file to add to it", "name"),
        command("LOGCLOSE"),
        Command("PRINT", "%s", "a line for the operator's console", ("text",), bare=True),
        own("WAIT_INPUT", "wait for an input (M66, M67): L word, seconds (-1: without limit)", "input mode timeout"),
        own("PLC_CALL", "G100 and its arguments", "arguments"),
        own("INTERPOLATED_AXES", "G101: axes by bits", "mask"),
        own("HOME_AXES", "G102: axes by bits", "mask"),
        own("SET_TRAVERSE_RATE", "G103: highest rapid, mm/min; 0 none", "rate"),
        own("SET_DYNAMICS", "G104: mm/s², mm/s², percent; 0 the axes' own", "acceleration deceleration jerk"),
        own("TORCH_HEIGHT_CONTROL", "M17 1, M18 0", "on"),
        own(
            "TOOL_CENTER_POINT",
            "kinematics in force (geometry.kinematics.Setup), mm; model 0: none",
            " ".join(Setup._fields),
        ),
        own("AUXILIARY_AXES", "machine coordinates U, V and W at the end of the moves from here on, mm", "u v w"),
        own("AUXILIARY_OFFSETS", "of the next SET_G5X_OFFSET or SET_G92_OFFSET, mm", "u v w"),
        own("TOOL_CHANGE_MACRO", "M107 1, M108 0", "running"),
    )
}

#: Written under another name than their own, because two forms share one verb or it tells the spindle.
WRITTEN = {
    "SET_MOTION_CONTROL_BLEND": "SET_MOTION_CONTROL_MODE",
    "WAIT_ORIENT_COMPLETE": "SPINDLE.{}.WAIT_ORIENT_COMPLETE",
    "STORE_TOOL": "SET_TOOL_TABLE_ENTRY",
}

#: Commands that set something, by what they set: the last one of each is in force.
SETS = {
    name: what
    for what, names in {
        "units": "USE_LENGTH_UNITS",
        "work system": "SET_G5X_OFFSET",
        "shift": "SET_G92_OFFSET",
        "rotation": "SET_XY_ROTATION",
        "feed reference": "SET_FEED_REFERENCE",
        "feed mode": "SET_FEED_MODE",
        "feed": "SET_FEED_RATE",
        "plane": "SELECT_PLANE",
        "path": "SET_MOTION_CONTROL_MODE SET_MOTION_CONTROL_BLEND",
        "thinning": "SET_NAIVECAM_TOLERANCE",
        "spindle speed": "SET_SPINDLE_SPEED",
        "spindle": "START_SPINDLE_CLOCKWISE START_SPINDLE_COUNTERCLOCKWISE STOP_SPINDLE_TURNING",
        "spindle mode": "SET_SPINDLE_MODE",
        "tool length": "USE_TOOL_LENGTH_OFFSET",
        "tool center point": "TOOL_CENTER_POINT",
        "mist": "MIST_ON MIST_OFF",
        "flood": "FLOOD_ON FLOOD_OFF",
        "feed override": "ENABLE_FEED_OVERRIDE DISABLE_FEED_OVERRIDE",
        "speed override": "ENABLE_SPEED_OVERRIDE DISABLE_SPEED_OVERRIDE",
        "auxiliary axes": "AUXILIARY_AXES",
        "interpolated axes": "INTERPOLATED_AXES",
        "traverse rate": "SET_TRAVERSE_RATE",
        "dynamics": "SET_DYNAMICS",
        "torch": "TORCH_HEIGHT_CONTROL",
        "tool change": "TOOL_CHANGE_MACRO",
        "output": "SET_MOTION_OUTPUT_BIT CLEAR_MOTION_OUTPUT_BIT",
        "analog output": "SET_AUX_OUTPUT_VALUE",
    }.items()
    for name in names.split()
}
#: Of these there are many, told apart by their first value.
MANY = ("output", "analog output", "spindle speed", "spindle", "spindle mode", "speed override")
