"""Programs in the virtual world: inputs, operators, probing, and the documents' own macros."""

from math import sqrt
from pathlib import Path

import msgspec
import pytest

import aircut
from aircut.controller import Simulation, World
from aircut.controller.world import Body, File, Input, Reply
from aircut.interpreter.interpreter import Interpreter
from aircut.machine import Tool, built_in

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
BOX = Body("box", at=(0.0, 0.0, -10.0), size=(20.0, 20.0, 10.0))


def run(text: str, world: File, macros: Path | None = None, **variables: float) -> tuple[Interpreter, Simulation]:
    made = built_in("XYZ")
    made.tools = {1: Tool(1, z=40.0), 9: Tool(9, z=50.0, diameter=4.0, type=4)}
    made.variables |= {int(name[1:]): value for name, value in variables.items()}
    if macros:
        made.macros = (macros,)
        made.options = msgspec.structs.replace(made.options, tool_change="macro")
    interpreter = aircut.loads(text).interpreter(made)
    simulation = Simulation(interpreter, World(world))
    for _ in simulation.run():
        pass
    return interpreter, simulation


def codes(interpreter: Interpreter) -> list[str]:
    return [d.code for d in interpreter.diagnostics if d.severity.value == "error"]


RISE = Input(1, times=[(3.0, 1.0)])  # low, high from the third second
FALL = Input(1, value=1.0, times=[(3.0, 0.0)])
LOW, HIGH = Input(1), Input(1, value=1.0)


@pytest.mark.parametrize(
    ("one", "words", "failed", "time"),
    [
        (LOW, "L0", 0, 0.0),
        (HIGH, "L1", 0, 0.0),
        (FALL, "L0", 0, 3.0),
        (RISE, "L1", 0, 3.0),
        (FALL, "L2", 0, 3.0),
        (RISE, "L3", 0, 3.0),
        (RISE, "L1 Q5", 0, 3.0),
        (RISE, "L1 Q2", 1, 2.0),
        (FALL, "L0 Q2.5", 1, 2.5),
        (LOW, "L2 Q1", 1, 1.0),  # low already is no fall
        (HIGH, "L3 Q1", 1, 1.0),
        (RISE, "L2 Q5", 1, 5.0),
        (HIGH, "L4", 0, 0.0),
        (RISE, "L13 Q5", 0, 3.0),
    ],
)
def test_waits(one: Input, words: str, failed: int, time: float) -> None:
    interpreter, simulation = run(f"M66 P1 {words}\n#500=#5722\nM2\n", File(inputs=[one]))
    assert not codes(interpreter)
    assert interpreter.state.numbered[500] == failed
    assert simulation.time == pytest.approx(time)


@pytest.mark.parametrize(("one", "mode"), [(HIGH, 10), (LOW, 11), (RISE, 12), (FALL, 13)])
def test_time_outs_with_alarm(one: Input, mode: int) -> None:
    interpreter, _ = run(f"M66 P1 L{mode} Q5\n#500=1\nM2\n", File(inputs=[one]))
    assert codes(interpreter) == ["input-timeout"]
    assert interpreter.state.numbered[500] is None


@pytest.mark.parametrize(("percent", "failed"), [(49.99, 1), (50.0, 0), (100.0, 0)])
def test_analog_threshold(percent: float, failed: int) -> None:
    world = File(inputs=[Input(2, analog=True, value=percent)])
    text = "M67 P2 L4\n#501=#5720\nM67 P2 L1 Q1\n#500=#5722\nM2\n"
    values = run(text, world)[0].state.numbered
    assert values[500:502] == [failed, percent]


def test_input_groups() -> None:
    world = File(inputs=[Input(1, value=1.0), Input(21, value=1.0), Input(8, analog=True, value=7.5)])
    text = (
        "M166 P1\n#500=#5740 #501=#5759\nM166 P2\n#502=#5740 #503=#5751 #504=#5752\nM167 P1\n#505=#5747 #506=#5748\nM2"
    )
    values = run(text, world)[0].state.numbered
    assert values[500:507] == [1.0, 0.0, 1.0, 0.0, None, 7.5, None]  # 32 inputs, 8 analog ones


def test_operator() -> None:
    world = File(operator=[Reply(values=[1.5]), Reply(values=[1.0, None, 3.0]), Reply(stop=True)])
    text = 'M109 P"a" Q3 D9\n#500=#5721\nM109 P"b" Q100 R3\n#501=#5730 #502=#5731 #503=#5732\nM109 P"c" Q2\n#504=1\nM2'
    interpreter, simulation = run(text, world)
    assert interpreter.state.numbered[500:505] == [1.5, 1.0, None, 3.0, None]
    assert codes(interpreter) == ["operator-stop"]
    assert [ask.text for ask in simulation.shown] == ["a", "b", "c"]


SAVE = "#500=#5700 #501=#5711 #502=#5712 #503=#5713\nM2\n"


