"""LinuxCNC's language under an INI file, a tool table and a parameter file: as `rs274 -i -t -v` runs it."""

import os
import random
import re
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

import aircut
import oracle
import oracle_linuxcnc
from aircut.cli.main import cli
from aircut.machine import MachineError, inifile
from test_oracle_linuxcnc import machine

needs_oracle = pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (linuxcnc-uspace) is not installed")


def theirs(folder: Path, arguments: list[str]) -> tuple[str, bool]:
    """What rs274 prints for part.ngc with these arguments, and whether it ran to the end."""
    environment = {**os.environ, "HOME": str(folder)}
    done = subprocess.run(
        [str(oracle.PROGRAM), *arguments, "-g", "part.ngc"],
        cwd=folder, env=environment, capture_output=True, timeout=20,
    )  # fmt: skip
    text = done.stdout.decode("utf-8", "replace")
    text = "".join(re.split(r"(?m)^(?:File: .* Unrecognized line skipped:\n.*|executing)\n", text))
    return text, done.returncode == 0


def ours(folder: Path, arguments: list[str]) -> tuple[str, bool]:
    """The same of aircut."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        done = CliRunner().invoke(cli, ["run", "part.ngc", "--dialect", "linuxcnc", "--format", "canon", *arguments])
    finally:
        os.chdir(before)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.stdout, done.exit_code == 0


def compare(folder: Path, ini: str, program: str, table: str = "", parameters: str | None = None) -> None:
    """Equal listings, equal ends, equal parameter files."""
    (folder / "part.ngc").write_text(program)
    their, our = [], []
    if ini:
        (folder / "machine.ini").write_text(ini)
        their, our = ["-i", "machine.ini"], ["--ini", "machine.ini"]
    if table:
        (folder / "tool.tbl").write_text(table)
        their, our = [*their, "-t", "tool.tbl"], [*our, "--tools", "tool.tbl"]
    if parameters is not None:
        for name in ("their.var", "our.var"):
            (folder / name).unlink(missing_ok=True)
            (folder / f"{name}.bak").unlink(missing_ok=True)
            (folder / name).write_text(parameters)
        their, our = [*their, "-v", "their.var"], [*our, "--parameters", "our.var"]
    wanted, fine = theirs(folder, their)
    given, ok = ours(folder, our)
    assert given.splitlines() == wanted.splitlines()
    assert ok == fine
    if parameters is not None:
        assert (folder / "our.var").read_text() == (folder / "their.var").read_text()
        assert (folder / "our.var.bak").read_text() == parameters


def section(name: str, *lines: str) -> str:
    return "\n".join((f"[{name}]", *lines, ""))


def ngc(*lines: str) -> str:
    return "\n".join((*lines, "M2", ""))


VALUES = (
    "A=1 ", "A =\t4", "A 5", 'A="1"', "A=", "  A=3", "A==9",
    "A=1e", "A=1_0", "A=+5", "A=5.", "A=-.5e-1", ";A=1\nA=2", "#A=1\nA=2",
    "a=1\nA=2", "A=1\\\n2", "A=1;2", "A=0x1p3", "A=1 2", "A=6\nA=7", "[B]\nA=7\n[A]\nA=8",
    "A=TRUE",
)  # fmt: skip
SHOWN = ngc("(debug,#<_ini[a]a> #<_INI[A]A>)", "#1=exists[#<_ini[a]a>]", "(debug,#1)", "#2=#<_ini[a]a>", "(debug,#2)")
NAMES = [(section("A", value), SHOWN) for value in VALUES]
NAMES += [
    ("[ A ]\nA=1\n", ngc("(debug,#<_ini[a]a>)")),
    ("A=1\n[A]\n", ngc("(debug,#<_ini[]a> #<_ini[a]>)")),
    ("[A] x\nA=1\n", ngc("(debug,#<_ini[a]a>)")),
    ("[X]\n[A\nA=1\n", ngc("(debug,#<_ini[a]a>)")),
    ("[A-B_1]\nA-C=1\n", ngc("(debug,#<_ini[a-b_1]a-c> #<_ini[a]x> #<_ini>)")),
    ("[A]\nD=1\n", ngc("#<_ini[a]d>=4", "(debug,#<_ini[a]d>)")),
    ("[A]\nD=1\n", ngc("#1=#<_hal[motion.on]>")),
    ("[A]\nD=1\n", ngc("o1 sub", "(debug,#<_ini[a]d>)", "o1 endsub", "o1 call")),
]

ORIENT = [
    (section("RS274NGC", f"ORIENT_OFFSET={v}"), ngc("M19 R10", "M19 R350")) for v in ("0", "15", "-1", "x", "1.7")
]
ARCS = [
    (section("RS274NGC", f"CENTER_ARC_RADIUS_TOLERANCE_MM={v}"), ngc("F100", arc))
    for v in ("0.001", "0.01", "0.0282842")
    for arc in ("G2 X10.0035 I5", "G2 X10.012 I5", "G2 X10.06 I5", "G2 X2000.09 I1000", "G2 X2000.11 I1000")
]
ARCS += [(ARCS[0][0], ngc("F100", *["G2 X10 I5", "G2 X0 I-5"] * 9, "G2 X10.012 I5"))]
ARCS += [
    (section("RS274NGC", f"CENTER_ARC_RADIUS_TOLERANCE_INCH={v}"), ngc("G20", "F10", arc))
    for v in ("0.00004", "0.0005")
    for arc in ("G2 X1.0003 I.5", "G2 X1.0012 I.5")
]
CHANGES = [
    (section("EMCIO", *options), ngc(*lines))
    for options in (
        ["TOOL_CHANGE_WITH_SPINDLE_ON=1"],
        ["TOOL_CHANGE_WITH_SPINDLE_ON=YES"],
        ["TOOL_CHANGE_QUILL_UP=1"],
        ["TOOL_CHANGE_QUILL_UP=2", "TOOL_CHANGE_AT_G30=1"],
        ["TOOL_CHANGE_AT_G30=1"],
    )
    for lines in (
        ["G0 X1 Y2 Z3 A4", "#5181=5", "#5183=2", "#5184=9", "M3 S10", "T1 M6", "(debug,#<_spindle_on> #<_x> #<_z>)",
         "G0 X0"],
        ["#5223=1", "#5181=5", "#5183=2", "#5184=9", "G55", "G54", "G0 X1 Y2 Z3 A4", "T1 M6 G43",
         "(debug,#<_x> #<_z> #<_a>)", "T2 M6", "(debug,#<_x> #<_z> #<_a>)", "G0 X0"],
        ["G20", "G92 Z3", "G10 L2 P1 R30 Y2", "G0 X1 Z4", "T3 M6", "G43", "G0 Z2", "T1 M6", "G0 X0"],
    )
]  # fmt: skip
CHANGES += [
    (section("RS274NGC", "RETAIN_G43=1"), ngc(*lines))
    for lines in (
        ["N1 T1 M6", "N2 G43", "N3 G0 X1", "N4 G43 H2", "N5 (msg,a)", "N6 #1=2", "N7", "N8 G49", "N9 G0 X1"],
        ["N1 G43 H1", "N2 T2 M6", "#1=2", "", "(c)", "o1 if [1]", "o1 endif", "N5 G4 P0 G49", "N6 G43.2 H1", "N7 G20"],
        ["N1 G43 H1", "N2 T2", "N3 M61 Q2", "N4 G0 X1", "N5 G43 H1", "N6 G0 X2", "N7 T1 M6", "N8 G0 X1 G43 H2"],
        ["N1 G43 H1", "N2 G43.1 Z3", "N3 M3 S10", "N4 M8", "N5 T0 M6", "G0 X1"],
        ["T1 M6", "G43", "G41 D1", "F10 G1 X50"],
    )
]
CHANGES += [
    (section("EMCIO", f"RANDOM_TOOLCHANGER={value}"),
     ngc("T1 M6", "T2 M6", "(debug,#5400 #5403)", "G43", "M61 Q3", "T0", "T2 M6", "G10 L1 P2 Z1", "G43 H1", "T0 M6"))
    for value in (0, 1)
]  # fmt: skip
WRAPPED = section("AXIS_A", "WRAPPED_ROTARY=1")
TURNING = [
    (WRAPPED, ngc(*lines))
    for lines in (
        ["G0 A90", "A350", "A10", "A-10", "A-0", "A359.9", "G91 A20", "A-370", "A360"],
        ["G0 A360"],
        ["G0 A-360"],
        ["G0 A90", "A90", "A-90", "A1", "#1=-0.0", "G0 A30", "A#1", "A[-#1]", "A0", "B400"],
        ["G0 A90", "G92 A10", "G0 A20", "(debug,#5214)", "G0 A-5", "G52 A5", "G0 A2"],
        ["G92 A400"],
        ["G91 G52 A400"],
        ["G10 L20 P1 A400"],
        ["G10 L2 P1 A30", "G0 A20", "G53 G0 A10", "G53 G0 A-20", "G28 A350", "(debug,#<_a>)", "G10 L2 P1 A400"],
        ["G53 G0 A-370"],
        ["F10 G1 A350", "G2 I1 A10", "G91 G2 I1 A400", "G90 G1 A-1"],
        ["F10 G38.2 A350 X3", "G0 A-10"],
        ["M3 S10", "G33 A3 Z3 K1", "G33.1 A-3 Z4 K1", "G43.1 A400", "G0 A2"],
        ["G91 G0 A-10", "G28.1", "(debug,#5164)", "G0 A-720", "G30.1", "(debug,#5184)"],
        ["G0 A-20 X5", "G93 G1 A-30 F2", "G1 A300 F2", "G0 A-180", "A180", "A-179.9999"],
        ["G43.1 A40", "G0 A20", "G53 G0 A30", "G28.1", "(debug,#5164)", "G0 A-5", "G28", "G28 A7"],
    )
]
TURNING += [(section("AXIS_B", f"WRAPPED_ROTARY={v}"), ngc("G0 B-1", "B350")) for v in ("0", "2", "-1", "YES", "0.7")]
LOCKED = section("AXIS_A", "LOCKING_INDEXER_JOINT=3")
INDEXING = [
    (LOCKED, ngc(*lines))
    for lines in (
        ["G61", "G0 A3", "G61.1", "G0 A4", "G64 P1 Q2", "G0 A5", "G0 A5", "A7", "F1 G1 X1", "G53 G0 A1", "G0 X1 A5"],
        ["F10", "G1 A0"],
        ["F10", "G38.2 A2 X1"],
        ["F10", "G2 A2 I1"],
        ["M3 S1", "G33 A1 K1"],
        ["M3 S1", "G33.1 A1 K1 Z2"],
        ["#5164=30", "#5161=1", "G28", "G28 A2", "G28 X1", "G30"],
        ["#5164=30", "G28 A2 X1"],
        ["F1", "G53 G1 A2"],
        ["G0 A1 B2"],
        ["G0 A1 @3 ^4"],
    )
]
INDEXING += [(section("AXIS_C", f"LOCKING_INDEXER_JOINT={v}"), ngc("G0 C1")) for v in ("0", "-1", "x", "")]
CALLS = [
    (section("RS274NGC", f"OWORD_NARGS={v}"), ngc("o1 sub", "(debug,#<n_args> #1)", "o1 endsub", "o1 call [4] [5]",
                                                  "(debug,#<n_args>)", "o1 call")) for v in ("1", "2", "0", "x")
]  # fmt: skip
CALLS += [
    (section("RS274NGC", "OWORD_NARGS=1"), ngc("o1 sub", "#<n_args>=7", "o1 endsub", "o1 call [4]")),
    (section("RS274NGC", "DISABLE_FANUC_STYLE_SUB=1"), "M98 P100\nM2\nO100\nG0 X1\nM99\n"),
    (section("RS274NGC", "DISABLE_FANUC_STYLE_SUB=YES"), "M98 P100\nM2\nO100\nG0 X1\nM99\n"),
    (section("RS274NGC", "DISABLE_FANUC_STYLE_SUB=1"), "O5 (title)\nG0 X1\nM2\n"),
    (section("RS274NGC", "DISABLE_FANUC_STYLE_SUB=1"), "G0 X1\nM99\n"),
    (section("RS274NGC", "SUBROUTINE_PATH=two:one"), ngc("o<sub> call")),
    (
        section("RS274NGC", "SUBROUTINE_PATH=/nowhere:one") + section("DISPLAY", "PROGRAM_PREFIX=two"),
        ngc("o<sub> call"),
    ),
    (section("RS274NGC", "SUBROUTINE_PATH=/nowhere"), ngc("o<sub> call")),
]
IGNORED = [
    (section("TRAJ", "LINEAR_UNITS=mm", "COORDINATES=X Y Z"), ngc("(debug,#<_metric_machine>)", "G0 A1", "G10 L2 P1 X1",
                                                                "(debug,#5221)")),
    (section("TRAJ", "COORDINATES=X Y Z A B C U V W"), ngc("G0 U1")),
    (section("RS274NGC", "RS274NGC_STARTUP_CODE=G20 G91", "PARAMETER_FILE=p.var"),
     ngc("(debug,#<_metric> #<_absolute>)")),
    (section("RS274NGC", "USER_M_PATH=."), ngc("M101 P1")),
]  # fmt: skip


@needs_oracle
@pytest.mark.parametrize("cases", [NAMES, ORIENT, ARCS, CHANGES, TURNING, INDEXING, CALLS, IGNORED])
def test_ini_file_is_taken_as_the_oracle_takes_it(cases: list[tuple[str, str]], tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "sub.ngc").write_text(f"o<sub> sub\n(msg,{name})\no<sub> endsub\n")
    for ini, program in cases:
        try:
            compare(tmp_path, ini, program)
        except AssertionError as error:
            raise AssertionError(f"{ini}\n{program}\n{error}") from None


TABLE = """T1 P1 X1 Y2 Z3 A4 B5 C6 U7 V8 W9 D.5 I10 J20 Q3 ; all
t2 p7 z1 d2
T3 Z4 ; no pocket
T4 P9 Q3 FOO
T5 Z
T1 P4 Z9
T8 P2 Z8 Q9 d-.25
T9 P0 z+1.5
"""
TABLES = [
    (table, ngc(*lines))
    for table in (TABLE, "T2 Z1\nT1 P1 Z2\n", "\n", "T1 P1 A1 B2 C3 U4 V5 W6 I7 J8 Q9 D3\nT2 P2\nT8 P8 C9\n")
    for lines in (
        ["(debug,#<_current_tool> #<_current_pocket> #5400 #5403 #5410)", "G43", "T1 M6 G43", "G0 X0",
         "(debug,#5400 #5401 #5402 #5403 #5404 #5405 #5406 #5407 #5408 #5409 #5410 #5411 #5412 #5413)",
         "(debug,#<_x> #<_a> #<_u> #5426 #5427 #5428 #<_current_pocket>)", "G49", "T8 M6", "G43.2 H1", "G43.2 H8",
         "G0 X1 A2"],
        ["T3", "M6 G43", "(debug,#<_current_pocket> #5403)", "T2 M6", "G43 H1", "G43 H4"],
        ["T1 M6", "G43.1 A5 Z2", "G0 A1", "G10 L1 P1 A2 C-1", "G10 L10 P1 A3 B4 Z1", "G10 L11 P1 A3 C4 X2", "G43",
         "G0 B2 C3",
         "G10 L1 P8 R2 I3 J4 Q5", "G43 H8", "(debug,#5410 #5404)", "G53 G0 A1 B2", "G28 C5"],
        ["T1 M6", "G20 G43 H1", "G10 L1 P1 X1 A1", "G10 L10 P1 Z1 B1", "G41 D1 G1 X50 F10", "G40"],
        ["T5 M6"],
        ["T0 M6", "T2 M6", "M61 Q8", "G43", "(debug,#5400 #5403 #<_current_tool>)", "M61 Q0"],
    )
]  # fmt: skip


OPTIONS = [
    ("AXIS_A", "WRAPPED_ROTARY=1"),
    ("AXIS_C", "WRAPPED_ROTARY=1"),
    ("AXIS_B", "LOCKING_INDEXER_JOINT=4"),
    ("EMCIO", "TOOL_CHANGE_WITH_SPINDLE_ON=1"),
    ("EMCIO", "TOOL_CHANGE_QUILL_UP=1"),
    ("EMCIO", "TOOL_CHANGE_AT_G30=1"),
    ("EMCIO", "RANDOM_TOOLCHANGER=1"),
    ("RS274NGC", "ORIENT_OFFSET=12.5"),
    ("RS274NGC", "CENTER_ARC_RADIUS_TOLERANCE_MM=0.002"),
    ("RS274NGC", "OWORD_NARGS=1"),
    ("RS274NGC", "DISABLE_G92_PERSISTENCE=1"),
    ("RS274NGC", "RETAIN_G43=1"),
]
#: All topics but splines, after which the position that a probe takes over is not the oracle's, and compensation.
TOPICS = "straight,arc,polar,mode,offset,setting,auxiliary,tool,comment,home,probe,show,flow,call,saved,cycle,thread"
PROGRAMS = 80


@needs_oracle
def test_random_programs_under_random_files(tmp_path: Path) -> None:
    for seed in range(PROGRAMS):
        chance = random.Random(seed)
        chosen = chance.sample(OPTIONS, chance.randint(1, 4))
        sections = dict.fromkeys(name for name, _ in chosen)
        text = "".join(section(name, *(line for other, line in chosen if other == name)) for name in sections)
        program = oracle_linuxcnc.Writer(seed, TOPICS).program(25)
        file = tmp_path / "machine.ini"
        file.write_text(text)
        answer = oracle.answer(program, tmp_path, ["-i", str(file)])
        made = machine()
        made.ini = inifile.load(file)
        result = aircut.loads(program, "linuxcnc").run(made)
        told = "".join(result.canon()).splitlines()
        difference = oracle.differ(told, [line for line in answer.listing if line != "executing"])
        assert not difference, f"seed {seed}\n{text}{difference}"
        assert result.ok == answer.accepted, f"seed {seed}\n{text}{answer.message}"


@pytest.mark.parametrize(
    ("name", "line", "said"),
    [
        ("RS274NGC", "CENTER_ARC_RADIUS_TOLERANCE_MM=0.0009", "MM is 0.001 to 0.02828427"),
        ("RS274NGC", "CENTER_ARC_RADIUS_TOLERANCE_MM=0.0283", "MM is 0.001 to 0.02828427"),
        ("RS274NGC", "CENTER_ARC_RADIUS_TOLERANCE_INCH=nan", "INCH is 4e-05 to 0.002828427"),
        ("RS274NGC", "REMAP=M400 ngc=x", "there is no file x.ngc"),
        ("TRAJ", "SPINDLES=0", "SPINDLES is 1 to 8"),
        ("TRAJ", "SPINDLES=9", "SPINDLES is 1 to 8"),
    ],
)
def test_what_cannot_be_run_is_told(name: str, line: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "machine.ini"
    file.write_text(section(name, line))
    with pytest.raises(MachineError, match=re.escape(said)):
        inifile.load(file)


def test_any_bytes_are_a_file(tmp_path: Path) -> None:
    file = tmp_path / "machine.ini"
    file.write_bytes(b"[RS274NGC]\nSUBROUTINE_PATH=~nobody-of-this-name/x:a\0b:\xff:\n[\n]\n=\n[]=\n\\")
    assert [folder.name for folder in inifile.load(file).folders] == ["x", "\ufffd"]


def test_ini_files_are_for_linuxcnc(tmp_path: Path) -> None:
    (tmp_path / "machine.ini").write_text("")
    (tmp_path / "part.ngc").write_text("M2\n")
    done = CliRunner().invoke(cli, ["run", str(tmp_path / "part.ngc"), "--ini", str(tmp_path / "machine.ini")])
    assert done.exit_code == 2
    assert "linuxcnc dialect" in done.stderr


@needs_oracle
def test_tool_table_has_nine_offsets(tmp_path: Path) -> None:
    for table, program in TABLES:
        try:
            compare(tmp_path, "", program, table)
        except AssertionError as error:
            raise AssertionError(f"{table}\n{program}\n{error}") from None


PARAMETERS = [
    ("", ngc("#5221=2", "#31=4")),
    ("5161\t1\n5162\t2.5\n", ngc("(debug,#5161)", "G28.1")),
    ("31\t7\nfoo bar\n32 8 9\n33 x\n34\n35\t1e3\n36 +2.5\n37 4x\n38.5 3\n039 6\n\n5161 1\n",
     ngc("(debug,#31 #32 #33 #34 #35 #36 #37 #38 #39)", "#31=1.23456789", "G0 X1")),
    ("5210 1\n5211 2\n5220 2\n5241 3\n5247 2\n5250 10\n", "(debug,#5210 #<_x> #<_u>)\nG92 X3\n"),
    ("5210 1\n5211 2\n5220 9\n5381 3\n5390 10\n", ngc("(debug,#5210 #<_x>)", "G92.2", "G28.1", "G10 L20 P3 X1 A2")),
    ("5220 10\n", ngc("G0 X1")),
    ("5400 9\n5420 3\n5599 0\n", ngc("(debug,#5400 #5420 #5599)")),
    ("5063 1\n5400 9\n5403 1\n5420 3\n5424 3\n", ngc("F10 G0 X4 A5 B2", "T1 M6", "G38.3 Z5")),
    ("5601 1\n", ngc("(debug,#5601)")),
]  # fmt: skip


@needs_oracle
@pytest.mark.parametrize("orientation", [-1, 0, 1, 9, 10, 12])
def test_tool_table_has_any_orientation(orientation: int, tmp_path: Path) -> None:
    """10 once ended in an IndexError."""
    lines = ("G18 G20 F9", "T1 M6", "(debug,#5413)", "G0 X-2 Z-2", "G41", "G1 X0 Z0", "X1", "G40", "G1 X3 Z3")
    compare(tmp_path, "", ngc(*lines), f"T1 P1 D.02 Q{orientation}\n")


@needs_oracle
@pytest.mark.parametrize("ini", ["", section("RS274NGC", "DISABLE_G92_PERSISTENCE=1")], ids=["plain", "g92"])
def test_parameter_file_is_read_and_written_as_the_oracle_does(ini: str, tmp_path: Path) -> None:
    for text, program in PARAMETERS:
        try:
            compare(tmp_path, ini, program, "", text)
        except AssertionError as error:
            raise AssertionError(f"{text}\n{program}\n{error}") from None
