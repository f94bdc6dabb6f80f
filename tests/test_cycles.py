"""Canned cycles: what a case file cannot say."""

import msgspec
import pytest

import aircut
from aircut.canon import BY_HAND, EXACT_PATH, EXACT_STOP, Kind
from aircut.machine import built_in


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
