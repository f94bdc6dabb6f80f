"""Random programs that mean the same in both languages, and LinuxCNC's interpreter to ask about them."""

from __future__ import annotations

import random
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

PROGRAM = shutil.which("rs274")
AXES = "XYZABC"
PLANES = {"G17": "XYIJZ", "G18": "XZIKY", "G19": "YZJKX"}
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
NUMBER = re.compile(r"-?\d+\.\d+")


class Answer(NamedTuple):
    """What the oracle says to a program. message: what it writes beside the listing."""

    listing: list[str]
    accepted: bool
    message: str

    def names(self, line: str) -> bool:
        """Whether it says that this line is wrong; of a call that finds nothing it names the last line read."""
        return line.strip() in self.message or "seeking o-word" in self.message


def answer(text: str, folder: Path, options: Sequence[str] = ()) -> Answer:
    """What the oracle says to a program. folder: its own, to write in."""
    file = folder / "program.ngc"
    file.write_text(text, newline="")
    assert PROGRAM
    done = subprocess.run(
        [PROGRAM, *options, "-g", str(file)],
        capture_output=True,
        timeout=60,
        cwd=folder,
        env={"HOME": str(folder)},
    )
    listing, message = done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")
    return Answer(listing.splitlines(), done.returncode == 0, message)


def ask(text: str, folder: Path) -> tuple[list[str], bool]:
    """The oracle's listing of a program, and whether it accepted it."""
    listing, accepted, _ = answer(text, folder)
    return listing, accepted


def differ(ours: list[str], theirs: list[str], tolerance: float = 1.0001e-4) -> str:
    """The first difference of two listings, in words; empty when there is none."""
    for at, (a, b) in enumerate(zip(ours, theirs, strict=False)):
        if a == b:
            continue
        x, y = NUMBER.findall(a), NUMBER.findall(b)
        near = len(x) == len(y) and all(abs(float(p) - float(q)) <= tolerance for p, q in zip(x, y, strict=True))
        if not near or NUMBER.sub("#", a) != NUMBER.sub("#", b):
            return f"line {at + 1}:\n  ours   {a}\n  theirs {b}"
    if len(ours) != len(theirs):
        return f"{len(ours)} lines, not {len(theirs)}: {(ours[len(theirs) :] or theirs[len(ours) :])[:3]}"
    return ""


