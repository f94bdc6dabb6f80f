"""The rules of `aircut check`: each row's own examples, no false alarms, and every way to switch them off."""

from pathlib import Path

import pytest

import aircut
from aircut.diagnostics import FAULTS, Severity
from aircut.rules import RULES, Policy, RulesError

ROOT = Path(__file__).parent.parent
WARNINGS = {fault.code for fault in FAULTS.values() if fault.severity is Severity.WARNING}


def warnings(text: str | bytes, **settings: object) -> list[tuple[str, int]]:
    """Rules that a text breaks, with the lines; it must have no errors."""
    found = aircut.loads(text).check(**settings)  # type: ignore[arg-type]
    assert not [str(d) for d in found if d.severity is Severity.ERROR]
    return [(d.code, d.span.line) for d in found]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.fault.code)
def test_examples(rule) -> None:
    assert {code for code, _ in warnings(rule.bad)} == {rule.fault.code}
    assert warnings(rule.good) == []


def test_rules_stand_once_and_are_warnings() -> None:
    codes = [rule.fault.code for rule in RULES]
    assert len(codes) == len(set(codes)) and set(codes) <= WARNINGS


# --- no false alarms: a text, and the rules that it breaks

UNITS = "G21 S1000 M3 F100\n"
READINGS = {
    # what is set before, on whatever way
    "#500=1\n#501=#500": "",
    "#501=#500": "unset-variable",
    "#501=#500\n#500=1": "unset-variable",
    "#500=[1] #501=#500": "unset-variable",
    "#501=[[#500]+[1]]": None,  # an error says it
    "# 5 0 0=1\n#501=#500": "",
    "#<A b>=1\n#501=#<ab>": "",
    "IF [#100 GT 0] THEN #500=1\n#501=#500": "",
    "#100=#4000 #101=#6000 #102=#5001 #103=#100": "",
    "#1=#2": "unset-variable",
    "#1=#<x>": None,
    "IF [#100 EQ 1] THEN #1=#<x>": "unset-variable",
    "IF [#100 EQ 1] THEN #1=#<cnc.x.type>": "",
    "IF [#100 EQ 1] THEN #1=#<_args.a>": "",
    # tests for null
    "IF [#500 EQ #0] THEN #500=1": "",
    "IF [#0 NE #500] THEN #500=1": "",
    "IF [#500 EQ #<math.nan>] THEN #500=1": "",
    "IF [EXISTS[#<x>]] THEN #500=1": "",
    "IF [#500 EQ 1] THEN #501=1": "unset-variable",
    "IF [#500 EQ #4001] THEN #501=1": "unset-variable",
    # comments and messages
    "(#500) ; #501": "",
    'M109 P"#500"': "",
    # loops and jumps
    "#9=0\nWHILE [#9 LT 2] DO1\n#9=[#9+1]\nIF [#9 EQ 2] THEN #501=#500\n#500=1\nEND1": "",
    "#9=0\nN1 #9=[#9+1]\nIF [#9 EQ 2] THEN #501=#500\n#500=1\nIF [#9 LT 2] GOTO 1": "",
    "#9=0\nN1 #9=[#9+1]\nIF [#9 EQ 2] THEN #501=#500\n#500=1\nIF [#9 LT 2] GOTO[1]": "",
    # computed
    "#9=500\n#[#9]=1\n#501=#500": "",
    "##4001=1\n#501=#500": None,
    "#<a> = 1\n#501 = #<a>": "",
    "#500\t=1\n#501 =#500": "",
    "#9=#[500]": "",
    "#9=#[#500+1]": None,
}


@pytest.mark.parametrize("text", READINGS, ids=lambda text: text.replace("\n", "|"))
def test_readings(text: str) -> None:
    codes = [d.code for d in aircut.loads(f"{UNITS}{text}\nM2\n").check()]
    wanted = READINGS[text]
    assert ("unset-variable" in codes) == (wanted == "unset-variable")
    if wanted is not None:
        assert codes == [wanted] * bool(wanted)


