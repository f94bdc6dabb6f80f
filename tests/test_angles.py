"""Angles: the compiled kernel and its twin agree, and what has a round value has it to the last bit."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aircut.kernels import angles, twin

both = pytest.mark.parametrize("kernel", [angles, twin("angles", "aircut.kernels.angles_twin")], ids=["built", "twin"])
NAMES = ("sine", "cosine", "tangent", "to_degrees")


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300))
def test_twins(value: float) -> None:
    other = twin("angles", "aircut.kernels.angles_twin")
    assert [getattr(angles, name)(value) for name in NAMES] == [getattr(other, name)(value) for name in NAMES]


@both
def test_round_values(kernel: object) -> None:
    """By hand; in 53 bits SIN[30] is 0.49999999999999994."""
    found = [kernel.sine(30.0), kernel.sine(150.0), kernel.cosine(60.0), kernel.tangent(45.0), kernel.tangent(-135.0)]
    assert found == [0.5, 0.5, 0.5, 1.0, 1.0]
    assert kernel.to_degrees(math.acos(0.0)) == 90.0


@both
def test_no_angle(kernel: object) -> None:
    with pytest.raises(ValueError):
        kernel.sine(math.inf)
    with pytest.raises(TypeError):
        kernel.cosine(None)
