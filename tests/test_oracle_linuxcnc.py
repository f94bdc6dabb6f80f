"""The canonical listing of LinuxCNC's own language equals that of its interpreter."""

from math import inf
from pathlib import Path
from subprocess import TimeoutExpired

import msgspec
import pytest

import aircut
import oracle
import oracle_linuxcnc
from aircut import dialects
from aircut.machine import Machine
from explained import MET, explained

PROGRAMS = 300  # in one test run; scripts/fuzz runs as many as wanted


def program(seed: int, only: str = "") -> str:
    if only == "mistyped":
        return oracle_linuxcnc.mistyped(seed)
    if seed % 3 == 0:
        return oracle_linuxcnc.probe_line(seed)
    return oracle_linuxcnc.Writer(seed, only).program(25)


def machine() -> Machine:
    """The oracle's: without limits."""
    made = dialects.machine(dialects.load("linuxcnc"))
    made.axes = {name: msgspec.structs.replace(axis, min=-inf, max=inf) for name, axis in made.axes.items()}
    return made


def difference(text: str, folder: Path) -> str:
    """The first difference for a program, in words; empty when there is none."""
    try:
        theirs = oracle_linuxcnc.ask(text, folder)
    except TimeoutExpired:  # a loop without end, or text that it cannot read
        MET["hang"] += 1
        return ""
    result = aircut.loads(text, "linuxcnc").run(machine())
    ours = [line.rstrip("\n") for line in result.canon()]
    found = oracle.differ(ours, theirs.listing)
    if found and explained(text, found, ours):
        return ""
    if not found and result.ok != theirs.accepted:
        found = f"ok is {result.ok}, theirs {theirs.accepted}"
    if not found and not result.ok:
        line = result.diagnostics[-1].span.line
        at = text.splitlines()[line - 1].strip() if line else ""
        cut = theirs.message == "Command too long" and at.startswith(theirs.line)
        elsewhere = any(words in theirs.message for words in ("seeking o-word", "restore_settings failed"))
        if theirs.line not in ("", at) and not cut and not elsewhere:
            found = f"refused at {at!r}, theirs at {theirs.line!r}: {theirs.message}"
    if not found:
        return ""
    return f"{found}\n  {[str(d) for d in result.diagnostics]}\n  {theirs.message}: {theirs.line}"


def compare(seed: int, folder: Path, only: str = "") -> str:
    """The same for the program of this seed."""
    found = difference(program(seed, only), folder)
    return f"seed {seed}: {found}" if found else ""


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
@pytest.mark.parametrize("only", ["", "compensation", "mistyped"])
def test_listing_equals_the_oracle(only: str, tmp_path: Path) -> None:
    differences = [text for seed in range(PROGRAMS) if (text := compare(seed, tmp_path, only))]
    assert not differences, f"{len(differences)} of {PROGRAMS}\n" + "\n".join(differences[:5])


def test_what_is_explained_is_no_more_than_that() -> None:
    before = MET.copy()
    far = "line 3:\n  ours   ARC_FEED(1.0000, 7739790296528284.0000)\n  theirs ARC_FEED(1.0000, 7739790296528283.0000)"
    assert explained("", far)
    assert not explained("", far.replace("theirs ARC_FEED(1.0000", "theirs ARC_FEED(1.0002"))
    lost = "line 3:\n  ours   STRAIGHT_FEED(0.0000)\n  theirs STRAIGHT_FEED(-60.0000)"
    assert explained("", lost, ["", "SET_G92_OFFSET(0.0000, 15976889103234500608.0000)", "STRAIGHT_FEED(0.0000)"])
    assert not explained("", lost, ["", "SET_G92_OFFSET(0.0000, 50000000.0000)", "STRAIGHT_FEED(0.0000)"])
    back = 'line 3:\n  ours   MESSAGE("1.000000")\n  theirs MESSAGE("0.746000")'
    assert explained("G38.3 A5", back)
    assert not explained("G38.3 A5", back.replace("746", "747"[::-1]))
    assert not explained("G1 A5", back)
    aside = (
        "line 3:\n  ours   STRAIGHT_FEED(0.0, -0.3575, 1.3296, 5.0)\n  theirs STRAIGHT_FEED(0.0, -0.3555, 1.3296, 5.0)"
    )
    assert explained("G38.3 X1\nA5", aside)
    assert not explained("G38.3 X1 A5", aside)
    assert not explained("G38.3 X1\nA5", aside.replace("-0.3555", "0.3555"))
    assert MET - before == {"huge": 2, "still": 2}
