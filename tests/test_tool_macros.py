"""The documents' tool change macros on the simulated machine (000 sections 3.5 and 11.1)."""

from pathlib import Path
from typing import NamedTuple

import msgspec
import pytest

import aircut
from aircut.canon import ROW
from aircut.controller import Simulation, World
from aircut.controller.world import Body, File, Reply, TrueTool
from aircut.interpreter.running import Run
from aircut.machine import Tool, built_in

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
pytestmark = pytest.mark.skipif(not EXAMPLES.exists(), reason="needs the documents' examples")

#: The table is wrong about every length.
TOOLS = [Tool(1, z=40.0, slot=3), Tool(2, z=60.0, slot=1), Tool(3, z=10.0)]
TRUE = [TrueTool(1, length=41.25), TrueTool(2, length=58.125), TrueTool(3, length=12.5)]
SENSOR = Body("cylinder", at=(10.0, 10.0, 0.0), radius=5.0, height=20.0)
PLACES = {
    6002: 1.0, 6003: 1000.0, 6010: 2.0, 6011: -50.0, 6012: -60.0, 6013: 200.0, 6021: 500.0,
    6022: 50.0, 6023: 100.0, 6024: 20.0, 6031: 10.0, 6032: 10.0, 6033: 150.0,
}  # fmt: skip


class Log(NamedTuple):
    run: Run
    simulation: Simulation
    moves: list[tuple[float, ...]]  # machine coordinates without the tool, and the feed
    events: list[tuple[str, tuple[object, ...]]]

    def told(self, *names: str) -> list[tuple[object, ...]]:
        return [(name, *values) for name, values in self.events if name in names]

    @property
    def codes(self) -> list[str]:
        return [d.code for d in self.run.diagnostics]


def change(macro: str, text: str, tmp_path: Path, *replies: Reply, **places: float | None) -> Log:
    """A program on a machine whose M6 runs one of the macros (a name, or the text of one)."""
    name = EXAMPLES / f"tool_change_{macro}.ngc"
    (tmp_path / "tool_change.ngc").write_text(name.read_text("utf-8") if "\n" not in macro else macro, "utf-8")
    made = built_in("XYZ")
    made.tools = {tool.id: tool for tool in TOOLS}
    made.variables |= PLACES
    for key, value in places.items():
        if value is None:
            del made.variables[int(key[1:])]
        else:
            made.variables[int(key[1:])] = value
    made.macros = (tmp_path,)
    made.options = msgspec.structs.replace(made.options, tool_change="macro")
    run = aircut.loads(text).interpreter(made)
    simulation = Simulation(run, World(File(bodies=[SENSOR], tools=TRUE, operator=list(replies))))
    moves, events = [], []
    for chunk in simulation.run():
        moves += [(*row[:3], row[8]) for row in ROW.iter_unpack(chunk.rows)]
        events += [(event.name, event.values) for event in chunk.events]
    return Log(run, simulation, moves, events)


def near(*values: float) -> list[object]:
    return [pytest.approx(value, abs=1e-6) for value in values]


SAVE = "#500=#5134 #501=#5422 #502=#5108 #503=#5130 #504=#5101 #505=#5001 #506=#5002 #507=#5003 #508=#5151\nM102\n"


@pytest.mark.parametrize("tool", [1, 2, 3])
def test_the_measured_length_is_the_true_one(tool: int, tmp_path: Path) -> None:
    told = change("length", f"F300\nG1 X5 Y6 Z80\nT{tool} M6\n{SAVE}", tmp_path)
    assert not told.codes
    length = TRUE[tool - 1].length
    assert told.run.state.numbered[500:508] == near(tool, length, 43.1, 300.0, 1.0, 5.0, 6.0, 80.0)


@pytest.mark.parametrize(("mode", "length", "code"), [(0, 0.0, 49.0), (1, 40.0, 43.0), (2, 41.25, 43.1)])
def test_6010(mode: int, length: float, code: float, tmp_path: Path) -> None:
    """0 changes only, 1 takes the table's length, 2 measures."""
    told = change("length", f"F300\nG0 X5 Y6 Z80\nT1 M6\n{SAVE}", tmp_path, _6010=mode)
    assert not told.codes
    assert told.run.state.numbered[500:503] == near(1.0, length, code)
    assert len(told.told("TURN_PROBE_ON")) == (2 if mode == 2 else 0)


@pytest.mark.parametrize("macro", ["manual", "automatic", "length"])
def test_the_loaded_tool_is_not_changed_again(macro: str, tmp_path: Path) -> None:
    told = change(macro, f"F300\nM61 Q2\nT2 M6\n{SAVE}", tmp_path)
    assert not [code for code in told.codes if code != "tool-not-declared"]
    assert not told.moves and not told.simulation.shown
    assert told.run.state.numbered[500:503] == near(2.0, 0.0, 49.0)