SUBROUTINES = {
    "M98 P1\n#501=#500\nM2\nO1\n#500=1\nM99": "",
    "M98 P1\n#501=#1\nM2\nO1\n#1=1\nM99": "",
    "M98 P1\nM2\nO1\n#501=#500\nM99": "unset-variable",
    "#500=1\nM98 P1\nM2\nO1\n#501=#500\nM99": "",
    "G65 P1 A1\nM2\nO1\n#501=#1 #502=#2\nM99": "",
    "G65 P1 A1\nM2\nO1\nIF [#100 EQ 1] THEN #501=#<_x>\nM99": "unset-variable",
    "G65 P1 A1\nM2\nO1\n#<_x>=1\nIF [#100 EQ 1] THEN #501=#<_x>\nM99": "",
    '#501=#500\nG65 P"1"\nM2\nO1\n#500=1\nM99': "unset-variable",
    "IF [#100 EQ 1] THEN M98 P7\n#501=#500\nM2": "",
}


@pytest.mark.parametrize("text", SUBROUTINES, ids=lambda text: text.replace("\n", "|"))
def test_readings_around_calls(text: str) -> None:
    codes = [code for code, _ in warnings(f"{UNITS}{text}\n")]
    assert codes == [SUBROUTINES[text]] * bool(SUBROUTINES[text])


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("M2\nG0 X1", 3),
        ("M30\n\n(comment)\nG0 X1\nG0 X2", 5),
        ("M02\nG0 X1", 3),
        ("M2", 0),
        ("M2\n%\nG0 X1", 0),
        ("M2\n(only a comment)\n", 0),
        ("/M2\nG0 X1\nM2", 0),
        ("IF [#100 EQ 1] THEN M2\nG0 X1\nM2", 0),
        ("IF [#100 EQ 1] THEN 1\nM2\nELSE1\nG0 X1\nEND1\nG0 X2\nM2", 0),
        ("IF [#100 EQ 1] THEN 1\nM2\nG0 X1\nEND1\nG0 X2\nM2", 4),
        ("GOTO 5\nIF [#100 EQ 1] THEN 1\nG0 X1\nELSE 1\nG0 X3\nEND1\nG0 X2\nN5 M2", 3),
        ("GOTO 5\nN4 G0 X1\nN5 M2", 3),
        ("IF [#100 EQ 1] GOTO 4\nGOTO 5\nN4 G0 X1\nN5 M2", 0),
        ("#1=5\nGOTO #1\nN4 G0 X1\nN5 M2", 0),
        ("#1=0\nWHILE [#1 LT 5] DO1\n#1=[#1+1]\nBREAK 1\nG0 X1\nEND1\nM2", 6),
        ("#1=0\nWHILE [#1 LT 5] DO1\n#1=[#1+1]\nIF [#1 EQ 2] BREAK 1\nG0 X1\nEND1\nM2", 0),
        ("M98 P1\nM2\nO1\nM99\nG0 X1", 6),
        ("G65 P1 M2\nM2\nO1\nM99", 0),
        ("M20 0", 0),
        ("M98 P1\nM2\nO1\nRETURN\nG0 X1", 6),
        ("M98 P1\nM2\nSUB 1\nG0 X1\nENDSUB\nG0 X1", 7),
    ],
)
def test_unreachable(text: str, line: int) -> None:
    found = aircut.loads(UNITS + text + "\n").check()
    assert [d.span.line for d in found if d.code == "unreachable-code"] == [line] * bool(line)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("M98 P1\nM2\nO1\nM99\nO2\nM99", ["2"]),
        ('CALL P"drill"\nM2\nSUB "Drill"\nENDSUB', []),
        ('G65 P"DRILL"\nM2\nSUB "drill"\nENDSUB', []),
        ("#1=2\nM98 P#1\nM2\nO1\nM99\nO2\nM99", []),
        ("IF [#100 EQ 1] THEN M98 P1\nM2\nO1\nM98 P2\nM99\nO2\nM99", []),
        ("M2\nO1\nM98 P2\nM99\nO2\nM99", ["1", "2"]),
        ("M2\nO1\nIF [#1 GT 3] THEN M98 P1\nM99", ["1"]),
        ("G66 P1\nG67\nM2\nO1\nM99", []),
        ("O1\nM98 P2\nM99\nO2\nM99", []),
    ],
)
def test_unused_subroutines(text: str, names: list[str]) -> None:
    found = aircut.loads(("" if text.startswith("O") else UNITS) + text + "\n").check()
    assert [d.message for d in found if d.code == "unused-subroutine"] == [
        f"nothing calls subroutine {n}" for n in names
    ]


