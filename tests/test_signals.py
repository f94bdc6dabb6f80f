"""Inputs as scripted, outputs to the end of the program, and functions of the PLC (000 section 1.2)."""

import sys
from pathlib import Path

import msgspec
import pytest

import aircut
from aircut.controller import Simulation, World
from aircut.controller.world import File, Input
from aircut.interpreter.running import Run
from aircut.machine import built_in


def run(text: str, *inputs: Input, read_back: bool = True) -> tuple[Run, Simulation]:
    made = built_in("XYZ")
    made.options = msgspec.structs.replace(made.options, m66_read_back=read_back)
    interpreter = aircut.loads(text).interpreter(made)
    simulation = Simulation(interpreter, World(File(inputs=list(inputs))))
    for _ in simulation.run():
        pass
    return interpreter, simulation


def values(text: str, *inputs: Input, read_back: bool = True, count: int = 4) -> list[float | None]:
    interpreter, _ = run(text, *inputs, read_back=read_back)
    return interpreter.state.numbered[500 : 500 + count]


def test_an_input_scripted_in_time_by_dwells_and_moves() -> None:
    """High from second 2 to 5: read at 0, at 2 (dwell), at 4.9 and 5 (a feed of 60 mm/min for 3 mm)."""
    pulse = Input(1, times=[(2.0, 1.0), (5.0, 0.0)])
    text = (
        "M66 P1 L4\n#500=#5720\nG4 P2\nM66 P1 L4\n#501=#5720\nG1 X2.9 F60\nM66 P1 L4\n#502=#5720\n"
        "X3\nM66 P1 L4\n#503=#5720\nM2\n"
    )
    assert values(text, pulse) == [0.0, 1.0, 1.0, 0.0]


def test_an_input_scripted_in_sequence() -> None:
    """Each reading is the next of the sequence; the last one stays."""
    text = "".join(f"M66 P1 L4\n#{500 + i}=#5720\n" for i in range(5)) + "M2\n"
    assert values(text, Input(1, sequence=[1.0, 0.0, 1.0]), count=5) == [1.0, 0.0, 1.0, 1.0, 1.0]
    text = "".join(f"M67 P1 L4\n#{500 + i}=#5720\n" for i in range(4)) + "M2\n"
    assert values(text, Input(1, analog=True, sequence=[10.0, 62.5])) == [10.0, 62.5, 62.5, 62.5]


@pytest.mark.parametrize(
    ("mode", "sequence", "failed"),
    [
        (0, [1.0, 1.0, 0.0], 0.0),
        (1, [0.0, 0.0, 1.0], 0.0),
        (2, [0.0, 1.0, 0.0], 0.0),
        (2, [0.0, 1.0], 1.0),
        (3, [1.0, 0.0, 1.0], 0.0),
        (3, [1.0, 0.0], 1.0),
    ],
)
def test_waits_in_a_sequence(mode: int, sequence: list[float], failed: float) -> None:
    assert values(f"M66 P1 L{mode} Q5\n#500=#5722\nM2\n", Input(1, sequence=sequence), count=1) == [failed]


def test_a_value_steers_the_program() -> None:
    text = "M66 P1 L4\nIF [#5720 EQ 1] THEN1\n#500=1\nELSE1\n#500=2\nEND1\nM2\n"
    assert values(text, Input(1, value=1.0), count=1) == [1.0]
    assert values(text, Input(1, value=0.0), count=1) == [2.0]


@pytest.mark.parametrize("code", ["M66 P1 L4", "M66 P1 L1", "M67 P1 L4"])
def test_without_read_back_the_value_is_not_kept(code: str) -> None:
    inputs = (Input(1, value=1.0), Input(1, analog=True, value=80.0))
    text = f"{code}\n#500=#5720 #501=#5722\nM2\n"
    assert values(text, *inputs, read_back=False, count=2) == [None, 0.0]
    assert values(text, *inputs, count=2) == [80.0 if "M67" in code else 1.0, 0.0]


def test_read_back_is_the_default() -> None:
    assert built_in().options.m66_read_back


@pytest.mark.parametrize(("end", "on"), [("M2", False), ("M30", False), ("M102", True), ("", True)])
def test_outputs_at_the_end(end: str, on: bool) -> None:
    _, simulation = run(f"M62 P3\nM62 P4\nM63 P4\nM68 P2 Q40\n{end}\n")
    kept = {(3, False): 1.0, (4, False): 0.0, (2, True): 40.0}
    assert simulation.outputs == (kept if on else dict.fromkeys(kept, 0.0))


def test_plc_functions_come_from_installed_packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_plc.py").write_text(
        "def clamp(simulation, **arguments):\n"
        "    simulation.outputs[5, False] = arguments['a']\n"
        "    simulation.time += 1.5\n"
    )
    info = tmp_path / "my_plc-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-plc\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[aircut.plc]\n7 = my_plc:clamp\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    interpreter, simulation = run("G100 P7 A2.5 B#1\nG100 P8 Z1\nM102\n")
    assert not interpreter.failed
    assert simulation.outputs == {(5, False): 2.5} and simulation.time == 1.5
    assert [(call.function, call.arguments) for call in simulation.plc_calls] == [("7", {"a": 2.5}), ("8", {"z": 1.0})]
    events = [e.values[0] for e in aircut.loads("G100 P8 Z1\nM2\n").run().events if e.name == "PLC_CALL"]
    assert events == [{"p": 8.0, "z": 1.0}]
