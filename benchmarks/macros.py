"""Programs whose work is in the language: each in RosettaCNC's and in LinuxCNC's, with what there is of it."""

from __future__ import annotations

from typing import NamedTuple

PASSES = 400_000
CALLS = 50_000
HOLES = 200_000
CORNERS = 100_000


class Work(NamedTuple):
    """One benchmark."""

    title: str
    rosetta: bytes
    linuxcnc: bytes
    goal: float  # times as fast as rs274
    count: int
    of: str


def loops() -> Work:
    """Two WHILE loops, one in the other, with trigonometry: six blocks a pass."""
    body = "#2=[COS[#1*0.1]*10+0.5]\n#3=[SIN[#5*0.1]*10]\nG1 X#2 Y#3\n#5=[#5+1]\n"
    outer = PASSES // 200
    rosetta = (
        f"G21 F500\n#1=0\nWHILE [#1 LT {outer}] DO1\n#5=0\nWHILE [#5 LT 200] DO2\n{body}END2\n#1=[#1+1]\nEND1\nM2\n"
    )
    theirs = (
        f"G21 F500\n#1=0\no1 while [#1 LT {outer}]\n#5=0\no2 while [#5 LT 200]\n{body}o2 endwhile\n#1=[#1+1]\n"
        "o1 endwhile\nM2\n"
    )
    return Work("macro loops", rosetta.encode(), theirs.encode(), 5.0, 6 * PASSES, "blocks")


def calls() -> Work:
    """A subroutine with three arguments and two moves, called over and over."""
    body = "#4=[#1+#2]\nG1 X#4 Y#3\nG0 Z#1\n"
    rosetta = (
        f"G21 F500\n#100=0\nWHILE [#100 LT {CALLS}] DO1\nG65 P1000 A1 B[#100*0.001] C3\n#100=[#100+1]\nEND1\nM2\n"
        f"O1000\n{body}M99\n"
    )
    theirs = (
        f"o<s> sub\n{body}o<s> endsub\nG21 F500\n#100=0\no1 while [#100 LT {CALLS}]\n"
        "o<s> call [1] [#100*0.001] [3]\n#100=[#100+1]\no1 endwhile\nM2\n"
    )
    return Work("subroutine calls", rosetta.encode(), theirs.encode(), 4.0, CALLS, "calls")


def cycles() -> Work:
    """Drilling holes in rows."""
    places = "".join(f"X{i % 500}.5 Y{i // 500}.25\n" for i in range(HOLES))
    text = f"G21 G90 F300\nG0 X0 Y0 Z10\nG81 G98 Z-5 R2\n{places}G80\nM2\n".encode()
    return Work("canned cycles", text, text, 3.0, HOLES, "holes")


def compensated() -> Work:
    """A contour with corners of both kinds and arcs, beside which the tool is led, turn after turn."""
    lines = ["G21 G90 F600", "G0 X-60 Y-60", "G41.1 D4", "G1 X-50 Y-50"]
    turn = (
        "G1 X-40 Y-48", "X-20 Y-50", "X0 Y-44", "X20 Y-50", "G3 X50 Y-20 R30", "G1 X48 Y0", "X50 Y20", "X40 Y50",
        "X0 Y46", "X-30 Y50", "G3 X-50 Y30 R20", "G1 X-47 Y0", "X-50 Y-50",
    )  # fmt: skip
    while len(lines) < CORNERS:
        lines += turn
    text = "\n".join([*lines, "G40", "G0 X-80", "M2", ""]).encode()
    return Work("compensated moves", text, text, 3.0, len(lines), "moves")


WORKS = (loops, calls, cycles, compensated)