MOTION = {
    # the spindle
    "M5\nG1 X1": [("spindle-off", 3)],
    "M5\nG1 X1\nG1 X2\nM3\nG1 X3\nM5\nG2 X5 R1": [("spindle-off", 3), ("spindle-off", 8)],
    "M5\nG1 Z5": [],
    "M5\nG1 Z5\nG1 Z4": [("spindle-off", 4)],
    "S0\nG1 X1": [("spindle-off", 3)],
    "M5\nG0 X1": [],
    "M5\nG38.3 Z-5": [],
    "M5\nM4\nG1 X1": [],
    # rapids
    "G0 Z-1": [("rapid-below-cut", 2)],
    "M5\nG0 Z-1": [],
    "G0 Z0\nG1 Z-1\nG0 Z5\nG0 Z-1": [],
    "G0 Z0\nG1 Z-1\nG0 Z5\nG0 Z-1.001": [("rapid-below-cut", 5)],
    "G0 Z0\nG1 Z-1\nG1 Z2\nG0 Z-1": [],
    "G0 Z0\nG1 Z-3\nG0 X5\nG1 X6 Z-1\nG0 Z-2": [("rapid-below-cut", 6)],
    "G0 Z0\nG1 Z-3\nG0 X5": [],
    "G0 Z5\nG0 Z1\nG0 Z0": [],
    "G53 G0 Z-10\nG28\nG30 Z-2": [],
    "G92 Z10\nG0 Z-1": [("rapid-below-cut", 3)],
    "G10 L2 P1 Z-50\nG0 Z5": [],
    "G10 L2 P1 Z-50\nG0 Z-5": [("rapid-below-cut", 3)],
    "G10 L2 P1 Z50\nG0 Z5\nG0 Z-5": [("rapid-below-cut", 4)],
    "G20\nG0 Z-0.1": [("rapid-below-cut", 3)],
}


@pytest.mark.parametrize("text", MOTION, ids=lambda text: text.replace("\n", "|"))
def test_motion(text: str) -> None:
    assert warnings(f"{UNITS}{text}\nM2\n") == MOTION[text]


def test_motion_over_many_chunks() -> None:
    """The last cut is remembered from chunk to chunk, whatever lies between."""
    fill = "G0 X1\nG0 X2\n" * 40_000
    text = f"{UNITS}G0 Z1\nG1 Z-2\nG0 Z1\n{fill}G0 Z-2\n{fill}G0 Z-2.5\nM2\n"
    assert warnings(text) == [("rapid-below-cut", 160_006)]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("G0 X1", 1), ("G21 G0 X1", 0), ("G20\nG0 X1", 0), ("G0 A5", 0), ("G28", 0), ("G28\nG0 X1\nG21", 2), ("M3", 0),
        ("G1 A5\nG0 X1", 2), ("M98 P1\nM2\nO1\nG0 X1\nM99", 4), ("(G21)\nG0 X1", 2),
    ],
)  # fmt: skip
def test_units(text: str, line: int) -> None:
    found = aircut.loads(f"{text}\nM2\n").check(machine("XYZA"))
    assert [d.span.line for d in found if d.code == "no-units"] == [line] * bool(line)


def machine(axes: str):
    from aircut.machine import built_in

    return built_in(axes)


@pytest.mark.parametrize(
    "text", ["O1\nG1 X1\nM99\n", "G1 X1\nM99\n", "IF [#1 EQ #0] THEN M2\nG1 X#1\nM99\n", 'SUB "a"\nG0 Z-5\nENDSUB\n']
)
def test_macros_run_in_their_callers_modes(text: str) -> None:
    assert warnings(text) == []


# --- switching off

BAD = "G21 S1000 F100\nG0 Z5\nG1 X1{}\nG1 X2\nM5\nM3\nG1 X3\nM5\nG1 X4\nM2\n"


@pytest.mark.parametrize(
    ("comment", "lines"),
    [
        ("", [3, 9]),
        (" (aircut: ignore spindle-off)", [9]),
        (" ; AIRCUT : Ignore SPINDLE-OFF", [9]),
        (" (aircut: ignore no-feed, spindle-off)", [9]),
        (" (aircut: off spindle-off)", []),
        (" (aircut: off spindle-off)\n(aircut: on spindle-off)", [10]),
        (" (aircut: ignore no-feed)", [3, 9]),
    ],
)
def test_comments(comment: str, lines: list[int]) -> None:
    assert [line for code, line in warnings(BAD.format(comment)) if code == "spindle-off"] == lines


