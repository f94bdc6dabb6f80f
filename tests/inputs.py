"""Inputs of every kind, made from bytes: what the fuzzers and the fixed samples run.

Bytes are read as choices (`Choices`), so the same bytes always make the same input;
a fuzzer that is guided by coverage, a random generator and Hypothesis can all drive it.
`one(data)` runs one input and raises only where aircut is at fault: a traceback, a
diagnostic without a place, a run that does not end.
"""

from __future__ import annotations

import signal
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import aircut
import cases
from aircut import dialects
from aircut.api import Limits
from aircut.controller import Simulation, World, WorldError
from aircut.controller import load as load_world
from aircut.diagnostics import Severity
from aircut.language.arithmetic import FUNCTIONS, OPERATORS
from aircut.machine import Machine, MachineError, built_in, load, memory, ngx
from aircut.machine.imports import read_tools
from aircut.rules import RulesError
from aircut.rules.policy import read as read_project

ROOT = Path(__file__).parent.parent
LIMITS = Limits(blocks=1500, moves=50_000)
PATIENCE = 20  # seconds of work after which an input counts as one that hangs
HOLDER = tempfile.TemporaryDirectory(prefix="aircut-inputs-")  # gone when the process ends
FOLDER = Path(HOLDER.name)


class Choices:
    """Bytes read as choices; behind their end everything is the first of its kind."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def __bool__(self) -> bool:
        return self.at < len(self.data)

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def pick(self, items: Sequence[Any]) -> Any:
        number = self.byte() if len(items) <= 256 else self.byte() << 8 | self.byte()
        return items[number % len(items)]

    def rest(self) -> bytes:
        return self.data[self.at :]


# --- programs

NUMBERS = ("0", "1", "2", "3", "-1", "10", ".5", "-2.5", "100", "1000.125", "0.0001", "1.00004", "-0",
           "99999999999", "9" * 40, "9" * 400, "33", "34", "500", "4000", "5220", "5730", "6000", "7000",
           "5", "4", "7", "12")  # fmt: skip
PRELUDE = (
    "G17 G21 G90 G54 M3 S1000 F500 G0\n#1=1 #2=2.5 #3=0 #4=-4 #5=5 #6=30 #7=7 #8=0\n#<a>=1 #<_b>=2 #<xy>=3 #<list[1]>=4"
)
NAMES = ("a", "_b", "x y", "list[1]", "list[#1]", "_args.a", "cnc.axis_mask", "tool.diameter", "_")
CONDITIONS = ("EQ", "NE", "GT", "GE", "LT", "LE")
STRUCTURE = ("IF [{c}] THEN {i}", "ELIF [{c}] THEN {i}", "ELSE {i}", "END {i}", "WHILE [{c}] DO{i}",
             "END{i}", "BREAK {i}", "IF [{c}] BREAK {i}", "IF [{c}] GOTO {n}", "GOTO {n}", "N{n}",
             "N{n} X{v}", "O{n}", 'SUB "{n}"', "M99", "ENDSUB", "RETURN", "%", "M2", "M30", "M47")  # fmt: skip
CALLS = ("M98 P{n}", "M98 P{n} L{v}", "G65 P{n} A{v} X{v}", "CALL {n} B{v}", 'G65 P"{n}" Z{v}',
         "G66 P{n} A{v}", "G67", 'M98 P"helper"', "M6 T{n}", "G250 X{v}", "G390 X{v} Y{v}", "M60",
         "M200 A{v}")  # fmt: skip
OTHERS = ('M109 P"text #{n} #<a> <b>{v}</b>" Q{n}', 'M120 P"{v}" Q{n}', "(comment {v})", "; {v}", "/G0 X{v}",
          "(aircut: ignore no-feed)", "(MSG, {v})", "G100 P{n} A{v}", "G#1", "M#{n}", "G[{v}] X1")  # fmt: skip
POISON = (
    "",
    "#",
    "[",
    "]",
    '"',
    "(",
    ")",
    "=",
    "\0",
    "\xff",
    "G",
    "X",
    "\t",
    ";",
    "/",
    "?",
    "\r",
    "**",
    "[[",
    "#<",
    ">",
    ",",
)


@cache
def rows(dialect: str) -> list[Any]:
    """The codes of a dialect; user defined ones but for a few."""
    tables = dialects.load(dialect)
    every = [row for row in tables.codes.values() if row.title != "User defined code"]
    return [*every, *(row for row in tables.settings.values())]


class Writer:
    """Writes a program of the language, mostly well formed."""

    def __init__(self, choices: Choices, dialect: str) -> None:
        self.choices = choices
        self.dialect = dialect

    def text(self) -> str:
        lines = [PRELUDE] if self.choices.byte() & 3 else []
        while self.choices and len(lines) < 80:
            line = self.block() if self.choices.byte() < 40 else self.line()
            if self.choices.byte() > 248:
                at = self.choices.byte() % (len(line) + 1)
                line = line[:at] + self.choices.pick(POISON) + line[at:]
            lines.append(line)
        return "\n".join(lines)

    def block(self) -> str:
        """Some lines between the marks of an IF or a WHILE, or a subroutine after the end."""
        id = self.id()
        inner = "\n".join(self.line() for _ in range(self.choices.byte() % 4))
        kind = self.choices.byte() % 5
        if kind < 2:
            return f"IF [{self.condition()}] THEN {id}\n{inner}\nELSE {id}\n{self.line()}\nEND {id}"
        if kind < 4:
            return f"#3=0\nWHILE [#3 LT {id}] DO {id}\n#3=[#3+1]\n{inner}\nEND {id}"
        return f"M2\nO{id}\n{inner}\nM99"

    def line(self) -> str:
        kind = self.choices.byte() % 16
        if kind < 7:
            return self.words()
        if kind < 9:
            return f"{self.target()}={self.value()}"
        if kind < 12:
            return self.filled(self.choices.pick(STRUCTURE))
        if kind < 14:
            return self.filled(self.choices.pick(CALLS))
        if kind < 15:
            return self.filled(self.choices.pick(OTHERS))
        return f"IF [{self.condition()}] THEN {self.words()}"

    def filled(self, form: str) -> str:
        for mark, make in (("{c}", self.condition), ("{v}", self.value), ("{i}", self.id), ("{n}", self.id)):
            while mark in form:
                form = form.replace(mark, make(), 1)
        return form

    def id(self) -> str:
        return str(1 + self.choices.byte() % 4)

    def words(self) -> str:
        found = []
        for _ in range(self.choices.byte() % 3):
            row = self.choices.pick(rows(self.dialect))
            found.append(row.name)
            found += [letter.upper() + self.value() for letter in row.needs if letter.isalpha()]
            if row.takes and self.choices.byte() & 1:
                found.append(self.choices.pick(row.takes.upper()) + self.value())
        for letter in "XYZ" if self.choices.byte() < 200 else "XYZABCIJKFSRPQ@^UVW":
            if self.choices.byte() < 60:
                found.append(letter + self.value())
        return " ".join(found)

    def target(self) -> str:
        kind = self.choices.byte() % 8
        if kind < 4:
            return f"#{1 + self.choices.byte() % 8}"
        if kind < 6:
            return f"#<{self.choices.pick(NAMES)}>"
        return "#" + (self.choices.pick(NUMBERS) if kind < 7 else f"[{self.value(1)}]")

    def value(self, depth: int = 0) -> str:
        kind = self.choices.byte() % 16
        if kind < 7 or depth > 4:
            return str(self.choices.byte() % 20)
        if kind < 8:
            return str(self.choices.pick(NUMBERS))
        if kind < 11:
            return self.choices.pick(("", "", "-", "+")) + self.target()
        if kind < 14:
            operator = self.choices.pick(OPERATORS).name.upper()
            return f"[{self.value(depth + 1)} {operator} {self.value(depth + 1)}]"
        function = self.choices.pick(FUNCTIONS)
        if function.arguments == "two":
            return f"{function.name.upper()}[{self.value(depth + 1)}]/[{self.value(depth + 1)}]"
        inner = "#<a>" if function.arguments == "name" else self.value(depth + 1)
        return f"{function.name.upper()}[{inner}]"

    def condition(self) -> str:
        return f"{self.value(1)} {self.choices.pick(CONDITIONS)} {self.value(1)}"


def machine(choices: Choices) -> Machine:
    made = built_in(choices.pick(("XYZ", "XYZABC", "X", "XYZAC")))
    made.macros = (helpers(),)
    made.key = "key"
    return made


@cache
def helpers() -> Path:
    """A folder of macros."""
    folder = FOLDER / "macros"
    folder.mkdir(exist_ok=True)
    (folder / "helper.ngc").write_text("#500=[#500+1]\nIF [#500 GT 3] THEN M99\nG0 X#500\nM99\n")
    (folder / "M200.ngc").write_text("G91 G1 X1 F100\nG90\nM99\n")
    (folder / "1.ngx").write_bytes(b"\x89AIRCUT\nrubbish")
    return folder


def fit(text: str | bytes, dialect: str, made: Machine, world: World | None = None) -> None:
    """Check, run or simulate a program: no traceback, diagnostics with places, a check that tells what a run does."""
    program = aircut.loads(text, dialect=dialect)
    if world is not None:
        interpreter = program.interpreter(made, limits=LIMITS)
        for _ in Simulation(interpreter, world).run():
            pass
        diagnostics = interpreter.diagnostics
    else:
        diagnostics = program.check(made, limits=LIMITS)
        failed = any(d.severity is Severity.ERROR for d in diagnostics)
        result = program.run(made, limits=LIMITS)
        assert result.ok or failed, "the run finds an error that the check does not"
        list(result.canon())
    for diagnostic in diagnostics:
        assert diagnostic.message and str(diagnostic)
        if diagnostic.span.line and diagnostic.file == program.source.name:
            assert diagnostic.span.line <= max(len(program.source), 1), "line of a diagnostic"
            width = len(program.source.text(diagnostic.span.line - 1))
            assert 1 <= diagnostic.span.column <= width + 1, f"column of {diagnostic!r}"
            assert diagnostic.span.column < diagnostic.span.end <= width + 2 or width == 0, f"end of {diagnostic!r}"


def dialect_of(choices: Choices) -> str:
    return str(choices.pick(sorted(dialects.DIALECTS)))


def raw(choices: Choices) -> None:
    """Any bytes as a program."""
    dialect, made = dialect_of(choices), machine(choices)
    fit(choices.rest(), dialect, made)


def written(choices: Choices) -> None:
    """A program of the language."""
    dialect, made = dialect_of(choices), machine(choices)
    fit(Writer(choices, dialect).text().encode("utf-8", "replace"), dialect, made)


@cache
def programs() -> list[bytes]:
    """Programs that mean something: the conformance cases' and the examples."""
    texts = [cases.read(path).program.encode() for path in sorted(cases.CONFORMANCE.rglob("*.case"))]
    return texts + [path.read_bytes() for path in sorted((ROOT / "examples").glob("*.ngc"))]


