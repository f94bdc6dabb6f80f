"""The lines of a function that `weaving` writes: settings and straight moves, and others as the interpreter's.

What a line asks for beyond that is left to the general lane before anything of it has happened.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aircut.canon import Kind
from aircut.diagnostics import Refusal
from aircut.interpreter.linuxcnc.blocks import BRACKETS, Item, read
from aircut.interpreter.linuxcnc.looms import Values, own_name
from aircut.interpreter.linuxcnc.state import FAULTS, LAST, READ_ONLY
from aircut.interpreter.linuxcnc.text import check
from aircut.kernels import scan
from aircut.language.arithmetic import LARGEST
from aircut.language.expressions import Application, Expression, Name, Number

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.files import Text
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

STRETCH = 12  # plain lines on end that the fast lane is faster with
STRAIGHT = {"g0": int(Kind.TRAVERSE), "g1": int(Kind.FEED)}
LINEAR = "xyz"
FREELY = 5000  # numbered parameters below have no meaning of their own


class Emitter:
    """Writes lines of Python for lines of one text."""

    def __init__(self, run: Interpreter, text: Text) -> None:
        self.run = run
        self.m = run.state
        self.text = text
        self.lines: list[str] = []
        self.space: dict[str, Any] = {"text": text}

    # --- text

    def put(self, depth: int, *lines: str) -> None:
        self.lines += ["    " * depth + line for line in lines]

    def leave(self, depth: int, line: int, condition: str = "") -> None:
        """Leave a line to the general lane."""
        if condition:
            self.put(depth, f"if {condition}:")
        self.put(depth + bool(condition), f"run.next_line = {line}", "return None")

    def value(self, depth: int, name: str, node: Expression, line: int, checked: bool = True) -> None:
        """Compute a value into a variable of the function, or leave the line."""
        writer = Values(self.m)
        bracketed = isinstance(node, Application) and node.function is BRACKETS
        text, _ = writer.checked(node.arguments[0]) if bracketed else writer.expression(node)  # type: ignore[union-attr]
        if any("m." in part for part in (text, *writer.steps)):
            self.put(depth, f"m.line = out.line = {line + 1}")
        for step in writer.steps:
            self.put(depth, step.strip())
        self.put(depth, f"{name} = {text}")
        if checked and isinstance(node, Application):
            self.leave(depth, line, f"not -{LARGEST!r} <= {name} <= {LARGEST!r}")

    def blank(self, at: int) -> bool:
        source = self.text.source
        raw = source.raw(at)
        return not raw.strip() or (self.run.settings.block_delete and raw.lstrip().startswith(b"/"))

    # --- lines

    def stretch(self, depth: int, at: int) -> int:
        """A line, or plain lines on end; returns the one behind."""
        if self.blank(at):
            return at + 1
        classes = self.text.source.classes
        end = last = at
        while end < len(classes) and classes[end] != scan.OTHER:
            end += 1
            last = end if classes[end - 1] == scan.PLAIN else last
        if end - at >= STRETCH:
            self.put(
                depth,
                f"run.next_line = {at}",
                "acting = True",
                f"while run.next_line < {last}:",
                "    run.advance(run.next_line, True)",
                "    if run.talk is not None or m.finished or not steady(m): return None",
                "acting = False",
                f"if run.next_line > {end}: return None",
                "M = asked",
            )
            return end
        self.line(depth, at)
        return at + 1

    def line(self, depth: int, at: int) -> None:
        """A block."""
        line = self.text.line(at)
        try:
            check(line.code)
            items = read(line.code)
        except Refusal:
            items = None
        self.put(depth, f"line = {at}")
        if items is None or line.comment is not None or line.code.startswith("/"):
            self.carry(depth, at)
        elif items and all(item.target is not None for item in items) and self.free(items):
            self.settings(depth, at, items)
        elif (words := self.straight(items)) is not None:
            self.put(depth, "if M is asked: M = modes(run)")
            code, nodes = words
            other = "" if code else " or not (run.modal is g1 or run.modal is g0)"
            self.put(depth, f"if not M{other}:")
            self.carry(depth + 1, at)
            self.put(depth, "else:")
            self.move(depth + 1, at, code, nodes)
        else:
            self.carry(depth, at)

    def carry(self, depth: int, at: int) -> None:
        """Let the interpreter carry out a block."""
        self.put(depth, "acting = True", f"run.advance({at}, False)", "acting = False")
        self.settled(depth, at + 1)

    def settled(self, depth: int, after: int) -> None:
        """Behind a block of the interpreter's: go on if nothing else is to be done first."""
        self.put(
            depth,
            f"if run.next_line != {after} or run.talk is not None or m.finished or not steady(m): return None",
            "M = asked",
        )

    def free(self, items: list[Item]) -> bool:
        """Whether the settings need nothing but to be made."""
        for item in items:
            target = item.target
            if isinstance(target, Name):
                if not own_name(self.m, str(target.parts[0])):
                    return False
            elif target is not None and isinstance(target.number, Number):
                number = target.number.value
                if number != int(number) or not 1 <= number <= LAST or int(number) in (*READ_ONLY, *FAULTS):
                    return False
        return True

    def settings(self, depth: int, at: int, items: list[Item]) -> None:
        """All values, then all settings."""
        names = [str(item.target.parts[0]) for item in items if isinstance(item.target, Name)]
        for name in names:
            self.put(depth, f"m.create({name!r})")
        for i, item in enumerate(items):
            self.value(depth, f"s{i}", item.value, at)
        for i, item in enumerate(items):
            if not isinstance(item.target, Name):
                assert item.target is not None
                if not isinstance(item.target.number, Number):
                    self.value(depth, f"n{i}", item.target.number, at)
                    self.put(depth, f"n{i} = m.number_of(n{i})")
                    self.leave(depth, at, f"not 0 < n{i} < {FREELY}")
        for i, item in enumerate(items):
            if isinstance(item.target, Name):
                name = str(item.target.parts[0])
                self.put(depth, f"{'S' if self.m.is_local(name) else 'N'}[{name!r}] = s{i}")
            elif item.target is not None and isinstance(item.target.number, Number):
                self.put(depth, f"V[{int(item.target.number.value)}] = s{i}")
            else:
                self.put(depth, f"V[n{i}] = s{i}")

    def straight(self, items: list[Item]) -> tuple[str, dict[str, Expression]] | None:
        """The code, or "", and the axis words of a straight move and nothing else."""
        code = ""
        words: dict[str, Expression] = {}
        for item in items:
            if item.letter == "g" and isinstance(item.value, Number) and item.value.value in (0.0, 1.0) and not code:
                code = f"g{item.value.value:g}"
            elif item.letter and item.letter in LINEAR and item.letter in self.m.axes and item.letter not in words:
                words[item.letter] = item.value
            else:
                return None
        return (code, words) if words else None

    def move(self, depth: int, at: int, code: str, words: dict[str, Expression]) -> None:
        """A straight move, from words to its row."""
        for letter, node in words.items():
            self.value(depth, f"w{letter}", node, at)
        self.put(
            depth,
            "if known is not M:",
            "    absolute, unit, lx, hx, ly, hy, lz, hz, dx, dy, dz, ox, oy, oz, rest = known = M",
            "    place = None",
            "if place is not m.position:",
            "    x, y, z, a, b, c, u, v, w = place = m.position",
            "    sx = x + dx + ox; sy = y + dy + oy; sz = z + dz + oz",
        )
        for letter in words:
            self.put(depth, f"n{letter} = w{letter} * unit + (0.0 if absolute else {letter})")
            self.put(depth, f"s{letter} = n{letter} + d{letter} + o{letter}")
        inside = " and ".join(f"l{letter} <= s{letter} <= h{letter}" for letter in words)
        self.leave(depth, at, f"not ({inside})")
        for letter in words:
            self.put(depth, f"{letter} = n{letter}")
        if code:
            self.put(depth, f"if run.modal is not {code}:", f"    run.modal = {code}", f"    m.motion_name = {code!r}",
                     "    m.cycle = None")  # fmt: skip
        kind = str(STRAIGHT[code]) if code else "kind"
        self.space[f"r_{at}"] = [None, None, None]  # the row of this line but for its place, and what it was made for
        if not code:
            self.put(depth, "kind = 1 if run.modal is g1 else 0")
        self.put(
            depth,
            f"if r_{at}[0] is not M{'' if code else f' or r_{at}[2] != kind'}:",
            f"    r_{at}[:] = M, template(rest, {at + 1}, {kind}, out.file), {kind}",
            f"row = r_{at}[1]",
            "place_in(row, 0, sx, sy, sz)",
            "out.rows += row",
            "m.position = place = [x, y, z, a, b, c, u, v, w]",
            "m.told = place[:]",
        )
