"""G390 and G250 on simulated workpieces (003, decisions section 21)."""

import pytest

import aircut
from aircut.controller import Simulation, World
from aircut.controller.world import Body, File
from aircut.diagnostics import Diagnostic
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.requests import Probe, Probed
from aircut.machine import Tool, built_in

LENGTH = 55.0
MICRONS2 = 0.002


def run(text: str, *bodies: Body, radius: float = 3.0, **tool: float) -> tuple[Interpreter, Simulation]:
    made = built_in("XYZ")
    made.tools = {9: Tool(9, **{"z": LENGTH, "diameter": 2 * radius, "type": 4, **tool}), 1: Tool(1, z=10.0)}
    interpreter = aircut.loads(text).interpreter(made)
    simulation = Simulation(interpreter, World(File(bodies=list(bodies))))
    for _ in simulation.run():
        pass
    return interpreter, simulation


def errors(text: str, *bodies: Body, **tool: float) -> list[Diagnostic]:
    return [d for d in run(text, *bodies, **tool)[0].diagnostics if d.severity.value == "error"]


READY = "T9 M6\nG43\nF1000\n"

#: In the documents' order; words that break this rule and no earlier one.
RANGES = [
    ("V0", "v", "1..4"),
    ("V5", "v", "1..4"),
    ("V2.5", "v", "1..4"),
    ("W0", "w", "1..9"),
    ("W10", "w", "1..9"),
    ("X4.999", "x", "5..500"),
    ("X500.001", "x", "5..500"),
    ("Y4.999", "y", "5..500"),
    ("Y500.001", "y", "5..500"),
    ("Z4.999", "z", "5..500"),
    ("Z500.001", "z", "5..500"),
    ("D0.999", "d", "1..50"),
    ("D50.001", "d", "1..50"),
    ("F0.999", "f", ">= 1"),
    ("H0.999", "h", ">= 1"),
    ("I0.999", "i", ">= 1"),
    ("S0.999", "s", "1..100"),
    ("S100.001", "s", "1..100"),
    ("K0.999", "k", "1..50"),
    ("K50.001", "k", "1..50"),
    ("E-5.001", "e", "-5..5"),
    ("E5.001", "e", "-5..5"),
]
ORDER = list(dict.fromkeys(letter for _, letter, _ in RANGES))


@pytest.mark.parametrize(("words", "letter", "limits"), RANGES)
def test_ranges(words: str, letter: str, limits: str) -> None:
    told = errors(f"{READY}G390 {words}\nM2\n")
    assert [(d.code, d.message) for d in told] == [("E0345", f"invalid {letter} param value [valid range {limits}]")]


def test_the_first_failure_wins_in_the_listed_order() -> None:
    wrong = {letter: words for words, letter, _ in reversed(RANGES)}
    for at, letter in enumerate(ORDER):
        told = errors(f"{READY}G390 {' '.join(wrong[one] for one in reversed(ORDER[at:]))}\nM2\n")
        assert [d.message.split()[1] for d in told] == [letter]


LIMITS = ("X5", "X500", "Y5", "Z5", "D1", "D50", "H1", "I1", "S1", "S100", "K1", "K50", "E-5", "E5", "V4", "W9", "F1")


@pytest.mark.parametrize("words", LIMITS)
def test_limits_themselves_are_accepted(words: str) -> None:
    """Nothing is there to touch, so the run ends in alarm 101, not in an error of the words."""
    told = errors(f"{READY}G390 {words}\nM2\n")
    assert [d.code for d in told] == ["operator-stop"]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("X0.1968", "invalid x param value [valid range 0.1969..19.685]"),
        ("Z19.6851", "invalid z param value [valid range 0.1969..19.685]"),
        ("D1.9686", "invalid d param value [valid range 0.0394..1.9685]"),
        ("F0.0393", "invalid f param value [valid range >= 0.0394]"),
        ("S3.9371", "invalid s param value [valid range 0.0394..3.937]"),
        ("K0.0393", "invalid k param value [valid range 0.0394..1.9685]"),
        ("E0.197", "invalid e param value [valid range -0.1969..0.1969]"),
        ("V5", "invalid v param value [valid range 1..4]"),
        ("W10", "invalid w param value [valid range 1..9]"),
    ],
)
def test_ranges_in_inches(words: str, text: str) -> None:
    """The millimeters / 25.4, to four decimals (AMB-G390-2)."""
    assert [d.message for d in errors(f"T9 M6\nG43\nG20 F40\nG390 {words}\nM2\n")] == [text]