def changed(choices: Choices) -> None:
    """A program that means something, with some of it changed."""
    dialect, made = dialect_of(choices), machine(choices)
    text = choices.pick(programs())
    for _ in range(choices.byte() % 6):
        text = mutated(text, choices)
    fit(text, dialect, made)


def mutated(text: bytes, choices: Choices) -> bytes:
    lines = text.split(b"\n")
    at = choices.pick(range(len(lines)))
    place = (choices.byte() << 8 | choices.byte()) % (len(text) + 1)
    match choices.byte() % 8:
        case 0:
            del lines[at]
        case 1:
            lines.insert(at, choices.pick(lines))
        case 2:
            lines.insert(at, choices.pick(choices.pick(programs()).split(b"\n")))
        case 3:
            return text[:place] + text[place + 1 :]
        case 4:
            return text[:place] + bytes([choices.byte()]) + text[place:]
        case 5:
            return text[:place] + choices.pick(POISON).encode("latin-1") + text[place:]
        case 6:
            return text[:place] + choices.pick(NUMBERS).encode() + text[place + 1 :]
        case _:
            return text[:place]
    return b"\n".join(lines)


def simulated(choices: Choices) -> None:
    """A program in a world."""
    dialect, made = dialect_of(choices), machine(choices)
    world = World(choices.pick(worlds()))
    text = (
        Writer(choices, dialect).text().encode("utf-8", "replace")
        if choices.byte() & 1
        else mutated(choices.pick(programs()), choices)
    )
    fit(text, dialect, made, world)


