"""Words of whole numbers at the bounds of what counts as whole and is in range, against LinuxCNC's interpreter.

G20 in the same block tells whether a fault is found before the block runs or while it does.
"""

from pathlib import Path

import pytest

import oracle
from test_oracle_linuxcnc import difference

BLOCKS = (
    "T{}", "T{} M6", "G43 H{}", "G43.2 H{}", "G41 D{} G1 X1", "G18 G41.1 D.01 L{} G1 X1", "G81 X1 Y1 Z-1 R1 L{}",
    "M66 E{} L0", "M66 P0 L{} Q1", "M62 P{}", "M67 E{} Q1", "M61 Q{}", "M19 R10 P{}", "S100 ${}", "G2 X2 I1 P{}",
    "G5.2 X1 Y1 P1 L{}", "G76 P1 Z-10 I-1 J0.3 K1 H{}", "G76 P1 Z-10 I-1 J0.3 K1 L{}", "G10 L{} P1 X1", "G10 L0 P{}",
    "G10 L1 P{} X1", "G10 L2 P{} X1", "G10 L10 P{} X1", "G10 L11 P{} X1", "G10 L20 P{} X1", "G10 L1 P1 Q{}", "M50 P{}",
    "M53 P{}", "M100 Q{}", "G{} X1", "M{}",
)  # fmt: skip
VALUES = (
    "-0.5",
    "-0.0001",
    "-0.00009",
    "0.0001",
    "0.4",
    "0.9999",
    "0.99995",
    "1.0001",
    "1.5",
    "2.0001",
    "2.9999",
    "9.5",
)


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
@pytest.mark.parametrize("block", BLOCKS)
def test_whole_numbers_equal_the_oracle(block: str, tmp_path: Path) -> None:
    for value in VALUES:
        text = f"G21 F100 S100 M3\nG0 X0 Y0 Z0\nG20 {block.format(value)}\nG0 X5\n(debug,#5400 #5420 #5221)\nM2\n"
        assert not difference(text, tmp_path), text
