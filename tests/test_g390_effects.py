"""What each word of G390 does to its movement: read from the moves themselves (003, decisions section 21)."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import aircut
import aircut.interpreter.requests
from aircut.canon import ROW, Kind
from aircut.controller import Simulation, World
from aircut.controller.world import Body, File
from aircut.interpreter.running import Run
from aircut.machine import Machine, Tool, built_in

LENGTH = 55.0
STOCK = Body("box", at=(0.0, 0.0, -40.0), size=(100.0, 60.0, 40.0))
READY = "T9 M6\nG43\nF777\nG0 X10 Y10 Z20\n"


class Move(NamedTuple):
    """A move of the tip: machine coordinates without the tool, mm, mm/min."""

    x: float
    y: float
    z: float
    feed: float
    probing: bool


class Log(NamedTuple):
    run: Run
    moves: list[Move]
    events: list[str]  # names, in order
    texts: list[str]  # of windows


def machine(radius: float = 3.0, **limits: tuple[float, float]) -> Machine:
    made = built_in("XYZ")
    made.tools = {9: Tool(9, z=LENGTH, diameter=2 * radius, type=4)}
    for letter, (low, high) in limits.items():
        made.axes[letter] = msgspec.structs.replace(made.axes[letter], min=low, max=high)
    return made


def log(text: str, made: Machine | None = None, *bodies: Body) -> Log:
    run = aircut.loads(text).interpreter(made or machine())
    simulation = Simulation(run, World(File(bodies=list(bodies or [STOCK]))))
    moves, events = [], []
    for chunk in simulation.run():
        moves += [Move(*row[:3], row[8], row[13] == Kind.PROBE) for row in ROW.iter_unpack(chunk.rows)]
        events += [event.name for event in chunk.events]
    return Log(run, moves, events, [window.text for window in simulation.shown])


def near(*values: float) -> list[object]:
    return [pytest.approx(value, abs=1e-6) for value in values]


def touches(moves: list[Move]) -> Iterator[tuple[Move, Move, Move]]:
    """The two touches of each surface, with the way back between them, which has another feed than both."""
    for first, back, second in zip(moves, moves[1:], moves[2:], strict=False):
        if first.probing and second.probing and not back.probing and back.feed not in (first.feed, second.feed):
            yield first, back, second


def test_the_whole_way() -> None:
    """AMB-G390-6, vertex 1 of a stock at the origin, ball of 3, all words at their defaults but X and Y."""
    text = f"{READY}G390 X40 Y30\nM2\n"
    told = log(text)
    assert not told.run.diagnostics
    z, side = 0.0, -3.0  # where the tip stands at the touches
    way = [
        (10, 10, z, 500), (10, 10, z + 5, 777), (10, 10, z, 50), (10, 10, 10, 777),
        (-30, 10, 10, 777), (-30, 10, -5, 777), (side, 10, -5, 500), (side - 5, 10, -5, 777), (side, 10, -5, 50),
        (side - 5, 10, -5, 777), (side - 5, 10, 10, 777), (10, 10, 10, 777),
        (10, -20, 10, 777), (10, -20, -5, 777), (10, side, -5, 500), (10, side - 5, -5, 777), (10, side, -5, 50),
        (10, side - 5, -5, 777), (10, side - 5, 10, 777), (10, 10, 10, 777),
    ]  # fmt: skip
    assert [list(move[:4]) for move in told.moves[1:]] == [near(*place) for place in way]


@pytest.mark.parametrize("back", [1.0, 2.5, 50.0])
def test_d_is_the_way_back_of_each_surface(back: float) -> None:
    found = list(touches(log(f"{READY}G390 D{back} X100 Y100 Z50\nM2\n").moves))
    assert len(found) == 3
    for axis, (first, away, second) in zip((2, 0, 1), found, strict=True):
        assert abs(away[axis] - first[axis]) == pytest.approx(back, abs=1e-6)
        assert second[:3] == tuple(near(*first[:3]))


@pytest.mark.parametrize("depth", [3.0, 8.0, 20.0])
def test_k_is_the_depth_of_x_and_y(depth: float) -> None:
    _, x, y = touches(log(f"{READY}G390 K{depth}\nM2\n").moves)
    assert [move.z for move in (*x, *y)] == near(*[-depth] * 6)


@pytest.mark.parametrize(("fast", "slow"), [(1.0, 2.0), (300.0, 20.0), (2000.0, 900.0)])
def test_h_and_i_are_the_feeds_of_the_touches(fast: float, slow: float) -> None:
    moves = log(f"{READY}G390 H{fast} I{slow} F444\nM2\n").moves[1:]
    found = list(touches(moves))
    assert [(first.feed, back.feed, second.feed) for first, back, second in found] == [(fast, 444.0, slow)] * 3
    touching = [move for one in found for move in (one[0], one[2])]
    assert {move.feed for move in moves if move not in touching} == {444.0}


@pytest.mark.parametrize("height", [1.0, 30.0])
def test_s_is_the_height_of_safe_moves(height: float) -> None:
    told = log(f"{READY}G390 S{height}\nM2\n")
    assert not told.run.diagnostics
    across = [(a, b) for a, b in pairwise(told.moves[1:]) if abs(a.x - b.x) > 6 and b.probing and b.feed == 777.0]
    assert across and all(move.z == pytest.approx(height, abs=1e-6) for pair in across for move in pair)
    assert told.moves[-1][:3] == tuple(near(10, 10, height))


@pytest.mark.parametrize("shift", [-0.5, 0.75])
def test_the_second_touch_counts(shift: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first touch of each surface trips elsewhere: the origins stay those of the second."""
    original = Simulation.probe

    def probe(self, request):  # type: ignore[no-untyped-def]
        reply = original(self, request)
        if request.feed != 500.0 or reply.state != 1:
            return reply
        way = [b - a for a, b in zip(request.start, request.target, strict=True)]
        length = sum(v * v for v in way) ** 0.5
        return reply._replace(position=tuple(p + shift * v / length for p, v in zip(reply.position, way, strict=True)))

    monkeypatch.setitem(Simulation.ANSWERS, aircut.interpreter.requests.Probe, probe)
    told = log(f"{READY}G390\n#500=#5221 #501=#5222 #502=#5223\nM2\n")
    assert not told.run.diagnostics
    assert told.run.state.numbered[500:503] == near(0.0, 0.0, 0.0)


