"""Tool libraries: what is read from each format, and that no file makes a traceback."""

import io
import json
import random
import re
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import oracle
from aircut.machine import MachineError, Tool, imports
from aircut.machine.imports import read_library, read_tools, write_tools

anywhere = settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])

LENGTH = st.floats(allow_nan=False, allow_infinity=False)
TOOL = st.builds(
    Tool,
    id=st.integers(1, 2**31 - 1),
    name=st.text(st.characters(exclude_categories=["Cs"])),
    slot=st.integers(0, 10**6),
    type=st.integers(0, 8),
    **dict.fromkeys(("x", "y", "z", "diameter", "p1", "p2", "p3"), LENGTH),
)


def put(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def refused(path: Path) -> str:
    """The message, which names the file."""
    with pytest.raises(MachineError) as caught:
        read_library(path)
    assert str(caught.value).startswith(f"{path}")
    return str(caught.value)[len(str(path)) :]


# tools.toml


@anywhere
@given(st.lists(TOOL, unique_by=lambda tool: tool.id))
@example([Tool(1, 'a "b" \\ \n\r\t\x00\x7f\x85\u2028 é 🔩', z=-0.0, x=1e-7, y=1e16, p1=5e-324)])
def test_written_and_read_is_the_same(tmp_path: Path, tools: list[Tool]) -> None:
    path = tmp_path / "tools.toml"
    given = {tool.id: tool for tool in tools}
    write_tools(path, given)
    assert read_tools(path) == given
    assert read_library(path).warnings == ()
    assert [p.name for p in tmp_path.iterdir()] == ["tools.toml"]


def test_what_is_written(tmp_path: Path) -> None:
    path = tmp_path / "tools.toml"
    write_tools(path, {2: Tool(2, "drill", z=40.5, type=3), 1: Tool(1, diameter=6.0)})
    assert path.read_text() == (
        "# Tool library. Lengths mm.\n"
        "\n[[tools]]\nid = 1\ndiameter = 6.0\n"
        '\n[[tools]]\nid = 2\nname = "drill"\nz = 40.5\ntype = 3\n'
    )


def test_numbers_of_numpy_are_numbers(tmp_path: Path) -> None:
    import numpy as np

    write_tools(tmp_path / "t.toml", {1: Tool(1, z=np.float64(1.5))})
    assert read_tools(tmp_path / "t.toml") == {1: Tool(1, z=1.5)}


@pytest.mark.parametrize(
    "tool, why",
    [
        (Tool(0), "tool 0: ids are above zero"),
        (Tool(1, type=9), "tool 1: type is 0 to 8, not 9"),
        (Tool(1, slot=-1), "tool 1: slot is not below 0"),
        (Tool(1, z=float("nan")), "tool 1: z must be a finite number"),
        (Tool(1, p2=float("inf")), "tool 1: p2 must be a finite number"),
        (Tool(1, "\udc80"), "a tool's name is not text"),
    ],
)
def test_what_cannot_be_written(tmp_path: Path, tool: Tool, why: str) -> None:
    path = put(tmp_path, "tools.toml", "# old")
    with pytest.raises(MachineError, match=why):
        write_tools(path, {tool.id: tool})
    assert path.read_text() == "# old"
    assert len(list(tmp_path.iterdir())) == 1


def test_nowhere_to_write(tmp_path: Path) -> None:
    with pytest.raises(MachineError, match="No such file"):
        write_tools(tmp_path / "none" / "tools.toml", {})
    (tmp_path / "folder").mkdir()
    with pytest.raises(MachineError, match="folder"):
        write_tools(tmp_path / "folder", {})
    assert [p.name for p in tmp_path.iterdir()] == ["folder"]


@pytest.mark.parametrize(
    "text, why",
    [
        ("[[tools]]\nid = 1\n[[tools]]\nid = 1\n", "each stands once"),
        ("[[tools]]\nid = 0\n", "above zero"),
        ("[[tools]]\nid = 1\n[[tools]]\nid = 2\nz = 'x'", r"$.tools[1].z"),
        ("[[tools]]\nid = 1\ncolor = 2", "color"),
        ("[[tools]]\nid = 1\nz = nan", "tool 1: z must be a finite number"),
        ("[[tools]]\nid = 1\nz = inf", "tool 1: z must be a finite number"),
        ("[[tools]]\nid = 1\ntype = 9", "tool 1: type is 0 to 8"),
        ("[[tools]]\nid = 1\nslot = -1", "tool 1: slot"),
        ("tools = 3", "$.tools"),
        ("[[tools]]\nid = x", "line 2"),
        ("a = " + "[" * 100_000, "nested too deeply"),
        ("[[tools]]\nid = " + "9" * 5000, "digits"),
    ],
)
def test_faults_in_toml(tmp_path: Path, text: str, why: str) -> None:
    assert why in refused(put(tmp_path, "tools.toml", text))


# LinuxCNC


def test_linuxcnc_table(tmp_path: Path) -> None:
    text = (
        "; T P Z D\n\n"
        "T1 P3 D+0.125000 Z+0.511000 ;1/8 end mill ; two flutes\r\n"
        "t2 p2 x-1 y.5 z1e1\n"
        "T30\tP0\tD4\n"
        "   \t\n"
        "T9 D-2;left\n"
    )
    library = read_library(put(tmp_path, "tool.tbl", text))
    assert library.warnings == ()
    assert library.tools == {
        1: Tool(1, "1/8 end mill ; two flutes", slot=3, diameter=0.125, z=0.511),
        2: Tool(2, slot=2, x=-1.0, y=0.5, z=10.0),
        30: Tool(30, diameter=4.0),
        9: Tool(9, "left", diameter=-2.0),
    }


def test_linuxcnc_inches(tmp_path: Path) -> None:
    path = put(tmp_path, "tool.tbl", "T1 P1 D0.125 X1 Y-2 Z0.5 I10 J20 Q6\n")
    assert read_tools(path, unit_mm=25.4) == {
        1: Tool(1, slot=1, diameter=3.175, x=25.4, y=-50.8, z=12.7, type=8, p1=10.0, p2=20.0, p3=6.0)
    }


@pytest.mark.parametrize("unit", [0.0, -1.0, float("nan"), float("inf")])
def test_units_that_are_none(tmp_path: Path, unit: float) -> None:
    with pytest.raises(MachineError, match="not a unit of length"):
        read_tools(put(tmp_path, "tool.tbl", "T1 P1\n"), unit)


@pytest.mark.parametrize(
    "line, why",
    [
        ("T6 P6 D1 R5", "unknown word R5"),
        ("T 4 P4 D1", "T is not a word with a whole number"),
        ("T5.5 P5", "T5.5 is not a word with a whole number"),
        ("T5 D1mm", "D1mm is not a word with a number"),
        ("T5 Dnan", "Dnan is not a word with a number"),
        ("T5 D1_0", "D1_0 is not a word with a number"),
        ("T5 D٣", "D٣ is not a word with a number"),
        ("T5 Z1e999", "a number is too large"),
        ("P5 D1", "no T word above 0"),
        ("T0 P1", "no T word above 0"),
        ("T-3 P1", "no T word above 0"),
        ("T99999999999 P1", "T99999999999 is not a word"),
        ("\x00", "unknown word"),
    ],
)
def test_lines_that_are_skipped(tmp_path: Path, line: str, why: str) -> None:
    path = put(tmp_path, "tool.tbl", f"T1 P1\n{line}\nT2 P2\n")
    library = read_library(path)
    assert set(library.tools) == {1, 2}
    (warning,) = library.warnings
    assert warning.startswith(f"{path}:2: {why}") and warning.endswith(": line skipped")


@pytest.mark.skipif(oracle.PROGRAM is None, reason="needs LinuxCNC's rs274")
def test_as_linuxcnc_reads_it(tmp_path: Path) -> None:
    """Diameter, offsets and angles of each tool of a table, asked of LinuxCNC itself."""
    made = random.Random(1)
    numbers = [*range(1, 15), 7, 3, 100, 20]
    lines = [
        " ".join(f"{letter}{made.uniform(-9, 9):+.4f}" for letter in made.sample("DXYZIJ", made.randint(1, 6)))
        for _ in numbers
    ]
    words = [f"{made.choice('Tt')}{n} P{i} {line}" for i, (n, line) in enumerate(zip(numbers, lines, strict=True), 1)]
    words[4:4] = ["; comment", "", "T8 P9 K3"]
    path = put(tmp_path, "tool.tbl", "".join(f"{line} ;name\n" for line in words))
    tools = read_tools(path)
    assert set(tools) == set(numbers)
    program = "".join(f"T{n} M6\n(print,{n} #5401 #5402 #5403 #5410 #5411 #5412)\n" for n in tools) + "M2\n"
    put(tmp_path, "ask.ngc", program)
    ask = [str(oracle.PROGRAM), "-g", "-t", "tool.tbl", "ask.ngc"]
    said = subprocess.run(ask, capture_output=True, text=True, cwd=tmp_path, timeout=60).stdout
    theirs = [[float(x) for x in line.split()] for line in said.splitlines() if re.fullmatch(r"[-.\d ]+", line)]
    ours = [[t.id, t.x, t.y, t.z, t.diameter, t.p1, t.p2] for t in tools.values()]
    assert theirs == [pytest.approx(row, abs=1e-6) for row in ours]


def test_tool_twice_the_first_counts(tmp_path: Path) -> None:
    """As LinuxCNC has it: T7 twice, and #5410 is the first one's."""
    path = put(tmp_path, "tool.tbl", "T7 P7 D1\nT7 P8 D2\n")
    assert read_library(path) == (
        {7: Tool(7, slot=7, diameter=1.0)},
        (f"{path}:2: tool 7 stands twice: the first counts",),
    )


def test_offsets_of_nine_axes(tmp_path: Path) -> None:
    """Angles have no unit of length: 25.4 mm an inch is for U, V and W."""
    path = put(tmp_path, "tool.tbl", "T1 P1 Z5 A90 B0 C-1 U1 V.5 W-2\n")
    tool = Tool(1, slot=1, z=127.0, a=90.0, c=-1.0, u=25.4, v=12.7, w=-50.8)
    assert read_library(path, 25.4) == ({1: tool}, ())


def test_name_that_is_not_utf8(tmp_path: Path) -> None:
    assert read_tools(put(tmp_path, "tool.tbl", b"T1 P1 ;\xd86mm\n"))[1].name == "\ufffd6mm"


def test_a_flood_of_warnings(tmp_path: Path) -> None:
    path = put(tmp_path, "tool.tbl", "T1 P1\n" + "R\n" * 5000)
    warnings = read_library(path).warnings
    assert len(warnings) == 101
    assert warnings[-1] == f"{path}: 4900 more warnings"


def test_nothing_but_faults_is_no_table(tmp_path: Path) -> None:
    assert refused(put(tmp_path, "tool.tbl", "G0 X1\nM2\n")) == ":1: unknown word G0: line skipped (no tools found)"


# Fusion


def tool(number: Any = 3, **changes: Any) -> dict[str, Any]:
    return {
        "type": "flat end mill",
        "description": "6 mm",
        "unit": "millimeters",
        "geometry": {"DC": 6, "LB": 30, "LCF": 20, "OAL": 57, "NOF": 3, "HAND": True},
        "post-process": {"number": number, "length-offset": number, "diameter-offset": number, "turret": 0},
        "start-values": {"presets": [{"n": 12000}]},
        **changes,
    }


def fusion(folder: Path, *entries: Any) -> Path:
    return put(folder, "library.json", json.dumps({"data": entries, "version": 18}))


def archive(**members: str | bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in members.items():
            made.writestr(name.replace("_", "."), content)
    return out.getvalue()


def test_fusion_tool(tmp_path: Path) -> None:
    library = read_library(fusion(tmp_path, tool()))
    assert library == ({3: Tool(3, "6 mm", diameter=6.0, type=1)}, ())


def test_fusion_archive_holds_the_same(tmp_path: Path) -> None:
    text = json.dumps({"data": [tool()]})
    path = put(tmp_path, "library.tools", archive(tools_json=text, other_txt="x"))
    assert read_tools(path) == read_tools(fusion(tmp_path, tool()))
    assert read_tools(put(tmp_path, "plain.tools", text)) == read_tools(path)


def test_fusion_lengths(tmp_path: Path) -> None:
    geometry = {"DC": 0.25, "LB": 1.0, "OAL": 3.0}
    holder = {"type": "holder", "gaugeLength": 50.8, "unit": "millimeters"}
    lengths = {
        1: tool(1, unit="inches", geometry={**geometry, "assemblyGaugeLength": 4.0}, holder=holder),
        2: tool(2, unit="inches", geometry=geometry, holder=holder),  # the holder's unit is its own
        3: tool(3, unit="inches", geometry=geometry, holder={"gaugeLength": 2.0}),
        4: tool(4, unit="inches", geometry=geometry, holder={"segments": []}),
        5: tool(5, unit="inches", geometry=geometry),
        6: tool(6, unit=None, expressions={"tool_unit": "'inches'"}, geometry={"DC": "0.25"}),
    }
    tools = read_tools(fusion(tmp_path, *lengths.values()))
    assert {number: t.z for number, t in tools.items()} == {1: 101.6, 2: 76.2, 3: 76.2, 4: 0.0, 5: 0.0, 6: 0.0}
    assert {t.diameter for t in tools.values()} == {6.35}


@pytest.mark.parametrize(
    "name, number",
    [("flat end mill", 1), ("bull nose end mill", 1), ("face mill", 1), ("ball end mill", 2), ("drill", 3),
     ("spot drill", 3), ("center drill", 3), ("probe", 4), ("slot mill", 5), ("plasma cutter", 6),
     ("turning general", 8), ("chamfer mill", 0), ("tap right hand", 0), ("Flat End Mill", 1), (None, 0)],
)  # fmt: skip
def test_fusion_types(tmp_path: Path, name: str | None, number: int) -> None:
    assert read_tools(fusion(tmp_path, tool(type=name)))[3].type == number


def test_fusion_name_is_the_type_without_one(tmp_path: Path) -> None:
    assert read_tools(fusion(tmp_path, tool(description="")))[3].name == "flat end mill"


@pytest.mark.parametrize(
    "entry, why",
    [
        (tool(0), "no tool number"),
        (tool(**{"post-process": None}), "no tool number"),
        ({}, "no tool number"),
        (tool(-1), "tool numbers are 1 to 2147483647, not -1"),
        (tool(2**31), "tool numbers are 1 to 2147483647, not 2147483648"),
        (tool(unit="furlongs"), "tool 3 is in 'furlongs', not in millimeters or inches"),
        (tool(unit=None), "no unit"),
        (tool(geometry={"DC": -1}), "tool 3 has a diameter of -1 mm"),
        (tool(geometry={"DC": "inf"}), "tool 3 has a diameter of inf mm"),
        (tool(geometry={"DC": "nan"}), "tool 3 has a diameter of nan mm"),
        (tool(geometry={"assemblyGaugeLength": -1}), "tool 3 has a length of -1 mm"),
        (tool(unit="inches", geometry={"DC": 1e308}), "tool 3 has a diameter of inf mm"),
    ],
)
def test_fusion_tools_that_are_skipped(tmp_path: Path, entry: dict[str, Any], why: str) -> None:
    path = fusion(tmp_path, tool(8), entry)
    assert read_library(path) == ({8: read_tools(path)[8]}, (f"{path}: data[1]: {why}: tool skipped",))
    assert refused(fusion(tmp_path, entry)).endswith("(no tools found)")


def test_fusion_holders_are_no_tools(tmp_path: Path) -> None:
    assert read_library(fusion(tmp_path, {"type": "holder", "gaugeLength": 50}, {"type": "tool block"})) == ({}, ())


def test_fusion_length_offset_is_a_register(tmp_path: Path) -> None:
    entry = tool()
    entry["post-process"]["length-offset"] = 43
    path = fusion(tmp_path, entry, tool())
    library = read_library(path)
    assert library.tools[3].z == 0.0
    assert library.warnings == (
        f"{path}: data[0]: tool 3 uses length register 43: H43 is tool 43's length",
        f"{path}: data[1]: tool 3 stands twice: the first counts",
    )


@pytest.mark.parametrize(
    "text, place",
    [
        ("{", "truncated"),
        ("[]", "got `array`"),
        ("{}", "`data`"),
        ('{"data": {}}', "$.data"),
        ('{"data": [1]}', "$.data[0]"),
        ('{"data": [{}, {"geometry": []}]}', "$.data[1].geometry"),
        ('{"data": [{"geometry": {"DC": {}}}]}', "$.data[0].geometry.DC"),
        ('{"data": [{"geometry": {"DC": 1e999}}]}', "$.data[0].geometry.DC"),
        ('{"data": [{"post-process": {"number": 1.5}}]}', "$.data[0].post-process.number"),
        ('{"data": [{"description": "\\ud800"}]}', ""),
        ("[" * 100_000, ""),
        ('{"a": ' * 100_000, "nested too deeply"),
        ('{"a": [' * 500 + "[" * 100_000, "nested too deeply"),
        ("", ""),
    ],
)
def test_faults_in_json(tmp_path: Path, text: str, place: str) -> None:
    assert place in refused(put(tmp_path, "library.json", text))


def test_archives_that_are_none(tmp_path: Path) -> None:
    good = archive(tools_json=json.dumps({"data": [tool()]}))
    assert "without tools.json" in refused(put(tmp_path, "a.tools", archive(other_json="{}")))
    for cut in range(4, len(good)):
        refused(put(tmp_path, "cut.tools", good[:cut]))
    locked = bytearray(good)
    for flags in (good.find(b"PK\x03\x04") + 6, good.find(b"PK\x01\x02") + 8):
        locked[flags] |= 1
    assert "encrypted" in refused(put(tmp_path, "locked.tools", bytes(locked)))
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_LZMA) as made:
        made.writestr("tools.json", "{}")
    assert "packed in a way that is not read" in refused(put(tmp_path, "lzma.tools", packed.getvalue()))


def test_bombs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(imports, "MAX_JSON", 100_000)
    monkeypatch.setattr(imports, "MAX_TEXT", 10_000)
    monkeypatch.setattr(imports, "MAX_OBJECTS", 10_000)
    bomb = archive(tools_json=b" " * 50_000_000)
    assert len(bomb) < 100_000
    assert "tools.json: too large" in refused(put(tmp_path, "bomb.tools", bomb))
    # An archive that lies about the size.
    lie = bytearray(bomb)
    for size in (bomb.find(b"PK\x03\x04") + 22, bomb.find(b"PK\x01\x02") + 24):
        lie[size : size + 4] = (10).to_bytes(4, "little")
    refused(put(tmp_path, "lie.tools", bytes(lie)))
    assert "too many files" in refused(put(tmp_path, "many.tools", b"PK\x03\x04" + b"PK\x01\x02" * 2000))
    assert "objects" in refused(put(tmp_path, "many.json", '{"data": [' + "{}," * 20_000 + "{}]}"))
    assert "too large" in refused(put(tmp_path, "big.json", b" " * 100_001))
    assert "too large" in refused(put(tmp_path, "big.tbl", b";" * 10_001))
    assert "too large" in refused(put(tmp_path, "big.toml", b"#" * 10_001))


# Which format


def test_format_by_content(tmp_path: Path) -> None:
    toml, table = "[[tools]]\nid = 4\n", "T4 P0\n"
    for name, text in [
        ("a.toml", toml), ("b", toml), ("c.txt", "# mine\n" + toml), ("d.toml", "\ufeff" + toml),
        ("e.tbl", table), ("f", table), ("g.txt", "\n; mine\n" + table), ("h.tbl", "\ufeff" + table),
        ("i.TBL", table), ("j", "  t4\n"),
    ]:  # fmt: skip
        assert read_tools(put(tmp_path, name, text)) == {4: Tool(4)}, name
    for name in ("k", "l.txt", "m.tbl", "n.toml"):
        assert set(read_tools(put(tmp_path, name, json.dumps({"data": [tool()]})))) == {3}, name
    for name in ("o", "p.tbl", "q.toml"):
        assert read_tools(put(tmp_path, name, "")) == {}, name


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    assert "No such file" in refused(tmp_path / "none.toml")
    assert "directory" in refused(tmp_path)


@anywhere
@given(
    st.sampled_from(["a.toml", "a.tbl", "a.json", "a.tools", "a"]),
    st.one_of(
        st.binary(max_size=300),
        st.text(st.sampled_from('TPDXYZIJQ;.-+0123456789eE \t\n[]"={}:,'), max_size=200).map(str.encode),
        st.binary(max_size=100).map(lambda b: b"PK\x03\x04" + b),
        st.binary(max_size=100).map(lambda b: archive(tools_json=b)),
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
            lambda inner: (
                st.lists(inner, max_size=4)
                | st.dictionaries(
                    st.sampled_from(["data", "geometry", "post-process", "number", "DC", "unit", "holder", "type"]),
                    inner,
                )
            ),
            max_leaves=20,
        ).map(lambda value: json.dumps({"data": value if isinstance(value, list) else [value]}).encode()),
    ),
)
def test_no_file_makes_a_traceback(tmp_path: Path, name: str, data: bytes) -> None:
    path = put(tmp_path, name, data)
    try:
        library = read_library(path)
    except MachineError as error:
        assert str(error).startswith(str(path))
    else:
        write_tools(tmp_path / "again.toml", library.tools)
        assert read_tools(tmp_path / "again.toml") == library.tools
