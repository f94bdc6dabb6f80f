"""Roughing in passes, worked out by hand for a step of 10 by 10 with its approach on a slope of 1 in 5."""

import pytest

from aircut.geometry.offsetting import Element
from aircut.geometry.roughing import Cut, Pockets, Roughing, Turning, beside, check_monotonic, joined

START = (2.0, 15.0)
STEP = [Element((0.0, 5.0), (-10.0, 5.0)), Element((-10.0, 5.0), (-10.0, 15.0))]


def test_passes_of_a_step() -> None:
    cuts = list(Roughing(START, joined(START, STEP), 5.0, 0.5, Pockets.ALL).cuts())
    assert cuts == [
        Cut(True, (2.0, 15.0)),
        Cut(False, (-10.0, 15.0)),
        Cut(True, (-9.5, 15.5)),
        Cut(True, (1.5, 15.5)),
        Cut(True, (2.0, 15.0)),
        Cut(True, (1.0, 10.0)),
        Cut(False, (-10.0, 10.0)),
        Cut(True, (-9.5, 10.5)),
        Cut(True, (0.5, 10.5)),
        Cut(True, (1.0, 10.0)),
        Cut(True, (0.0, 5.0)),
        Cut(False, (-10.0, 5.0)),
        Cut(False, (-10.0, 15.0)),
    ]


def test_an_allowance_lies_on_the_side_of_the_stock() -> None:
    assert beside(STEP, 1.0) == [Element((0.0, 6.0), (-9.0, 6.0)), Element((-9.0, 6.0), (-9.0, 15.0))]


def test_a_contour_that_goes_back_is_refused() -> None:
    with pytest.raises(Turning):
        check_monotonic([Element((0.0, 5.0), (1.0, 8.0))])
