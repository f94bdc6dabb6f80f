"""What lathes use, and codes beside motion, against LinuxCNC's own interpreter: random programs with fixed seeds.

Turning cycles have a writer of their own: contours of lines that climb or fall as they lead along the part. Those with
a pocket that is not closed are left out: the interpreter does not end there.
"""

import random
from pathlib import Path

import pytest

import aircut
import oracle

PROGRAMS = 25  # of a topic
CONTOURS = 80
#: Seeds of contours that are not compared: the interpreter does not end, or a rounding error decides on a
#: summit or on whether two ways are parallel.
APART = (3, 71, 42, 80)
CYCLES = ("G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89")
MODES = (
    "G7|G8|G18|G17|G19|G20|G21|G90|G91|G98|G99|G61|G64 P.1|G17.1|G18.1|G90.1|G91.1|G53 G0 X1|G52 X1 Z2|G92 X3|G92.1|"
    "G10 L2 P1 X1 Z2|G10 L20 P1 X3|G54|G55|F100|F0|M48|M49|M50 P0|M51 P0|G80"
)
SPINDLE = (
    "M3|M4|M5|S100|M3 S500|G96 S80|G96 D1500 S100|G96|G97 S300|G97|M19 R90|M19 R10 P1 Q2|M19 P2|M19 Q3|M19|G95|G95 F.2|"
    "G94|G94 F100|G93|G96 S100 $0|M3 $-1|M3 $0 S20"
)
TOOLS = (
    "T1 M6|T2 M6 G43|T3|M6|M61 Q1|M61 Q3 G43|G43|G43 H2|G43.1 X1 Z2|G49|G43.2 H1|T0 M6|M61 Q0|G10 L0|"
    "G10 L1 P2 X1 Z.5 R.2 Q3 I10 J20|G10 L10 P1 X3 Z2|G10 L11 P3 Z1|G10 L1 P2 Q5|G10 L10 P2 R1|G10 L1 P1 Q9|"
    "G10 L1 P1 Q10|"
    "G10 L20 P0 Z3|G10 L2 P0 R20|G10 L2 P2 R-30 X1|G10 L20 P2 X1 Y1 A3|G10 L2 P10 X1|G10 L11 P1 X1 Y2 Z3|"
    "G10 L1 P99999 Z.3"
)
OTHERS = (
    "G28|G30|G28 X3|G30 Y1 Z2|G28.1|G30.1|G28.1 X1|M62 P1|M63 P0|M64 P3|M65 P2|M67 E1 Q2.5|M68 E0 Q-1|M66 P1 L3 Q2|"
    "M66 P1 L1|M66 E1 L0|M66 E1 L2 Q1|M66 P1 E1 L0|M60|M100|M101 P1 Q2|M199|M52|M52 P0|M53 P1|M53 P0|M50|M51|M50 P2|"
    "M0|M1|"
    "M62|M62 P1.5|M67 E1|M67 Q1|G4 P1|G38.2 X1 F20|(DEBUG,#5061 #5062 #5063 #5070 #5399)"
)
SHOWN = (
    "(DEBUG,#<_x> #<_y> #<_z> #5420 #5422 #<_motion_mode> #<_abs_x> #<_abs_z> #5400 #5403 #5410 #5413 #<_feed> #<_rpm>)"
)
TOPICS = {
    "threads": ("thread", "follow", "spindle", "mode", "move", "show"),
    "cycles": ("cycle", "cycle", "mode", "move", "spindle", "show"),
    "tools": ("tool", "move", "mode", "show"),
    "others": ("other", "probe", "move", "mode", "show"),
    "splines": ("spline", "spline", "move", "mode", "show"),
    "orientation": ("entry", "move", "move", "tool"),
}
ROUGHING = ("G70", "G71", "G71", "G71.1", "G71.2", "G72", "G72", "G72.1", "G72.2")