@cache
def worlds() -> list[Any]:
    from aircut.controller.world import Body, File, Input, Reply

    box = Body("box", (-5.0, -5.0, -20.0), (10.0, 10.0, 10.0))
    ball = Body("sphere", (3.0, 0.0, -5.0), radius=4.0)
    return [
        File(),
        File([box, ball], [Input(1, value=1.0), Input(2, sequence=[0.0, 1.0, 0.0])]),
        File([ball], [Input(1, times=[(0.5, 1.0), (2.0, 0.0)])], [Reply(values=[1.0, None, 3.0]), Reply(stop=True)]),
    ]


# --- files

KEYS = ("id", "x", "z", "diameter", "type", "slot", "description", "axes", "X", "A", "min", "max",
        "velocity", "options", "units", "kinematics", "rotary_table", "d_x", "bodies", "shape", "at",
        "size", "radius", "height", "file", "inputs", "number", "value", "times", "sequence", "operator",
        "values", "stop", "overshoot", "tools", "length", "spindle", "axis", "analog", "rules", "name",
        "system", "version")  # fmt: skip
VALUES = ("1", "-1", "0", "0.5", "1e400", "nan", "inf", "'box'", "'sphere'", "'cylinder'", "'stl'",
          "'rotary_table_ac'", "[1.0, 2.0, 3.0]", "[[0.0, 1.0]]", "[]", "{}", "true", "'../x'", "''",
          "99999999999999999999", "20", "'off'")  # fmt: skip
