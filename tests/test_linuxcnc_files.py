"""Files of subroutines in LinuxCNC's language: where they are looked for, and what is said when they are not there."""

from pathlib import Path

import pytest

import aircut
from aircut import dialects
from aircut.diagnostics import Diagnostic

SUB = "o<s> sub\n(PRINT,{})\no<s> endsub\n"


def told(text: str, name: str = "<text>", folders: tuple[Path, ...] = ()) -> tuple[list[str], list[Diagnostic]]:
    machine = dialects.machine(dialects.load("linuxcnc"))
    machine.macros = folders
    result = aircut.loads(text, "linuxcnc", name).run(machine)
    return [event.values[0] for event in result.events if event.name == "PRINT"], result.diagnostics


def test_the_order_of_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The working directory, the program's folder, then the machine's folders in their order."""
    places = [tmp_path / name for name in ("working", "program", "first", "second")]
    for place in places:
        place.mkdir()
        (place / "s.ngc").write_text(SUB.format(place.name))
    monkeypatch.chdir(places[0])
    for place in places:
        found, _ = told("o<s> call\nM2\n", str(places[1] / "main.ngc"), tuple(places[2:]))
        assert found == [place.name]
        (place / "s.ngc").unlink()
    found, (diagnostic,) = told("o<s> call\nM2\n", str(places[1] / "main.ngc"), tuple(places[2:]))
    assert found == [] and diagnostic.code == "no-subroutine"
    assert all(str(place) in diagnostic.hint for place in places)


@pytest.mark.parametrize("name", ["../s", "{folder}/s", "inner/../../s", "s.ngc", "."])
def test_nothing_is_read_outside_the_folders(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "s.ngc").write_text(SUB.format("outside"))
    inside = tmp_path / "inside"
    (inside / "inner").mkdir(parents=True)
    monkeypatch.chdir(inside)
    found, (diagnostic,) = told(f"o<{name.format(folder=tmp_path)}> call\nM2\n")
    assert found == [] and diagnostic.code == "no-subroutine"


def test_a_file_without_its_subroutine_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.ngc").write_text("o<other> sub\no<other> endsub\n")
    _, (diagnostic,) = told("G0 X1\n o<s> call\nM2\n")
    assert (diagnostic.code, diagnostic.span.line, diagnostic.span.column) == ("no-subroutine", 2, 2)
    assert diagnostic.hint == "there is no O<s> SUB in s.ngc"


def test_a_folder_of_the_name_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.ngc").mkdir()
    assert told("o<s> call\nM2\no<s> sub\n(PRINT,in the program)\no<s> endsub\n") == (["in the program"], [])
