"""The fast lane under radius compensation.

`kernels.plain` reads the lines as ever, but its rows, which are the contour, go to a scratch memory;
`kernels.beside` makes of them what the stage of interpreter.compensation would, to the last bit. Where a move asks
for more (an entry, a gouge, a limit in the way), the lines up to it are read once more, so that the
state is that before it, and the stage holds the move before it back as ever.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

from aircut.canon import ROW, Kind
from aircut.geometry.offsetting import Element
from aircut.interpreter.compensation import Held, Move, Nist, growth
from aircut.interpreter.path import RECORDER
from aircut.interpreter.tipping import NOWHERE
from aircut.kernels import beside, plain

if TYPE_CHECKING:
    from aircut.interpreter.lane import Lane
    from aircut.interpreter.state import State
    from aircut.source import Source

LEAST, MOST = 64, 16384  # lines tried at a time: more after success
FEW = 4096
ARC = int(Kind.ARC)


def alone(m: State) -> Nist | None:
    """The stage, where no other works on moves and it holds back one that is no entry."""
    stage = m.stages.get("compensation")
    if not isinstance(stage, Nist) or len(m.stages) != 1 or stage.behind:
        return None
    held = stage.held
    return None if held is None or held.first or held.move.element is None else stage


class Leading:
    """Scratch memory and the number of lines to try next."""

    def __init__(self) -> None:
        self.memory: Any = None
        self.firsts = array("q", [0] * (MOST + 1))
        self.lines = LEAST

    def run(self, lane: Lane, m: State, stage: Nist, source: Source, line: int, end: int) -> int:
        """As Lane.run."""
        if self.memory is None:
            self.memory = memoryview(bytearray(3 * MOST * ROW.size))
        contour, written = self.memory[: MOST * ROW.size], self.memory[MOST * ROW.size :]
        self.read(lane, m, source, line, min(end, line + self.lines))
        moves = lane.numbers[plain.ROWS]
        held, last = self.held(stage), array("d", [0.0] * 2)
        work = array("d", [0.0] * 21), array("d", [0.0] * 4)
        words = contour.cast("q")
        taken = beside.lead(
            array("d", [stage.side * stage.radius, m.dialect.cutter.straight, *stage.shift, *m.space_box, growth(m)]),
            held, stage.u, stage.v, stage.loose, contour.cast("d"), words, moves,
            written.cast("d"), written.cast("q"), self.firsts, last, *work,
        )  # fmt: skip
        if taken < moves:  # the number of the line is the row's first integer
            self.lines = LEAST
            self.read(lane, m, source, line, (words[plain.WIDTH * taken + 9] & beside.LINE) - 1)
        else:
            self.lines = min(2 * self.lines, MOST)
        after = lane.numbers[plain.LINE]
        if not taken:
            if not lane.numbers[plain.ROWS] and after > line:
                lane.settle(m, after)
                lane.tell(m, m.out.moves)
            return after
        self.write(lane, m, stage, held, (last[0], last[1]), taken)
        lane.settle(m, after)
        return after

    def read(self, lane: Lane, m: State, source: Source, line: int, end: int) -> None:
        """Read lines into the scratch memory."""
        lane.prepare(m, line, NOWHERE)
        lane.read(source, end, self.memory[: MOST * ROW.size])

    def held(self, stage: Nist) -> array[float]:
        """What the kernel needs of the move held back."""
        held = stage.held
        assert held is not None and held.move.element is not None
        element, path, guide = held.move.element, held.path, held.guide
        center = element.center or (0.0, 0.0)
        return array("d", [*element.start, *element.end, *center, element.turns if element.center else 0,
                           *path.start, *guide.start, *guide.end, *held.move.end])  # fmt: skip

    def write(
        self, lane: Lane, m: State, stage: Nist, held: array[float], last: tuple[float, float], taken: int
    ) -> None:
        """Write what the kernel has made of the rows taken, and hold the last of them back."""
        out = m.out
        before = stage.held
        assert before is not None
        out.contour += self.memory[: taken * ROW.size]
        out.line = self.move(stage, 0).line
        stage.release(m, last, RECORDER, checked=False)
        base, count = out.moves, self.firsts[taken]
        start = MOST * ROW.size
        space = out.space(count)
        space[: count * ROW.size] = self.memory[start : start + count * ROW.size]
        out.fill(count, FEW)
        told, numbers = lane.numbers[plain.FEEDS], lane.feed_places
        if told:
            m.feed_told = lane.reals[plain.FEED]
        places = [(nth, base + self.firsts[min(numbers[2 * nth], taken)]) for nth in range(told)]
        in_time = [nth for nth, _ in places if numbers[2 * nth] < taken]
        for nth, at in places:
            if nth == len(in_time):
                out.hold()
            out.tell_feeds([at], [numbers[2 * nth + 1]], [lane.feeds[nth]])
        if len(in_time) == told:
            out.hold()
        move = self.move(stage, taken - 1, held)
        element = move.element
        assert element is not None
        ways = [Element((held[at], held[at + 1]), (held[11], held[12]), element.center, element.turns) for at in (7, 9)]
        stage.held = Held(move, ways[0], ways[1], False, before.move if taken == 1 else self.move(stage, taken - 2))
        stage.contour = move.end
        stage.tool = (held[7], held[8])
        if count:
            stage.written = list(space[(count - 1) * ROW.size : count * ROW.size].cast("d")[:6])

    def move(self, stage: Nist, row: int, held: array[float] | None = None) -> Move:
        """A row of the contour as a move; held: with its element."""
        *end, _, _, speed, line, tool, turns, file, kind, _, flags = ROW.unpack_from(self.memory, row * ROW.size)
        element = None
        if held is not None:
            center = (held[4], held[5]) if kind == ARC else None
            element = Element((held[0], held[1]), (held[2], held[3]), center, turns if kind == ARC else 0)
        return Move(kind, end, element, speed, flags, line, file, tool)
