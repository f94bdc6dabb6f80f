"""The flow of LinuxCNC's programs: O-words, calls, M98 and M99.

Flow is worked out as the program runs, as LinuxCNC does: a label is known from when it
was met; lines that are passed over are not read but for their O-words.
Sources: 001 (subroutine parameters); the canonical listing, section 9.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arithmetic import marked
from aircut.interpreter.linuxcnc.arranging import whole
from aircut.interpreter.linuxcnc.blocks import OLine, arguments, brackets, to_value
from aircut.interpreter.linuxcnc.places import EVALUATION, explained
from aircut.interpreter.linuxcnc.remapping import resume
from aircut.interpreter.linuxcnc.saving import restore_call
from aircut.interpreter.linuxcnc.state import ARGUMENTS, LOCALS

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.files import Text
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

DEEPEST = 9  # calls in calls
LOOPS = ("while", "do")
KINDS = "O… SUB is for CALL, a bare O… for M98"
BRANCHES = ("elseif", "else", "endif")
OPENERS = ("if", "while", "repeat")
PARTNERS = dict.fromkeys(BRANCHES, ("if",)) | dict.fromkeys(("break", "continue"), LOOPS)
PARTNERS |= {"endwhile": ("while",), "endrepeat": ("repeat",)}


@dataclass
class Mark:
    """A label that has been met."""

    kind: str  # sub, o (a bare number), if, while, do, repeat
    text: Text
    line: int  # from 0
    taken: bool = False  # a branch of the IF has run; the REPEAT is going on
    left: int = 0  # passes of the REPEAT


class Level(NamedTuple):
    """A caller, waiting for its call to come back."""

    text: Text
    line: int  # to go on with
    sub: str  # that the caller is in
    locals: list[float] | None  # None: shared (M98)
    scope: dict[str, float | None]
    label: str  # of what was called
    fanuc: bool
    saved: Any  # what M70 saved for the caller
    passes: int  # still to do, with this one
    rest: Any = None  # of the block, behind a remapped code


@dataclass
class Search:
    """Lines are passed over until this label."""

    label: str
    call: bool = False  # it is a subroutine that was called
    fanuc: bool = False
    where: tuple[Text, int] | None = None  # of the call
    file: str = ""  # name of the file that it may be in
    kinds: tuple[str, ...] = field(default=())


def refuse(what: str, hint: str = "") -> Refusal:
    return Refusal(F.O_WORD, what=what, hint=hint)


def bar_fanuc(run: Interpreter) -> None:
    """Raises Refusal where the INI file forbids M98 and bare O numbers."""
    if run.state.ini.no_fanuc:
        raise refuse("M98 and bare O numbers are switched off", "[RS274NGC]DISABLE_FANUC_STYLE_SUB is 1")


class Flow:
    """What leads from line to line. `run` is the interpreter."""

    def __init__(self, run: Interpreter) -> None:
        self.run = run
        self.marks: dict[str, Mark] = {}
        self.stack: list[Level] = []
        self.search: Search | None = None
        self.sub = ""  # that is being run
        self.breaking = False
        self.continuing = False
        self.moves = 0  # made before the call that the main program is in
        #: A call has come back: until a definition is passed over LinuxCNC lets RETURN stand outside of subroutines.
        self.called = False

    # --- labels

    def name(self, line: OLine) -> str:
        """The label as written, or its computed number. Raises Refusal."""
        if isinstance(line.label, str):
            return line.label
        return str(whole("o", line.label(self.run.state, ())[0]))

    def scoped(self, name: str) -> str:
        return f"{self.sub}#{name}"

    def mark(self, label: str, kind: str) -> Mark:
        """Note that a label opens here. Raises Refusal where it opens elsewhere already."""
        run = self.run
        known = self.marks.get(label)
        if known is not None and (known.text is not run.unit or known.line != run.line):
            raise refuse(f"the label {label.split('#')[-1]} is in use by line {known.line + 1}")
        mark = self.marks[label] = Mark(kind, run.unit, run.line)
        return mark

    # --- one O-word

    def step(self, line: OLine) -> None:
        """Carry out an O-word; sets the interpreter's next line. Raises Refusal."""
        if self.search is None:
            self.WORDS[line.keyword](self, line, self.name(line))
            return
        with self.unrun():
            self.passed(line, self.name(line))

    @contextmanager
    def unrun(self) -> Iterator[None]:
        """For what is computed among lines that are passed over: in a definition names without a value read as 0."""
        m = self.run.state
        m.defining = self.search is not None and self.search.kinds == ("endsub",)
        try:
            yield
        finally:
            m.defining = False

    def passed(self, line: OLine, name: str) -> None:
        """An O-word among lines that are passed over."""
        search = self.search
        assert search is not None
        if line.keyword == "?" and search.kinds != ("endsub",):
            self.unknown(line, name)
        if search.call:
            if name == search.label and line.keyword in ("", "sub"):
                self.enter_found(line, name, search)
            elif name == search.label and line.keyword in ("endsub", "return"):
                self.give_back(to_value(line))
            return
        if line.keyword in ("", "sub", "<") and search.kinds == ("endsub",):
            raise refuse("a subroutine inside a subroutine")
        if line.keyword == "return" and name == search.label and search.kinds == ("endsub",):
            self.give_back(to_value(line))
            return
        label = name if line.keyword == "endsub" else self.scoped(name)
        if label != search.label:
            return
        if line.keyword not in search.kinds:
            self.crossed(line, label)
            return
        if line.keyword == "endwhile":
            self.opened(label, ("while",), line)
        self.search = None
        self.WORDS[line.keyword](self, line, name, True)

    def crossed(self, line: OLine, label: str) -> None:
        """An O-word of the label that is sought, but of another kind: LinuxCNC heeds it. Raises Refusal."""
        if line.keyword in OPENERS:
            self.mark(label, line.keyword)
        elif line.keyword in PARTNERS:
            self.opened(label, PARTNERS[line.keyword], line)
            self.breaking = self.breaking or line.keyword == "break"
        elif line.keyword == "do":
            self.search = None

    def values(self, line: OLine, least: int, most: int) -> tuple[float, ...]:
        known = self.run.argument_cache.get(line)
        if known is None:
            known = self.run.argument_cache[line] = arguments(line, least, most)
        try:
            return known(self.run.state, ())
        except EVALUATION as failure:
            raise explained(brackets(line, least, most), self.run.state, failure) from None

    def nothing(self, line: OLine) -> None:
        if line.rest:
            where = (line.end, len(line.code))
            what = f"O … {line.keyword.upper()}" if line.keyword else "an O-word"
            raise Refusal(F.MISPLACED_WORDS, where=where, what=what)

    def skip(self, label: str, *kinds: str) -> None:
        self.search = Search(label, kinds=kinds)

    # --- branches

    def if_(self, line: OLine, name: str, sought: bool = False) -> None:
        label = self.scoped(name)
        (truth,) = self.values(line, 1, 1)
        mark = self.mark(label, "if")
        mark.taken = truth != 0.0
        if not mark.taken:
            self.skip(label, *BRANCHES)

    def elseif(self, line: OLine, name: str, sought: bool = False) -> None:
        """Its condition is computed even where a branch above has run."""
        label = self.scoped(name)
        mark = self.opened(label, ("if",), line)
        (truth,) = self.values(to_value(line) if sought else line, 1, 1)
        if not sought or mark.taken or truth == 0.0:
            self.skip(label, *BRANCHES)
            return
        mark.taken = True

    def else_(self, line: OLine, name: str, sought: bool = False) -> None:
        if not sought:
            self.nothing(line)
        label = self.scoped(name)
        mark = self.opened(label, ("if",), line)
        if not sought or mark.taken:
            self.skip(label, *BRANCHES)
            return
        mark.taken = True

    def endif(self, line: OLine, name: str, sought: bool = False) -> None:
        if not sought:
            self.nothing(line)
            self.opened(self.scoped(name), ("if",), line)

    def opened(self, label: str, kinds: tuple[str, ...], line: OLine) -> Mark:
        mark = self.marks.get(label)
        if mark is None or mark.kind not in kinds:
            raise refuse(f"{line.keyword.upper()} without its {' or '.join(kinds).upper()}")
        return mark

    # --- loops. A BREAK and a CONTINUE are remembered until the end of a loop that asks for them,
    # which need not be the loop that they stood in: so LinuxCNC does it.

    def while_(self, line: OLine, name: str, sought: bool = False) -> None:
        label = self.scoped(name)
        (truth,) = self.values(to_value(line) if sought else line, 1, 1)
        known = self.marks.get(label)
        if known is not None and known.kind == "do":
            if self.breaking:
                self.breaking = False
            elif truth != 0.0:
                self.run.jump(known.text, known.line + 1)
                self.run.loop(known.text, known.line)
            return
        self.mark(label, "while")
        if truth == 0.0:
            self.skip(label, "endwhile")

    def endwhile(self, line: OLine, name: str, sought: bool = False) -> None:
        self.end_loop("while", line, name, sought)

    def end_loop(self, kind: str, line: OLine, name: str, sought: bool) -> None:
        """Back to the top of a loop; sought: by `continue`, or by what skips it. Raises Refusal."""
        if not sought:
            self.nothing(line)
            mark = self.opened(self.scoped(name), (kind,), line)
        elif not self.continuing:
            return
        else:
            self.continuing = False
            mark = self.marks[self.scoped(name)]
        self.run.jump(mark.text, mark.line)
        self.run.loop(mark.text, mark.line)

    def do(self, line: OLine, name: str, sought: bool = False) -> None:
        self.nothing(line)
        self.marks.setdefault(self.scoped(name), Mark("do", self.run.unit, self.run.line))

    def repeat(self, line: OLine, name: str, sought: bool = False) -> None:
        label = self.scoped(name)
        known = self.marks.get(label)
        if known is not None and known.taken and known.line == self.run.line and known.text is self.run.unit:
            known.left -= 1
        else:
            (count,) = self.values(line, 1, 1)
            known = self.mark(label, "repeat")
            known.left = round(count) if abs(count) < 1e9 else 0
            known.taken = True
        if known.left <= 0:
            known.taken = False
            self.skip(label, "endrepeat")

    def endrepeat(self, line: OLine, name: str, sought: bool = False) -> None:
        self.end_loop("repeat", line, name, sought)

    def break_(self, line: OLine, name: str, sought: bool = False) -> None:
        self.nothing(line)
        self.opened(self.scoped(name), LOOPS, line)
        self.breaking = True
        self.skip(self.scoped(name), "while", "endwhile")

    def continue_(self, line: OLine, name: str, sought: bool = False) -> None:
        self.nothing(line)
        self.opened(self.scoped(name), LOOPS, line)
        self.continuing = True
        self.skip(self.scoped(name), "while", "endwhile")

    # --- subroutines

    def sub_(self, line: OLine, name: str, sought: bool = False) -> None:
        """Met while running: the definition is passed over."""
        self.nothing(line)
        if self.stack and self.stack[-1].fanuc:
            raise refuse("a definition in a subroutine of M98", KINDS)
        if self.stack:  # in a subroutine that was called another SUB does nothing
            return
        if name in self.marks:
            raise refuse(f"the definition of {name} stands where the program runs into it", "put it behind M2")
        self.mark(name, "sub")
        self.skip(name, "endsub")

    def endsub(self, line: OLine, name: str, sought: bool = False) -> None:
        if sought:
            self.give_back(to_value(line))
            self.called = False
            return
        self.return_(line, name)

    def return_(self, line: OLine, name: str, sought: bool = False) -> None:
        if not self.stack and not (self.called and line.keyword == "return"):
            raise refuse(f"{line.keyword.upper()} outside a subroutine")
        if self.stack and self.stack[-1].fanuc:
            raise refuse("a subroutine of M98 ends with M99")
        self.give_back(line)
        if self.stack:
            self.leave()

    def give_back(self, line: OLine) -> None:
        """The value behind RETURN or ENDSUB."""
        values = self.values(line, 0, 1)
        m = self.run.state
        m.value = marked(values[0]) if values else 0.0
        m.value_returned = bool(values)

    def call_(self, line: OLine, name: str, sought: bool = False) -> None:
        self.enter(name, self.values(line, 0, LOCALS), 1)

    def enter(self, name: str, values: tuple[float, ...] | None, count: int) -> None:
        """Call a subroutine. values: of its locals; None by M98, where they are shared. Raises Refusal.

        A name with a path is that of the file; the subroutine in it has the last part of it.
        """
        run = self.run
        file, name = name, name.rsplit("/", 1)[-1]
        fanuc = values is None
        self.descend(name, values, count)
        known = self.marks.get(name)
        if known is not None:
            if known.kind != ("o" if fanuc else "sub"):
                raise refuse(f"{name} is not for this kind of call", KINDS)
            run.jump(known.text, known.line + 1)
            if not fanuc:
                run.routine(name, known.text, known.line + 1)
            return
        self.search = Search(name, True, fanuc, (run.unit, run.line), file)
        found = run.find_file(file)
        if found is not None:
            run.jump(found, 0)

    def descend(self, name: str, values: tuple[float, ...] | None, count: int) -> None:
        """Go a level of calls deeper, in the subroutine of this name. Raises Refusal."""
        run, m = self.run, self.run.state
        if len(self.stack) >= DEEPEST:
            raise Refusal(F.TOO_DEEP, limit=DEEPEST, what="calls")
        kept = None
        if values is not None:
            kept = m.numbered[1 : LOCALS + 1]
            m.numbered[1 : LOCALS + 1] = [*map(marked, values), *[0.0] * (LOCALS - len(values))]
        if not self.stack:
            self.moves = m.out.moves
        self.stack.append(Level(run.unit, run.next_line, self.sub, kept, m.scope, name, values is None, m.saved, count))
        m.calls = len(self.stack)
        counted = m.ini.counts_arguments and values is not None
        m.scope = {ARGUMENTS: float(len(values or ()))} if counted else {}
        m.saved = None
        self.sub = name

    def enter_found(self, line: OLine, name: str, search: Search) -> None:
        if (line.keyword == "") != search.fanuc:
            raise refuse(f"{name} is not for this kind of call", KINDS)
        self.search = None
        self.marks[name] = Mark("o" if search.fanuc else "sub", self.run.unit, self.run.line)

    def give_up(self) -> None:
        """A call has found nothing: go on behind it."""
        self.search = None
        self.run.state.saved = None
        self.leave()

    def leave(self) -> None:
        """Go back to the caller."""
        run, m = self.run, self.run.state
        level = self.stack.pop()
        self.called = True
        restore_call(run)
        if level.locals is not None:
            m.numbered[1 : LOCALS + 1] = level.locals
        m.scope, m.saved = level.scope, level.saved
        m.calls = len(self.stack)
        self.sub = level.sub
        run.jump(level.text, level.line)
        if level.rest is not None:
            resume(run, level.rest)

    def bare(self, line: OLine, name: str, sought: bool = False) -> None:
        """A number alone: where M98 enters; nothing to do when it is run into, but in a subroutine of CALL."""
        bar_fanuc(self.run)
        self.nothing(line)
        if self.stack and not self.stack[-1].fanuc:
            raise refuse(f"{name} is not for this kind of call", KINDS)

    def m98(self, name: str, count: int) -> None:
        """M98: call a bare number, so many times. Raises Refusal.

        L0 calls nothing; but LinuxCNC goes a level deeper all the same, and comes back behind it at the next M99.
        """
        bar_fanuc(self.run)
        if count > 0:
            self.enter(name, None, count)
        else:
            self.descend(name, None, 1)

    def m99(self, rest: tuple[int, int]) -> None:
        """M99 in a subroutine: back to M98, or run again. rest: what follows it in the line. Raises Refusal."""
        if rest[0] < rest[1]:
            raise Refusal(F.MISPLACED_WORDS, where=rest, what="M99")
        level = self.stack[-1]
        if not level.fanuc:
            raise refuse("a subroutine of CALL ends with ENDSUB")
        self.run.state.value, self.run.state.value_returned = 0.0, False
        if level.passes > 1:
            restore_call(self.run)
            self.stack[-1] = level._replace(passes=level.passes - 1)
            self.run.state.scope, self.run.state.saved = {}, None
            mark = self.marks[level.label]
            self.run.jump(mark.text, mark.line + 1)
        else:
            self.leave()

    def pass_m99(self, search: Search) -> None:
        """M99 on the way to a subroutine that is called takes back the value, as if it came back."""
        if search.call:
            self.run.state.value, self.run.state.value_returned = 0.0, False

    def unknown(self, line: OLine, name: str, sought: bool = False) -> None:
        where = (line.end, len(line.code))
        found = f"“{line.rest[:12]}”"
        raise Refusal(F.EXPECTED, where=where, wanted="an O-word such as CALL or IF", found=found, hint="")

    def unclosed(self, line: OLine, name: str, sought: bool = False) -> None:
        """LinuxCNC takes no notice of the line."""
        self.run.warn(F.UNCLOSED_NAME)

    WORDS: dict[str, Callable[..., None]] = {
        "": bare, "?": unknown, "<": unclosed, "sub": sub_, "endsub": endsub, "call": call_, "return": return_,
        "if": if_, "elseif": elseif, "else": else_, "endif": endif,
        "while": while_, "endwhile": endwhile, "do": do,
        "repeat": repeat, "endrepeat": endrepeat, "break": break_, "continue": continue_,
    }  # fmt: skip
