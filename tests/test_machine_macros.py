"""Macros that the machine itself calls: the pallet shuttle's and the tool changer's."""

from pathlib import Path

import msgspec
import pytest

import aircut
from aircut import dialects
from aircut.controller import panel
from aircut.interpreter.running import Run
from aircut.machine import Machine, built_in

SHUTTLE = "#510=#5001 #511=#5150\nG0 X50\n#513=#5149\nM99\n"


def machine(folder: Path, shuttle: bool = True, **macros: str) -> Machine:
    for name, text in macros.items():
        (folder / f"{name}.ngc").write_text(text, "utf-8")
    made = built_in("XYZ")
    made.macros = (folder,)
    made.options = msgspec.structs.replace(made.options, pallet_shuttle=shuttle)
    return made


def run(text: str, made: Machine) -> tuple[Run, list[str]]:
    interpreter = aircut.loads(text).interpreter(made)
    names = [event.name for chunk in interpreter.run() for event in chunk.events]
    return interpreter, names


def test_m30_calls_the_macro_before_the_end(tmp_path: Path) -> None:
    interpreter, names = run("G0 X7\nS100 M3\nM30\n#520=1\n", machine(tmp_path, pallet_shuttle=SHUTTLE))
    assert not interpreter.diagnostics
    m = interpreter.state
    assert m.numbered[510:514] == [7.0, 30.0, None, 1.0]  # behind the motion, in a call
    assert m.numbered[520] is None  # the program is over
    assert m.position[0] == 50.0 and m.spindle == 5  # and was reset behind the macro
    assert names[-3:] == ["PROGRAM_END", "ON_RESET", "ON_RESET"]


def test_m60_calls_the_macro_and_goes_on(tmp_path: Path) -> None:
    interpreter, _ = run("G0 X7\nM60\n#520=#5001\nM60\nM2\n", machine(tmp_path, pallet_shuttle=SHUTTLE))
    assert not interpreter.diagnostics
    assert interpreter.state.numbered[510:512] == [50.0, 60.0]  # of the second call
    assert interpreter.state.numbered[520] == 50.0


@pytest.mark.parametrize("code", ["M30", "M60"])
def test_without_the_setting_nothing_is_called(code: str, tmp_path: Path) -> None:
    interpreter, names = run(f"G0 X7\n{code}\nM2\n", machine(tmp_path, shuttle=False, pallet_shuttle=SHUTTLE))
    assert not interpreter.diagnostics
    assert interpreter.state.numbered[510] is None and names.count("PALLET_SHUTTLE") == 1


@pytest.mark.parametrize("code", ["M30", "M60"])
def test_a_missing_macro_is_an_error(code: str, tmp_path: Path) -> None:
    interpreter, _ = run(f"G0 X7\n{code}\nM2\n", machine(tmp_path))
    assert [d.code for d in interpreter.diagnostics] == ["no-subroutine"]
    assert "pallet_shuttle.ngc" in interpreter.diagnostics[0].message
    assert interpreter.diagnostics[0].span.line == 2


def test_a_subroutine_of_the_program_is_not_meant(tmp_path: Path) -> None:
    text = 'M60\nM2\nSUB "pallet_shuttle"\n#520=1\nENDSUB\n'
    interpreter, _ = run(text, machine(tmp_path, pallet_shuttle=SHUTTLE))
    assert interpreter.state.numbered[520] is None and interpreter.state.numbered[511] == 60.0


@pytest.mark.parametrize(("action", "number"), [("pick", 1.0), ("place", 2.0), ("place-pick", 3.0)])
def test_the_tool_changer(action: str, number: float, tmp_path: Path) -> None:
    macro = (
        "#510=#13 #511=#<_args.m> #512=#<cnc.compile.mode>\n"
        "#513=[#13 EQ #<pick_place.mode_pick>]\nG0 X9\nM99\n"
    )  # fmt: skip
    interpreter = panel.pick_place(
        action, dialects.load("rosetta"), machine(tmp_path, atcm_pick_place_tool=macro)
    )  # fmt: skip
    for _ in interpreter.run():
        pass
    assert not interpreter.diagnostics
    assert interpreter.state.numbered[510:514] == [number, number, 1.0, float(action == "pick")]
    assert interpreter.state.position[0] == 9.0


def test_the_tool_changer_without_its_macro(tmp_path: Path) -> None:
    interpreter = panel.pick_place("pick", dialects.load("rosetta"), machine(tmp_path))
    for _ in interpreter.run():
        pass
    assert [d.code for d in interpreter.diagnostics] == ["no-subroutine"]
    with pytest.raises(KeyError):
        panel.pick_place("throw", dialects.load("rosetta"), machine(tmp_path))