@pytest.mark.parametrize(
    ("text", "tool", "message"),
    [
        ("T1 M6\nG390 V9", {}, "required a tool of PROBE type"),
        ("G390", {}, "required a tool of PROBE type"),
        ("T9 M6\nG390 V9", {}, "G43 compensation required but found G49"),
        ("T9 M6\nG43.1 Z5\nG390 V9", {}, "G43 compensation required but found G43.1"),
        ("T9 M6\nG43\nF100\nG390 V9", {"z": 0.0}, "probe tool length invalid"),
        ("T9 M6\nG43\nF100\nG390 V9", {"z": -1.0}, "probe tool length invalid"),
        ("T9 M6\nG43\nG390", {}, "invalid f param value [valid range >= 1]"),
    ],
)
def test_tool_and_compensation(text: str, tool: dict[str, float], message: str) -> None:
    assert [(d.code, d.message) for d in errors(f"{text}\nM2\n", **tool)] == [("E0345", message)]


def test_errors_come_when_compiled() -> None:
    program = aircut.loads("G21 G0 X1\nG390\nM2\n")
    told = program.check()[0]
    assert told.vendor().startswith("[E0345] in line 2 (G390, line ")
    assert told.vendor().endswith(") - required a tool of PROBE type")


@pytest.mark.parametrize("word", ["A1", "B1", "C1", "J1", "M1", "Q1", "R1", "T1", "U1"])
def test_other_words_are_errors(word: str) -> None:
    assert errors(f"{READY}G390 {word}\nM2\n")


def box(x: float, y: float, top: float) -> Body:
    return Body("box", at=(x, y, top - 40.0), size=(100.0, 60.0, 40.0))


def corner(body: Body, vertex: int) -> tuple[float, float, float, float]:
    """X and Y of a corner, and where the stock lies seen from it."""
    left, front = vertex in (1, 2), vertex in (1, 3)
    x = body.at[0] + (0.0 if left else body.size[0])
    y = body.at[1] + (0.0 if front else body.size[1])
    return x, y, 1.0 if left else -1.0, 1.0 if front else -1.0


@pytest.mark.parametrize("vertex", [1, 2, 3, 4])
@pytest.mark.parametrize("radius", [0.5, 2.0, 3.0])
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (-250.5, 120.25, -33.3)])
def test_vertices(vertex: int, radius: float, place: tuple[float, float, float]) -> None:
    body = box(*place)
    x, y, inward_x, inward_y = corner(body, vertex)
    start = (x + 10 * inward_x, y + 10 * inward_y, place[2] + 20)
    text = (
        f"G55\nG10 L2 P2 X7 Y-8 Z9\nG52 X1\nT9 M6\nG43\nG0\nG53 X{start[0]} Y{start[1]} Z{start[2] + LENGTH}\n"
        f"#510=#5001 #511=#5002\nG91 G1 F777\nG390 V{vertex} X40 Y40 W6\n"
        "#500=#5321 #501=#5322 #502=#5323 #503=#5241 #504=#5220\n"
        "#512=#5001 #513=#5002 #514=#5003 #515=#5130 #516=#5103 #517=#5101 #518=#5136 #519=#5137\nM2\n"
    )
    interpreter, simulation = run(text, body, radius=radius)
    assert not interpreter.diagnostics
    values = interpreter.state.numbered
    found = values[500:503]
    assert found == [pytest.approx(v, abs=MICRONS2) for v in (x, y, place[2])]
    assert values[503:505] == [7.0, 2.0]  # the system in force is not touched
    assert values[512:514] == [pytest.approx(v, abs=1e-6) for v in values[510:512]]
    assert values[514] == pytest.approx(place[2] + 10 - 9, abs=MICRONS2)  # 10 above the found top
    assert values[515:520] == [777.0, 91.0, 1.0, 1.0, 1.0]
    assert not simulation.shown


