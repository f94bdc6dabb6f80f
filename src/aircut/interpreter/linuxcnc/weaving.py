"""Loops and subroutines as Python functions: what repeats is compiled whole.

The general lane stays the meaning. A function does what that would, line by line, and leaves
a line to it before anything of it has happened where the line asks for more: a value that
cannot be computed, a label that is new, a limit in the way. Straight moves are packed here, settings
made; other blocks are carried out by the interpreter. A function (run, modes) returns the modes
where it came to its end, None where the interpreter is to go on at its next line.
Source: the canonical listing, sections 7 and 9.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from aircut.canon import CHUNK, ROW
from aircut.diagnostics import Refusal
from aircut.interpreter.compiling import FAILURES
from aircut.interpreter.linuxcnc.blocks import ENVIRONMENT, OLine, brackets
from aircut.interpreter.linuxcnc.emitting import Emitter
from aircut.interpreter.linuxcnc.flow import DEEPEST, Level
from aircut.interpreter.linuxcnc.looms import ASKED, Loom, Modes, fail, modes, steady
from aircut.interpreter.linuxcnc.state import ARGUMENTS, LOCALS
from aircut.interpreter.looms import LINEAR_PLACE, template
from aircut.language.expressions import Expression, Number

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc import files
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

FULL = CHUNK * ROW.size
LONGEST = 2000  # lines of a function
#: What leaves a line to the general lane, which says what is wrong with it.
EVALUATION = (*FAILURES, Refusal, KeyError)


class Unwoven(Exception):
    """It cannot be compiled."""


class Weaver(Emitter):
    """Writes the function of one loop or subroutine."""

    def __init__(self, run: Interpreter, text: files.Text, sub: str) -> None:
        super().__init__(run, text)
        self.sub = sub
        self.hoisted: list[str] = []
        self.words: dict[int, OLine] = {}  # the O-words, by line
        self.opened: set[str] = set()
        self.loops: list[str] = []  # labels of the loops around, the innermost last; "" of a REPEAT

    def survey(self, first: int, ends: Callable[[OLine], bool]) -> int:
        """Read the O-words from a line on up to the one that ends it; returns its line. Raises Unwoven."""
        text = self.text
        for at in range(first, min(len(text.source), first + LONGEST)):
            if self.blank(at):
                continue
            line = text.line(at)
            if line.fanuc is not None or line.code == "%":
                raise Unwoven
            word = line.oline
            if word is None:
                continue
            if not isinstance(word.label, str) or word.keyword in ("", "?", "sub"):
                raise Unwoven
            self.words[at] = word
            if ends(word):
                return at
        raise Unwoven

    def mark(self, depth: int, at: int, kind: str) -> str:
        """The variable of a label's mark, which stands where it should."""
        label = f"{self.sub}#{self.words[at].label}"
        if label in self.opened:
            raise Unwoven
        self.opened.add(label)
        name = f"k{len(self.opened)}"
        self.hoisted.append(f"{name} = marks.get({label!r})")
        self.leave(
            depth, at, f"{name} is None or {name}.line != {at} or {name}.text is not text or {name}.kind != {kind!r}"
        )
        return name

    def nothing(self, at: int) -> None:
        if self.words[at].rest:
            raise Unwoven

    def single(self, at: int) -> Expression:
        """The value in brackets behind an O-word. Raises Unwoven, Refusal."""
        return brackets(self.words[at], 1, 1)[0]

    def body(self, depth: int, first: int, ends: tuple[str, ...], label: str) -> int:
        """Lines up to an O-word of this label and one of these kinds; returns its line. Raises Unwoven."""
        at = first
        self.put(depth, "pass")
        while True:
            if at >= first + LONGEST:
                raise Unwoven
            word = self.words.get(at)
            if word is None:
                at = self.stretch(depth, at)
            elif word.keyword in ends and word.label == label:
                return at
            else:
                at = self.WORDS.get(word.keyword, Weaver.misplaced)(self, depth, at)

    def misplaced(self, depth: int, at: int) -> int:
        raise Unwoven

    def back(self, depth: int, at: int, start: int) -> None:
        """Jump back to the start of a loop: it is counted."""
        self.leave(depth, at, "run.repeated >= limit")
        self.put(depth, "run.repeated += 1")
        self.leave(depth, start, f"len(out.rows) >= {FULL} or out.used > out.stowed")

    def while_(self, depth: int, at: int) -> int:
        """A WHILE; returns the line after its ENDWHILE."""
        label = str(self.words[at].label)
        self.mark(depth, at, "while")
        self.put(depth, "while True:", f"    line = {at}")
        self.value(depth + 1, "t", self.single(at), at, False)
        crossed = ["    flow.breaking = True"] if self.breaks(at, label) else []
        self.put(depth + 1, "if t == 0.0:", *crossed, "    break")
        return self.looped(depth, at, "endwhile", label)

    def breaks(self, at: int, label: str) -> bool:
        """Whether the loop of this label has a BREAK behind a line. Passed over, LinuxCNC remembers it."""
        end = next((line for line in sorted(self.words) if line > at and self.closes(line, label)), at)
        return any(
            word.keyword == "break" and word.label == label for line, word in self.words.items() if at < line < end
        )

    def repeat(self, depth: int, at: int) -> int:
        """A REPEAT; returns the line after its ENDREPEAT."""
        label = str(self.words[at].label)
        if any(word.label == label and word.keyword in ("break", "continue") for word in self.words.values()):
            raise Unwoven  # they are refused, even passed over
        k = self.mark(depth, at, "repeat")
        self.put(depth, "while True:", f"    line = {at}", f"    if {k}.taken: {k}.left -= 1", "    else:")
        self.value(depth + 2, "t", self.single(at), at, False)
        self.put(depth + 2, f"{k}.left = round(t) if abs(t) < 1e9 else 0", f"{k}.taken = True")
        self.put(depth + 1, f"if {k}.left <= 0:", f"    {k}.taken = False", "    break")
        return self.looped(depth, at, "endrepeat", label, False)

    def looped(self, depth: int, at: int, end: str, label: str, breakable: bool = True) -> int:
        """The body of a loop, and its end."""
        self.loops.append(label if breakable else "")
        last = self.body(depth + 1, at + 1, (end,), label)
        self.nothing(last)
        self.loops.pop()
        self.put(depth + 1, f"line = {last}")
        self.back(depth + 1, last, at)
        return last + 1

    def do(self, depth: int, at: int) -> int:
        """A DO; returns the line after its WHILE."""
        label = str(self.words[at].label)
        self.nothing(at)
        self.mark(depth, at, "do")
        self.put(depth, "while True:")
        return self.done(depth, at, label)

    def done(self, depth: int, at: int, label: str) -> int:
        """The body of a DO, and its end."""
        self.loops.append(label)
        last = self.body(depth + 1, at + 1, ("while",), label)
        self.loops.pop()
        self.put(depth + 1, f"line = {last}")
        self.value(depth + 1, "t", self.single(last), last, False)
        self.put(depth + 1, "if flow.breaking:", "    flow.breaking = False", "    break", "if t == 0.0: break")
        self.back(depth + 1, last, at + 1)
        return last + 1

    def break_(self, depth: int, at: int) -> int:
        word = self.words[at]
        if not self.loops or self.loops[-1] != word.label or word.rest:
            self.leave(depth, at)
            return at + 1
        self.put(depth, "flow.breaking = True")
        #: The WHILE of a DO is where it is asked for, and its value is computed all the same.
        end = next(line for line in sorted(self.words) if line > at and self.closes(line, str(word.label)))
        if self.words[end].keyword == "while":
            self.put(depth, f"line = {at}")
            self.value(depth, "t", self.single(end), at, False)
            self.put(depth, "flow.breaking = False")
        self.put(depth, "break")
        return at + 1

    def closes(self, at: int, label: str) -> bool:
        return self.words[at].label == label and self.words[at].keyword in ("while", "endwhile")

    def continue_(self, depth: int, at: int) -> int:
        word = self.words[at]
        start = next((line for line in sorted(self.words, reverse=True) if line < at and self.starts(line, word)), -1)
        if not self.loops or self.loops[-1] != word.label or word.rest or self.words[start].keyword != "while":
            self.leave(depth, at)
            return at + 1
        if self.breaks(at, str(word.label)):
            self.put(depth, "flow.breaking = True")
        self.back(depth, at, start)
        self.put(depth, "continue")
        return at + 1

    def starts(self, at: int, word: OLine) -> bool:
        return self.words[at].label == word.label and self.words[at].keyword in ("while", "do")

    def if_(self, depth: int, first: int) -> int:
        """An IF to its ENDIF; returns the line after it."""
        label = str(self.words[first].label)
        k = self.mark(depth, first, "if")
        level, at = depth, first
        taken: list[tuple[int, int, int]] = []  # where in the text a branch ends, how deep, at which line
        while True:
            self.put(level, f"line = {first}")  # nobody can begin at an ELSEIF
            self.value(level, "t", self.single(at), first, False)
            if at == first:
                self.put(level, f"{k}.taken = t != 0.0", "if t != 0.0:")
            else:
                self.put(level, "if t != 0.0:", f"    {k}.taken = True")
            end = self.body(level + 1, at + 1, ("elseif", "else", "endif"), label)
            taken.append((len(self.lines), level + 1, end))
            kind = self.words[end].keyword
            if kind == "elseif":
                self.put(level, "else:")
                level, at = level + 1, end
                continue
            self.nothing(end)
            if kind == "else":
                self.put(level, "else:", f"    {k}.taken = True")
                end = self.body(level + 1, end + 1, ("endif",), label)
                self.nothing(end)
            break
        self.passed(taken, end, label)
        return end + 1

    def passed(self, taken: list[tuple[int, int, int]], end: int, label: str) -> None:
        """Behind a branch that has run the conditions of all ELSEIFs after it are computed too."""
        for place, depth, at in reversed(taken):
            rest, self.lines = self.lines[place:], self.lines[:place]
            for line in range(at, end):
                word = self.words.get(line)
                if word is not None and word.keyword == "elseif" and word.label == label:
                    self.put(depth, f"line = {at}")
                    self.value(depth, "t", self.single(line), at, False)
            self.lines += rest

    # --- calls

    def call(self, depth: int, at: int) -> int:
        """A call, by the function of the subroutine if it has one."""
        word = self.words[at]
        name = str(word.label).rsplit("/", 1)[-1]
        nodes = brackets(word, 0, LOCALS)
        self.put(depth, f"line = {at}")
        for i, node in enumerate(nodes):
            self.value(depth, f"a{i}", node, at, False)
        self.put(depth, f"loom = routines.get({name!r})")
        numbers = "".join(f" or a{i} - a{i} != 0.0" for i, node in enumerate(nodes) if not isinstance(node, Number))
        self.leave(depth, at, f"loom is None or len(stack) >= {DEEPEST} or run.repeated >= limit{numbers}")
        zeros = f"zeros_{len(nodes)}"
        self.space[zeros] = (0.0,) * (LOCALS - len(nodes))
        values = "".join(f"a{i}, " for i in range(len(nodes)))
        counted = self.m.ini.counts_arguments
        scope = f"{{{ARGUMENTS!r}: {float(len(nodes))}}}" if counted else "{}"
        self.put(
            depth,
            f"kept = V[1:{LOCALS + 1}]",
            "if not stack: flow.moves = out.moves",
            f"stack.append(new(Level, (text, {at + 1}, {self.sub!r}, kept, S, {name!r}, False, m.saved, 1, None)))",
            f"V[1:{LOCALS + 1}] = ({values}*{zeros})",
            "m.calls = len(stack)",
            f"m.scope = {scope}",
            "m.saved = None",
            f"flow.sub = {name!r}",
            f"if loom.first <= {at}: run.repeated += 1",
            "if loom.text is not text: run.enter_text(loom.text)",
            "acting = True",
            "M = loom.run(run, M)",
            "acting = False",
            "if M is None: return None",
        )
        return at + 1

    def return_(self, depth: int, at: int) -> int:
        """Back to the caller, with a value."""
        nodes = brackets(self.words[at], 0, 1)
        self.put(depth, f"line = {at}")
        for node in nodes:
            self.value(depth, "t", node, at, False)
        number = " or t - t != 0.0" if nodes else ""
        self.leave(depth, at, f"m.saved is not None or not stack or stack[-1].fanuc or run.repeated >= limit{number}")
        self.put(
            depth,
            f"m.value = {'t' if nodes else '0.0'}",
            f"m.value_returned = {bool(nodes)}",
            "level = stack.pop()",
            "flow.called = True",
            f"V[1:{LOCALS + 1}] = level.locals",
            "m.scope, m.saved, flow.sub, m.calls = level.scope, level.saved, level.sub, len(stack)",
            "run.next_line = level.line",
            f"if level.line <= {at}: run.repeated += 1",
            "if level.text is not text: run.enter_text(level.text)",
            "return M",
        )
        return at + 1

    WORDS: dict[str, Callable[[Weaver, int, int], int]] = {
        "while": while_, "repeat": repeat, "do": do, "if": if_, "call": call, "return": return_,
        "break": break_, "continue": continue_,
    }  # fmt: skip

    # --- the whole

    def build(self, title: str) -> Callable[[Interpreter, Modes], Modes | None]:
        head = [
            "def woven(run, M):",
            "    m = run.state",
            "    out = m.out",
            "    flow = run.flow",
            "    marks, stack, routines = flow.marks, flow.stack, run.routines",
            "    limit = run.settings.limits.blocks",
            "    V, S, N = m.numbered, m.scope, m.names",
            "    g0, g1 = run.lane.motions[:2]",
            "    known = place = None",
            *("    " + line for line in self.hoisted),
            "    acting = False",
            "    try:",
            *self.lines,
            "    except EVALUATION:",
            "        if acting: raise",
            "        run.next_line = line",
            "        return None",
        ]
        space = {
            **ENVIRONMENT,
            **self.space,
            "modes": modes,
            "steady": steady,
            "asked": ASKED,
            "fail": fail,
            "Level": Level,
            "new": tuple.__new__,
            "template": template,
            "place_in": LINEAR_PLACE.pack_into,
            "EVALUATION": EVALUATION,
        }
        exec(compile("\n".join(head), f"<{title}>", "exec"), space)
        woven: Callable[[Interpreter, Modes], Modes | None] = space["woven"]
        return woven


