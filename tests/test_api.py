"""The Python API."""

from pathlib import Path

import numpy as np
import pytest

import aircut
from aircut.canon import Chunk, Kind

PROGRAM = """G21 G90 F600
G0 X10 Y0 Z5
G1 Z-1
G2 X0 Y10 I-10 J0
#500 = 7
#<depth> = 2.5
G20
T2 M6
M2
"""


@pytest.fixture
def result() -> aircut.Result:
    return aircut.loads(PROGRAM).run()


def test_toolpath_columns(result: aircut.Result) -> None:
    toolpath = result.toolpath
    assert len(toolpath) == 3
    assert toolpath.x.tolist() == [10.0, 10.0, 0.0]
    assert toolpath.kind.tolist() == [Kind.TRAVERSE, Kind.FEED, Kind.ARC]
    assert toolpath.line.tolist() == [2, 3, 4]
    assert toolpath.turns.tolist() == [0, 0, -1]
    assert (toolpath.u[2], toolpath.v[2]) == (0.0, 0.0)  # center: 10 - 10, 0 + 0
    assert toolpath.feed.tolist() == [0.0, 600.0, 600.0]


def test_lengths_and_extents(result: aircut.Result) -> None:
    # √(10² + 5²); 5 + 1; clockwise from 0° to 90° the long way: 3/4 of a circle of radius 10
    assert result.toolpath.lengths() == pytest.approx([125**0.5, 6.0, 1.5 * np.pi * 10])
    assert result.extents is not None
    assert result.extents.low[:3] == pytest.approx((-10.0, -10.0, -1.0))
    assert result.extents.high[:3] == pytest.approx((10.0, 10.0, 5.0))
    assert result.toolpath.extents(rapid=True).low[2] == 0.0  # type: ignore[union-attr]


def test_variables_and_state(result: aircut.Result) -> None:
    assert result.variables[500] == 7.0 and result.variables["depth"] == 2.5
    assert result.state["position"]["y"] == 10.0 and result.state["tool"] == 2
    assert result.state["modes"]["units"] == "G21"  # M2 puts the modes back
    assert result.system(5220) == 1.0


def test_commands_in_order(result: aircut.Result) -> None:
    names = [command.name for command in result]
    assert names.index("SET_FEED_RATE") < names.index("STRAIGHT_TRAVERSE") < names.index("ARC_FEED")
    arc = next(command for command in result if command.name == "ARC_FEED")
    assert arc.line == 4 and arc.values["y"] == 10.0
    tool = next(command for command in result if command.name == "CHANGE_TOOL")
    assert tool.values == {"tool": 2}


def test_other_libraries(result: aircut.Result) -> None:
    rows = result.toolpath.to_numpy()
    assert rows["z"].tolist() == [5.0, -1.0, -1.0]
    table = result.toolpath.to_arrow()
    assert table.column("x").to_pylist() == [10.0, 10.0, 0.0]
    assert table.schema.field("x").metadata[b"meaning"]
    frame = result.toolpath.to_pandas()
    assert frame["kind"].tolist() == [0, 1, 2]


def test_a_program_runs_again_from_the_start() -> None:
    program = aircut.loads("G91\nG0 X5\n#500=[5+5]\nM2\n")
    first, second = program.run(), program.run()
    assert first.toolpath.x.tolist() == second.toolpath.x.tolist() == [5.0]


def test_stream_gives_the_same_as_run() -> None:
    text = "G91\n" + "G0 X0.0625 Y-0.03125\n" * 150_000 + "M2\n"
    chunks = list(aircut.loads(text).stream())
    assert len(chunks) > 2 and all(isinstance(chunk, Chunk) for chunk in chunks)
    whole = aircut.loads(text).run().toolpath
    assert b"".join(chunk.rows for chunk in chunks) == whole.to_numpy().tobytes()
    assert whole.x[-1] == 150_000 / 16


def test_load(tmp_path: Path) -> None:
    path = tmp_path / "p.ngc"
    path.write_bytes(b"\xef\xbb\xbfG21 G0 X1\r\nM2\r\n\x1a")
    program = aircut.load(path)
    assert program.check() == []
    assert len(program.run().toolpath) == 1
    with pytest.raises(OSError):
        aircut.load(tmp_path / "none.ngc")
    with pytest.raises(ValueError, match="dialect"):
        aircut.load(path, "klingon")


def test_run_stops_where_check_goes_on() -> None:
    program = aircut.loads("G0 X1 K1\nG0 X2 K2\nM2\n")
    assert [d.span.line for d in program.check()] == [1, 2]
    result = program.run()
    assert not result.ok and [d.span.line for d in result.diagnostics] == [1]
    assert len(result.toolpath) == 0


def test_diagnostics_carry_the_call_stack() -> None:
    text = "M98 P1\nM2\nO1\nM98 P2\nM99\nO2\nG0 X[1/0]\nM99\n"
    diagnostic = aircut.loads(text, name="p.ngc").check()[0]
    assert diagnostic.span.line == 7 and diagnostic.span.column == 6
    assert [(frame.name, frame.line) for frame in diagnostic.stack] == [("1", 1), ("2", 4)]


def test_an_empty_toolpath() -> None:
    result = aircut.loads("M2\n").run()
    assert len(result.toolpath) == 0 and result.extents is None
    assert result.toolpath.lengths().tolist() == []


def test_columns_are_the_packed_rows() -> None:
    """Column by column what ROW packed, whatever the chunking."""
    text = "G91 F100\n" + "".join(f"G1 X{i % 7 - 3} F{i + 1}\n" for i in range(70_000)) + "M2\n"
    toolpath = aircut.loads(text).run().toolpath
    assert toolpath.feed.tolist() == [float(i + 1) for i in range(70_000)]
    assert toolpath.line[0] == 2 and toolpath.line[-1] == 70_001
