"""Programs against a virtual world."""

from pathlib import Path

import pytest

import aircut
from aircut.controller import Simulation, World, WorldError, load
from aircut.controller.world import Body, File, Input, Reply
from aircut.diagnostics import Diagnostic
from aircut.interpreter.state import State
from aircut.machine import Machine, Tool, built_in

PROBE = Tool(9, z=55.0, diameter=6.0, type=4)
BOX = Body("box", at=(100.0, 50.0, -40.0), size=(60.0, 30.0, 40.0))


def machine() -> Machine:
    made = built_in("XYZ")
    made.tools = {9: PROBE}
    return made


def simulate(text: str, world: File) -> tuple[State, list[Diagnostic], Simulation]:
    """The state after a run, its diagnostics, and the simulation."""
    interpreter = aircut.loads(text).interpreter(machine())
    simulation = Simulation(interpreter, World(world))
    for _ in simulation.run():
        pass
    return interpreter.state, interpreter.diagnostics, simulation


def values(text: str, world: File, *numbers: int) -> list[float | None]:
    state, diagnostics, _ = simulate(text, world)
    assert not diagnostics, diagnostics
    return [state.numbered[number] for number in numbers]


SAVE = "#500=#5700 #501=#5711 #502=#5712 #503=#5713 #504=#5701 #505=#5703 #506=#5003\nM2\n"


def test_probing_down_onto_a_box() -> None:
    """The ball's lowest point meets the top, Z 0: the axis stands at 0 + 55."""
    text = "T9 M6 G43\nF100\nG0 X120 Y60 Z20\nG10 L2 P1 Z3\nG38.2 Z-30\n" + SAVE
    state, machine_x, _, machine_z, _, program_z, tip = values(
        text, File(bodies=[BOX]), 500, 501, 502, 503, 504, 505, 506
    )
    assert (state, machine_x) == (1.0, 120.0)
    assert machine_z == pytest.approx(55.0, abs=1e-6)
    assert program_z == pytest.approx(52.0, abs=1e-6)  # 55 - 3: the tool's offset is not taken off
    assert tip == pytest.approx(-3.0, abs=1e-6)  # the tip at machine 0 reads 0 - 3


def test_probing_sideways_stops_a_radius_before() -> None:
    text = "T9 M6 G43\nF100\nG0 X80 Y60 Z-10\nG38.3 X130\n" + SAVE
    assert values(text, File(bodies=[BOX]), 500, 501) == [1.0, pytest.approx(97.0, abs=1e-6)]  # 100 - 3


def test_a_sphere() -> None:
    """Balls of 3 and 10 mm along X, 5 mm beside: 13² = 5² + 12²."""
    sphere = Body("sphere", at=(0.0, 0.0, 3.0), radius=10.0)
    text = "T9 M6 G43\nF100\nG0 X-50 Y5 Z0\nG38.3 X50\n" + SAVE
    assert values(text, File(bodies=[sphere]), 501) == [pytest.approx(-12.0, abs=1e-6)]


def test_what_can_go_wrong() -> None:
    miss = "T9 M6 G43\nF100\nG0 X120 Y60 Z20\nG38.3 Z10\n" + SAVE
    assert values(miss, File(bodies=[BOX]), 500) == [-1.0]
    inside = "T9 M6 G43\nF100\nG0 X120 Y60 Z-5\nG38.3 Z-10\n" + SAVE
    assert values(inside, File(bodies=[BOX]), 500) == [-2.0]
    away = "T9 M6 G43\nF100\nG0 X120 Y60 Z-5\nG38.5 Z10\n" + SAVE
    assert values(away, File(bodies=[BOX]), 500, 503) == [1.0, pytest.approx(55.0, abs=1e-6)]
    _, diagnostics, _ = simulate(miss.replace("G38.3", "G38.2"), File(bodies=[BOX]))
    assert [d.code for d in diagnostics] == ["probe-failed"]


