"""The system variables #5000 to #5999: what the interpreter reports of itself.

A number that no row covers reads as null and cannot be written (AMB-VAR-6).
Sources: 000 and 004 section 2.1; decisions section 4.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES
from aircut.interpreter import rotary
from aircut.interpreter.state import WORK_SYSTEMS, State
from aircut.interpreter.table import Group, SystemVariable
from aircut.machine.tools import EMPTY

Read = Callable[[State, int], float | None]


def null(m: State, i: int) -> None:
    """Before the first event that fills it (AMB-VAR-16)."""
    return


def code(group: Group) -> Read:
    """The code of a modal group that is in force."""
    return lambda m, i: m.modal[group].number


def attribute(name: str) -> Read:
    """A number of the state."""
    return lambda m, i: None if getattr(m, name) is None else float(getattr(m, name))


def element(name: str, first: int = 0) -> Read:
    """One of a list of the state."""
    return lambda m, i: getattr(m, name)[first + i]


def set_element(name: str, first: int = 0) -> Callable[[State, int, float | None], None]:
    def write(m: State, i: int, value: float | None) -> None:
        if value is None:
            raise Refusal(F.NULL_VALUE, what="the value", operation="a stored position needs a number")
        getattr(m, name)[first + i] = value

    return write


def origin(system: int, first: int) -> Read:
    return lambda m, i: m.origins[system][first + i]


def slot(name: str) -> Read:
    """Slot of a tool of the state."""

    def read(m: State, i: int) -> float:
        return float(m.tools.get(getattr(m, name), EMPTY).slot)

    return read


def tool_data(*names: str) -> Read:
    """Data of the tool in the spindle; zeros for one that the library does not know."""

    def read(m: State, i: int) -> float:
        return float(getattr(m.tools.get(m.tool, EMPTY), names[i]))

    return read


def feed(m: State, i: int) -> float:
    return m.feed if m.inverse_time else m.feed / m.unit


def scaling(part: str, neutral: float) -> Read:
    """Factors or center of G51."""
    return lambda m, i: getattr(m.frame.scaling, part)[i] if m.frame and m.frame.scaling else neutral


def rotation_plane(m: State, i: int) -> float:
    """17, 18 or 19; 0 without G68, and under G68.2 (AMB-VAR-12)."""
    rotation = m.frame.rotation if m.frame else None
    return 0.0 if rotation is None or rotation.plane is None else 17.0 + rotation.plane


def rotation_angle(m: State, i: int) -> float:
    """Angle of G68, where it turns the XY, XZ or YZ plane."""
    rotation = m.frame.rotation if m.frame else None
    return rotation.angles[PLANE_AXES[i][2]] if rotation and rotation.plane == i else 0.0


def rotation_center(m: State, i: int) -> float:
    return m.frame.rotation.programmed[i] if m.frame and m.frame.rotation else 0.0


def axes(first: int, title: str, read: Callable[[int], Read], write: object = None) -> tuple[SystemVariable, ...]:
    """Six variables, one an axis: three lengths and three angles. read: the reader from an axis on."""
    writers = (write(0), write(3)) if callable(write) else (None, None)
    return (
        SystemVariable(first, first + 2, f"{title}, X Y Z", read(0), "length", writers[0]),
        SystemVariable(first + 3, first + 5, f"{title}, A B C", read(3), "", writers[1]),
    )


def one(number: int, title: str, read: Read, unit: str = "") -> SystemVariable:
    return SystemVariable(number, number, title, read, unit)


SYSTEM = (
    SystemVariable(5001, 5003, "Position in the work system, X Y Z", element("position"), "length"),
    SystemVariable(5004, 5006, "Position in the work system, A B C", rotary.position),
    *axes(5081, "Position at the restart", lambda axis: element("restarted", axis)),
    *axes(5091, "Position of the last stop, machine coordinates", lambda axis: element("stopped", axis)),
    one(5100, "Line being run", attribute("line")),
    one(5101, "Motion mode", code(Group.MOTION)),
    one(5102, "Plane", code(Group.PLANE)),
    one(5103, "Distance mode", code(Group.DISTANCE)),
    one(5104, "Arc distance mode", code(Group.ARC_DISTANCE)),
    one(5105, "Feed mode", code(Group.FEED_MODE)),
    one(5106, "Units", code(Group.UNITS)),
    one(5107, "Cutter compensation", code(Group.CUTTER)),
    one(5108, "Tool length compensation", code(Group.TOOL_LENGTH)),
    one(5110, "Return mode of cycles", code(Group.RETRACT)),
    one(5111, "Scaling", code(Group.SCALING)),
    one(5112, "Work system", code(Group.SYSTEM)),
    one(5113, "Path mode", code(Group.PATH)),
    one(5116, "Rotation", code(Group.ROTATION)),
    one(5117, "Polar coordinates", code(Group.POLAR)),
    one(5120, "Interpolated axes by bits (G101)", attribute("interpolated")),
    one(5127, "Jerk, percent (G104 J)", attribute("jerk")),
    one(5128, "Acceleration along the path (G104 A)", attribute("acceleration"), "length"),
    one(5129, "Deceleration along the path (G104 D)", attribute("deceleration"), "length"),
    one(5130, "Feed rate F, program units", feed),
    one(5131, "Spindle speed S", attribute("speed")),
    one(5132, "Selected tool", attribute("selected_tool")),
    one(5133, "Slot of the selected tool", slot("selected_tool")),
    one(5134, "Tool in the spindle", attribute("tool")),
    one(5135, "Slot of the tool in the spindle", slot("tool")),
    one(5136, "Feed override mode (M50 P)", attribute("feed_override")),
    one(5137, "Spindle override mode (M51 P)", attribute("speed_override")),
    one(5138, "Traverse rate (G103)", attribute("traverse_rate"), "length"),
    one(5139, "1 while the tool change macro runs (M107)", attribute("changing")),
    one(5140, "Blend tolerance (G64 P)", attribute("blend"), "length"),
    one(5141, "Point removal (G64 Q)", attribute("thinning"), "length"),
    one(5148, "Calls of the modal macro so far", attribute("macro_count")),
    one(5149, "1 in a subroutine", lambda m, i: float(m.calls > 0)),
    one(5150, "Last stop code", attribute("stop_code")),
    one(5151, "Spindle code", attribute("spindle")),
    one(5152, "Last tool change code", attribute("tool_code")),
    one(5153, "Mist: 7 or 9", lambda m, i: 7.0 if m.mist else 9.0),
    one(5154, "Flood: 8 or 9", lambda m, i: 8.0 if m.flood else 9.0),
    one(5155, "Last feed override code", attribute("feed_override_code")),
    one(5156, "Last spindle override code", attribute("speed_override_code")),
    *axes(5161, "G28 position", lambda axis: element("home", axis), lambda axis: set_element("home", axis)),
    *axes(5181, "G30 position", lambda axis: element("second_home", axis),
          lambda axis: set_element("second_home", axis)),
    *axes(5201, "G52 shift", lambda axis: element("local", axis)),
    one(5210, "1 when the G92 shift is on", lambda m, i: float(m.shifted)),
    *axes(5211, "G92 shift", lambda axis: element("shift", axis)),
    one(5220, "Number of the work system", lambda m, i: float(m.system + 1)),
    *(
        row
        for system in range(WORK_SYSTEMS)
        for row in axes(5221 + 20 * system, f"Origin of work system {system + 1}", partial(origin, system))
    ),
    one(5400, "Tool in the spindle", attribute("tool")),
    SystemVariable(5401, 5403, "Offsets X Y Z of the tool in the spindle", tool_data("x", "y", "z"), "length"),
    one(5410, "Diameter of the tool in the spindle", tool_data("diameter"), "length"),
    one(5411, "Type of the tool in the spindle", tool_data("type")),
    SystemVariable(5412, 5414, "Parameters 1 to 3 of the tool in the spindle", tool_data("p1", "p2", "p3")),
    *axes(5420, "Tool offset in force", lambda axis: element("tool_offset", axis)),
    one(5426, "Tool whose offset is in force", lambda m, i: float(m.compensated_tool.id)),
    one(5427, "Type of that tool", lambda m, i: float(m.compensated_tool.type)),
    SystemVariable(5501, 5503, "Scaling factors X Y Z (G51)", scaling("factors", 1.0)),
    SystemVariable(5504, 5506, "Scaling center X Y Z, as programmed", scaling("programmed", 0.0), "length"),
    one(5510, "Plane that G68 turns: 17, 18, 19; 0 without", rotation_plane),
    SystemVariable(5511, 5513, "Angle of G68 in the XY, XZ, YZ plane", rotation_angle),
    SystemVariable(5514, 5516, "Center of G68 or G68.2 X Y Z, as programmed", rotation_center, "length"),
    one(5700, "State of the last probing: 1, -1, -2; null: only compiled", attribute("probe_state")),
    *axes(5701, "Probed position, work system, without tool offset", lambda axis: element("probed", axis)),
    *axes(5711, "Probed position, machine coordinates", lambda axis: element("probed_machine", axis)),
    one(5720, "Input read by M66 or M67", attribute("input_value")),
    one(5721, "Value entered in M109 or M120 Q3", attribute("answer")),
    one(5722, "Last wait: 0 succeeded, 1 failed", attribute("waited")),
    SystemVariable(5730, 5739, "Values entered in M109 or M120 Q100 and above", element("entered")),
    SystemVariable(5740, 5759, "Inputs read by M166 or M167", element("input_group")),
    one(5800, "Motion between calls of the modal macro: 0 G0, 1 G1", attribute("macro_motion")),
    one(5801, "Modulus of rotary axes, degrees", attribute("rotary_modulus")),
    SystemVariable(5802, 5804, "Rotary modes of A, B, C", element("rotary_modes")),
)  # fmt: skip