TOML = ("[[tools]]", "[axes.X]", "[axes.A]", "[options]", "[[bodies]]", "[[inputs]]", "[[operator]]",
        "[spindle]", "[system]", "[rules]", "[")  # fmt: skip
TABLE = ("T1 P1 Z5.0 D3 ;end mill", "T2", "P3 T4", "T1 P1 Z-", "T99999999999 P1", ";", "T3 P3 X1e400",
         "T5 P5 Dnan", "T1T1", "T2.5 P2", "\0", "Tool 1", "T7 P7 Q5 I1 J2")  # fmt: skip
PARAMETERS = (
    "5161 1.0",
    "4000 nan",
    "100 5",
    "5220 3",
    "5221 1e400",
    "x y",
    "5161",
    "-1 3",
    "99999 1",
    "4001\t-2.5",
    "5220 99",
)
JSON = ('{"data":[', "]}", '{"post-process":{"number":1}', '"geometry":{"DC":', '"NaN"', "1e999", "-5",
        "null", "[", "]", "{", "}", ",", ":", '"unit":"inches"', '"type":"probe"', '"type":"drill"',
        '"guid":', "true", '""')  # fmt: skip


def toml(choices: Choices) -> str:
    lines = []
    while choices and len(lines) < 40:
        kind = choices.byte() % 8
        if kind < 2:
            lines.append(choices.pick(TOML))
        elif kind < 7:
            lines.append(f"{choices.pick(KEYS)} = {choices.pick(VALUES)}")
        else:
            lines.append(choices.pick(POISON))
    return "\n".join(lines)


def picked(items: Sequence[str], between: str) -> Callable[[Choices], str]:
    def make(choices: Choices) -> str:
        found = []
        while choices and len(found) < 60:
            found.append(choices.pick(items) if choices.byte() < 240 else choices.pick(POISON))
        return between.join(found)

    return make


def parameters(path: Path) -> None:
    memory.read_parameters(path, memory.PERSISTENT)


#: Files: suffix or name, what makes the text, what reads it, and what the reader may raise.
FILES: tuple[tuple[str, Callable[[Choices], str], Callable[[Path], Any], type[Exception]], ...] = (
    ("tools.toml", toml, read_tools, MachineError),
    ("tool.tbl", picked(TABLE, "\n"), read_tools, MachineError),
    ("library.json", picked(JSON, ""), read_tools, MachineError),
    ("machine.toml", toml, lambda path: load(path.parent), MachineError),
    ("world.toml", toml, load_world, WorldError),
    ("aircut.toml", toml, read_project, RulesError),
    (
        "linuxcnc.var",
        picked(PARAMETERS, "\n"),
        lambda path: memory.read_parameters(path, memory.PERSISTENT),
        MachineError,
    ),
)


def file(choices: Choices) -> None:
    """A file other than a program: read, or refused with a reason."""
    name, make, read, refusal = choices.pick(FILES)
    text = choices.rest() if choices.byte() < 50 else make(choices).encode("utf-8", "replace")
    path = FOLDER / name
    path.write_bytes(text)
    try:
        read(path)
    except refusal as error:
        assert name.split(".")[1] in str(error) or str(path) in str(error), f"the file is not named: {error}"
    finally:
        path.unlink()


@cache
def container() -> bytes:
    return ngx.encrypt(b"G0 X1\nM99\n", "key")


def encrypted(choices: Choices) -> None:
    """An encrypted macro, damaged or not; the cost of its key is kept low."""
    import hashlib

    data = bytearray(container()[: -ngx.DIGEST])
    data[10:13] = bytes([1 + choices.byte() % 4, 1 + choices.byte() % 3, 1])
    for _ in range(choices.byte() % 4):
        data[choices.byte() % len(data)] = choices.byte()
    data[10] = min(data[10], 19) if data[10] > 18 else min(data[10], 4)
    body = bytes(data[: len(data) - choices.byte() % 8])
    made = body + (hashlib.sha256(body).digest() if choices.byte() & 1 else choices.rest())
    try:
        ngx.decrypt(made, choices.pick(("key", "", "x")))
    except ngx.NgxError as error:
        assert str(error)


TARGETS: tuple[Callable[[Choices], None], ...] = (
    written, written, written, changed, changed, raw, simulated, simulated, file, encrypted,
)  # fmt: skip


class Hang(Exception):
    """An input took longer than PATIENCE."""


def hang(_signal: int, _frame: Any) -> None:
    raise Hang(f"no end after {PATIENCE} s")


def one(data: bytes) -> None:
    """Run one input; raises only where aircut is at fault."""
    choices = Choices(data)
    target = choices.pick(TARGETS)
    before = signal.signal(signal.SIGPROF, hang)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        target(choices)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
