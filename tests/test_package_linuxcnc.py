"""Every program that LinuxCNC's package brings is listed as its own interpreter lists it, or fails where it fails.

The package has some 330, from macros of a few lines to parts of 300 kB. Each is run in its own folder, where calls
look for the files of subroutines. The oracle has no limit of time here but one for all that never end: a program
that is not compared would fail the test.
"""

import os
import subprocess
from pathlib import Path

import pytest

import aircut
import oracle

FOLDERS = (Path("/usr/share/linuxcnc"), Path("/usr/share/doc/linuxcnc"), Path("/usr/share/axis"))
ENDINGS = (".ngc", ".nc", ".tap", ".cnc", ".gcode")
#: Programs that are not compared, and why.
APART = {
    "lathe_g70_71_demo.ngc": "a rounding error makes its flats rise or fall: line 112 is printed or not",
}
LONGEST = 20  # seconds for a program; none of the package takes one


def programs() -> list[Path]:
    return sorted(
        file
        for folder in FOLDERS
        for file in folder.rglob("*")
        if file.suffix.lower() in ENDINGS and file.name not in APART
    )


def compare(file: Path, home: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The first difference for a program, in words; empty when there is none."""
    assert oracle.PROGRAM
    done = subprocess.run(
        [oracle.PROGRAM, "-g", str(file)],
        cwd=file.parent,
        env={**os.environ, "HOME": str(home)},
        capture_output=True,
        timeout=LONGEST,
    )
    monkeypatch.chdir(file.parent)
    result = aircut.load(file, "linuxcnc").run()
    ours = [line.rstrip("\n") for line in result.canon()]
    difference = oracle.differ(ours, done.stdout.decode("latin-1").splitlines())
    accepted = done.returncode == 0
    if not difference and result.ok != accepted:
        difference = f"ok is {result.ok}, theirs {accepted}"
    return difference and f"{file}: {difference}"


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
def test_programs_of_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = programs()
    assert files, "the package has programs"
    differences = [text for file in files if (text := compare(file, tmp_path, monkeypatch))]
    assert not differences, f"{len(differences)} of {len(files)}\n" + "\n".join(differences)
