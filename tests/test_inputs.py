"""Fuzzing, the part of it that always runs: what was found before, and a fixed sample (scripts/fuzz has the rest)."""

import random
from pathlib import Path

import pytest

import inputs

FOUND = sorted((Path(__file__).parent / "found").glob("*"))


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.name)
def test_found_before(path: Path) -> None:
    """Texts (.ngc) as they were found; inputs (.bin) as scripts/fuzz writes them."""
    data = path.read_bytes()
    if path.suffix == ".bin":
        inputs.one(data)
    else:
        for dialect in ("rosetta", "linuxcnc"):
            inputs.fit(data, dialect, inputs.machine(inputs.Choices(b"")))


@pytest.mark.parametrize("seed", range(8))
def test_sample(seed: int) -> None:
    choose = random.Random(seed)
    for _ in range(200):
        inputs.one(choose.randbytes(choose.choice((20, 60, 150, 400))))
