"""The canonical listing of LinuxCNC's own language equals that of its interpreter."""

from pathlib import Path

import pytest

import aircut
import oracle
import oracle_linuxcnc

PROGRAMS = 200  # in one test run; scripts/fuzz runs as many as wanted
#: All topics of the writer but cutter compensation, where differences at gouges are still open.
TOPICS = (
    "straight,arc,polar,mode,offset,setting,auxiliary,tool,comment,home,probe,show,flow,call,saved,cycle,spline,thread"
)


def program(seed: int, only: str = "") -> str:
    if seed % 3 == 0:
        return oracle_linuxcnc.probe_line(seed)
    return oracle_linuxcnc.Writer(seed, only).program(25)


def compare(seed: int, folder: Path, only: str = "") -> str:
    """The first difference for the program of this seed, in words; empty when there is none."""
    text = program(seed, only)
    theirs, accepted = oracle.ask(text, folder)
    result = aircut.loads(text, "linuxcnc").run()
    ours = [line.rstrip("\n") for line in result.canon()]
    difference = oracle.differ(ours, theirs)
    if not difference and result.ok != accepted:
        difference = f"ok is {result.ok}, theirs {accepted}"
    if not difference:
        return ""
    return f"seed {seed}: {difference}\n  {[str(d) for d in result.diagnostics]}"


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
def test_listing_equals_the_oracle(tmp_path: Path) -> None:
    differences = [text for seed in range(PROGRAMS) if (text := compare(seed, tmp_path, TOPICS))]
    assert not differences, f"{len(differences)} of {PROGRAMS}\n" + "\n".join(differences[:5])
