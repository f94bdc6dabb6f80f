"""The 3D page, opened from a file in a real browser."""

import base64
import json
import re
import time
import zlib
from math import inf, nan

import numpy as np
import pytest

import chromium
from aircut.canon import ROW, Kind, Recorder, Recording
from aircut.export import page

TEXT = """%
(a pocket) ; ünïcödé ✓ </script><script>bad()</script> <!-- &amp;
G21 G90
G0 X10 Y0
G1 Z-2 F300
G3 X10 Y0 Z-4 I-10 J0 F600
G1 X0 Y0
G0 Z20
M30
%
"""


def recording() -> Recording:
    """What TEXT does."""
    recorder = Recorder()
    moves = (
        (4, (10, 0, 0), (0, 0), 0, 0, Kind.TRAVERSE),
        (5, (10, 0, -2), (0, 0), 300, 0, Kind.FEED),
        (6, (10, 0, -4), (0, 0), 600, 1, Kind.ARC),
        (7, (0, 0, -4), (0, 0), 600, 0, Kind.FEED),
        (8, (0, 0, 20), (0, 0), 0, 0, Kind.TRAVERSE),
    )
    for line, end, center, feed, turns, kind in moves:
        recorder.rows += ROW.pack(*end, 0, 0, 0, *center, feed, line, 7, turns, 0, kind, 0, 0)
    made = Recording()
    made.add(recorder.take())
    made.files = ["part.ngc"]
    return made


def facts(text: str) -> dict:
    found = re.search(r'<script type="application/json" id="facts">(.*?)</script>', text, re.S)
    assert found
    return json.loads(found[1])


def block(text: str, name: str) -> bytes:
    found = re.search(f'<script type="application/octet-stream" id="{name}">(.*?)</script>', text)
    assert found
    return zlib.decompress(base64.b64decode(found[1]))


def column(text: str, name: str) -> np.ndarray:
    """A column as the page's script reads it."""
    (spec,) = (each for each in facts(text)["columns"] if each["name"] == name)
    if not spec["quantum"]:
        return np.full(spec["count"], spec["base"])
    planes = np.frombuffer(block(text, f"column-{name}"), np.uint8).reshape(4, -1).T
    zigzag = np.ascontiguousarray(planes).view("<u4").ravel()
    step = (zigzag >> 1).astype(np.int32) ^ -(zigzag & 1).astype(np.int32)
    return spec["base"] + spec["quantum"] * np.cumsum(step, dtype=np.int32)


def test_columns_come_back():
    made = recording()
    text = page.html(made, {"part.ngc": TEXT}, "part <1> & co")
    assert "<title>part &lt;1&gt; &amp; co</title>" in text
    told = facts(text)
    assert told["moves"] == 5
    assert told["title"] == "part <1> & co"
    move = column(text, "move").astype(int)
    last = np.searchsorted(move, np.arange(5), side="right") - 1
    assert np.allclose(column(text, "x")[last], made.toolpath.x, atol=6e-5)
    assert np.allclose(column(text, "z")[last], made.toolpath.z, atol=6e-5)
    assert column(text, "line").tolist() == made.toolpath.line.tolist()
    assert np.allclose(column(text, "feed"), made.toolpath.feed)
    assert column(text, "tool").tolist() == [7] * 5
    assert block(text, "file-0").decode() == TEXT


def test_far_coordinates_keep_nine_digits():
    recorder = Recorder()
    for x in (-3e7, 3e7, 12345.678):
        recorder.rows += ROW.pack(x, 0, 0, 0, 0, 0, 0, 0, 100, 1, 1, 0, 0, Kind.FEED, 0, 0)
    made = Recording()
    made.add(recorder.take())
    made.files = ["far.ngc"]
    assert np.allclose(column(page.html(made, {}, "far"), "x")[1:], made.toolpath.x, atol=0.06)


def test_page_stands_alone():
    text = page.html(recording(), {"part.ngc": TEXT}, "part")
    assert "default-src 'none'" in text
    assert not re.search(r'(?:src|href)="(?!data:)', text)
    assert "bad()" not in text
    assert page.TITLE_MARK not in text and page.DATA_MARK not in text
    assert "MIT" in text  # the license notice of three.js
    assert text == page.html(recording(), {"part.ngc": TEXT}, "part")


