"""Lines as bytes: their length, their ends, what they may hold; and files of any size."""

import subprocess
from pathlib import Path

import pytest

import aircut
import oracle

FILLED = {length: b"G0 X1(" + b"x" * (length - 7) + b")" for length in (251, 252, 253)}
ACCEPTED = {
    "line feed": b"G0 X1\nG0 X2\nM2\n",
    "carriage return and line feed": b"G0 X1\r\nG0 X2\r\nM2\r\n",
    "no end of the last line": b"G0 X1\nM2",
    "percent signs": b"\t%\r\nG0 X1\r\n %\t\r\n",
    "a carriage return within a line": b"G0 X1\rY2\nM2\n",
    "blank lines": b"\n \t\n\r\n\x0c\n\x0b\nG0 X1\nM2\n",
    "form feed at the end of a line": b"G0 X1\x0c\nM2\n",
    "longest": b"\n" + FILLED[252] + b"\nM2\n",
    "longest, with a carriage return": b"\n" + FILLED[251] + b"\r\nM2\n",
    "longest, without an end": b"G0 X1\nM2" + b" " * 251,
    "longest of all plain words": b"G1 F100\n" * 9 + b"X1" + b" " * 250 + b"\n" + b"X2\n" * 9 + b"M2\n",
    "any bytes in comments": b"G0 X1 (\xc3\xa4)\nM2\n",
}
REFUSED = {
    "too long": (b"\n" + FILLED[253] + b"\nM2\n", "line-too-long", 2),
    "too long, with a carriage return": (b"G0 X1\n" + FILLED[252] + b"\r\nM2\n", "line-too-long", 2),
    "too long at the start": (FILLED[253] + b"\nM2\n", "line-too-long", 1),
    "too long, without an end": (b"G0 X1\nM2" + b" " * 252, "line-too-long", 2),
    "too long, passed over": (b"o1 if [0]\n" + b"x" * 253 + b"\no1 endif\nM2\n", "line-too-long", 2),
    "too long among plain words": (
        b"G1 F100\n" * 9 + b"X1" + b" " * 251 + b"\n" + b"X2\n" * 9 + b"M2\n", "line-too-long", 10,
    ),
    "form feed": (b"G0 X1\x0c Y2\nM2\n", "illegal-character", 1),
    "vertical tab": (b"G0 X1\x0b Y2\nM2\n", "illegal-character", 1),
    "beyond ASCII": (b"G0 X1 \xc3\xa4\nM2\n", "illegal-character", 1),
    "control character": (b"G0 X1\x1a\nM2\n", "illegal-character", 1),
    "tilde": (b"G0 X1~\nM2\n", "illegal-character", 1),
}  # fmt: skip


def asked(data: bytes, folder: Path) -> tuple[list[str], bool]:
    """The oracle's listing, and whether it accepted the program."""
    (folder / "program.ngc").write_bytes(data)
    assert oracle.PROGRAM
    done = subprocess.run(
        [oracle.PROGRAM, "-g", "program.ngc"], capture_output=True, timeout=60, cwd=folder, env={"HOME": str(folder)}
    )
    return done.stdout.decode("utf-8", "replace").splitlines(), done.returncode == 0


def agrees(data: bytes, folder: Path) -> None:
    if oracle.PROGRAM is not None:
        result = aircut.loads(data, "linuxcnc").run()
        listing, accepted = asked(data, folder)
        assert oracle.differ([line.rstrip("\n") for line in result.canon()], listing) == ""
        assert accepted == result.ok


@pytest.mark.parametrize("name", ACCEPTED)
def test_accepted(name: str, tmp_path: Path) -> None:
    assert aircut.loads(ACCEPTED[name], "linuxcnc").run().diagnostics == []
    agrees(ACCEPTED[name], tmp_path)


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, tmp_path: Path) -> None:
    data, code, line = REFUSED[name]
    (found,) = aircut.loads(data, "linuxcnc").run().diagnostics
    assert (found.code, found.span.line) == (code, line)
    agrees(data, tmp_path)


def test_lines_that_end_with_carriage_returns_alone_are_lines() -> None:
    """As the document says; the interpreter takes such a file for one line."""
    result = aircut.loads(b"G0 X1\rG0 X2\rM2\r", "linuxcnc").run()
    assert result.ok and len(result.toolpath) == 2


def test_a_large_file() -> None:
    """More lines than 16 bits count: nothing but memory bounds a program."""
    count = 70_000
    text = "G21 F1000\n" + "".join(f"G1 X{i % 999} Y[{i % 7}]\n" for i in range(count)) + "M2\n"
    result = aircut.loads(text, "linuxcnc").run()
    assert result.ok and len(result.toolpath) == count
    assert result.toolpath.ends()[-1][:2].tolist() == [(count - 1) % 999, (count - 1) % 7]