@pytest.mark.parametrize(
    ("comment", "problem"),
    [
        ("(aircut: ignore)", "it names no rule"),
        ("(aircut: ignore spindle-of)", "there is no rule spindle-of; spindle-off is meant?"),
        ("(aircut: ignore overflow)", "overflow is an error, which cannot be switched off"),
        ("(aircut: spindle-off)", "it begins with ignore, off or on"),
        ("(aircut:)", "it begins with ignore, off or on"),
    ],
)
def test_comments_that_say_nothing(comment: str, problem: str) -> None:
    found = aircut.loads(f"{comment}\nM2\n").check()
    assert [(d.code, d.span.line) for d in found] == [("bad-directive", 1)] and problem in found[0].message


def test_ignored_by_the_caller() -> None:
    assert warnings(BAD.format(""), ignore=["spindle-off"]) == []
    with pytest.raises(RulesError, match="spindle-off is meant"):
        warnings("M2", ignore=["spindel-off"])


def project(folder: Path, text: str) -> Path:
    (folder / "aircut.toml").write_text(text)
    path = folder / "parts" / "left" / "part.ngc"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(BAD.format(""))
    return path


@pytest.mark.parametrize(
    ("text", "severities"),
    [
        ("", ["warning", "warning"]),
        ('[rules]\nspindle-off = "off"', []),
        ('[rules]\nspindle-off = "error"', ["error", "error"]),
        ('[rules]\nspindle-off = "warning"\nno-feed = "off"', ["warning", "warning"]),
    ],
)
def test_the_project_s_file(tmp_path: Path, text: str, severities: list[str]) -> None:
    found = aircut.load(project(tmp_path, text)).check()
    assert [d.severity.value for d in found] == severities


def test_the_nearest_project_file_counts(tmp_path: Path) -> None:
    path = project(tmp_path, '[rules]\nspindle-off = "off"')
    (path.parent / "aircut.toml").write_text("[rules]\n")
    assert len(aircut.load(path).check()) == 2


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('[rules]\nspindel-off = "off"', "there is no rule spindel-off"),
        ('[rules]\noverflow = "off"', "is an error"),
        ('[rules]\nspindle-off = "on"', "Invalid enum value 'on'"),
        ("[ruls]", "ruls"),
        ("rules = 3", "Expected object"),
        ("rules", "aircut.toml"),
    ],
)
def test_project_files_that_cannot_be_used(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(RulesError) as refused:
        Policy.of(project(tmp_path, text))
    assert reason in str(refused.value) and "aircut.toml" in str(refused.value)


def command(*words: object) -> tuple[int, str]:
    from click.testing import CliRunner

    from aircut.cli.main import cli

    done = CliRunner().invoke(cli, [str(word) for word in words])
    return done.exit_code, done.output


def test_on_the_command_line(tmp_path: Path) -> None:
    path = project(tmp_path, "")
    status, text = command("check", path)
    assert status == 0 and text.count("spindle-off") == 2
    assert command("check", "--ignore", "spindle-off", path) == (0, "")
    status, text = command("check", "--ignore", "nonsense", path)
    assert status == 2 and "there is no rule nonsense" in text
    project(tmp_path, '[rules]\nspindle-off = "error"\nno-feed = "error"')
    assert command("check", path)[0] == 1
    path.write_text("G21 G1 X1\nM2\n")
    assert command("run", path)[0] == 1
    path.write_text("G21 G1 X1 (aircut: ignore no-feed)\nM2\n")
    assert "no-feed" not in command("run", path)[1]
    project(tmp_path, "[rules")
    assert command("check", path)[0] == 2 and command("run", path)[0] == 2


# --- the examples


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.ngc")), ids=lambda path: path.name)
def test_shipped_examples_are_clean(path: Path) -> None:
    assert [str(d) for d in aircut.load(path).check()] == []


def test_a_small_check_is_quick() -> None:
    """Rules bring in nothing heavy: NumPy stays out."""
    import subprocess
    import sys

    text = "import sys; from aircut.cli.main import main\ntry: main()\nexcept SystemExit: print('numpy' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", text, "check", ROOT / "examples" / "bracket.ngc"], capture_output=True, text=True
    )
    assert done.stdout == "False\n", done.stdout + done.stderr