def test_6002_at_0_measures_the_loaded_tool_again(tmp_path: Path) -> None:
    told = change("length", f"F300\nM61 Q2\nT2 M6\n{SAVE}", tmp_path, _6002=0.0)
    assert told.run.state.numbered[500:503] == near(2.0, 58.125, 43.1)
    assert not told.simulation.shown  # nothing is to be inserted


@pytest.mark.parametrize(("macro", "text"), [("manual", "Insert tool T3"), ("length", "Insert tool T3 and press OK")])
def test_the_operator_is_asked_for_the_tool(macro: str, text: str, tmp_path: Path) -> None:
    told = change(macro, f"F300\nT3 M6\n{SAVE}", tmp_path)
    assert [(w.text, w.buttons) for w in told.simulation.shown] == [(text, ("Stop", "Resume"))]
    stopped = change(macro, f"F300\nT3 M6\n{SAVE}", tmp_path, Reply(stop=True))
    assert stopped.codes == ["operator-stop"]
    assert stopped.run.state.tool == 0


def test_slots_and_outputs_of_the_automatic_change(tmp_path: Path) -> None:
    """#4 is the slot of tool 2 (1), #2 that of tool 1 (3): X-10 at Y0, then at Y20. Output 1 drops and locks."""
    told = change("automatic", f"F300\nM61 Q2\nG0 X5 Y6 Z80\nT1 M6\n{SAVE}", tmp_path)
    assert not told.codes
    assert told.told("SET_MOTION_OUTPUT_BIT", "CLEAR_MOTION_OUTPUT_BIT", "CHANGE_TOOL_NUMBER") == [
        ("CHANGE_TOOL_NUMBER", 2), ("SET_MOTION_OUTPUT_BIT", 1), ("CHANGE_TOOL_NUMBER", 0),
        ("CLEAR_MOTION_OUTPUT_BIT", 1), ("CHANGE_TOOL_NUMBER", 1),
    ]  # fmt: skip
    assert told.simulation.outputs == {(1, False): 0.0}
    places = [move[:3] for move in told.moves]
    dropped, loaded = places.index((-10.0, 0.0, 200.0)), places.index((-10.0, 20.0, 200.0))
    assert dropped < loaded
    assert told.run.state.numbered[500:503] == near(1.0, 40.0, 43.0)


@pytest.mark.parametrize("macro", ["manual", "automatic", "length"])
@pytest.mark.parametrize(
    ("before", "events"),
    [
        ("S900 M3 M7", ["START_SPINDLE_CLOCKWISE", "MIST_ON"]),
        ("S900 M4 M8", ["START_SPINDLE_COUNTERCLOCKWISE", "FLOOD_ON"]),
        ("M5 M9", []),
    ],
)
def test_spindle_and_coolant_come_back(macro: str, before: str, events: list[str], tmp_path: Path) -> None:
    told = change(macro, f"F300\n{before}\nM0\nT1 M6\n{SAVE}", tmp_path)
    names = [name for name, _ in told.events]
    behind = names[names.index("PROGRAM_STOP") :]
    of_interest = [name for name in behind if name.startswith(("START_SPINDLE", "MIST_ON", "FLOOD_ON"))]
    assert of_interest == events
    assert "STOP_SPINDLE_TURNING" in behind
    if events:
        assert behind.index("STOP_SPINDLE_TURNING") < behind.index(events[0])


@pytest.mark.parametrize("number", [6002, 6003, 6010, 6011, 6012, 6013, 6021, 6022, 6023, 6024, 6031, 6032, 6033])
def test_a_missing_parameter_stops(number: int, tmp_path: Path) -> None:
    """The first line asks #6002 GE 1: of null that is false (000 section 2.4), so the check that follows tells it."""
    told = change("length", f"F300\nT1 M6\n{SAVE}", tmp_path, **{f"_{number}": None})
    assert [w.text for w in told.simulation.shown] == ["One or more compulsory system parameters are not specified."]
    assert told.simulation.shown[0].buttons == ("Stop",)
    assert told.codes == ["operator-stop"] and not told.moves
    assert told.run.state.numbered[500] is None


def test_a_macro_that_declares_nothing(tmp_path: Path) -> None:
    told = change("G0 Z1\nM99\n", f"T1 M6\nM61 Q2\nT3 M6\n{SAVE}", tmp_path)
    assert told.codes == ["tool-not-declared", "tool-not-declared"]
    assert [d.span.line for d in told.run.diagnostics] == [1, 3]
    assert told.run.state.numbered[500] == 2.0
    for declared in ("M61 Q#1", "M106"):
        assert not change(f"{declared}\nM99\n", f"T1 M6\n{SAVE}", tmp_path).codes