# --- overrides


@pytest.mark.parametrize(
    ("before", "feed", "speed"),
    [("", 1, 1), ("M48", 1, 1), ("M49", 0, 0), ("M50 P0", 0, 1), ("M51 P0", 1, 0), ("M50 P2", 2, 1), ("M50 P3", 3, 1)],
)
def test_overrides_are_off_meanwhile_and_as_before_behind(before: str, feed: int, speed: int) -> None:
    made = machine()
    text = f"{before}\n{READY}G390\n#510=#5136 #511=#5137\nM102\n"
    run = aircut.loads(text).interpreter(made)
    original, meanwhile = Simulation.probe, []
    simulation = Simulation(run, World(File(bodies=[STOCK])))

    def probe(self, request):  # type: ignore[no-untyped-def]
        meanwhile.append((run.state.feed_override, run.state.speed_override))
        return original(self, request)

    answers, Simulation.ANSWERS = Simulation.ANSWERS, {**Simulation.ANSWERS, aircut.interpreter.requests.Probe: probe}
    try:
        for _ in simulation.run():
            pass
    finally:
        Simulation.ANSWERS = answers
    assert not run.failed
    assert len(meanwhile) > 10 and set(meanwhile) == {(0, 0)}
    assert run.state.numbered[510:512] == [feed, speed]


# --- what is put back


@pytest.mark.parametrize(
    ("mode", "motion"),
    [("G0", 0), ("G1", 1), ("G2", 2), ("G3", 3), ("G80", 80), ("S100 M3\nG81 X10 Y10 Z19 R20", 80)],
)
@pytest.mark.parametrize("distance", [90, 91])
def test_modes_are_put_back(mode: str, motion: int, distance: int) -> None:
    text = f"{READY}{mode}\nG{distance}\nG390\n#510=#5101 #511=#5103 #512=#5130\nM2\n"
    told = log(text)
    assert not told.run.failed, told.run.diagnostics
    assert told.run.state.numbered[510:513] == [motion, distance, 777.0]


def test_f_of_the_command_is_not_kept() -> None:
    text = f"{READY}G390 F300\n#510=#5130\nM2\n".replace("F777\n", "")
    told = log(text)
    assert not told.run.failed
    assert told.run.state.numbered[510] == 0.0


# --- the working area


