"""Encrypted macros: what goes in comes out, and nothing else does."""

import hashlib
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from aircut.cli import encrypting
from aircut.machine import ngx
from aircut.machine.ngx import NgxError, decrypt, encrypt

KEY = "correct horse"
TEXT = b"O1000\nG1 X#1\nM99\n"
FOREIGN = "encrypted macro cannot be read: not an aircut container"
DAMAGED = "encrypted macro cannot be read: the file is damaged or cut off"
WRONG = "encrypted macro cannot be read: wrong key (or the file was altered on purpose)"


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys that cost little. The real cost is tested on its own."""
    monkeypatch.setattr(ngx, "LOG_N", 4)


def resealed(body: bytes) -> bytes:
    """With a checksum that fits, as someone who alters a file on purpose would write it."""
    return body + hashlib.sha256(body).digest()


def message(data: bytes, key: str = KEY) -> str:
    with pytest.raises(NgxError) as caught:
        decrypt(data, key)
    return str(caught.value)


def lines() -> st.SearchStrategy[bytes]:
    line = st.binary(max_size=ngx.LINE).map(lambda b: b.replace(b"\n", b"").replace(b"\r", b""))
    return st.lists(line).map(b"\n".join)


@settings(max_examples=50, deadline=None)
@given(text=lines(), key=st.text(st.characters(exclude_categories=["Cs"]), min_size=1))
def test_round_trip(text: bytes, key: str) -> None:
    assert decrypt(encrypt(text, key), key) == text


def test_real_cost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ngx, "LOG_N", 15)
    container = encrypt(TEXT, KEY)
    assert container[8:16] == bytes([1, 1, 15, 8, 1, 1, 0, 0])
    assert decrypt(container, KEY) == TEXT


def test_documented_layout() -> None:
    container = encrypt(TEXT, KEY)
    assert container[:8] == b"\x89AIRCUT\n"
    assert ngx.HEADER.size == 44
    assert len(container) == 92 + len(TEXT)
    assert container[-32:] == hashlib.sha256(container[:-32]).digest()


def test_another_reader_of_the_documentation() -> None:
    """Python's own scrypt and the table in the docs lead to the text."""
    from cryptography.hazmat.primitives.ciphers.aead import AESGCM

    data = encrypt(TEXT, "cafe\u0301")
    key = hashlib.scrypt("caf\u00e9".encode(), salt=data[16:32], n=2 ** data[10], r=data[11], p=data[12], dklen=32)
    assert AESGCM(key).decrypt(data[32:44], data[44:-32], data[:44]) == TEXT


def test_same_text_never_the_same_bytes() -> None:
    first, second = encrypt(TEXT, KEY), encrypt(TEXT, KEY)
    assert first[16:32] != second[16:32]
    assert first[32:44] != second[32:44]
    assert first[44:-32] != second[44:-32]


def test_text_is_not_in_the_container() -> None:
    assert b"G1 X#1" not in encrypt(TEXT, KEY)


@pytest.mark.parametrize("text", [b"", b"\n", b"\xff\xfe\x00\x80", b"G0\r\nX1\r\n", b"\xef\xbb\xbfG0", b"no end"])
def test_bytes_survive(text: bytes) -> None:
    assert decrypt(encrypt(text, KEY), KEY) == text


@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n", b"\r"])
def test_lines_of_250_bytes_pass(end: bytes) -> None:
    text = (b"x" * 250 + end) * (2 if end else 1)
    assert decrypt(encrypt(text, KEY), KEY) == text
    assert ngx.long_line(b"\xef\xbb\xbf" + b"x" * 250) is None


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_lines_of_251_bytes_are_refused(end: bytes) -> None:
    with pytest.raises(NgxError, match="line has 251 bytes, at most 250") as caught:
        encrypt(b"G0" + end + end + b"x" * 251 + end, KEY)
    assert caught.value.line == 3


def test_bytes_count_not_characters() -> None:
    with pytest.raises(NgxError, match="line has 252 bytes"):
        encrypt("é".encode() * 126, KEY)


def test_wrong_key() -> None:
    container = encrypt(TEXT, KEY)
    for key in ("Correct horse", "correct horse ", "x"):
        assert message(container, key) == WRONG


def test_key_is_the_same_however_typed() -> None:
    assert decrypt(encrypt(TEXT, "cafe\u0301"), "caf\u00e9") == TEXT


def test_keys_that_are_none() -> None:
    container = encrypt(TEXT, KEY)
    for key, why in (("", "the key is empty"), ("\udcff", "the key is not text")):
        with pytest.raises(NgxError, match=why):
            encrypt(TEXT, key)
        assert message(container, key) == why


@pytest.mark.parametrize("bit", [0, 7])
def test_every_byte_is_guarded(bit: int) -> None:
    container = encrypt(TEXT, KEY)
    for at in range(len(container)):
        damaged = bytearray(container)
        damaged[at] ^= 1 << bit
        assert message(bytes(damaged)) == (FOREIGN if at < 8 else DAMAGED)


@pytest.mark.parametrize("bit", [0, 7])
def test_every_byte_is_authenticated(bit: int) -> None:
    """Also when the checksum is made to fit: nothing but the key opens a file that was altered."""
    container = encrypt(TEXT, KEY)
    for at in range(8, len(container) - 32):
        altered = bytearray(container[:-32])
        altered[at] ^= 1 << bit
        assert message(resealed(bytes(altered))).startswith(ngx.UNREADABLE)