def test_m106_and_m61(tmp_path: Path) -> None:
    """M106 is the controller's own change of the selected tool; M61 only says which one is there now."""
    told = change("M106\nM99\n", f"T1 M6\n#510=#5152\n{SAVE}", tmp_path)
    assert told.told("CHANGE_TOOL", "CHANGE_TOOL_NUMBER") == [("CHANGE_TOOL", 1)]
    assert told.run.state.numbered[500] == 1.0 and told.run.state.numbered[510] == 106.0
    told = change("M61 Q[#1 + 1]\nM99\n", f"T1 M6\n{SAVE}", tmp_path)
    assert told.told("CHANGE_TOOL", "CHANGE_TOOL_NUMBER") == [("CHANGE_TOOL_NUMBER", 2)]
    assert told.run.state.numbered[500] == 2.0


def test_arguments_of_the_macro(tmp_path: Path) -> None:
    text = f"M61 Q2\n#1=77\nT1 M6\n#509=#1\nT3 M6\n{SAVE}"
    macro = (
        "IF [#1 EQ 1] THEN #510=#1 #511=#2 #512=#3 #513=#4 #514=#5132 #515=#5133 #516=#5134 #517=#5135\n"
        "IF [#1 EQ 3] THEN #520=#1 #521=#2 #522=#3 #523=#4\n"
        "#524=#5\n#525=EXISTS[#<_args.a>]\nM61 Q#1\nM99\n"
    )
    told = change(macro, text, tmp_path)
    assert not told.codes
    values = told.run.state.numbered
    assert values[510:518] == [1.0, 3.0, 2.0, 1.0] * 2
    assert values[520:526] == [3.0, 0.0, 1.0, 3.0, None, 0.0]  # tool 3 has no slot
    assert values[509] == 77.0  # the caller's own


def test_the_change_comes_last_in_its_line(tmp_path: Path) -> None:
    """As a macro M6 runs behind the motion and behind M98's place; without, before the motion (000 section 1.7)."""
    macro = "#510=#5001\nM61 Q#1\nG0 Y1\nM99\n"
    told = change(macro, f"G0 X5 T1 M6\n#511=#5002\n{SAVE}", tmp_path)
    assert told.run.state.numbered[510:512] == [5.0, 1.0]
    text = f"G0 X5 T1 M6 M98 P7\n{SAVE}O7\n#512=#5134\n#513=#5001\nM99\n"
    told = change(macro, text, tmp_path)
    assert not told.codes
    assert told.run.state.numbered[510] == 5.0
    assert told.run.state.numbered[512:514] == [1.0, 5.0]


def test_a_missing_macro(tmp_path: Path) -> None:
    made = built_in("XYZ")
    made.macros = (tmp_path,)
    made.options = msgspec.structs.replace(made.options, tool_change="macro")
    told = aircut.loads("T1 M6\nM2\n").check(made)
    assert [d.code for d in told] == ["no-subroutine"] and "tool_change.ngc" in told[0].message


@pytest.mark.parametrize("height", [0.0, 12.5, 35.0])
@pytest.mark.parametrize("tool", [1, 2])
@pytest.mark.parametrize(("before", "motion"), [("G1", 1.0), ("G38.3 Z99", 80.0)])
def test_the_piece_lies_where_it_is_found(height: float, tool: int, before: str, motion: float, tmp_path: Path) -> None:
    """update_piece_position reckons with the table's length, so that must be the true one here."""
    name = "update_piece_position.ngc"
    (tmp_path / name).write_text((EXAMPLES / name).read_text("utf-8"), "utf-8")
    made = built_in("XYZ")
    made.tools = {1: Tool(1, z=41.25), 2: Tool(2, z=58.125)}
    made.variables |= PLACES | {6013: 250.0, 6023: 130.0, 6024: 30.0, 6035: 20.0}
    made.macros = (tmp_path,)
    sensor = Body("cylinder", at=(0.0, 0.0, height), radius=10.0, height=20.0)
    text = (
        f'M61 Q{tool}\nG43\nF1000\nG0 X0 Y0 Z100\n{before}\nG65 P"{name}"\n'
        "#500=#5203\n#503=#5101\nG1 X0 Y0 Z10\n#501=#5003 #502=#5130\nM2\n"
    )
    run = aircut.loads(text).interpreter(made)
    for _ in Simulation(run, World(File(bodies=[sensor]))).run():
        pass
    assert not run.diagnostics
    assert run.state.numbered[500:503] == near(height, 10.0, 1000.0)
    assert run.state.numbered[503] == motion
