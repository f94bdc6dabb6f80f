"""Cutter radius compensation against LinuxCNC's interpreter."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import aircut
import contours
import oracle
from aircut.canon import ROW, Kind, Recorder
from aircut.export import page, seen
from aircut.export.listing import Listing
from aircut.interpreter import interpreter
from aircut.interpreter.interpreter import Interpreter
from aircut.machine import built_in
from aircut.source import Source

SEEDS = range(250)


def ours(text: str) -> tuple[list[str], Interpreter]:
    """Our listing of a program, up to the error if there is one."""
    run = Interpreter(Source("program", text.encode()), contours.dialect(), built_in("XYZABC"))
    listing = Listing(lambda file: run.units[run.files[file]].source)
    return "".join(piece for chunk in run.run() for piece in listing.write(chunk)).splitlines(), run


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


PART = """F100 G10 L1 P1 D4
G0 X-10 Y5
G41 D1
G1 X0 Y0
G2 X10 Y0 I5
S100 (an event)
G1 X20
G40
G1 X30
M2
"""


def test_the_programmed_contour_is_kept_beside():
    result = aircut.loads(PART).run()
    contour = result.recording.contour
    assert contour.line.tolist() == [4, 4, 5, 7]
    assert contour.kind.tolist() == [Kind.TRAVERSE, Kind.FEED, Kind.ARC, Kind.FEED]
    assert contour.ends()[:, :2].tolist() == [[-10, 5], [0, 0], [10, 0], [20, 0]]
    assert len(aircut.loads("G1 X1 F1\nM2").run().recording.contour) == 0
    points, drawn = seen.programmed(result.recording, 1000)
    assert not drawn[:2].any() and drawn[2:].all()
    assert points[-1].tolist() == [20, 0, 0]
    assert page.html(result.recording, {}, "part").count('id="column-contour-') == 4


def test_events_wait_behind_moves_held_back():
    """Chunks that are handed out meanwhile do not hold what waits."""
    out = Recorder()

    def move() -> None:
        out.rows += bytes(ROW.size)

    out.event("MIST_ON")
    out.hold()
    out.event("FLOOD_ON")
    out.hold()
    out.event("MIST_OFF")
    early = out.take()
    assert [event.name for event in early.events] == ["MIST_ON"]
    out.at_once = frozenset({"SELECT_TOOL"})
    out.event("SELECT_TOOL", 1)
    out.free(lambda: (move(), move()))
    out.event("FLOOD_OFF")
    out.free(move)
    late = out.take()
    told = [(event.at, event.name) for event in late.events]
    assert told == [(0, "SELECT_TOOL"), (2, "FLOOD_ON"), (3, "MIST_OFF"), (3, "FLOOD_OFF")]
    assert len(late.rows) == 3 * ROW.size
    out.hold()
    out.event("MIST_ON")
    out.drop()
    assert not out.take().events


def test_chunks_do_not_change_the_listing(monkeypatch):
    """However small the pieces in which a run is handed out."""
    text = "\n".join(contours.Contours(7, 0.0).lines()) + "\n"
    whole, _ = ours(text)
    monkeypatch.setattr(interpreter, "FULL", 1)
    assert ours(text)[0] == whole


def test_a_fault_leaves_what_went_before(tmp_path):
    """A run that stops has the moves up to the gouging, and none of those that waited."""
    text = "F100 G10 L1 P1 D4\nG41 D1\nG1 X10\nX20\nX30 Y0\nX30 Y1\nX0\nM2\n"
    result = aircut.loads(text).run()
    assert [d.code for d in result.diagnostics] == ["gouging-corner"]
    assert "line 5 and line 6" in result.diagnostics[0].message
    assert result.toolpath.line.tolist() == [3, 4, 5]
