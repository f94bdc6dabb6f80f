"""Loops and subroutines of LinuxCNC's language compiled whole mean what the general lane means, to the last bit."""

import random
from typing import Any

import pytest

import aircut
from aircut.interpreter.linuxcnc import interpreter
from aircut.interpreter.running import Limits
from aircut.machine import built_in

VALUES = (
    "#1", "#2", "#100", "#101", "#<a>", "#<_b>", "#5420", "#5421", "#[100+1]", "#3", "#199", "2.5", "-3", "0",
    "[#1+#2]", "[#1*0.1]", "COS[#1*10]", "SQRT[#2]", "[#1/#2]", "[#1 MOD 3]", "FIX[#1/2]", "[#1 GT 2]", "[#<a>+1]",
    "[#100**2]", "EXISTS[#<a>]", "ATAN[#1]/[#2]", "[[#1] EQ 3]", "ABS[#101]", "[10**300*10**300]", "#<_line>",
    "[[1 LT #1] + [#2 LE 3]]", "#<_value>", "#<_value_returned>", "[#1 AND #2]", "##30", "#<_call_level>", "#<c>",
)  # fmt: skip
LINES = (
    "#1=[#1+1] G1 XV", "#2=V", "#100=V", "#101=V", "#<a>=V", "#<_b>=V", "#[100+#1]=V", "#[#1]=V", "#5420=V",
    "#2=V #100=V", "#<a>=V #2=#<a>", "#<c>=V", "G1 XV YV", "G0 ZV", "XV", "G1 XV YV ZV F500", "YV ZV", "G2 XV YV R20",
    "G3 X1 I2 J[#1]", "FV", "G1 FV", "G91", "G90", "G20", "G21", "(a remark)", "#2=V (another)", "; nothing", "",
    "M3 S100", "G4 P0.1", "G1 X5 Y#1",
    "X1 Y2 Z3", "N70 G1 XV", "o<p> call [V]", "o<p> call [V] [V]", "o<q> call",
    "o<r> call [V]", "G[#1-1] X1", "G52 X[#1]", "G1 AV", "G53 G0 X1", "G41.1 D1", "G40", "X9999", "M#1", "(debug,#1)",
    "G81 X1 Z-1 R1", "/G1 XV", "/#2=V", "G1 XV YV (far)", "T1 M6", "G93 G1 X1 F2", "G94", "G10 L2 P1 R10",
    "G10 L2 P1 R0",
    "G7", "G8", "S#1", "M2", "M70", "M72", "M73", "#5600=1", "G92 XV", "G92.1", "G43.1 ZV", "G49", "G17.1", "G17",
    "G5.2 X1 Y1 L3\nX2 Y2\nX3 Y1\nG5.3", "G0 UV", "@1 ^V", "G38.3 Z-1",
    "G1 X1\nX2\nX3\nX4\nX5\n\nX6\nG0 X7\nX8\nX9\nX10\nX11\nX12\nX13", "o900 sub",
)  # fmt: skip
MOTION = ("G1 XV YV", "G0 ZV", "XV", "YV ZV", "G1 X[#1] Y[#2] Z0", "#1=[#1+1]", "#100=V", "#<a>=V", "o<p> call [V]")


