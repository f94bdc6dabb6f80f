"""Where macro files are found. Names are compared without regard to case; no path may be given.

Sources: 000 section 3.3.3; decisions AMB-LEX-6, AMB-CALL-5, AMB-CALL-6.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F

EXTENSION = ".ngc"


def has_extension(name: str) -> bool:
    """Whether a called name says which file it means: then no subroutine of the calling file is meant."""
    return bool(Path(name).suffix)


def stem(name: str) -> str:
    """A called name without its extension."""
    return Path(name).stem


def find(name: str, folders: Iterable[Path]) -> Path | None:
    """The file of a called name; without extension .ngc is meant. Raises Refusal for names that are paths."""
    if not name or "/" in name or "\\" in name or ".." in name or "\0" in name:
        raise Refusal(F.BAD_FILE_NAME, "p", name=name)
    wanted = name if has_extension(name) else name + EXTENSION
    for folder in folders:
        if (folder / wanted).is_file():
            return folder / wanted
        if folder.is_dir():
            alike = sorted(p for p in folder.iterdir() if p.name.lower() == wanted.lower() and p.is_file())
            if alike:
                return alike[0]
    return None