@pytest.mark.parametrize(("corner", "x", "y"), [(1, 100, 50), (2, 100, 80), (3, 160, 50), (4, 160, 80)])
@pytest.mark.parametrize("radius", [1.0, 3.0])
def test_g390_finds_every_corner(corner: int, x: float, y: float, radius: float) -> None:
    start = (x + (8 if corner < 3 else -8), y + (8 if corner in (1, 3) else -8))
    text = f"T9 M6\nG43\nF1000\nG0 X{start[0]} Y{start[1]} Z15\nG390 V{corner} W2\n#500=#5241 #501=#5242 #502=#5243\n"
    made = machine()
    made.tools = {9: Tool(9, z=55.0, diameter=2 * radius, type=4)}
    interpreter = aircut.loads(text + "M2\n").interpreter(made)
    for _ in Simulation(interpreter, World(File(bodies=[BOX]))).run():
        pass
    assert not interpreter.diagnostics
    found = interpreter.state.numbered[500:503]
    assert found == [pytest.approx(x, abs=0.002), pytest.approx(y, abs=0.002), pytest.approx(0.0, abs=0.002)]


def test_g390_alarms_where_there_is_nothing() -> None:
    _, diagnostics, _ = simulate("T9 M6\nG43\nF1000\nG0 Z15\nG390\nM2\n", File())
    assert [d.code for d in diagnostics] == ["operator-stop"]
    assert "Alarm 101" in diagnostics[0].message


def test_g390_names_macro_and_line_as_the_vendor_does() -> None:
    diagnostic = aircut.loads("G21 G0 X1\nG390\nM2\n").check()[0]
    assert diagnostic.code == "E0345" and diagnostic.stack[0].line == 2
    line = diagnostic.span.line
    assert diagnostic.vendor() == f"[E0345] in line 2 (G390, line {line}) - required a tool of PROBE type"


def test_inputs() -> None:
    world = File(inputs=[Input(1, value=1.0), Input(2, times=[(2.0, 1.0)]), Input(3, analog=True, value=62.5)])
    text = (
        "M66 P1 L4\n#500=#5720\nM66 P2 L1 Q5\n#501=#5722\nM66 P2 L0 Q1\n#502=#5722\nM67 P3 L4\n#503=#5720\n"
        "M166 P1\n#504=#5740 #505=#5741\nM2\n"
    )
    assert values(text, world, 500, 501, 502, 503, 504, 505) == [1.0, 0.0, 1.0, 62.5, 1.0, 1.0]


def test_a_time_out_with_alarm() -> None:
    _, diagnostics, simulation = simulate("M66 P1 L11 Q3\nM2\n", File())
    assert [d.code for d in diagnostics] == ["input-timeout"]
    assert simulation.time == 3.0


def test_outputs_and_operator() -> None:
    world = File(operator=[Reply(values=[12.5]), Reply(stop=True)])
    text = 'M62 P3\nM68 P2 Q40\nM109 P"thickness" Q3\n#500=#5721\nM109 P"go on?" Q2\n#501=1\nM2\n'
    state, diagnostics, simulation = simulate(text, world)
    assert simulation.outputs == {(3, False): 1.0, (2, True): 40.0}
    assert state.numbered[500] == 12.5 and state.numbered[501] is None
    assert [d.code for d in diagnostics] == ["operator-stop"]
    assert [ask.text for ask in simulation.shown] == ["thickness", "go on?"]


def test_plc_calls_are_noted() -> None:
    _, diagnostics, simulation = simulate("G100 P7 A1.5\nM2\n", File())
    assert not diagnostics
    assert simulation.plc_calls[0] == ("7", {"a": 1.5})


def test_world_files(tmp_path: Path) -> None:
    path = tmp_path / "world.toml"
    path.write_text('[[bodies]]\nshape = "box"\nsize = [1, 2, 3]\n[[inputs]]\nnumber = 1\nvalue = 1\n')
    assert load(path).body is not None
    for text in (
        "bodies = 3",
        '[[bodies]]\nshape = "box"\n',
        "nonsense",
        '[[bodies]]\nshape = "stl"\nfile = "none.stl"\n',
    ):
        path.write_text(text)
        with pytest.raises(WorldError, match=r"world\.toml"):
            load(path)


def test_a_workpiece_from_a_mesh_file(tmp_path: Path) -> None:
    import trimesh

    trimesh.creation.box(extents=(20.0, 20.0, 10.0)).export(tmp_path / "part.stl")
    world = World(File(bodies=[Body("stl", at=(50.0, 0.0, -5.0), file="part.stl")]), tmp_path)
    interpreter = aircut.loads("T9 M6 G43\nF100\nG0 X20 Z-5\nG38.2 X60\n" + SAVE).interpreter(machine())
    for _ in Simulation(interpreter, world).run():
        pass
    assert interpreter.state.numbered[501] == pytest.approx(37.0, abs=1e-3)  # 50 - 10 - 3
