"""Still pictures: there, of the right size, the same each time, and sane for odd programs."""

import io
import re
import struct
import zlib
from math import nan
from xml.etree import ElementTree

import numpy as np
import pytest

from aircut.canon import ROW, Kind, Recorder, Recording
from aircut.export import still
from test_page import recording, surface


def made(*ends, kind=Kind.FEED, offset=None) -> Recording:
    recorder = Recorder()
    if offset:
        recorder.event("SET_G5X_OFFSET", 2, *offset, 0.0, 0.0, 0.0)
    for end in ends:
        recorder.rows += ROW.pack(*end, 0, 0, 0, 0, 0, 100, 1, 1, 0, 0, kind, 0, 0)
    found = Recording()
    found.add(recorder.take())
    found.files = ["part.ngc"]
    return found


def png(recording: Recording, title="part", size=(800, 600)) -> np.ndarray:
    """The picture's pixels, (height, width, 4)."""
    from matplotlib import image

    file = io.BytesIO()
    still.draw(recording, file, "png", title, size)
    data = file.getvalue()
    assert data.startswith(b"\x89PNG")
    assert struct.unpack(">II", data[16:24]) == size
    return image.imread(io.BytesIO(data))


def svg(recording: Recording, title="part") -> str:
    file = io.BytesIO()
    still.draw(recording, file, "svg", title)
    text = file.getvalue().decode()
    ElementTree.fromstring(text)
    assert "nan" not in re.sub('base64,[^"]*', "", text).lower()
    return text


def share(pixels: np.ndarray, color: str) -> float:
    """Part of the picture in a color, nearly."""
    wanted = [int(color[at : at + 2], 16) / 255 for at in (1, 3, 5)]
    return float((np.abs(pixels[..., :3] - wanted).max(axis=-1) < 0.12).mean())


def test_rapids_and_feeds_are_told_apart():
    pixels = png(recording())
    assert share(pixels, still.FEED) > 0.0005
    assert share(pixels, still.RAPID) > 0.0001
    assert share(png(made((5, 0, 0), (5, 5, 0))), still.RAPID) == 0


def test_the_same_program_gives_the_same_bytes():
    assert svg(recording()) == svg(recording())


def test_title_is_only_text():
    text = svg(recording(), "a $x^2 <b> & \\frac{}")
    assert "<b>" not in text


def test_written_to_a_path(tmp_path):
    still.draw(recording(), tmp_path / "part.png", "png", "part")
    still.draw(recording(), str(tmp_path / "part.svg"), "svg", "part")
    assert (tmp_path / "part.png").stat().st_size > 10_000
    assert (tmp_path / "part.svg").read_text().startswith("<?xml")


def test_no_moves_say_so():
    assert png(made()).mean() > 0.95
    assert len(svg(made())) > 1000


@pytest.mark.parametrize(
    "ends",
    [
        [(0, 0, 0)],  # no length at all
        [(7, 0, 0)],
        [(0, 0, -3)],
        [(10, 10, 0), (20, 10, 0), (20, 30, 0)],  # no height
        [(1e6, 0, 0), (1e6, 1e-3, 0)],
        [(nan, 0, 0), (1, nan, 2)],
        [(1e300, 0, 0), (-1e300, 5, 5)],
        [(1e-9, 0, 0)],
    ],
)
@pytest.mark.parametrize("kind", [Kind.FEED, Kind.TRAVERSE, Kind.PROBE])
def test_odd_programs(ends, kind):
    found = made(*ends, kind=kind)
    assert png(found, size=(400, 300)).shape == (300, 400, 4)
    svg(found)


def test_work_origin_is_marked():
    names = [name for name, _ in still.gather(made((10, 0, 0), (10, 50, 0), offset=(5.0, 5.0, 0.0))).origins]
    assert names == ["G55", "machine zero"]
    assert [name for name, _ in still.gather(made((10, 0, 0))).origins] == ["0"]


def test_far_rapids_leave_the_cut_in_sight():
    recorder = Recorder()
    for end, kind in (((900, 0, 0), 0), ((910, 0, 0), 1), ((910, 8, 0), 1)):
        recorder.rows += ROW.pack(*end, 0, 0, 0, 0, 0, 100, 1, 1, 0, 0, kind, 0, 0)
    found = Recording()
    found.add(recorder.take())
    path = still.gather(found)
    assert path.low.tolist() == [900, 0, 0] and path.high.tolist() == [910, 8, 0]


def test_many_moves_are_drawn_as_pixels():
    found = surface(300_000)
    pixels = png(found)
    blue = (pixels[..., 2] > pixels[..., 0] + 0.3) & (pixels[..., 3] > 0)
    assert blue.mean() > 0.1
    assert len(zlib.compress(svg(found).encode())) < 400_000


def test_thinning_keeps_ends_and_shape():
    line = np.column_stack([np.linspace(0, 100, 50_000), np.zeros(50_000)])
    thin = still.thinned(line, 1.0)
    assert len(thin) < 250
    assert thin[0].tolist() == [0, 0] and thin[-1].tolist() == [100, 0]
    assert np.diff(thin[:, 0]).max() < 1.01


def test_millimeters():
    assert [still.millimeters(value) for value in (0, -0.0, -1e-9, 1.5, 100, 12.3456, -0.5)] == [
        *("0", "0", "0", "1.5", "100", "12.346", "-0.5")
    ]


def test_nothing_global_changes():
    import matplotlib

    before = dict(matplotlib.rcParams)
    png(recording())
    assert dict(matplotlib.rcParams) == before
