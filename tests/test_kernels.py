"""The compiled scanner and its uncompiled twin do the same, bit for bit, and read numbers as Python does."""

import importlib.util
import struct
from array import array
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircut.kernels import scan


def load_twin():
    """The kernel as plain Python, whatever is compiled."""
    path = Path(scan.__file__).with_name("scan.py")
    spec = importlib.util.spec_from_file_location("scan_uncompiled", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


twin = load_twin()
POWERS = array("d", scan.POWERS)
both = pytest.mark.parametrize("kernel", [scan, twin], ids=["built", "twin"])


def scanned(kernel, data, batch=1 << 30):
    """All that the kernel says of a text, scanned some lines at a time."""
    lines = data.count(b"\n") + (not data.endswith(b"\n") and bool(data))
    classes = bytearray(lines)
    said = []
    at = 0
    for first in range(0, lines, min(batch, max(lines, 1))):
        count = min(batch, lines - first)
        shapes, values = bytearray(count * scan.SHAPE), array("d", bytes(8 * count * scan.WORDS))
        shape_ends, value_ends = array("i", bytes(4 * count)), array("i", bytes(4 * count))
        at = kernel.scan(data, at, count, classes, first, shapes, shape_ends, values, value_ends, POWERS)
        shape_at = value_at = 0
        for shape_end, value_end in zip(shape_ends, value_ends, strict=True):
            said.append((bytes(shapes[shape_at:shape_end]), values[value_at:value_end].tobytes()))
            shape_at, value_at = shape_end, value_end
    return at, bytes(classes), said


def words_of(kernel, text):
    """Class, shape and values of one line."""
    _, classes, said = scanned(kernel, text.encode())
    shape, values = said[0]
    return classes[0], shape, list(struct.unpack(f"{len(values) // 8}d", values))


LIKELY = st.sampled_from([*b"GMXYZNFOgmxno0123456789.+- \t\r\n;()#[]/%", 0, 127, 128, 255])
blanks = st.sampled_from(["", " ", "\t", "  "])
digits = st.text("0123456789", min_size=1, max_size=15)


@st.composite
def literals(draw):
    """Numbers as programs write them: at most 15 digits."""
    text = draw(digits)
    point = draw(st.integers(-1, len(text)))
    if point >= 0:
        text = text[:point] + "." + text[point:]
    return draw(st.sampled_from(["", "-", "+"])) + text


@st.composite
def lines(draw):
    """Lines that are plain, or nearly."""
    letters = draw(st.lists(st.sampled_from("ABCDFIJKPQRXYZGMNxyzgmnO#"), max_size=6))
    end = draw(st.sampled_from(["", "", ";comment", "; (x", "(c)", "\r"]))
    return "".join(x + draw(blanks) + draw(literals()) + draw(blanks) for x in letters) + end


@pytest.mark.skipif(not scan.COMPILED, reason="the kernel is not compiled")
@given(st.lists(LIKELY, max_size=120).map(bytes), st.integers(1, 5))
@settings(max_examples=400, deadline=None)
def test_twins_on_bytes(data, batch):
    assert scanned(scan, data, batch) == scanned(twin, data, batch)


@pytest.mark.skipif(not scan.COMPILED, reason="the kernel is not compiled")
@given(st.binary(max_size=200))
@settings(deadline=None)
def test_twins_on_any_bytes(data):
    assert scanned(scan, data) == scanned(twin, data)


@pytest.mark.skipif(not scan.COMPILED, reason="the kernel is not compiled")
@given(st.lists(lines(), max_size=8), st.integers(1, 9))
@settings(max_examples=300, deadline=None)
def test_twins_on_lines(texts, batch):
    data = "\n".join(texts).encode()
    assert scanned(scan, data, batch) == scanned(twin, data, batch)


@both
@given(st.lists(lines(), max_size=6), st.integers(1, 6))
@settings(deadline=None)
def test_batches_do_not_matter(kernel, texts, batch):
    data = "\n".join(texts).encode()
    assert scanned(kernel, data, batch) == scanned(kernel, data)


@both
@given(literals())
@settings(max_examples=500, deadline=None)
def test_a_value_is_python_s_float(kernel, text):
    kind, shape, values = words_of(kernel, "X" + text)
    assert (kind, shape) == (scan.PLAIN, b"x")
    assert struct.pack("d", values[0]) == struct.pack("d", float(text))


@both
@given(st.text("0123456789", min_size=16, max_size=20), st.integers(0, 16))
@settings(deadline=None)
def test_more_digits_are_left_to_the_general_lane(kernel, text, point):
    assert words_of(kernel, f"X{text[:point]}.{text[point:]}")[0] == scan.OTHER


@both
@given(literals(), st.lists(st.integers(0, 20), max_size=4))
@settings(deadline=None)
def test_blanks_inside_a_number_do_not_matter(kernel, text, places):
    spaced = "X" + text
    for place in sorted(places, reverse=True):
        spaced = spaced[: place + 1] + " " + spaced[place + 1 :]
    assert words_of(kernel, spaced) == words_of(kernel, "X" + text)


@both
@pytest.mark.parametrize(
    ("text", "kind", "shape", "values"),
    [
        ("", scan.BLANK, b"", []),
        (" \t\r", scan.BLANK, b"", []),
        ("; G1 X1", scan.BLANK, b"", []),
        ("N10", scan.PLAIN, b"", []),
        ("N10 G01 X1.5 Y-2", scan.PLAIN, b"g1xy", [1.5, -2.0]),
        ("g00x.5", scan.PLAIN, b"g0x", [0.5]),
        ("G59.10 X1", scan.PLAIN, b"g59.1x", [1.0]),
        ("G1.0 F100", scan.PLAIN, b"g1f", [100.0]),
        ("G38.25", scan.OTHER, b"", []),
        ("G-1", scan.OTHER, b"", []),
        ("X1 N10", scan.OTHER, b"", []),
        ("N1.5 X1", scan.OTHER, b"", []),
        ("N-1 X1", scan.OTHER, b"", []),
        ("X1 X2", scan.OTHER, b"", []),
        ("G1 G2", scan.PLAIN, b"g1g2", []),
        ("X1 x2", scan.OTHER, b"", []),
        ("X", scan.OTHER, b"", []),
        ("X.", scan.OTHER, b"", []),
        ("X-", scan.OTHER, b"", []),
        ("X--1", scan.OTHER, b"", []),
        ("X1-2", scan.OTHER, b"", []),
        ("X1.2.3", scan.OTHER, b"", []),
        ("O100", scan.OTHER, b"", []),
        ("/G1", scan.OTHER, b"", []),
        ("X#1", scan.OTHER, b"", []),
        ("X1 (c)", scan.OTHER, b"", []),
        ("%", scan.OTHER, b"", []),
        ("X1 ; (", scan.PLAIN, b"x", [1.0]),
    ],
)
def test_lines(kernel, text, kind, shape, values):
    assert words_of(kernel, text + "\n") == (kind, shape, values)


@both
def test_words_of_a_line_are_limited(kernel):
    """A line of more words than fit is left to the general lane, not cut."""
    fits, more = "G1" * scan.WORDS, "G1" * (scan.WORDS + 1)
    assert words_of(kernel, fits) == (scan.PLAIN, b"g1" * scan.WORDS, [])
    assert words_of(kernel, more) == (scan.OTHER, b"", [])
    longest = "G999.9" * scan.WORDS
    assert words_of(kernel, longest) == (scan.PLAIN, b"g999.9" * scan.WORDS, [])