class Writer:
    """Writes one program of a topic. Methods return a line."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def number(self, low: float = -20.0, high: float = 20.0) -> str:
        return f"{self.random.uniform(low, high):.{self.random.choice((0, 1, 2, 3))}f}"

    def maybe(self, share: float, text: str) -> str:
        return text if self.random.random() < share else ""

    def axes(self, letters: str = "XYZ", share: float = 0.6) -> str:
        return " ".join(f"{letter}{self.number()}" for letter in letters if self.random.random() < share)

    def thread(self) -> str:
        n = self.number
        line = f"G76 P{n(0.1, 3)} Z{n(-20, -1)} I{n(-3, 3)} J{n(0.05, 1)} K{n(0.5, 3)}"
        line += self.maybe(0.4, f" R{n(0.8, 3)}") + self.maybe(0.4, f" Q{n(0, 60)}")
        line += self.maybe(0.4, f" H{self.random.randint(0, 3)}") + self.maybe(0.4, f" E{n(0, 3)}")
        line += self.maybe(0.4, f" L{self.random.randint(0, 4)}")
        return line + self.maybe(0.3, f" X{n()}") + self.maybe(0.1, f" Y{n()}") + self.maybe(0.05, " A3")

    def follow(self) -> str:
        line = f"{self.random.choice(('G33', 'G33.1'))} {self.axes()} {self.maybe(0.95, 'K' + self.number(-2, 3))}"
        return line + self.maybe(0.1, " $0") + self.maybe(0.05, " I1.5") + self.maybe(0.05, " A3")

    def cycle(self) -> str:
        name, n = self.random.choice(CYCLES), self.number
        line = f"{name} {self.axes('XYZ', 0.7)}" + self.maybe(0.9, f" R{n(-5, 20)}")
        line += self.maybe(0.6, f" Q{n(0.5, 5)}") + self.maybe(0.6, f" P{n(0, 2)}")
        line += self.maybe(0.2, f" L{self.random.randint(0, 3)}")
        return line + (f" I{n(-2, 2)} J{n(-2, 2)} K{n(-2, 2)}" if name == "G87" else "") + self.maybe(0.05, " A1")

    def spline(self) -> str:
        n = self.number
        here = f"X{n()} Y{n()}"
        return self.random.choice(
            (
                f"G5 {here} I{n()} J{n()} P{n()} Q{n()}",
                f"G5 {here} P{n()} Q{n()}",
                f"G5.1 {here} I{n()} J{n()}",
                f"G5.1 X{n()} I{n()}",
                f"G5.2 {here} P{n(-0.2, 3)} L{self.random.randint(0, 5)}",
                f"G5.2 {here} P1\nX{n()} Y{n()} P2\nX{n()} Y{n()} P.5\nG5.3",
                "G5.3",
                "G5.2 P2",
                "G5.2 X1 P1",
                f"{here} P1",
            )
        )

    def entry(self) -> str:
        diameter = self.number(0.1, 2)
        which = self.random.choice(("G41.1", "G42.1"))
        orientation = self.random.randint(0, 9)
        return self.random.choice(
            ("G40", f"{which} D{diameter} L{orientation}", f"{which} D{diameter}", "G41 D2", "G42")
        )

    def probe(self) -> str:
        return f"G38.{self.random.randint(2, 5)} {self.axes('XYZA')}"

    def move(self) -> str:
        return self.random.choice(("G0 ", "G1 ", "")) + self.axes("XYZ", 0.4)

    def spindle(self) -> str:
        return self.random.choice(SPINDLE.split("|"))

    def mode(self) -> str:
        return self.random.choice(MODES.split("|"))

    def tool(self) -> str:
        return self.random.choice(TOOLS.split("|"))

    def other(self) -> str:
        return self.random.choice(OTHERS.split("|"))

    def show(self) -> str:
        return SHOWN

    def program(self, topic: str) -> str:
        lines = ["G21 F100 S100 M3" if self.random.random() < 0.8 else "G20", self.maybe(0.5, "G18")]
        for _ in range(self.random.randint(3, 10)):
            lines.append(self.maybe(0.03, "N5 ") + getattr(self, self.random.choice(TOPICS[topic]))())
        return "\n".join([*lines, "M2", ""])

    def turned(self) -> str:
        """A contour and a cycle over it."""
        choose = self.random
        x, z = choose.randint(0, 10), 0
        side, way = choose.choice((1, 1, -1)), choose.choice((-1, -1, 1))
        lines = ["O100 sub", f"G0 X{x} Z{z}"]
        for _ in range(choose.randint(1, 6)):
            dx = choose.choice((0, choose.randint(1, 5), choose.randint(1, 5), -choose.randint(1, 4)))
            dz = choose.randint(0, 6)
            if dx or dz:
                x, z = x + dx * side, z + dz * way
                lines.append(f"G1 X{x} Z{z}")
        code = choose.choice(ROUGHING)
        line = f"{code} Q100 X{choose.choice((20, 25, 8)) * side} Z{choose.choice((2, 5, -3)) * -way}"
        if code == "G70":
            line += self.maybe(0.5, f" D{choose.choice((0.5, 1, 2))} P{choose.randint(1, 3)}") + self.maybe(
                0.3, " E0.5"
            )
        else:
            line += self.maybe(0.4, f" D{choose.choice((0.3, 0.5, 1))}")
            line += self.maybe(0.8, f" I{choose.choice((0.75, 1.5, 2, 3, 5))}")
            line += self.maybe(0.5, f" R{choose.choice((0, 0.2, 1, 3, -1))}")
        start = f"{choose.choice(('G21', 'G20'))} G18 F100"
        return "\n".join([start, *lines, "O100 endsub", line, self.maybe(0.5, "X1 Z1"), "M2", ""])


def compare(text: str, folder: Path) -> str:
    """The first difference, in words; empty where there is none."""
    result = aircut.loads(text, "linuxcnc").run()
    if any("does not come up" in str(diagnostic) for diagnostic in result.diagnostics):
        return ""
    theirs, accepted = oracle.ask(text, folder)
    difference = oracle.differ([line.rstrip("\n") for line in result.canon()], theirs)
    if not difference and result.ok != accepted:
        difference = f"ok is {result.ok}, theirs {accepted}"
    return difference and f"{difference}\n  {[str(d) for d in result.diagnostics]}\n{text}"


installed = pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")


@installed
@pytest.mark.parametrize("topic", TOPICS)
def test_topic_equals_the_oracle(topic: str, tmp_path: Path) -> None:
    texts = [Writer(seed).program(topic) for seed in range(PROGRAMS)]
    differences = [found for text in texts if (found := compare(text, tmp_path))]
    assert not differences, f"{len(differences)} of {PROGRAMS}\n" + "\n".join(differences[:3])


@installed
def test_turning_equals_the_oracle(tmp_path: Path) -> None:
    texts = [Writer(seed).turned() for seed in range(CONTOURS) if seed not in APART]
    differences = [found for text in texts if (found := compare(text, tmp_path))]
    assert not differences, f"{len(differences)} of {CONTOURS}\n" + "\n".join(differences[:3])
