"""Every program of the documents compiles, in its own dialect, on a machine that has what it needs."""

import shutil
from pathlib import Path

import msgspec
import pytest

import aircut
from aircut.machine import Machine, Tool, built_in
from aircut.machine.config import parse

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
pytestmark = pytest.mark.skipif(not EXAMPLES.exists(), reason="the documents' examples are not at hand")

MACROS = (
    "O101.ngc", "O200.ngc", "O1001.ngc", "O9110.ngc", "g200.ngc", "m200.ngc", "my_sub.ngc", "named_sub.ngc",
    "update_piece_position.ngc",
)  # fmt: skip
CHANGES = ("tool_change_automatic.ngc", "tool_change_length.ngc", "tool_change_manual.ngc")
PROGRAMS = sorted({path.name for path in EXAMPLES.glob("*.ngc")} - {*MACROS, *CHANGES})
#: Meant to fail, and how (000 section 10.1).
FAILING = {
    "message_user_error.ngc": "[E0345] in line 2 - user error message",
    "message_default_error.ngc": "[E0345] in line 2 - generic user error with m109 q-1",
}
#: What the user has done before.
BEFORE = {"g250_after_g390.ngc": "T1 M6 G43 F500 "}
PLACES = {
    6002: 1.0, 6003: 1000.0, 6010: 2.0, 6011: -50.0, 6012: -60.0, 6013: 200.0, 6021: 500.0, 6022: 50.0,
    6023: 100.0, 6024: 20.0, 6031: 10.0, 6032: 10.0, 6033: 150.0, 6035: 20.0,
}  # fmt: skip


def machine(name: str, folder: Path) -> Machine:
    """Six axes, tools 1 to 5, the documents' macros, and what the program's section asks for."""
    made = built_in("XYZABC")
    if name.startswith("rtcp"):
        axes = {letter: {} for letter in "XYZAC"}
        made = Machine(parse({"kinematics": "rotary_table_ac", "axes": axes}), {}, own_tools=False)
    for macro in MACROS:
        shutil.copy(EXAMPLES / macro, folder)
    shutil.copy(EXAMPLES / "tool_change_length.ngc", folder / "tool_change.ngc")
    kind = {"g250_after_g390.ngc": 4, "rtcp_g43_7_saw.ngc": 5}.get(name, 0)
    made.tools = {id: Tool(id, z=50.0, diameter=6.0, type=kind) for id in range(1, 6)}
    made.macros = (folder,)
    made.variables |= PLACES
    changes = "macro" if name == "tool_change_usage.ngc" else "internal"
    entry = {"cutter_compensation.ngc": "easy", "automatic_compensation.ngc": "normal"}.get(name, "nist")
    made.options = msgspec.structs.replace(made.options, tool_change=changes, entry=entry)
    return made


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_compiles(name: str, tmp_path: Path) -> None:
    text = BEFORE.get(name, "").encode() + (EXAMPLES / name).read_bytes()
    if name in BEFORE:  # its first line is a comment, which stays at the end of ours
        text = text.replace(b" ;", b"\n;", 1)
    program = aircut.loads(text, "linuxcnc" if name.startswith("lc_") else "rosetta", name)
    told = [d.vendor() for d in program.check(machine(name, tmp_path)) if d.severity.value == "error"]
    assert told == ([FAILING[name]] if name in FAILING else [])


@pytest.mark.parametrize("name", CHANGES)
def test_tool_changes_compile(name: str, tmp_path: Path) -> None:
    made = machine("tool_change_usage.ngc", tmp_path)
    shutil.copy(EXAMPLES / name, tmp_path / "tool_change.ngc")
    told = aircut.load(EXAMPLES / "tool_change_usage.ngc").check(made)
    assert not [d for d in told if d.severity.value == "error"]
