"""Rotary axes: roll-over against the rules as formulas, and the display."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import aircut
from aircut.interpreter.rotary import TRAVEL
from aircut.machine.config import File, Machine, axis_of

ANGLES = st.integers(-2_000_000, 2_000_000).map(lambda n: n / 1000)
MODULI = st.sampled_from([360.0, 400.0, 90.0, 1.0])


def apart(a: float, b: float, modulus: float) -> float:
    """How far two angles are from being one."""
    return abs((a - b + modulus / 2) % modulus - modulus / 2)


@given(ANGLES, ANGLES, MODULI)
def test_each_mode_ends_at_the_target_and_turns_as_told(value: float, here: float, modulus: float) -> None:
    travel = {mode: move(value, here, modulus) for mode, move in TRAVEL.items()}
    assert apart(here + travel[1.0], value, modulus) < 1e-8
    assert apart(here + travel[2.0], value, modulus) < 1e-8
    assert apart(here + travel[3.0], abs(value), modulus) < 1e-8
    assert abs(travel[1.0]) < modulus
    assert -modulus / 2 < travel[2.0] <= modulus / 2 + 1e-8
    assert (0 <= travel[3.0] < modulus) if value >= 0 else (-modulus < travel[3.0] <= 0)


@pytest.mark.parametrize("wrapped", [False, True], ids=["linear", "rounded"])
@pytest.mark.parametrize("mode", [0, 2])
def test_the_display_is_a_matter_of_its_own(wrapped: bool, mode: int) -> None:
    """000 section 9: linear or rounded display; targets do not ask for it (AMB-ROT-7)."""
    axes = {letter: axis_of(letter, {"wrapped_rotary": wrapped} if letter == "a" else {}) for letter in "xyza"}
    machine = Machine(File(axes=axes), {}, own_tools=False)
    program = f"G10 L100 P5802 V{mode}\nG0 A350\nA-20\nG91 A400\nM2\n"
    result = aircut.loads(program).run(machine)
    ends = {0: [350.0, -20.0, 380.0], 2: [-10.0, -20.0, 380.0]}[mode]
    assert result.toolpath.a.tolist() == ends
    assert result.state["position"]["a"] == 380.0
    assert result.state["display"]["a"] == (20.0 if wrapped else 380.0)
    assert result.state["display"]["x"] == 0.0
