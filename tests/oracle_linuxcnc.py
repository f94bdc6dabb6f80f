# ruff: noqa: E501
"""Random programs of LinuxCNC's own language, valid and not, to compare with its interpreter."""

from __future__ import annotations

import random
import subprocess
from collections.abc import Callable
from math import atan2, cos, hypot, pi, sin
from pathlib import Path
from typing import NamedTuple

import oracle

FUNCTIONS = ("abs", "acos", "asin", "cos", "exp", "fix", "fup", "round", "ln", "sin", "sqrt", "tan")
OPERATORS = ("+", "-", "*", "/", "mod", "**", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor")
PLANES = {"G17": "XYIJZK", "G18": "XZIKYJ", "G19": "YZJKXI"}
#: What stands between the moves of a contour.
COMPENSATED = (
    "G1 Z3", "S300", "G4 P1", "(note)", "F100", "M8", "(MSG,hi)", "T1", "G7\nG8", "G91\nG90", "G61", "G64 P.1", "G97 S30",
    "M3", "M5", "M9", "G90.1\nG91.1", "G94 F80", "M64 P1", "M65 P1", "M62 P2", "M68 E1 Q3", "(DEBUG,#5420 #<_x> #<_y>)",
    "#1=[#1+1]", "M70", "M72", "M19 R30", "G96 S20 D300", "M66 P0 L0", "(PRINT,#5421)", "G52 X0", "G21", "M7", "G4 P0.5", "M0",
    "M0\nG1 Z2", "M60", "M0\nM0", "M1", "M0\nG0 Z3\nG1 Z1", "G1 Z2\nM0", "M6", "A5", "M0\nA7",
    "G10 L1 P2 R1", "G10 L10 P2 X1 Y2", "G10 L11 P2 Z3", "G10 L20 P2 X1 Y2", "#1=#<_abs_x> #2=#<_abs_y>",
    "(DEBUG,#<_abs_x> #<_abs_y> #5420)",
)  # fmt: skip
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
CODES = [
    "G0",
    "G1",
    "G2",
    "G3",
    "G4",
    "G5",
    "G5.1",
    "G5.2",
    "G5.3",
    "G7",
    "G8",
    "G10",
    "G17",
    "G18",
    "G19",
    "G17.1",
    "G18.1",
    "G19.1",
    "G20",
    "G21",
    "G28",
    "G28.1",
    "G30",
    "G30.1",
    "G33",
    "G33.1",
    "G38.2",
    "G38.3",
    "G38.4",
    "G38.5",
    "G40",
    "G41",
    "G42",
    "G41.1",
    "G42.1",
    "G43",
    "G43.1",
    "G43.2",
    "G49",
    "G52",
    "G53",
    "G54",
    "G55",
    "G59.3",
    "G61",
    "G61.1",
    "G64",
    "G73",
    "G74",
    "G76",
    "G80",
    "G81",
    "G82",
    "G83",
    "G84",
    "G85",
    "G86",
    "G87",
    "G88",
    "G89",
    "G90",
    "G91",
    "G90.1",
    "G91.1",
    "G92",
    "G92.1",
    "G92.2",
    "G92.3",
    "G93",
    "G94",
    "G95",
    "G96",
    "G97",
    "G98",
    "G99",
    "G11",
    "G50",
    "G68",
    "G99.9",
    "G100",
]
M_CODES = [
    "M0",
    "M1",
    "M3",
    "M4",
    "M5",
    "M6",
    "M7",
    "M8",
    "M9",
    "M19",
    "M48",
    "M49",
    "M50",
    "M51",
    "M52",
    "M53",
    "M60",
    "M61",
    "M62",
    "M63",
    "M64",
    "M65",
    "M66",
    "M67",
    "M68",
    "M70",
    "M71",
    "M72",
    "M73",
    "M20",
    "M100",
    "M150",
    "M200",
    "M98",
    "M99",
    "M2",
    "M30",
]
NAMES = [
    "_vmajor",
    "_vminor",
    "_metric_machine",
    "_line",
    "_motion_mode",
    "_plane",
    "_ccomp",
    "_metric",
    "_imperial",
    "_absolute",
    "_incremental",
    "_inverse_time",
    "_units_per_minute",
    "_units_per_rev",
    "_coord_system",
    "_tool_offset",
    "_retract_r_plane",
    "_retract_old_z",
    "_spindle_rpm_mode",
    "_spindle_css_mode",
    "_ijk_absolute_mode",
    "_lathe_diameter_mode",
    "_lathe_radius_mode",
    "_spindle_on",
    "_spindle_cw",
    "_mist",
    "_flood",
    "_speed_override",
    "_feed_override",
    "_adaptive_feed",
    "_feed_hold",
    "_feed",
    "_rpm",
    "_current_tool",
    "_current_pocket",
    "_selected_tool",
    "_selected_pocket",
    "_x",
    "_y",
    "_z",
    "_a",
    "_b",
    "_c",
    "_u",
    "_v",
    "_w",
    "_abs_x",
    "_abs_y",
    "_abs_z",
    "_abs_a",
    "_abs_b",
    "_abs_c",
    "_value",
    "_value_returned",
    "_task",
    "_call_level",
    "_remap_level",
]


DETAIL = "num_spindles"  # begins a line between a message and the line of the program


#: What a program can read of the machine.
STATE = (
    "#<_x> #<_y> #<_z> #<_a> #<_abs_x> #<_abs_z> #5061 #5063 #5070 #5211 #5220 #5221 #5223 #5399 #5400 #5403 #5410 #5413 "
    "#5420 #5421 #5422 #5600 #<_motion_mode> #<_plane> #<_metric> #<_absolute> #<_feed> #<_rpm> #<_value> #<_call_level> "
    "#<_tool_offset> #<_selected_tool> #<_current_pocket> #<_value_returned> #<_ccomp> #<_coord_system>"
)


class Answer(NamedTuple):
    """What the interpreter made of a program. line: text of the one it refused, message: why."""

    listing: list[str]
    accepted: bool
    message: str
    line: str


def ask(text: str, folder: Path) -> Answer:
    """Run a program. folder: its own, to write in."""
    file = folder / "program.ngc"
    file.write_text(text)
    assert oracle.PROGRAM
    done = subprocess.run([oracle.PROGRAM, "-g", str(file)], capture_output=True, text=True, timeout=10, cwd=folder,
                          env={"HOME": str(folder)})  # fmt: skip
    told = [line for line in done.stderr.splitlines()[1:] if done.returncode and not line.startswith(DETAIL)] + ["", ""]
    return Answer(done.stdout.splitlines(), done.returncode == 0, told[0], told[1].strip())


class Writer:
    """Writes one random program. Topics are methods that return a line or a few."""

    def __init__(self, seed: int, only: str = "") -> None:
        self.random = random.Random(seed)
        self.plane = "G17"
        self.absolute = True
        self.inverse = False
        self.known: list[str] = []
        self.label = 100
        self.depth = 0
        self.subs: list[str] = []
        self.behind: list[str] = []  # what follows the end of the program: subroutines of M98
        self.faulty = self.random.choice((0.0, 0.0, 0.0, 0.03, 0.15))
        self.odd = self.random.choice((0.0, 0.0, 0.1))  # strange spellings
        topics: dict[str, tuple[Callable[[], str], int]] = {
            "straight": (self.straight, 8),
            "arc": (self.arc, 4),
            "polar": (self.polar, 1),
            "mode": (self.mode, 6),
            "offset": (self.offset, 4),
            "setting": (self.setting, 4),
            "auxiliary": (self.auxiliary, 4),
            "tool": (self.tool, 3),
            "comment": (self.comment, 2),
            "home": (self.home, 2),
            "probe": (self.probe, 1),
            "flow": (self.flow, 4),
            "call": (self.call, 2),
            "saved": (self.saved, 1),
            "cycle": (self.cycle, 3),
            "spline": (self.spline, 1),
            "thread": (self.thread, 1),
            "compensation": (self.compensation, 1),
            "show": (self.show, 3),
            "fanuc": (self.fanuc, 1),
            "indirect": (self.indirect, 1),
            "recursion": (self.recursion, 1),
        }
        wanted = only.split(",") if only else list(topics)
        self.codes = [code for code in CODES if "compensation" in wanted or code[:3] not in ("G41", "G42")]
        self.topics = [method for name in wanted for method in [topics[name][0]] * topics[name][1]]

    # --- pieces

    def chance(self, share: float) -> bool:
        return self.random.random() < share

    def pick(self, items: object) -> str:
        return self.random.choice(items.split() if isinstance(items, str) else list(items))  # type: ignore[call-overload]

    def literal(self, low: float = -50.0, high: float = 50.0) -> str:
        value = self.random.uniform(low, high)
        text = f"{value:.{self.random.choice((0, 1, 2, 3, 4))}f}"
        if self.chance(self.odd):
            text = self.pick(
                (f"+{text}" if value > 0 else text, f"{text}.".replace("..", "."), f"--{text.lstrip('-')}")
            )
            if text.count(".") > 1:
                text = text.rstrip(".")
        return text

    def value(self, low: float = -50.0, high: float = 50.0) -> str:
        """A literal, a variable or an expression."""
        share = self.random.random()
        if share < 0.75 or not self.known:
            return self.literal(low, high)
        if share < 0.85:
            return self.pick(self.known)
        return f"[{self.expression(2)}]" if self.chance(0.7) else self.function(1)

    def expression(self, depth: int) -> str:
        parts = [self.operand(depth)]
        for _ in range(self.random.choice((0, 1, 1, 2, 3))):
            parts += [self.pick(OPERATORS if self.chance(0.6) else "+ - *"), self.operand(depth)]
        return (" " if self.chance(0.7) else "").join(parts)

    def operand(self, depth: int) -> str:
        share = self.random.random()
        if self.chance(0.06):
            return self.pick(STATE)
        if depth == 0 or share < 0.5:
            return self.literal(-5, 5)
        if share < 0.7 and self.known:
            return self.pick(self.known)
        if share < 0.85:
            return f"[{self.expression(depth - 1)}]"
        return self.function(depth - 1)

    def function(self, depth: int) -> str:
        if self.chance(0.1):
            return f"atan[{self.expression(depth)}]/[{self.expression(depth)}]"
        if self.chance(0.1):
            return f"fix[{self.pick('sin cos tan')}[{self.pick('0 30 45 60 90 120 150 180 210 330')}]*{self.pick('2 10 100')}]"
        if self.chance(0.1):
            return f"exists[#{self.pick(('<_x>', '<nn>', '31', '5', '7000'))}]"
        return f"{self.pick(FUNCTIONS)}[{self.expression(depth)}]"

    def words(self, axes: str, least: int = 1, low: float = -50.0, high: float = 50.0) -> str:
        count = self.random.randint(least, len(axes))
        return " ".join(f"{axis}{self.value(low, high)}" for axis in self.random.sample(axes, count))

    def feed(self) -> str:
        if self.inverse:
            return f" F{self.literal(0.5, 9)}"
        return f" F{self.literal(1, 2000)}" if self.chance(0.2) else ""

    # --- topics

    def straight(self) -> str:
        axes = "XYZABC" if self.chance(0.3) else "XYZ"
        if self.chance(0.3):
            return self.words(axes) + self.feed()
        code = self.pick("G0 G1 G00 G01")
        if self.chance(0.05):
            return code + self.feed()
        prefix = "G53 " if self.absolute and self.chance(0.1) else ""
        return prefix + f"{code} {self.words(axes)}" + (self.feed() if "1" in code else "")

    def arc(self) -> str:
        first, second, i, j, across, _ = PLANES[self.plane]
        code = self.pick("G2 G3")
        back = "G90" if self.absolute else "G91"
        share = self.random.random()
        turns = f" P{self.random.randint(1, 3)}" if self.chance(0.2) else ""
        rise = f" {self.words(across + 'ABC', 1)}" if self.chance(0.3) else ""
        if share < 0.4:
            r = self.random.randint(1, 20)
            return f"G91 {code} {first}{r} {second}{r} {i}{r} {j}0{rise}{turns}{self.feed()}\n{back}"
        if share < 0.6:
            return f"{code} {i}{self.value(1, 9)} {j}{self.value(1, 9)}{rise}{turns}{self.feed()}"
        if share < 0.9:
            r = self.random.choice((-1, 1)) * self.random.randint(20, 90)
            step = f"{first}{self.literal(1, 20)} {second}{self.literal(1, 20)}"
            return f"G91 {code} {step} R{r}{rise}{turns}{self.feed()}\n{back}"
        return f"{code} {self.words('XYZIJKRP')}{self.feed()}"

    def polar(self) -> str:
        text = self.pick(
            (f"@{self.value(1, 30)} ^{self.value(0, 360)}", f"^{self.value(0, 360)}", f"@{self.value(1, 20)}")
        )
        return f"{self.pick(('G0', 'G1', ''))} {text}{self.feed()}"

    def mode(self) -> str:
        pick = self.random.randint(0, 12)
        if pick == 0:
            self.plane = self.random.choice(list(PLANES))
            return self.plane
        if pick == 1:
            self.absolute = not self.absolute
            return "G90" if self.absolute else "G91"
        if pick == 2:
            return self.pick("G20 G21")
        if pick == 3:
            self.inverse = not self.inverse
            return "G93" if self.inverse else "G94 F200"
        if pick == 4:
            return self.pick(("G61", "G61.1", "G64", "G64 P0.1 Q0.2", "G64 P0.3", "G64 Q0.1", "G64 P0 Q0"))
        if pick == 5:
            return self.pick("G40 G49 G98 G99 G7 G8")
        if pick == 6:
            return "G80"
        if pick == 7:
            return self.pick(("G96 S100", "G96 D2000 S50", "G97 S1000", "G97", "S0", "G96 D-3 S1"))
        if pick == 8 and not self.inverse:
            return self.pick(("G95 S100 F0.2", "G94 F100"))
        if pick == 9:
            return self.pick(("G90.1\nG91.1", "G91.1", "G90.1"))
        if pick == 10:
            codes = self.random.sample(
                ["G17", "G21", "G40", "G49", "G54", "G80", "G90", "G94", "G98", "G64", "M5", "M9"], 5
            )
            self.plane = "G17" if "G17" in codes else self.plane
            self.absolute = True if "G90" in codes else self.absolute
            self.inverse = False if "G94" in codes else self.inverse
            return " ".join(codes) + " F150"
        return f"F{self.literal(0, 500)}" if not self.inverse else "G4 P0.5"

    def offset(self) -> str:
        pick = self.random.randint(0, 8)
        axes = "XYZABC" if self.chance(0.5) else "XYZ"
        if pick == 0:
            return self.pick(SYSTEMS)
        if pick == 1:
            turn = f" R{self.literal(-180, 180)}" if self.chance(0.3) else ""
            return f"G10 L2 P{self.random.randint(0, 9)} {self.words(axes, 0)}{turn}"
        if pick == 2:
            return f"G10 L20 P{self.random.randint(0, 9)} {self.words(axes)}"
        if pick == 3:
            return self.pick("G92.1 G92.2 G92.3")
        if pick == 4:
            return f"G10 L{self.pick('1 10 11')} P{self.pick('1 2 3')} {self.tool_words()}"
        if pick == 5:
            return f"#{self.pick('5221 5222 5230 5241 5211 5210 5161 5220')}={self.literal(-3, 3)}"
        return f"{self.pick('G52 G92')} {self.words(axes)}"

    def tool_words(self) -> str:
        letters = {"X": "-9 9", "Z": "-9 9", "R": "0 3", "I": "-90 90", "J": "-90 90", "A": "-9 9"}
        chosen = self.random.sample(list(letters), self.random.randint(1, 3))
        words = [f"{c}{self.literal(*map(float, letters[c].split()))}" for c in chosen]
        return " ".join(words) + (f" Q{self.random.randint(0, 9)}" if self.chance(0.3) else "")

    def setting(self) -> str:
        share = self.random.random()
        if share < 0.6:
            name = f"#{self.random.randint(1, 12) if self.chance(0.5) else self.random.randint(31, 40)}"
        elif share < 0.8:
            name = f"#<{self.pick('a b c')}>"
        else:
            name = f"#<_{self.pick('a b C')}>"
        text = f"{name}={self.value()}"
        if name not in self.known and self.depth == 0:
            self.known.append(name)
        if self.chance(0.1):
            text += f" {name}={self.value()}"
        if self.chance(0.1):
            text += f" G1 X{name} F100" if not self.inverse and name in self.known and "<" not in name else ""
        return text

    def auxiliary(self) -> str:
        return self.pick((
            f"S{self.literal(100, 9000)} M3", "M4", "M5", "M3 S500", "M7", "M8", "M9", "M48", "M49", "M50 P0", "M50 P1",
            "M51 P0", "M51 P1", "M50", "M51", "M52", "M52 P0", "M53", "M53 P0", f"G4 P{self.literal(0, 3)}", "M0", "M1",
            "M60", "M62 P1", "M63 P2", "M64 P0", "M65 P3", "M66 P0 L0", "M66 P1 L3 Q2", "M66 E0 L0", "M67 E1 Q2.5",
            "M68 E0 Q-3", "M19 R30", "M19 R90 Q5", "M19 P1 R10", "M3 $0", "M5 $-1", "S300 $0",
        ))  # fmt: skip

    def tool(self) -> str:
        return self.pick((
            "T1", "T2", "T3", "T0", "T99999", "T1 M6", "T2 M6", "T3 M6 G43", "T0 M6", "M6", "G43", "G43 H1", "G43 H2",
            "G43 H0", "G49", "M61 Q1", "M61 Q2", "M61 Q0", "T2 M6 G43 H2", f"G43.1 {self.words('XZ')}", "G43.2 H1",
            "G43.2 H3", "G10 L0",
        ))  # fmt: skip

    def comment(self) -> str:
        return self.pick((
            "(a comment)", "( b )", "()", "( )", "(MSG, hi)", "(msg,#1)", "; semi", "(debug, #1 #<_x> %d #5221)",
            "(print,%.3f #<_z> %f #1 %%)", "(LOG, %d#1 #<nope>)", "(LOGOPEN,f.txt)", "(LOGCLOSE)", "(PROBEOPEN f)",
            "G4 P1 (first) (second)", "(MSG ,x)", "(  Debug,#[1] #5602 #0)", "(debug,%.12f #1 %lf)", "(LOGCLOSE )",
            "/ G4 P2", "/(c)", "N5", "N7 (d)", "(a;b)", "G4 P1 ; (MSG,no)",
        ))  # fmt: skip

    def home(self) -> str:
        axes = self.words("XYZA", 0) if self.chance(0.6) else ""
        return self.pick((f"G28 {axes}", f"G30 {axes}", "G28.1", "G30.1"))

    def probe(self) -> str:
        return f"{self.pick('G38.2 G38.3 G38.4 G38.5')} {self.words('XYZ')} F{self.literal(10, 100)}"

    def show(self) -> str:
        names = self.random.sample(NAMES, 3)
        numbers = self.random.sample(
            [
                "5161",
                "5210",
                "5211",
                "5213",
                "5220",
                "5221",
                "5222",
                "5230",
                "5400",
                "5403",
                "5410",
                "5413",
                "5420",
                "5421",
                "5422",
                "5423",
                "5061",
                "5063",
                "5070",
            ],
            3,
        )
        values = [f"#<{name}>" for name in names] + [f"#{number}" for number in numbers]
        if self.chance(0.5):
            return "(debug," + " ".join(values) + ")"
        return f"#40=[{values[0]} + {values[4]}] (print,#40)"

    def saved(self) -> str:
        return self.pick("M70 M70 M71 M72 M72 M73")

    # --- flow

    def body(self, lines: int) -> str:
        self.depth += 1
        text = "\n".join(self.line() for _ in range(self.random.randint(0, lines)))
        self.depth -= 1
        return text

    def next_label(self) -> str:
        self.label += 1
        return f"o{self.label}" if self.chance(0.8) else f"o<w{self.label}>"

    def flow(self) -> str:
        if self.depth > 3:
            return self.straight()
        o = self.next_label()
        tested = f"[{self.pick(STATE)} {self.pick('gt lt eq ne ge le')} {self.pick(STATE)}]"
        condition = self.pick(("[0]", "[1]", "[#1 gt #2]", f"[{self.expression(1)}]", "[#31 lt 3]", tested))
        share = self.random.random()
        if share < 0.4:
            text = f"{o} if {condition}\n{self.body(3)}"
            while self.chance(0.3):
                text += f"\n{o} elseif {self.pick(('[0]', '[1]', '[#1 eq 1]'))}\n{self.body(2)}"
            if self.chance(0.5):
                text += f"\n{o} else\n{self.body(2)}"
            return text + f"\n{o} endif"
        if share < 0.6:
            return f"{o} repeat [{self.pick(('0', '1', '2', '3', '1.5', '-1'))}]\n{self.body(3)}\n{o} endrepeat"
        self.label += 1
        n = f"#{2000 + self.label}"
        exits = ""
        if self.chance(0.4):
            i = self.next_label()
            exits = f"\n{i} if [{n} eq {self.pick('1 2')}]\n{o} {self.pick('break continue')}\n{i} endif"
        if share < 0.8:
            return f"{o} while [{n} lt 3]\n{n}=[{n}+1]\n{self.body(2)}{exits}\n{self.body(1)}\n{o} endwhile"
        return f"{o} do\n{n}=[{n}+1]\n{self.body(2)}{exits}\n{self.body(1)}\n{o} while [{n} lt 3]"

    def call(self) -> str:
        if self.depth > 3:
            return self.straight()
        share = self.random.random()
        if self.subs and share < 0.5:
            arguments = " ".join(
                f"[{self.pick(STATE) if self.chance(0.2) else self.expression(1)}]"
                for _ in range(self.random.randint(0, 3))
            )
            return f"{self.pick(self.subs)} call {arguments}"
        if self.depth > 0:
            return self.straight()
        o = self.next_label()
        end = self.pick(("", "", " [#1+1]", f" [{self.expression(1)}]"))
        early = f"\no1 if [#1 gt 0]\n{o} return{self.pick(('', ' [5]'))}\no1 endif" if self.chance(0.3) else ""
        text = f"{o} sub\n{self.body(4)}{early}\n{self.body(1)}\n{o} endsub{end}"
        self.subs.append(o)
        return text

    def fanuc(self) -> str:
        """M98, and the subroutine behind the end of the program; seldom one that is met before."""
        if self.depth > 2:
            return self.straight()
        number = self.random.randint(900, 903)
        if self.chance(0.6):
            self.depth += 2  # no flow of its own
            self.behind.append(f"O{number}\n{self.body(3)}\nM99")
            self.depth -= 2
        repeat = self.pick(("", "", " L2", " L1", " L0", " L3"))
        return f"M98 P{number}{repeat}"

    def indirect(self) -> str:
        """Parameters and labels whose number is computed."""
        self.label += 1
        n = self.label
        inner = self.straight()
        return self.pick((
            f"#2=31 ##2={self.value()}", f"#[30 + #1]={self.value()}", "#31=##2", f"#[31.00001]={self.literal()} G0 X#31",
            f"#3={n}\no[#3] if [{self.pick('0 1')}]\n{inner}\no[{n}] endif", f"o[{n}+0] repeat [2]\n{inner}\no{n} endrepeat",
            f"#<l>={n}\no[#<l>] if [{self.pick('0 1')}]\n{inner}\no#<l> endif", f"o#<l{n}> repeat [2]\n{inner}\no{n} endrepeat",
            "#[#31]=1", f"#<a>=32 #[#<a>]={self.literal()}", "G[#31-#31] X1", "M[5] F[10+#31*0]", "G0 X[#[5220]] Y##2",
        ))  # fmt: skip

    def recursion(self) -> str:
        """A subroutine that calls itself, up to some depth or the deepest there is."""
        if self.depth > 0:
            return self.straight()
        o, i = self.next_label(), self.next_label()
        deep = self.pick("2 3 5 9 20")
        after = self.pick(("", "#5=[#5+#1]", "G0 X#1 Y#2", "(debug,#1 #<_call_level> #<_value>)"))
        return (f"{o} sub\n{self.body(2)}\n{i} if [#1 lt {deep}]\n{o} call [#1+1] [{self.literal()}]\n{i} endif\n{after}\n"
                f"{o} endsub [#1*2]\n{o} call [{self.pick('0 1 2')}]")  # fmt: skip

    # --- cycles, splines, threads, compensation

    def cycle(self) -> str:
        code = self.pick("G81 G82 G83 G73 G85 G89 G86 G88 G87 G84 G74")
        first, second, _, _, across, _ = PLANES[self.plane]
        base = self.random.choice((-10, 0, 5, 0.3))
        bite = self.pick("3 4 0.8 1.6 0.1 0.4")
        extra = {
            "G82": " P0.5",
            "G83": f" Q{bite}",
            "G73": f" Q{bite}",
            "G89": " P1",
            "G86": " P0.2",
            "G88": " P0.1",
        }.get(code, "")
        if code == "G87":
            extra = " I1 J1 K-2"
        spindle = "M4\n" if code == "G74" else "M3\n" if code in "G84 G86 G87 G88" else ""
        text = f"{spindle}{self.pick(('G98 ', 'G99 ', ''))}{code} {self.words(first + second, 0)} {across}{base - 8} R{base}{extra}"
        if self.absolute and self.chance(0.2):
            text = f"{spindle}G91 {code} {self.words(first + second, 0)} {across}-5 R-1 L{self.random.randint(1, 3)}{extra}\nG90"
        while self.chance(0.5):
            text += f"\n{self.words(first + second)}"
        if self.chance(0.2):
            text += f" L{self.random.randint(1, 3)}"
        if not self.inverse:
            text = f"F{self.literal(50, 100)}\n" + text
        return text + ("\nG80" if self.chance(0.7) else "")

    def spline(self) -> str:
        share = self.random.random()
        if share < 0.4:
            text = f"G5 I{self.value()} J{self.value()} P{self.value()} Q{self.value()} {self.words('XY', 2)}"
            if self.chance(0.5):
                text += f"\nG5 P{self.value()} Q{self.value()} {self.words('XY', 2)}"
            return text
        if share < 0.6:
            return f"G5.1 I{self.value()} J{self.value()} {self.words('XY', 2)}"
        order = f" L{self.random.randint(3, 5)}" if self.chance(0.4) else ""
        points = "\n".join(
            f"X{self.value()} Y{self.value()} P{self.literal(0.5, 3)}" for _ in range(self.random.randint(1, 5))
        )
        return f"G5.2 X{self.value()} Y{self.value()} P1{order}\n{points}\nG5.3"

    def thread(self) -> str:
        share = self.random.random()
        if share < 0.3:
            return f"M3 S100\nG33 Z{self.value()} K{self.literal(0.5, 3)}"
        if share < 0.6:
            return f"M3 S100\nG33.1 Z{self.value()} K{self.literal(0.5, 3)}"
        extra = " ".join(
            word for word in (f"R{self.literal(1, 2)}", f"Q{self.literal(0, 30)}", f"H{self.random.randint(0, 3)}",
                              f"E{self.literal(0.5, 2)}", f"L{self.random.randint(0, 3)}") if self.chance(0.4)
        )  # fmt: skip
        sign = self.pick(("", "-"))
        return (f"G18 G90 S100 M3\nG0 X20 Z5\nG76 P{self.literal(0.5, 2)} Z{self.literal(-30, -10)} I{sign}{self.literal(0.5, 2)} "
                f"J{self.literal(0.2, 1)} K{self.literal(1.1, 3)} {extra}\n{self.plane}")  # fmt: skip

    def around(self, axes: str, x: float, y: float) -> tuple[str, float, float]:
        """An arc about a center, and where it ends; its two radii differ by rounding."""
        digits = self.random.randint(2, 4)
        toward, radius = self.random.uniform(-pi, pi), self.random.uniform(6, 30)
        i, j = round(radius * cos(toward), digits), round(radius * sin(toward), digits)
        sweep = self.random.uniform(0.3, 5) * self.random.choice((1, -1))
        angle = atan2(-j, -i) + sweep
        end = [round(center + hypot(i, j) * way, digits) for center, way in ((x + i, cos(angle)), (y + j, sin(angle)))]
        left = (sweep > 0) == (axes[1] == "Y")  # G18 looks from the other side
        return f"{'G3' if left else 'G2'} {axes[0]}{end[0]} {axes[1]}{end[1]} {axes[2]}{i} {axes[3]}{j}", *end

    def compensation(self) -> str:
        """A shape around which the tool goes outside or inside with room enough, mostly; also that of a lathe tool."""
        plane = self.pick("G17 G17 G17 G18")
        axes, others = ("XYIJ", "ZABC") if plane == "G17" else ("XZIK", "ABC")
        u, v = axes[:2]
        nose = f" L{self.random.randint(0, 9)}" if plane == "G18" and self.chance(0.8) else ""
        tool = f"{self.pick('G41.1 G42.1')} D{self.literal(0.5, 6)}{nose}"
        text = [f"{plane} G90 G94 F200 G40", f"G0 {u}-60 {v}-60", tool, f"G1 {u}0 {v}0"]
        x = y = 0.0
        for _ in range(self.random.randint(2, 6)):
            before = x, y
            x, y = x + self.random.uniform(-40, 40), y + self.random.uniform(-40, 40)
            place = f"{u}{x:.3f} {v}{y:.3f}" + (f" {self.words(others, 1, -9, 9)}" if self.chance(0.2) else "")
            share = self.random.random()
            if share < 0.55:
                text.append(f"{self.pick('G1 G1 G0')} {place}")
            elif share < 0.6:
                text.append(f"S100 M3\n{self.pick('G33 G33.1')} {place} K1")
            elif share < 0.7:
                text.append(f"{self.pick('G2 G3')} {place} R{self.random.uniform(40, 90):.2f}")
            elif share < 0.8:
                arc, x, y = self.around(axes, *before)
                text.append(arc)
            else:
                text.append(self.pick(COMPENSATED))
        text += ["G40", f"G1 {u}{x + 30:.3f} {v}{y - 30:.3f}", "G17"]
        self.plane = "G17"
        self.absolute = True
        self.inverse = False
        return "\n".join(text)

    # --- faults

    def fault(self) -> str:
        """A line that may well be wrong: any codes with any words."""
        share = self.random.random()
        if share < 0.3:
            return self.pick((
                "G90 G91", "G1 X1 X2", "M3 M4", "X1 G80", "G4", "G2 X1", "G999", "#1=", "G0 X[1", "G1.05 X1", "G0.0005X1",
                "M3.00001", "M3.1", "T1.5", "G0 X1 (a (b)", "G0 X1 (open", "G0 X1)", "G0 X&1", "#0=1", "#5602=1", "#5400=1",
                "#5420=2", "X#0", "G0 X#5602", "X1e2", "N-5 G0 X1", "N5.5 G0 X1", "G0 N5 X1", "o", "o1", "o1 foo", "o1 if",
                "o1 endif", "o1 else", "o1 endwhile", "o1 endsub", "o1 break", "o999 call", "o1 return", "G0 X.", "G0 X1..2",
                "X--1", "G0 X-+3", "G0 X-sqrt[9]", "G0 X-[2]", "G0 X1 /2", "%", "G1 F-1 X1", "S-1", "M-1", "H-2", "P5", "Q3", "G1 X1 P-1", "Q-1", "G4 P-1",
                "G10 L2 P1.5 X1", "G10 L1 P0.6 Z1", "G10 L20 P3.2 X1", "#2.9999=1", "G20 G10 L2 P11 X1",
                "D3", "E3", "L3", "R3", "K1", "$1", "G96", "G96 D1", "G10 L2 P1.5 X1", "G10 L2 P10 X1", "G10 X1", "G10 L3 P1 X1",
                "G43 H77", "G43.1", "G52", "G92", "T77", "M61", "M61 Q77", "M66", "M66 P1 E1", "M66 P1 L1", "M62", "M67 Q1",
                "G53 X1", "G53 G2 X1 I5", "G91 G53 G0 X1", "G90 M99", "M99", "M98 P5", "M98 P1 L0", "G33 Z1", "G81 X1", "G82",
                "G0 @5 X1", "G0 @5 ^30 G53", "G5.3", "G41.1", "G2 I1 J1 K1", "#<_x>=1", "G0 X#<nope>", "G0 X[1/0]", "G0 X[0 ** -1]",
                "G0 XASIN[2]", "G0 Xsqrt[-1]", "G0 Xln[0]", "G0 X[1 foo 2]", "G0 Xfoo[1]", "G0 Xatan[1]", "G0 X exists[1]",
                "M72", "G28 G0 X1", "G28 G0", "G10 L2 P1 X1 G0", "G92 X1 G1", "G4 P1 G2 X1 I1", "G4 P-1", "G80 G1 X1", "G1 G80",
                "M7 M8", "M48 M49", "M6 M61 Q1", "M3 M5", "M3 M70", "M62 P1 M63 P1", "M1 M2", "G54 G55", "G40 G41", "G43 G49", "G98 G99",
                "G20 G21", "G17 G18", "G93 G94", "G96 G97 S1", "G7 G8", "G61 G64", "G90.1 G91.1", "M3 M7 M48 M60 M6", "M3 M7 M48 M60",
                "(ABORT,x #1)", "G1", "G2", "G38.2", "G38.2 X0 Y0 Z0 F0", "G64 P-1", "M50 P0.5", "M19", "M19 R400", "M19 P5 R1",
                "M19 R1 P-1", "G0 X1 L2", "G2 I1 P0", "G2 I1 P1.5", "G18 G0 @5 ^30", "G0 ^30", "G95 G1 X1 F1", "G93 G1 X1",
                "G5 P1 Q1 X1 Y1", "G5.1 X1 Y1", "G5.1 I1 J1 Z3", "G5.2 X1 P1", "#1=1#2=2", "#<a b>=3", "#[1+1]=5", "##2=1", "#1.5=3",
                "G1 X1 M2", "M30", "M2", "f", "x", "g", "G", "M", "G0 X1 Y", "a", "@", "G0G1X1",
            ))  # fmt: skip

        codes = self.random.sample(self.codes, self.random.choice((0, 1, 1, 1, 2))) + self.random.sample(
            M_CODES, self.random.choice((0, 0, 0, 1))
        )
        letters = self.random.sample("XYZABCDEFHIJKLPQRST@^$", self.random.choice((0, 1, 2, 3, 4)))
        whole = "HLTP$"
        words = [c + (str(self.random.randint(0, 3)) if c in whole else self.literal(-9, 20)) for c in letters]
        return " ".join(codes + words)

    def line(self) -> str:
        if self.chance(self.faulty):
            return self.fault()
        text = self.random.choice(self.topics)()
        if self.chance(0.07) and "\n" not in text and text[:1] not in "No/(":
            text = f"N{self.random.randint(1, 9999)} {text}"
        if self.chance(0.05):
            text = text.lower() if "(" not in text else text
        if self.chance(self.odd) and "(" not in text and "<" not in text:
            at = self.random.randint(0, len(text))
            text = text[:at] + " " + text[at:]
        return text

    def program(self, lines: int) -> str:
        start = "G21 G17 G90 F300\nG0 X1 Y2 Z3" if self.chance(0.9) else ""
        body = "\n".join(self.line() for _ in range(self.random.randint(1, lines)))
        end = self.pick(("M2", "M2", "M2", "M30", "M30", "%", ""))
        first = "%\n" if end == "%" or self.chance(0.05) else ""
        behind = "".join(text + "\n" for text in self.behind)
        return f"{first}{start}\n{body}\n{end}\n{behind}"


CHARACTERS = "0123456789.+-*/[]#<>()=;%@^$ \tGMXYZABCIJKPQRFSTHLDEONuvwgm_!?,:"


def mistyped(seed: int) -> str:
    """A random program in which a few characters are lost, added, changed or doubled."""
    choose = random.Random(seed)
    lines = Writer(seed).program(8).splitlines()
    for _ in range(choose.choice((1, 1, 1, 2, 3))):
        at = choose.randrange(len(lines))
        line = lines[at]
        place, other = choose.randrange(len(line) + 1), choose.randrange(len(line) + 1)
        before, behind, new = line[:place], line[place:], choose.choice(CHARACTERS)
        doubled = line[min(place, other) : max(place, other)]
        lines[at] = choose.choice((before + behind[1:], before + new + behind, before + new + behind[1:],
                                   before + doubled + behind, before))  # fmt: skip
    return "\n".join(lines) + "\n"


def probe_line(seed: int) -> str:
    """A short program around one line that may well be wrong."""
    writer = Writer(seed)
    writer.faulty = 0.0
    start = "G0 X1 Y2 Z3\nF100" if writer.chance(0.7) else ""
    state = "\n".join(writer.mode() for _ in range(writer.random.randint(0, 2)))
    motion = writer.pick(("", "", "G1 X5", "G0 X3", "G2 I3", "G81 X1 Z-3 R1", "G80", "M3 S100", "T1 M6", "G38.3 Z-5"))
    return f"{start}\n{state}\n{motion}\n{writer.fault()}\n(debug,#<_x> #<_y> #<_z> #<_motion_mode>)\nM2\n"