class Writer:
    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.wild = self.random.choice((0.0, 0.05, 0.1, 0.5))
        self.odd = self.random.choice((0.0, 0.0, 0.05))
        self.id = 1
        self.around: list[int] = []

    def line(self) -> str:
        text = self.random.choice(LINES if self.random.random() < self.wild else MOTION)
        while "V" in text:
            text = text.replace("V", self.random.choice(VALUES), 1)
        return text

    def label(self) -> int:
        self.id += 1
        if self.random.random() < self.odd:
            return self.random.randint(1, self.id)
        return self.id

    def body(self, depth: int) -> list[str]:
        lines: list[str] = []
        for _ in range(self.random.randint(1, 5)):
            pick = self.random.random()
            if pick < 0.12 and depth < 3:
                lines += self.branch(depth)
            elif pick < 0.22 and depth < 3:
                lines += self.loop(depth + 1)
            elif pick < 0.25:
                lines += self.leaving()
            else:
                lines.append(self.line())
        return lines

    def leaving(self) -> list[str]:
        id = self.label()
        around = self.random.choice(self.around) if self.around and self.random.random() < 0.3 else 0
        target = around or (self.around[-1] if self.around else 77)
        word = self.random.choice(
            (f"o{target} break", f"o{target} continue", f"o<p> return [{self.value()}]", "o<p> return")
        )
        return [f"o{id} if [{self.value()} GT 2]", word, f"o{id} endif"]

    def value(self) -> str:
        return self.random.choice(VALUES)

    def branch(self, depth: int) -> list[str]:
        id = self.label()
        lines = [f"o{id} if [{self.value()} LT 3]", *self.body(depth + 1)]
        while self.random.random() < 0.3:
            lines += [f"o{id} elseif [{self.value()} GT 1]", *self.body(depth + 1)]
        if self.random.random() < 0.5:
            lines += [f"o{id} else", *self.body(depth + 1)]
        return [*lines, f"o{id} endif"]

    def loop(self, depth: int) -> list[str]:
        id = self.label()
        counter = f"#{109 + depth}"
        times = self.random.choice((2, 5, 9, 40 if depth == 1 else 4))
        kind = self.random.choice(("while", "while", "do", "repeat"))
        if kind == "repeat":
            return [f"o{id} repeat [{times}]", *self.body(depth), f"o{id} endrepeat"]
        self.around.append(id)
        body = [f"{counter}=[{counter}+1]", *self.body(depth)]
        self.around.pop()
        if kind == "do":
            return [f"{counter}=0", f"o{id} do", *body, f"o{id} while [{counter} LT {times}]"]
        return [f"{counter}=0", f"o{id} while [{counter} LT {times}]", *body, f"o{id} endwhile"]

    def routine(self, name: str) -> list[str]:
        lines = [f"o<{name}> sub", *self.body(2)]
        end = self.random.choice(("", f" [{self.value()}]"))
        return [*lines, f"o<{name}> endsub{end}"]

    def program(self) -> str:
        routines = [*self.routine("p"), *self.routine("q")]
        routines = [line for line in routines if not line.startswith("o<q> call")]
        deep = self.random.choice((3, 12))
        last = ["o<r> sub", f"o77 if [#<_call_level> LT {deep}]", "o<r> call [#1+1]", "o77 endif"]
        last += [*self.body(2), "o<r> endsub"]
        lines = ["G21 G90 F500 G1 X0", "#1=0 #2=3", "#100=1 #101=-2 #30=2", "#<a>=1", "#<_b>=2", "#<c>=3"]
        for _ in range(self.random.randint(1, 3)):
            lines += [*self.loop(1), self.line()]
        before = self.random.random() < 0.7
        return "\n".join(
            [*(routines if before else []), *last, *lines, "G0 Z5", "M2", *([] if before else routines), ""]
        )


def run(text: str, woven: bool, keep_going: bool, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        if not woven:
            patch.setattr(interpreter, "weave_loop", lambda run, text, first: None)
            patch.setattr(interpreter, "weave_routine", lambda run, text, first, name: None)
        result = aircut.loads(text, "linuxcnc").run(
            built_in("XYZA"), keep_going=keep_going, limits=Limits(blocks=5_000), block_delete=len(text) % 2 == 0
        )
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    ran: Any = result._interpreter
    m = ran.state
    counts = ran.repeated, ran.line, ran.next_line, ran.modal.name, m.motion_name, m.told, m.position, m.scope
    flow = ran.flow.breaking, ran.flow.continuing, ran.flow.sub, len(ran.flow.stack)
    marks = {label: (mark.kind, mark.line, mark.taken, mark.left) for label, mark in ran.flow.marks.items()}
    numbered = list(m.numbered)
    return (result.toolpath.to_numpy().tobytes(), events, result.diagnostics, result.state, result.variables, counts,
            flow, marks, numbered, m.names)  # fmt: skip


def compare(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    writer = Writer(seed)
    text = writer.program()
    keep_going = writer.random.random() < 0.6
    woven = run(text, True, keep_going, monkeypatch)
    plain = run(text, False, keep_going, monkeypatch)
    for part, other in zip(woven, plain, strict=True):
        assert part == other, text


@pytest.mark.parametrize("seed", range(200))
def test_what_is_compiled_whole_agrees(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    compare(seed, monkeypatch)
