"""Macro files: which of them is meant, read once; encrypted ones the whole way (000 section 3.3.3)."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import aircut
from aircut.cli.main import cli
from aircut.interpreter import macros
from aircut.interpreter.running import Run
from aircut.machine import built_in, ngx


def run(text: str, *folders: Path, key: str | None = None) -> Run:
    made = built_in("XYZ")
    made.macros = folders
    made.key = key
    interpreter = aircut.loads(text).interpreter(made)
    for _ in interpreter.run():
        pass
    return interpreter


def sets(folder: Path, name: str, value: int) -> None:
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(f"#500={value}\nM99\n")


def value(text: str, *folders: Path) -> float | None:
    interpreter = run(f"{text}\nM2\n", *folders)
    assert not interpreter.failed, interpreter.diagnostics
    return interpreter.state.numbered[500]


# --- names (AMB-LEX-6, AMB-CALL-6)


def two_cases(folder: Path) -> bool:
    """Whether the file system tells the two names apart."""
    sets(folder, "Part.ngc", 1)
    sets(folder, "PART.ngc", 2)
    return len(list(folder.iterdir())) == 2


@pytest.mark.parametrize(("called", "wanted"), [("Part.ngc", 1), ("PART.ngc", 2), ("Part", 1), ("PART", 2)])
def test_a_case_exact_file_wins(called: str, wanted: int, tmp_path: Path) -> None:
    if not two_cases(tmp_path):
        wanted = 2  # there is but one file
    assert value(f'G65 P"{called}"', tmp_path) == wanted


@pytest.mark.parametrize("called", ["part.ngc", "pArT", "PART.NGC"])
def test_another_case_will_do(called: str, tmp_path: Path) -> None:
    sets(tmp_path, "Part.ngc", 1)
    assert value(f'G65 P"{called}"', tmp_path) == 1


def test_the_first_folder_wins_over_a_better_case(tmp_path: Path) -> None:
    sets(tmp_path / "a", "PART.ngc", 1)
    sets(tmp_path / "b", "part.ngc", 2)
    assert value('G65 P"part"', tmp_path / "a", tmp_path / "b") == 1


@pytest.mark.parametrize(("code", "file"), [("G212", "G212.NGC"), ("M210", "m210.ngc"), ("G200", "g200.ngc")])
def test_files_of_codes_in_any_case(code: str, file: str, tmp_path: Path) -> None:
    sets(tmp_path, file, 4)
    assert value(code, tmp_path) == 4


# --- once (000 section 3.3)


def test_a_macro_is_searched_and_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sets(tmp_path, "part.ngc", 1)
    sets(tmp_path, "g212.ngc", 2)
    searched, read = [], []
    find, load = macros.find, macros.load
    monkeypatch.setattr(macros, "find", lambda name, folders: (searched.append(name), find(name, folders))[1])
    monkeypatch.setattr(macros, "load", lambda path, key: (read.append(path.name), load(path, key))[1])
    text = '#1=0\nWHILE [#1 LT 50] DO1\nG65 P"part" L2\nG212\n#1=[#1 + 1]\nEND1\nM98 P"part"\nM2\n'
    assert not run(text, tmp_path).failed
    assert sorted(searched) == ["g212.ngc", "part"] and sorted(read) == ["g212.ngc", "part.ngc"]


def test_a_missing_macro_names_the_places_searched(tmp_path: Path) -> None:
    (told,) = run('G65 P"nowhere"\nM2\n', tmp_path).diagnostics
    assert told.code == "no-subroutine" and "nowhere" in told.message
    assert str(tmp_path) in told.hint


# --- encrypted


def invoke(*args: object, status: int = 0) -> str:
    result = CliRunner().invoke(cli, [str(arg) for arg in args], catch_exceptions=False)
    assert result.exit_code == status, result.output
    return result.output


TEXT = b"; secret\r\n#500=[#24 * 2]\r\nM99\r\n"


@pytest.fixture
def encrypted(tmp_path: Path) -> Path:
    (tmp_path / "g212.ngc").write_bytes(TEXT)
    invoke("encrypt", tmp_path / "g212.ngc", "-o", tmp_path / "g212.ngx", "--key", "secret")
    (tmp_path / "g212.ngc").unlink()
    return tmp_path / "g212.ngx"


def test_encrypt_call_and_decrypt(encrypted: Path) -> None:
    assert b"secret" not in encrypted.read_bytes() and b"#500" not in encrypted.read_bytes()
    interpreter = run("G212 X21\nM2\n", encrypted.parent, key="secret")
    assert not interpreter.diagnostics and interpreter.state.numbered[500] == 42.0
    again = encrypted.parent / "again.ngc"
    invoke("decrypt", encrypted, "-o", again, "--key", "secret")
    assert again.read_bytes() == TEXT


def test_the_plain_file_is_taken_first(encrypted: Path) -> None:
    sets(encrypted.parent, "g212.ngc", 7)
    interpreter = run("G212 X21\nM2\n", encrypted.parent, key="secret")
    assert interpreter.state.numbered[500] == 7.0


@pytest.mark.parametrize("called", ['G65 P"g212"', 'G65 P"g212.ngc"', 'G65 P"g212.ngx"', 'CALL P"G212.NGX"'])
def test_names_that_lead_to_it(called: str, encrypted: Path) -> None:
    interpreter = run(f"{called} X3\nM2\n", encrypted.parent, key="secret")
    assert not interpreter.diagnostics and interpreter.state.numbered[500] == 6.0


@pytest.mark.parametrize(("key", "reason"), [("Secret", "wrong key"), (None, "no key is given")])
def test_a_wrong_or_missing_key(key: str | None, reason: str, encrypted: Path) -> None:
    (told,) = run("G0 X1\nG212 X3\nM2\n", encrypted.parent, key=key).diagnostics
    assert (told.code, told.span.line) == ("encrypted-macro", 2)
    assert "g212.ngx" in told.message and reason in told.message
    assert (
        reason in invoke("decrypt", encrypted, "-o", encrypted.parent / "x.ngc", "--key", key, status=1) if key else 1
    )
    assert not (encrypted.parent / "x.ngc").exists()


@pytest.mark.parametrize("at", [0, 8, 12, 30, 60, -40, -1])
def test_a_damaged_file(at: int, encrypted: Path) -> None:
    data = bytearray(encrypted.read_bytes())
    data[at] ^= 1
    encrypted.write_bytes(data)
    (told,) = run("G212 X3\nM2\n", encrypted.parent, key="secret").diagnostics
    assert told.code == "encrypted-macro"
    assert "damaged" in told.message or "not an aircut container" in told.message
    assert "cannot be read" in invoke("decrypt", encrypted, "-o", encrypted.parent / "x", "--key", "secret", status=1)


@pytest.mark.parametrize("length", [0, 5, 40, 100])
def test_a_file_cut_off(length: int, encrypted: Path) -> None:
    encrypted.write_bytes(encrypted.read_bytes()[:length])
    (told,) = run("G212 X3\nM2\n", encrypted.parent, key="secret").diagnostics
    assert told.code == "encrypted-macro"


def test_lines_of_250_bytes_and_of_251(tmp_path: Path) -> None:
    for length, status in ((250, 0), (251, 1)):
        text = "(" + "é" * 10 + "x" * (length - 22) + ")"
        assert len(text.encode()) == length
        (tmp_path / "g212.ngc").write_text(f"#500=1\n{text}\nM99\n", "utf-8")
        output = invoke("encrypt", tmp_path / "g212.ngc", "-o", tmp_path / "g212.ngx", "--key", "k", status=status)
        assert status == 0 or "g212.ngc:2: error: line has 251 bytes, at most 250" in output
    (tmp_path / "g212.ngc").unlink()
    assert run("G212\nM2\n", tmp_path, key="k").state.numbered[500] == 1.0


def test_a_long_line_that_got_into_a_container(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ngx, "LINE", 300)
    (tmp_path / "g212.ngx").write_bytes(ngx.encrypt(b"(" + b"x" * 249 + b")\nM99\n", "k"))
    monkeypatch.undo()
    (told,) = run("G212\nM2\n", tmp_path, key="k").diagnostics
    assert told.code == "encrypted-macro" and "line 1 has 251 bytes" in told.message