def test_work_offsets_are_told():
    recorder = Recorder()
    recorder.event("SET_G5X_OFFSET", 1, 100.0, 50.0, -20.0, 0.0, 0.0, 0.0)
    recorder.event("SET_XY_ROTATION", 30.0)
    recorder.rows += ROW.pack(*(100, 50, 0), 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0)
    recorder.event("SET_G92_OFFSET", 1.0, 2.0, 3.0, 0.0, 0.0, 0.0)
    recorder.rows += ROW.pack(*(101, 50, 0), 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0)
    made = Recording()
    made.add(recorder.take())
    assert page.frames(made) == [
        (0, 1, (100, 50, -20, 0, 0, 0), (0,) * 6, 30),
        (1, 1, (100, 50, -20, 0, 0, 0), (1, 2, 3, 0, 0, 0), 30),
    ]


def surface(moves: int) -> Recording:
    """A raster of short moves, as finishing programs have them."""
    from aircut.canon.record import Chunk, Events
    from aircut.canon.toolpath import row_type

    rows = np.zeros(moves, row_type())
    side = int(moves**0.5)
    row, at = np.divmod(np.arange(moves), side)
    rows["x"] = np.where(row % 2, side - 1 - at, at) * 0.1
    rows["y"] = row * 0.1
    rows["z"] = np.sin(rows["x"] / 9) * np.cos(rows["y"] / 7) * 5
    rows["feed"], rows["tool"], rows["kind"] = 2000, 1, Kind.FEED
    rows["line"] = np.arange(moves) + 1
    made = Recording()
    made.add(Chunk(0, rows.tobytes(), Events()))
    made.files = ["surface.ngc"]
    return made


@pytest.fixture(scope="module")
def browser():
    if not chromium.BROWSER:
        pytest.skip("no Chromium on this machine")
    pytest.importorskip("websockets")
    with chromium.Page() as tab:
        yield tab


@pytest.fixture
def opened(browser, tmp_path):
    browser.errors.clear()
    browser.requests.clear()
    file = tmp_path / "part.html"
    file.write_text(page.html(recording(), {"part.ngc": TEXT}, "part.ngc"), "utf-8")
    browser.open(file)
    yield browser
    assert browser.errors == []
    assert [url for url in browser.requests if url != file.as_uri()] == []


def selected(tab) -> str:
    return tab.run("document.querySelector('#lines [aria-selected=true] .text')?.textContent")


def test_opens_without_a_network(opened):
    assert opened.run("aircut.moves") == 5
    assert opened.run("document.title") == "part.ngc"
    assert opened.run("aircut.state.frames") >= 1
    assert not opened.run("document.querySelector('#notice').checkVisibility()")


def test_seek_shows_the_line(opened):
    for move, line in enumerate((4, 5, 6, 7, 8)):
        opened.run(f"aircut.seek({move})")
        assert opened.run("aircut.line") == line
        assert selected(opened) == TEXT.splitlines()[line - 1]
    opened.run("aircut.seek(2)")
    assert opened.run("aircut.position") == pytest.approx([10, 0, -4, 0, 0, 0])
    readout = opened.run("document.querySelector('#readout').innerText")
    assert "part.ngc:6" in readout and "-4.0000" in readout and "600" in readout
    opened.run("aircut.seek(99)")
    assert opened.run("aircut.move") == 4
    opened.run("aircut.seek(-7)")
    assert opened.run("aircut.move") == -1


def test_text_survives(opened):
    assert opened.run("aircut.text(2)") == TEXT.splitlines()[1]
    assert opened.run("typeof bad") == "undefined"


def test_clicking_a_line_goes_to_its_move(opened):
    place = opened.run(
        "(() => { const at = document.querySelector('#lines [data-line=\"6\"]').getBoundingClientRect();"
        " return [at.x + 60, at.y + 9] })()"
    )
    opened.click(*place)
    assert opened.run("aircut.move") == 2


