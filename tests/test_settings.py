"""What the machine's settings and files do to programs, and codes that only tell the PLC something."""

import re
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner

import aircut
from aircut import dialects
from aircut.cli.main import cli
from aircut.interpreter.running import Mode, Start
from aircut.machine import built_in


@pytest.mark.parametrize("units", [20, 21])
def test_units_of_the_user_interface(units: int) -> None:
    made = built_in("XYZ")
    made.options = msgspec.structs.replace(made.options, units=units)
    result = aircut.loads("#500=#<sys.ui.units_mode> #501=#5106\nM2\n").run(made)
    assert [result.system(500), result.system(501)] == [units, 21.0]  # programs start in G21 all the same


def test_the_table_of_input_variables_is_untouched(tmp_path: Path) -> None:
    program, table = tmp_path / "p.ngc", tmp_path / "m.var"
    table.write_text("100\t7.5\n4000\t1\n")
    program.write_text("#500=#100\n#100=9 #101=10 #4000=[#4000 + #100]\nM2\n")
    for n in (1, 2):
        done = CliRunner().invoke(cli, ["run", str(program), "--parameters", str(table)])
        assert done.exit_code == 0
        kept = dict(line.split() for line in table.read_text().splitlines())
        assert float(kept["100"]) == 7.5 and float(kept.get("101", 0.0)) == 0.0
        assert float(kept["4000"]) == 1.0 + 7.5 * n  # the shared ones are written back


TABLE = "T1 P3 D+0.500000 Z+2.000000 ;half inch\nnonsense\n"


@pytest.mark.parametrize(("unit", "diameter", "length"), [("", 0.5, 2.0), ("mm", 0.5, 2.0), ("inch", 12.7, 50.8)])
def test_the_unit_of_a_tool_table(unit: str, diameter: float, length: float, tmp_path: Path) -> None:
    program, table = tmp_path / "p.ngc", tmp_path / "tool.tbl"
    table.write_text(TABLE)
    program.write_text('T1 M6 G43\nM109 P"#5410 #5422 #5133" Q4\nM2\n')
    option = ["--tool-unit", unit] if unit else []
    done = CliRunner().invoke(cli, ["run", str(program), "--tools", str(table), *option])
    assert done.exit_code == 0, done.output
    assert f"{diameter:g} {length:g} 3" in done.output
    assert "tool.tbl:2:" in done.output and "line skipped" in done.output  # what was passed over is told


def events(text: str, *names: str) -> list[tuple[object, ...]]:
    result = aircut.loads(text).run(built_in("XYZA"))
    assert result.ok, result.diagnostics
    return [(event.at, event.name, *event.values) for event in result.events if event.name in names]


def test_torch_height_control() -> None:
    """Among the coolant codes: behind the spindle, before the motion of the line."""
    names = ("TORCH_HEIGHT_CONTROL", "START_SPINDLE_CLOCKWISE", "DISABLE_FEED_OVERRIDE")
    assert events("G0 X1 M17 M49 M3 S5\nG0 X2 M18\nM2\n", *names) == [
        (0, "START_SPINDLE_CLOCKWISE", 0),
        (0, "TORCH_HEIGHT_CONTROL", 1),
        (0, "DISABLE_FEED_OVERRIDE"),
        (1, "TORCH_HEIGHT_CONTROL", 0),
    ]


def test_homing_is_requested_by_bits() -> None:
    """G102 asks the controller for it; the machine of a program's run stays where it is."""
    assert events("G102 P1\nG0 X5\nG102 P13\n#500=#5001\nM2\n", "HOME_AXES") == [
        (0, "HOME_AXES", 1),
        (1, "HOME_AXES", 13),
    ]
    result = aircut.loads("G0 X5\nG102 P13\n#500=#5001\nM2\n").run(built_in("XYZA"))
    assert result.system(500) == 5.0 and len(result.toolpath) == 1


def test_the_place_of_a_stop_reads_in_the_units_in_force() -> None:
    program = aircut.loads("G0 X25.4 Y-50.8 A90\nG20\nG4 P0\n#10=#5091 #11=#5092 #12=#5094 #13=#5081 #14=#5106\nM2\n")
    stopped = program.run(built_in("XYZA"), stop_line=4)
    assert stopped.stop is not None
    rest = program.run(built_in("XYZA"), start=Start(4, stopped.stop.moves, stopped.stop), mode=Mode.RESUME)
    assert [rest.variables[number] for number in range(10, 15)] == pytest.approx([1.0, -2.0, 90.0, 1.0, 20.0])


def listed() -> list[int]:
    """The system variables that the requirements name."""
    table = Path(__file__).parent.parent / "conformance" / "coverage.tsv"
    spans = re.findall(r"^VAR-(5\d{3})(?:\.\.(5\d{3}))?\t", table.read_text("utf-8"), re.MULTILINE)
    return [number for first, last in spans if first != "5000" for number in range(int(first), int(last or first) + 1)]


def test_every_listed_system_variable_has_a_meaning() -> None:
    rows = dialects.load("rosetta").system
    assert len(listed()) > 200
    assert [n for n in listed() if not any(row.first <= n <= row.last for row in rows)] == []