@pytest.mark.parametrize("vertex", [1, 4])
def test_e_enlarges_the_radius(vertex: int) -> None:
    body = box(0.0, 0.0, 0.0)
    x, y, inward_x, inward_y = corner(body, vertex)
    text = (
        f"{READY}G0 X{x + 10 * inward_x} Y{y + 10 * inward_y} Z20\nG390 V{vertex} E0.25\n"
        "#500=#5221 #501=#5222 #502=#5223\nM2\n"
    )
    found = run(text, body)[0].state.numbered[500:503]
    wanted = (x + 0.25 * inward_x, y + 0.25 * inward_y, 0.0)
    assert found == [pytest.approx(v, abs=MICRONS2) for v in wanted]


def test_in_inches() -> None:
    text = f"{READY}G0 X10 Y10 Z20\nG20 F40\nG390 H20 I2\nG21\n#500=#5221 #501=#5222 #502=#5223 #503=#5003\nM2\n"
    interpreter, _ = run(text, box(0.0, 0.0, 0.0))
    assert not interpreter.diagnostics
    values = interpreter.state.numbered[500:504]
    assert values == [pytest.approx(v, abs=MICRONS2) for v in (0.0, 0.0, 0.0, 10.0)]


def test_alarms() -> None:
    stock = box(0.0, 0.0, 0.0)
    post = Body("box", at=(-60.0, 0.0, -50.0), size=(30.0, 40.0, 80.0))  # in the way out toward X-
    cases = {
        100: (f"{READY}G0 X10 Y10 Z-1\nG390\nM2\n", [stock]),
        101: (f"{READY}G0 X10 Y10 Z60\nG390\nM2\n", [stock]),
        104: (f"{READY}G0 X10 Y10 Z20\nG390\nM2\n", [stock, post]),
    }
    texts = {
        100: "Sensor was found already tripped before to start 1st touch movements !",
        101: "Sensor was not found during 1st touch movements !",
        104: "Sensor collision during safe movements !",
    }
    for number, (text, bodies) in cases.items():
        told = errors(text, *bodies)
        assert [d.code for d in told] == ["operator-stop"], number
        assert texts[number] in told[0].message
        assert str(number) in told[0].message


def test_g250_after_g390() -> None:
    """003's example: from corner 1 of a stock of 100 by 50 by 50 to its middle."""
    stock = Body("box", at=(20.0, 30.0, -50.0), size=(100.0, 50.0, 50.0))
    text = f"G54\n{READY}G0 X30 Y40 Z20\nG390\nG250 X50 Y25 Z-25\n#500=#5221 #501=#5222 #502=#5223\nM2\n"
    interpreter, _ = run(text, stock)
    assert not interpreter.diagnostics
    found = interpreter.state.numbered[500:503]
    assert found == [pytest.approx(v, abs=MICRONS2) for v in (70.0, 55.0, -25.0)]


@pytest.mark.parametrize("word", ["W0", "W10", "W1.5", "W-1"])
def test_g250_refuses_systems_that_are_none(word: str) -> None:
    assert [(d.code, d.message) for d in errors(f"G250 X1 {word}\nM2\n")] == [
        ("E0345", "invalid w param value [valid range 1..9]")
    ]


@pytest.mark.parametrize("word", ["D1", "E1", "F1", "H1", "I1", "J1", "K1", "Q1", "R1", "S1", "V1"])
def test_g250_refuses_other_words(word: str) -> None:
    assert errors(f"G250 X1 {word}\nM2\n")


def test_alarms_of_the_second_touch(monkeypatch: pytest.MonkeyPatch) -> None:
    replies = {102: -2, 103: -1}
    touch = Simulation.probe
    for number, state in replies.items():
        count = []

        def second(self: Simulation, request: Probe, state: int = state, count: list[int] = count) -> Probed:
            count.append(1)
            return Probed(state, request.start) if len(count) == 2 else touch(self, request)

        monkeypatch.setitem(Simulation.ANSWERS, Probe, second)
        told = errors(f"{READY}G0 X10 Y10 Z20\nG390\nM2\n", box(0.0, 0.0, 0.0))
        assert [d.code for d in told] == ["operator-stop"]
        assert f"Alarm {number}" in told[0].message and "2nd touch movements !" in told[0].message