@pytest.mark.parametrize("compensation", ["G43\nG0", "G49\nG0 Z50\nG10 L2 P1 Z50\nG0"])
def test_ball_and_length(compensation: str) -> None:
    """The machine's trip is the same with and without G43: top 0, length 50."""
    values = run(f"T9 M6\n{compensation} X10 Y10 Z5\nF100\nG38.2 Z-5\n{SAVE}", File(bodies=[BOX]))[0].state.numbered
    assert values[500:504] == [1.0, 10.0, 10.0, pytest.approx(50.0, abs=1e-6)]


def test_edge_cylinder_and_sphere() -> None:
    """Ball of 2: beside a cylinder of 10 by 6 off its axis, 12² - 6²; a sphere's top 10 + 2 - 2."""
    cylinder = Body("cylinder", at=(0.0, 0.0, -10.0), radius=10.0, height=20.0)
    text = f"T9 M6 G43\nF100\nG0 X-40 Y6 Z0\nG38.2 X0\n{SAVE}"
    assert run(text, File(bodies=[cylinder]))[0].state.numbered[501] == pytest.approx(-sqrt(108.0), abs=1e-6)
    sphere = Body("sphere", radius=10.0)
    text = f"T9 M6 G43\nF100\nG0 Z40\nG38.2 Z0\n{SAVE}"
    assert run(text, File(bodies=[sphere]))[0].state.numbered[503] == pytest.approx(60.0, abs=1e-6)


def test_overshoot() -> None:
    text = f"T9 M6 G43\nF100\nG0 X10 Y10 Z5\nG38.3 Z-5\n{SAVE}"
    values = run(text, File(bodies=[BOX], overshoot=0.25))[0].state.numbered
    assert values[503] == pytest.approx(49.75, abs=1e-6)


@pytest.mark.parametrize(
    ("start", "probe", "state"),
    [
        (5, "G38.3 Z1", -1),
        (-2, "G38.3 Z-5", -2),
        (5, "G38.5 Z9", -2),
        (-5, "G38.5 Z-4", -1),
        (-2, "G38.5 Z5", 1),
    ],
)
def test_states(start: float, probe: str, state: int) -> None:
    text = f"T9 M6 G43\nF100\nG0 X10 Y10 Z{start}\n{probe}\n{SAVE}"
    interpreter, _ = run(text, File(bodies=[BOX]))
    assert not codes(interpreter) and interpreter.state.numbered[500] == state
    if state != 1:
        alarm = text.replace("G38.3", "G38.2").replace("G38.5", "G38.4")
        assert codes(run(alarm, File(bodies=[BOX]))[0]) == ["probe-failed"]
        assert interpreter.state.numbered[501] is None


PLACES = {
    "_6002": 1.0, "_6003": 1000.0, "_6010": 2.0, "_6011": -50.0, "_6012": -50.0, "_6013": 200.0, "_6021": 500.0,
    "_6022": 50.0, "_6023": 100.0, "_6024": 20.0, "_6031": 10.0, "_6032": 10.0, "_6033": 150.0, "_6035": 20.0,
}  # fmt: skip


@pytest.mark.skipif(not EXAMPLES.exists(), reason="needs the documents' examples")
@pytest.mark.parametrize("name", ["manual", "automatic", "length"])
def test_tool_change_macros(name: str, tmp_path: Path) -> None:
    (tmp_path / "tool_change.ngc").write_text((EXAMPLES / f"tool_change_{name}.ngc").read_text("utf-8"), "utf-8")
    sensor = Body("box", at=(0.0, 0.0, 0.0), size=(20.0, 20.0, 20.0))
    text = "F300\nG1 X5 Y6 Z80\nT1 M6\n#500=#5134 #501=#5422 #502=#5130 #503=#5101 #504=#5139 #505=#5108\nM2\n"
    interpreter, _ = run(text, File(bodies=[sensor]), tmp_path, **PLACES)
    assert not codes(interpreter)
    values = interpreter.state.numbered
    assert values[500:506] == [1.0, pytest.approx(40.0, abs=1e-6), 300.0, 1.0, 0.0, 43.1 if name == "length" else 43.0]


@pytest.mark.skipif(not EXAMPLES.exists(), reason="needs the documents' examples")
def test_update_piece_position(tmp_path: Path) -> None:
    """The tool of 40 on a sensor of 20 that stands on the piece at 35: the axis trips at 95, G52 Z is 35."""
    name = "update_piece_position.ngc"
    (tmp_path / name).write_text((EXAMPLES / name).read_text("utf-8"), "utf-8")
    sensor = Body("box", at=(-10.0, -10.0, 35.0), size=(20.0, 20.0, 20.0))
    text = f'M61 Q1\nG43\nF1000\nG0 X0 Y0 Z80\nG65 P"{name}"\n#500=#5203\nG1 X0 Y0 Z10\n#501=#5003 #502=#5130\nM2\n'
    interpreter, _ = run(text, File(bodies=[sensor]), tmp_path, **PLACES)
    assert not codes(interpreter)
    values = interpreter.state.numbered
    assert values[500:503] == [pytest.approx(35.0, abs=1e-6), pytest.approx(10.0), 1000.0]
