"""The canonical listing equals that of LinuxCNC's own interpreter where the languages agree."""

from pathlib import Path

import msgspec
import pytest

import aircut
import oracle
from aircut.machine import Machine, built_in

PROGRAMS = 500  # in one test run; scripts/fuzz runs as many as wanted


def endless() -> Machine:
    """A machine without limits, as the oracle's."""
    machine = built_in("XYZABC")
    machine.axes = {name: msgspec.structs.replace(axis, min=-1e9, max=1e9) for name, axis in machine.axes.items()}
    return machine


def compare(seed: int, folder: Path) -> str:
    """The first difference for the program of this seed, in words; empty when there is none."""
    text = oracle.Writer(seed).program(30)
    theirs, accepted = oracle.ask(text, folder)
    result = aircut.loads(text).run(endless())
    ours = [line.rstrip("\n") for line in result.canon()]
    difference = oracle.differ(ours, theirs)
    if not difference and result.ok != accepted:
        difference = f"ok is {result.ok}, theirs {accepted}: {[str(d) for d in result.diagnostics]}"
    return f"seed {seed}: {difference}" if difference else ""


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
def test_listing_equals_the_oracle(tmp_path: Path) -> None:
    differences = [text for seed in range(PROGRAMS) if (text := compare(seed, tmp_path))]
    assert not differences, f"{len(differences)} of {PROGRAMS}\n" + "\n".join(differences[:5])