def test_clicking_the_path_picks_the_move(opened):
    opened.run("aircut.view('iso')")
    x, y = opened.run("aircut.project(5, 0, -4)")
    assert opened.run(f"aircut.pick({x}, {y})") == 3
    opened.click(x, y)
    assert opened.run("aircut.move") == 3
    assert opened.run("aircut.pick(3, 3)") == -1


def test_keys_and_buttons(opened):
    opened.run("aircut.seek(1)")
    opened.key("ArrowRight", 39)
    assert opened.run("aircut.move") == 2
    opened.key("ArrowLeft", 37)
    assert opened.run("aircut.move") == 1
    opened.key("r", 82)
    assert opened.run("aircut.rapids") is False
    assert opened.run("document.querySelector('#rapids').ariaPressed") == "false"
    opened.run("document.querySelector('#rapids').click()")
    assert opened.run("aircut.rapids") is True
    names = opened.run("[...document.querySelectorAll('button, select, input')].map(e => e.ariaLabel)")
    assert all(names)


def colors(tab) -> int:
    """Pixels of the canvas that are of the hue of rapids, between that of the X axis and the tool's."""
    return tab.run(
        """(() => { const view = aircut.viewer; view.render(); const gl = view.renderer.getContext();
        const { drawingBufferWidth: w, drawingBufferHeight: h } = gl; const data = new Uint8Array(4 * w * h);
        gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, data); let many = 0;
        for (let i = 0; i < data.length; i += 4) {
          const span = data[i] - data[i + 2], hue = (data[i + 1] - data[i + 2]) / span;
          many += span > 30 && hue > 0.3 && hue < 0.58; }
        return many })()"""
    )


def test_hiding_rapids_takes_them_away(opened):
    opened.prefer("dark")
    opened.run("aircut.showGrid(false); aircut.view('front'); aircut.seek(4)")
    shown = colors(opened)
    opened.run("aircut.showRapids(false); aircut.view('front')")
    assert colors(opened) < shown / 3


def test_playing_ends_at_the_last_move(opened):
    opened.run("document.querySelector('#speed').value = '5000'; aircut.seek(-1); aircut.play()")
    until = time.monotonic() + 20
    while opened.run("aircut.playing") and time.monotonic() < until:
        time.sleep(0.05)
    assert opened.run("aircut.move") == 4


def test_no_moves_and_no_text(browser, tmp_path):
    browser.errors.clear()
    empty = Recording()
    empty.files = ["empty.ngc"]
    file = tmp_path / "empty.html"
    file.write_text(page.html(empty, {}, "empty"), "utf-8")
    browser.open(file)
    assert browser.run("aircut.moves") == 0
    assert "no moves" in browser.run("document.querySelector('#notice').innerText")
    browser.run("aircut.seek(3); aircut.play(); aircut.fit()")
    assert browser.errors == []


def test_numbers_that_are_none(browser, tmp_path):
    browser.errors.clear()
    recorder = Recorder()
    for x in (1.0, nan, inf, 2.0):
        recorder.rows += ROW.pack(x, 0, 0, 0, 0, 0, 0, 0, 100, 1, 1, 0, 0, Kind.FEED, 0, 0)
    made = Recording()
    made.add(recorder.take())
    made.files = ["odd.ngc"]
    file = tmp_path / "odd.html"
    file.write_text(page.html(made, {"odd.ngc": "G1 X1\n"}, "odd"), "utf-8")
    browser.open(file)
    assert browser.run("aircut.moves") == 4
    assert browser.errors == []


def test_many_lines_make_few_elements(browser, tmp_path):
    browser.errors.clear()
    moves = 700_000  # beyond what a browser can scroll without help
    made = surface(moves)
    text = "".join(f"X{n}\n" for n in range(1, moves + 1))
    file = tmp_path / "surface.html"
    file.write_text(page.html(made, {"surface.ngc": text}, "surface"), "utf-8")
    browser.open(file)
    assert browser.run("aircut.moves") == moves
    assert browser.run("document.querySelectorAll('*').length") < 1000
    for move in (0, 345_678, moves - 1):
        browser.run(f"aircut.seek({move})")
        assert selected(browser) == f"X{move + 1}"
    assert browser.errors == []