@pytest.mark.parametrize("units", [21, 20])
@pytest.mark.parametrize(("vertex", "x", "y"), [(1, -20, -15), (2, -20, 75), (3, 120, -15), (4, 120, 75)])
def test_ways_out_end_at_the_limits(vertex: int, x: float, y: float, units: int) -> None:
    """X50 and Y50 from 10 mm inside would lead 40 out; the axes end at 20 and at 15."""
    left, front = vertex < 3, vertex in (1, 3)
    made = machine(x=(-20.0, 120.0), y=(-15.0, 75.0))
    start = f"G0 X{10 if left else 90} Y{10 if front else 50} Z20"
    told = log(
        f"T9 M6\nG43\nF777\n{start}\nG{units}\nF20\nG390 V{vertex} H20 I2\nG21\n#510=#5221 #511=#5222\nM2\n", made
    )
    assert not told.run.failed, told.run.diagnostics
    assert (min if left else max)(move.x for move in told.moves) == pytest.approx(x, abs=1e-6)
    assert (min if front else max)(move.y for move in told.moves) == pytest.approx(y, abs=1e-6)
    corner = (0.0 if left else 100.0, 0.0 if front else 60.0)
    assert told.run.state.numbered[510:512] == near(*corner)


def test_the_search_downward_ends_at_the_limit() -> None:
    """The axis may go down to 70, where the tip is at 15: nothing is found there."""
    told = log(f"{READY}G390\nM2\n", machine(z=(70.0, 1000.0)))
    assert "Alarm 101" in told.run.diagnostics[0].message
    assert min(move.z for move in told.moves) == pytest.approx(15.0, abs=1e-6)
    assert not log(f"{READY}G390\nM2\n", machine(z=(30.0, 1000.0))).run.failed


def test_shortened_by_nothing_where_there_is_room() -> None:
    told = log(f"{READY}G390 X40 Y30\nM2\n", machine(x=(-30.0, 200.0), y=(-20.0, 200.0)))
    assert not told.run.failed
    assert min(move.x for move in told.moves) == pytest.approx(-30.0, abs=1e-6)


# --- alarms


def test_an_alarm_stops_all_movement() -> None:
    """The last thing that moves is the touch that found nothing; no line behind G390 runs."""
    told = log(f"{READY.replace('Z20', 'Z60')}G390\nG0 X99\n#510=1\nM2\n")
    assert [d.code for d in told.run.diagnostics] == ["operator-stop"]
    assert told.texts == ["Alarm 101: Sensor was not found during 1st touch movements !"]
    assert len(told.moves) == 2 and told.moves[-1].probing and told.moves[-1].z == pytest.approx(10.0, abs=1e-6)
    assert told.run.state.numbered[510] is None


# --- anywhere


@settings(max_examples=60, deadline=None)
@given(
    place=st.tuples(*[st.floats(-500, 500)] * 3),
    size=st.tuples(st.floats(30, 300), st.floats(30, 300), st.floats(30, 100)),
    radius=st.floats(0.1, 6.0),
    inset=st.tuples(st.floats(1.0, 14.0), st.floats(1.0, 14.0)),
    height=st.floats(1.0, 40.0),
    vertex=st.integers(1, 4),
    units=st.sampled_from([20, 21]),
)
def test_the_origin_is_within_2_um(
    place: tuple[float, float, float],
    size: tuple[float, float, float],
    radius: float,
    inset: tuple[float, float],
    height: float,
    vertex: int,
    units: int,
) -> None:
    left, front = vertex < 3, vertex in (1, 3)
    stock = Body("box", at=(place[0], place[1], place[2] - size[2]), size=size)
    x, y = place[0] + (0 if left else size[0]), place[1] + (0 if front else size[1])
    at = (x + inset[0] * (1 if left else -1), y + inset[1] * (1 if front else -1), place[2] + height)
    scale = 25.4 if units == 20 else 1.0
    text = (
        f"T9 M6\nG43\nF777\nG0 X{at[0]:.9f} Y{at[1]:.9f} Z{at[2]:.9f}\nG{units}\nF30\n"
        f"G390 V{vertex} K{7 / scale:.6f} H20 I2 W3\nG21\n#510=#5261 #511=#5262 #512=#5263\nM2\n"
    )
    told = log(text, machine(radius), stock)
    assert not told.run.failed, told.run.diagnostics
    assert told.run.state.numbered[510:513] == [pytest.approx(v, abs=0.002) for v in (x, y, place[2])]