def weave_loop(run: Interpreter, text: files.Text, first: int) -> Loom | None:
    """The function of the loop that begins at a line; None where it cannot be compiled."""
    sub = run.flow.sub
    weaver = Weaver(run, text, sub)
    try:
        word = text.line(first).oline
        if word is None or run.state.ini.keeps_length or not isinstance(word.label, str):
            return None
        label, kind = word.label, word.keyword
        closer = {"while": "endwhile", "do": "while", "repeat": "endrepeat"}[kind]
        weaver.words[first] = word
        weaver.survey(first + 1, lambda other: other.keyword == closer and other.label == label)
        after = weaver.WORDS[kind](weaver, 2, first)
        weaver.leave(2, after, "True")
        return Loom(weaver.build("loop"), sub, first, text)
    except (Unwoven, Refusal, RecursionError, SyntaxError, StopIteration):
        return None


def weave_routine(run: Interpreter, text: files.Text, first: int, name: str) -> Loom | None:
    """The function of a subroutine; None where it cannot be compiled. first: the line behind its SUB."""
    weaver = Weaver(run, text, name)
    try:
        if run.state.ini.keeps_length:
            return None
        last = weaver.survey(first, lambda word: word.keyword == "endsub")
        if weaver.words[last].label != name:
            return None
        weaver.body(2, first, ("endsub",), name)
        weaver.return_(2, last)
        return Loom(weaver.build("subroutine"), name, first, text)
    except (Unwoven, Refusal, RecursionError, SyntaxError, StopIteration):
        return None
