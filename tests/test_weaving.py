"""Loops compiled whole mean what the general lane means, to the last bit, faults and counts included."""

import random
from typing import Any

import pytest

import aircut
from aircut.interpreter import flow
from aircut.interpreter.running import Limits
from aircut.machine import built_in

VALUES = (
    "#1", "#2", "#100", "#101", "#<a>", "#<_b>", "#5001", "#5002", "#[100+1]", "#3", "#<none>", "#199", "#4001", "2.5",
    "-3", "0", "[#1+#2]", "[#1*0.1]", "COS[#1*10]", "SQRT[#2]", "[#1/#2]", "[#1 MOD 3]", "FIX[#1/2]", "[#1 GT 2]",
    "[#<a>+1]", "[#100**2]", "EXISTS[#<a>]", "ATAN[#1]/[#2]", "[#1 EQ #null]", "ABS[#101]", "[10**300*10**300]",
)  # fmt: skip
LINES = (
    "#1=[#1+1] G1 XV", "#2=V", "#100=V", "#101=V", "#<a>=V", "#<_b>=V", "#[100+#1]=V", "#[#1]=V", "#5001=V",
    "#5221=V", "#[5220+1]=#1",
    "#2=V #100=V", "G1 XV YV", "G0 ZV", "XV", "G1 XV YV ZV F500", "YV ZV", "G2 XV YV R20", "G3 X1 I2 J[#1]", "FV",
    "G1 FV", "G91", "G90", "G20", "G21", "(a remark)", "#2=V (another)", "; nothing", "", "M3 S100", "G4 P0.1",
    "G1 X5 Y#1", "X1 Y2 Z3", "N70 G1 XV", "IF [V GT 1] THEN #2=V", "IF [V] THEN G1 XV", "IF [#1 GT 30] THEN BREAK1",
    "IF [#1 EQ 7] GOTO 900", "G65 P100 A[#1]", "M98 P100", "M98 P200 L2",
    "G65 P200 B1 L2 CV", "G65 P300 AV IV", "G65 P999", "M98 P300", "CALL P\"cut\" AV", "M99", "G66 P100 A1", "G67",
    "G[#1-1] X1", "G52 X[#1]", "G1 AV", "G9 G1 XV",
    "G53 G0 X1", "G41.1 D1", "G40", "X9999", "M#1", "G81 X1 Z-1 R1", "/G1 XV", "G1 XV YV (far)", "T1 M6",
    "G93 G1 X1 F2", "G94", "G16", "G15", "G61", "G68 R[#1]", "G69", "S#1", "M2",
)  # fmt: skip
MOTION = ("G1 XV YV", "G0 ZV", "XV", "YV ZV", "G1 X[#1] Y[#2] Z0", "#1=[#1+1]", "#100=V", "#<a>=V",
          "G65 P100 AV BV", "M98 P200")  # fmt: skip


class Writer:
    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.wild = self.random.choice((0.0, 0.1, 0.5))
        self.id = 1

    def line(self) -> str:
        text = self.random.choice(LINES if self.random.random() < self.wild else MOTION)
        while "V" in text:
            text = text.replace("V", self.random.choice(VALUES), 1)
        return text

    def body(self, depth: int) -> list[str]:
        lines: list[str] = []
        for _ in range(self.random.randint(1, 5)):
            pick = self.random.random()
            if pick < 0.12 and depth < 3:
                lines += self.branch(depth)
            elif pick < 0.2 and depth < 3:
                lines += self.loop(depth + 1)
            else:
                lines.append(self.line())
        return lines

    def branch(self, depth: int) -> list[str]:
        id = self.id = self.id + 1
        lines = [f"IF [{self.random.choice(VALUES)} LT 3] THEN{id}", *self.body(depth + 1)]
        if self.random.random() < 0.3:
            lines += [f"ELIF [{self.random.choice(VALUES)} GT 1] THEN{id}", *self.body(depth + 1)]
        if self.random.random() < 0.5:
            lines += [f"ELSE{id}", *self.body(depth + 1)]
        return [*lines, f"END{id}"]

    def loop(self, depth: int) -> list[str]:
        id = self.id = self.id + 1
        counter = f"#{109 + depth}"
        times = self.random.choice((2, 5, 9, 40 if depth == 1 else 4))
        return [
            f"{counter}=0",
            f"WHILE [{counter} LT {times}] DO{id}",
            f"{counter}=[{counter}+1]",
            *self.body(depth),
            f"END{id}",
        ]

    def program(self) -> str:
        lines = ["G21 G90 F500 G1 X0", "#1=0 #2=3", "#100=1 #101=-2", "#<a>=1", "#<_b>=2"]
        for _ in range(self.random.randint(1, 3)):
            lines += [*self.loop(1), self.line()]
        return "\n".join([*lines, "N900 G0 Z5", "M2", *self.routines(), ""])

    def routines(self) -> list[str]:
        """Subroutines that call those before them; the last calls itself."""
        pick = self.random
        lines: list[str] = []
        for name, others in (("O100", ()), ("O200", ("G65 P100 A#1", "M98 P100")), ('SUB "cut"', ("M98 P200",))):
            ending = "ENDSUB" if name[0] == "S" else pick.choice(("M99", "M99", "RETURN"))
            body = [line for line in self.body(2) if not any(word in line for word in ("P200", "P300", "cut"))]
            if name == "O100":
                body = [line for line in body if "P100" not in line]
            early = [f"IF [{pick.choice(VALUES)} GT 20] THEN {pick.choice(('M99', 'RETURN'))}"] * pick.randint(0, 1)
            lines += [name, *early, *body, *others[: pick.randint(0, 2)], ending]
        deep = pick.choice((3, 120))
        guard = f"IF [#1 LT {deep}] THEN G65 P300 A[#1+1] B#2"
        return [*lines, "O300", *self.body(2)[:4], guard, f"G1 X#{pick.choice((1, 2))}", "M99"]


def run(text: str, woven: bool, keep_going: bool, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        if not woven:
            patch.setattr(flow, "weave", lambda unit, first: None)
            patch.setattr(flow, "weave_routine", lambda unit, routine: None)
        result = aircut.loads(text).run(built_in("XYZA"), keep_going=keep_going, limits=Limits(blocks=20_000))
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    ran = result._interpreter
    counts = ran.repeated, ran.passes, bytes(ran.unit.seen), ran.line, ran.routine, ran.state.line, len(ran.stack)
    return result.toolpath.to_numpy().tobytes(), events, result.diagnostics, result.state, result.variables, counts


def compare(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    writer = Writer(seed)
    text = writer.program()
    keep_going = writer.random.random() < 0.6
    woven = run(text, True, keep_going, monkeypatch)
    plain = run(text, False, keep_going, monkeypatch)
    for part, other in zip(woven, plain, strict=True):
        assert part == other, text


@pytest.mark.parametrize("seed", range(200))
def test_loops_compiled_whole_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    compare(seed, monkeypatch)