class Writer:
    """Writes one random program. It avoids what the two languages define differently."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.plane = "G17"
        self.absolute = True
        self.inverse = False
        self.moving = False
        self.known: list[int] = []
        self.shift = self.random.choice(("G52", "G92"))
        self.faulty = self.random.random() < 0.3

    def number(self, low: float = -50.0, high: float = 50.0) -> str:
        value = self.random.uniform(low, high)
        return f"{value:.{self.random.choice((0, 1, 2, 3, 4))}f}"

    def value(self, low: float = -50.0, high: float = 50.0) -> str:
        """A literal, a variable or an expression."""
        pick = self.random.random()
        if pick < 0.7 or not self.known:
            return self.number(low, high)
        variable = f"#{self.random.choice(self.known)}"
        if pick < 0.8:
            return variable
        if pick < 0.9:
            return f"[{variable} {self.random.choice('+-*')} {self.number(0.1, 3)}]"
        function = self.random.choice(("sin", "cos", "abs", "fix", "fup", "round"))
        return f"{function}[{variable}]"

    def words(self, axes: str, least: int = 1) -> str:
        count = self.random.randint(least, len(axes))
        return " ".join(f"{axis}{self.value()}" for axis in self.random.sample(axes, count))

    def feed(self) -> str:
        if self.inverse:
            return f" F{self.number(0.5, 9)}"
        return f" F{self.number(1, 2000)}" if self.random.random() < 0.2 else ""

    def line(self) -> str:
        kinds = (self.straight, self.straight, self.arc, self.arc, self.radius_arc, self.mode, self.offset,
                 self.setting, self.auxiliary, self.machine, self.full_circle, self.cycle, self.polar)  # fmt: skip
        text = self.random.choice(kinds)()
        if self.random.random() < 0.1:
            text = f"N{self.random.randint(1, 9999)} {text}"
        return text.lower() if self.random.random() < 0.1 else text

    def straight(self) -> str:
        axes = AXES if self.random.random() < 0.3 else "XYZ"
        if self.moving and not self.inverse and self.random.random() < 0.3:
            return self.words(axes)
        code = self.random.choice(("G0", "G1", "G00", "G01"))
        self.moving = True
        return f"{code} {self.words(axes)}" + (self.feed() if "1" in code else "")

    def arc(self) -> str:
        """A center arc that fits: from here by a turn of the plane's own vectors, in G91."""
        first, second, i, j, across = PLANES[self.plane]
        radius = self.random.randint(1, 20)
        rise = f" {across}{self.value()}" if self.random.random() < 0.3 else ""
        turns = f" P{self.random.randint(1, 3)}" if self.random.random() < 0.2 else ""
        code = self.random.choice(("G2", "G3"))
        back = "G90" if self.absolute else "G91"
        self.moving = False
        return f"G91 {code} {first}{radius} {second}{radius} {i}{radius} {j}0{rise}{turns}{self.feed()}\n{back}"

    def full_circle(self) -> str:
        _, _, i, j, _ = PLANES[self.plane]
        self.moving = False
        center = f"{i}{self.value(1, 9)} {j}{self.value(1, 9)}"
        return f"{self.random.choice(('G2', 'G3'))} {center}{self.feed()}"

    def radius_arc(self) -> str:
        first, second, _, _, _ = PLANES[self.plane]
        radius = self.random.choice((-1, 1)) * self.random.randint(30, 90)
        if self.faulty and self.random.random() < 0.2:
            radius = 1
        code = self.random.choice(("G2", "G3"))
        back = "G90" if self.absolute else "G91"
        self.moving = False
        step = f"{first}{self.number(1, 20)} {second}{self.number(1, 20)}"
        return f"G91 {code} {step} R{radius}{self.feed()}\n{back}"

    def cycle(self) -> str:
        """A canned cycle and places that repeat it, with changes of mode between them."""
        first, second, _, _, normal = PLANES[self.plane]
        code = self.random.choice(("G73", "G81", "G82", "G83", "G85", "G86", "G88", "G89"))
        top = self.random.uniform(-8, 8)
        depth = (
            top - self.random.uniform(-1 if self.faulty else 0, 30) if self.absolute else self.random.uniform(-30, 0)
        )
        words = f"{code} {first}{self.number()} {normal}{depth:.3f} R{top:.3f}"
        if code in ("G73", "G83"):
            words += f" Q{self.random.randint(1, 9)}.037"
        elif code in ("G82", "G86", "G88", "G89"):
            words += f" P{self.number(0, 3)}"
        if self.random.random() < 0.2:
            words += f" L{self.random.randint(1, 3)}"
        before = ("S500 M3\n" if code in ("G86", "G88") else "") + ("G94 F150\n" if self.inverse else "")
        self.inverse = self.moving = False
        lines = [before + words]
        for _ in range(self.random.randint(0, 4)):
            pick = self.random.random()
            if pick < 0.2:
                lines.append(self.random.choice(("G98", "G99")))
            elif pick < 0.3:
                # Another R too: sums of offsets round, and the height may come out above R by nothing.
                lines.append(f"{self.offset()}\n{first}{self.number()} R{self.number(9, 12)}7")
            elif pick < 0.35:
                lines.append(self.units())
            elif pick < 0.4:
                self.absolute = not self.absolute
                lines.append("G90" if self.absolute else "G91")
            elif pick < 0.5:
                lines.append(f"{second}{self.number()} L2 R{self.number(9, 12)}")
            else:
                lines.append(self.words(first + second))
        if code == "G88":  # the way out is no command, so M6 would take the bottom for the position in one language
            lines.append(f"G0 {normal}{self.number()}")
        return "\n".join(lines)

    def polar(self) -> str:
        """A move by radius and angle, or a ring of holes: in the XY plane, where both languages have them."""
        if self.plane != "G17":
            return self.straight()
        self.moving = False
        words = f"@{self.value()} ^{self.number(-400, 400)}"
        if self.random.random() < 0.3:  # a radius alone has no angle at the pole, which one language refuses
            words = (
                f"^{self.value()}" if self.absolute else self.random.choice((f"^{self.value()}", f"@{self.value()}"))
            )
        if self.random.random() < 0.3 and not self.inverse:
            return f"G81 {words} Z-3 R{self.number(-1 if self.absolute else -3, 9)} L2\n^{self.number(0, 90)}"
        code = self.random.choice(("G0", "G1"))
        rise = f" Z{self.value()}" if self.random.random() < 0.3 else ""
        return f"{code} {words}{rise}" + (self.feed() if code == "G1" else "")

    def units(self) -> str:
        """Other units; cycles put tolerances back in force as numbers in one language, as lengths in the other."""
        return self.random.choice(("G20\nG64 P0 Q0", "G21\nG64 P0 Q0"))

    def mode(self) -> str:
        pick = self.random.randint(0, 9)
        if pick == 0:
            self.plane = self.random.choice(list(PLANES))
            return self.plane
        if pick == 1:
            self.absolute = not self.absolute
            return "G90" if self.absolute else "G91"
        if pick == 2:
            return self.units()
        if pick == 3:
            self.inverse = not self.inverse
            return "G93" if self.inverse else "G94 F200"
        if pick == 4:
            return self.random.choice(("G61", "G61.1", "G64 P0.1 Q0.2", "G64 P0 Q0"))
        if pick == 5:
            return self.random.choice(("G40", "G49", "G98", "G99"))
        if pick == 6:
            self.moving = False
            return "G80"
        if self.faulty and pick == 7:
            return self.random.choice(
                ("G90 G91", "G1 X1 X2", "M3 M4", "X1 G80", "G4", "G2 X1", "G999", "#1=", "G0 X[1")
            )
        return "G90.1\nG91.1"

    def offset(self) -> str:
        pick = self.random.randint(0, 4)
        if pick == 0:
            return self.random.choice(SYSTEMS)
        if pick == 1:
            return f"G10 L2 P{self.random.randint(0, 9)} {self.words(AXES)}"
        if pick == 2:
            return f"G10 L20 P{self.random.randint(0, 9)} {self.words(AXES)}"
        if pick == 3 and self.shift == "G92":
            return self.random.choice(("G92.1", "G92.2", "G92.3"))
        return f"{self.shift} {self.words(AXES)}"

    def setting(self) -> str:
        number = self.random.randint(1, 9)
        text = f"#{number}={self.value()}"
        if number not in self.known:
            self.known.append(number)
        return text

    def auxiliary(self) -> str:
        return self.random.choice((
            f"S{self.number(100, 9000)} M3", "M4", "M5", "M7", "M8", "M9", "M48", "M49", "M50 P0", "M50 P1",
            "M51 P0", "M51 P1", f"G4 P{self.number(0, 3)}", "(a comment)", "M0", "M1", "T1", "T2", "T3 M6",
        ))  # fmt: skip

    def machine(self) -> str:
        return f"G53 G0 {self.words('XYZ')}" if self.absolute else "G28.1"

    def program(self, lines: int) -> str:
        body = "\n".join(self.line() for _ in range(lines))
        zeros = " ".join(f"{axis}0" for axis in AXES)  # the end of the program clears G52 in one language only
        last = f"G52 {zeros}\n" if self.shift == "G52" else ""
        return f"G21 G17 G90 G98 F300\nG0 X1 Y2 Z3\n{body}\n{last}M2\n"