def test_truncated_anywhere() -> None:
    container = encrypt(TEXT, KEY)
    for length in range(len(container)):
        assert message(container[:length]) == (FOREIGN if length < 8 else DAMAGED)
    assert "damaged" in message(container + b"\n")


def test_truncated_with_a_checksum() -> None:
    container = encrypt(TEXT, KEY)
    for length in range(8, len(container) - 32):
        assert message(resealed(container[:length])).startswith(ngx.UNREADABLE)


@pytest.mark.parametrize("data", [b"", b"G0 X1\n", b"\x89PNG\r\n\x1a\n", bytes(200), b"AIRCUT\n" + bytes(100)])
def test_not_ours(data: bytes) -> None:
    assert message(data) == FOREIGN


@pytest.mark.parametrize(
    "at, value, why",
    [(8, 2, "version"), (9, 2, "in a way"), (13, 0, "in a way"), (10, 63, "memory"), (10, 0, "memory"),
     (11, 255, "memory"), (11, 0, "memory"), (12, 200, "memory"), (12, 0, "memory")],
)  # fmt: skip
def test_headers_of_others(at: int, value: int, why: str) -> None:
    altered = bytearray(encrypt(TEXT, KEY)[:-32])
    altered[at] = value
    assert why in message(resealed(bytes(altered)))


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=200))
def test_no_bytes_make_a_traceback(data: bytes) -> None:
    for sealed in (data, ngx.MAGIC + data, resealed(ngx.MAGIC + b"\x01\x01\x04\x08\x01\x01" + data)):
        with pytest.raises(NgxError):
            decrypt(sealed, KEY)


def test_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    container = encrypt(TEXT, KEY)
    monkeypatch.setattr(ngx, "MAX_BYTES", len(TEXT) - 1)
    with pytest.raises(NgxError, match="too large: 17 bytes, at most 16"):
        encrypt(TEXT, KEY)
    assert "too large" in message(container)


def test_cryptography_is_not_imported_with_aircut() -> None:
    import subprocess
    import sys

    code = "import sys, aircut.machine.ngx, aircut.cli.encrypting; sys.exit('cryptography' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


# The commands.


@click.group()
def cli() -> None: ...


@cli.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True)
@click.option("--key")
def encrypt_(file: Path, output: Path, key: str | None) -> None:
    raise SystemExit(encrypting.encrypt(file, output, key))


@cli.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True)
@click.option("--key")
def decrypt_(file: Path, output: Path, key: str | None) -> None:
    raise SystemExit(encrypting.decrypt(file, output, key))


def run(command: click.Command, *words: object) -> tuple[int, str]:
    done = CliRunner().invoke(command, [str(w) for w in words])
    return done.exit_code, done.output


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("AIRCUT_KEY", raising=False)
    (tmp_path / "a.ngc").write_bytes(TEXT)
    return tmp_path


def test_command_round_trip(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(encrypt_, folder / "a.ngc", "-o", folder / "a.ngx", "--key", KEY) == (0, "")
    monkeypatch.setenv("AIRCUT_KEY", KEY)
    assert run(decrypt_, folder / "a.ngx", "-o", folder / "b.ngc") == (0, "")
    assert (folder / "b.ngc").read_bytes() == TEXT
    status, said = run(decrypt_, folder / "a.ngx", "-o", folder / "b.ngc", "--key", "other")
    assert (status, said) == (
        1,
        f"{folder / 'a.ngx'}: error: {WRONG}\n",
    )
    assert (folder / "b.ngc").read_bytes() == TEXT  # the old one stays
    assert len(list(folder.iterdir())) == 3


def test_command_asks(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def prompt(text: str, **options: object) -> str:
        asked.append((text, options))
        return KEY

    monkeypatch.setattr(click, "prompt", prompt)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    assert encrypting.key_from(None, new=True) == KEY
    assert encrypting.key_from(None, new=False) == KEY
    assert [options["confirmation_prompt"] for _, options in asked] == [True, False]
    assert all(options["hide_input"] for _, options in asked)


def test_command_without_a_key(folder: Path) -> None:
    assert run(encrypt_, folder / "a.ngc", "-o", folder / "a.ngx")[0] == 2
    status, said = run(encrypt_, folder / "a.ngc", "-o", folder / "a.ngx", "--key", "")
    assert status == 2 and "the key is empty" in said
    assert not (folder / "a.ngx").exists()


def test_command_long_line(folder: Path) -> None:
    (folder / "a.ngc").write_bytes(b"G0\n" + b"x" * 251)
    status, said = run(encrypt_, folder / "a.ngc", "-o", folder / "a.ngx", "--key", KEY)
    assert status == 1
    assert said == f"{folder / 'a.ngc'}:2: error: line has 251 bytes, at most 250 in an encrypted macro\n"
    assert not (folder / "a.ngx").exists()


def test_command_files(folder: Path) -> None:
    file = folder / "a.ngc"
    assert run(encrypt_, file, "-o", folder / "a.txt", "--key", KEY)[0] == 2
    assert run(decrypt_, file, "-o", file, "--key", KEY)[0] == 2
    assert run(decrypt_, folder / "none.ngx", "-o", folder / "b.ngc", "--key", KEY)[0] == 1
    assert run(decrypt_, folder, "-o", folder / "b.ngc", "--key", KEY)[0] == 1
    assert run(encrypt_, file, "-o", folder / "none" / "a.ngx", "--key", KEY)[0] == 1
    status, said = run(decrypt_, file, "-o", folder / "b.ngc", "--key", KEY)
    assert (status, said) == (1, f"{file}: error: {FOREIGN}\n")
    assert [p.name for p in folder.iterdir()] == ["a.ngc"]
