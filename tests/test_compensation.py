"""Cutter radius compensation against LinuxCNC's interpreter."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import contours
import oracle
from aircut.export.listing import Listing
from aircut.interpreter.interpreter import Interpreter
from aircut.machine import built_in
from aircut.source import Source

SEEDS = range(250)


def ours(text: str) -> tuple[list[str], Interpreter]:
    """Our listing of a program, up to the error if there is one."""
    run = Interpreter(Source("program", text.encode()), contours.dialect(), built_in("XYZABC"))
    listing = Listing(lambda file, line: b"")
    return [line.rstrip("\n") for chunk in run.run() for line in listing.write(chunk)], run


def told(text: str, folder: Path) -> tuple[list[str], str]:
    """The oracle's listing, and the text of the line that it refused."""
    (folder / "p.ngc").write_text(text)
    assert oracle.PROGRAM
    done = subprocess.run(
        [oracle.PROGRAM, "-g", "p.ngc"],
        capture_output=True,
        text=True,
        timeout=60,
        cwd=folder,
        env={"HOME": str(folder)},
    )
    said = [line for line in done.stderr.splitlines() if line and line != "executing"]
    return done.stdout.splitlines(), said[-1] if said else ""


@pytest.mark.skipif(oracle.PROGRAM is None, reason="needs rs274")
@pytest.mark.parametrize("short", [0.0, 0.1, 0.5], ids=["fits", "some short", "many short"])
def test_entry_nist_equals_the_oracle(short, tmp_path):
    """Move for move, event for event, and errors on the same line, but where the oracle leads the tool astray."""
    better = 0
    for seed in SEEDS:
        lines = contours.Contours(seed, short).lines()
        text = "\n".join(lines) + "\n"
        given, run = ours(text)
        wanted, refused = told(text, tmp_path)
        place = f"seed {seed}:\n{text}"
        if run.failed:
            given = given[:-2]  # without the resets
        difference = oracle.differ(given, wanted[: len(given)] if run.failed else wanted, 3e-4)
        if difference and strays(given, wanted):
            better += 1
            continue
        assert not difference, place + difference
        if not run.failed:
            assert not refused, place
            continue
        (fault,) = run.diagnostics
        if refused == lines[fault.span.line - 1]:
            assert wanted[len(given)].endswith("ON_RESET()"), place
        else:  # it goes on with a move against its direction, which we refuse
            assert fault.code == "gouging-corner", place
            better += 1
    assert better < 0.1 * len(SEEDS)


def strays(given: list[str], wanted: list[str]) -> bool:
    """Whether the oracle cuts an entry arc back at the wrong one of two crossings: then it goes nearly all around."""
    at = next(i for i, pair in enumerate(zip(given, wanted, strict=False)) if oracle.differ(*([x] for x in pair), 3e-4))
    entry = "compensation on" in given[at - 1] and "ARC_FEED" in given[at]
    return entry and given[at].split(",")[2:] == wanted[at].split(",")[2:]
