"""Canned cycles: what a case file cannot say."""

import msgspec
import numpy as np
import pytest

import aircut
from aircut.canon import BY_HAND, EXACT_PATH, EXACT_STOP, Kind, Recording
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.rosetta import ROSETTA
from aircut.machine import built_in
from aircut.source import Source


def test_peck_retract_is_the_machine_s() -> None:
    machine = built_in()
    machine.options = msgspec.structs.replace(machine.options, peck_retract=2.54)
    text = "F100 G99\nG73 Z-2 R0 Q1.5\nG20 G83 Z-1 R0 Q0.6\nM2\n"
    heights = aircut.loads(text).run(machine).toolpath.z
    inches = [0, -0.6, 0, -0.5, -1, 0]
    assert heights.tolist() == pytest.approx([0, -1.5, 1.04, -2, 0, *(25.4 * z for z in inches)])


def test_the_way_out_by_hand_is_a_move() -> None:
    """Nobody commands it, so the listing has it not; but the tool does leave the hole (AMB-CYC-2)."""
    path = aircut.loads("F100 S500 M3\nG0 Z5\nG98 G88 X1 Z-3 R2\nG0 X9\nM2\n").run().toolpath
    assert path.z.tolist() == [5, 5, 2, -3, 5, 5]
    assert [bool(flag) for flag in path.flags & BY_HAND] == [False, False, False, False, True, False]
    assert path.kind[4] == Kind.TRAVERSE


def test_cycles_are_exact_paths_and_stop_where_all_moves_stop() -> None:
    path = aircut.loads("F100\nG81 Z-3 R0\nG61.1\nZ-4\nM2\n").run().toolpath
    assert path.flags.tolist() == [EXACT_PATH] * 3 + [EXACT_PATH | EXACT_STOP] * 3


def test_a_million_bites_are_refused_at_once() -> None:
    result = aircut.loads("F100\nG83 Z-1000 R0 Q1 L1001\nM2\n").run()
    assert [d.code for d in result.diagnostics] == ["bad-value"]
    assert not aircut.loads("F100\nG83 Z-10 R0 Q1 L3\nM2\n").run().diagnostics


class Tilted:
    """Any frame: a turn about an axis that is none of the machine's, and a shift."""

    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [-2.0, 1.0, 0.3], [0.1, -0.4, 1.0]]))[0]
    shift = np.array([10.0, -20.0, 5.0])

    def to_space(self, place: list[float]) -> list[float]:
        return [*(self.turn @ place[:3] + self.shift).tolist(), *place[3:]]

    def to_program(self, place: list[float]) -> list[float]:
        return [*(self.turn.T @ (np.array(place[:3]) - self.shift)).tolist(), *place[3:]]


def ends(text: str, frame: Tilted | None) -> np.ndarray:
    """Ends of the moves of a program that starts at the program's origin in a frame."""
    interpreter = Interpreter(Source("<text>", text.encode()), ROSETTA, built_in())
    recording = Recording()
    interpreter.state.frame = frame
    for chunk in interpreter.run():
        recording.add(chunk)
    assert not interpreter.failed, interpreter.diagnostics
    return recording.toolpath.ends()[:, :3]


@pytest.mark.parametrize("plane", ["G17", "G18", "G19"])
@pytest.mark.parametrize("distance", ["G90", "G91"])
def test_cycles_and_polar_words_work_in_any_frame(plane: str, distance: str) -> None:
    """All their moves are the turned moves of the same program without the frame."""
    across, normal = {"G17": ("XY", "Z"), "G18": ("XZ", "Y"), "G19": ("YZ", "X")}[plane]
    text = f"""F100 S500 M3 {plane}
        G0 X1 Y2 Z3
        {distance} G98 G83 {across[0]}5 {across[1]}6 {normal}-9 R1 Q3 L2
        G99 {across[0]}7
        G88 {normal}-12 R-3
        G85 @10 ^20 {normal}-12 R-4 L2
        G1 ^35
        G16 {across[0]}8 {across[1]}90
        M102
    """
    frame = Tilted()
    assert ends(text, frame)[1:] == pytest.approx(ends(text, None)[1:] @ frame.turn.T + frame.shift)
