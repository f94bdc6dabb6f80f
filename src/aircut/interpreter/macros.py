"""Where macro files are found. Names are compared without regard to case; no path may be given.

Sources: 000 section 3.3.3; decisions AMB-LEX-6, AMB-CALL-5, AMB-CALL-6.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.source import Source

EXTENSION = ".ngc"
ENCRYPTED = ".ngx"
LONGEST = 255  # bytes of a file's name


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
    folders = list(folders)
    found = exact(wanted, folders)
    if found is None and wanted.lower().endswith(EXTENSION):
        found = exact(wanted[: -len(EXTENSION)] + ENCRYPTED, folders)
    return found


def searched(name: str, folders: Iterable[Path], routines: Iterable[str]) -> str:
    """Where a called name has been looked for, in words."""
    wanted = name if has_extension(name) else name + EXTENSION
    files = wanted
    if wanted.lower().endswith(EXTENSION):
        files += f" and {wanted[: -len(EXTENSION)]}{ENCRYPTED}"
    known = ", ".join(routines)
    inside = f"the file, which has {known}; " if known else ""
    places = ", ".join(map(str, folders))
    return f"searched: {inside}{files} in {places} (--macros adds a folder)"


def exact(wanted: str, folders: Iterable[Path]) -> Path | None:
    """The file of this name in the first folder that has it; one that differs in case will do."""
    if len(wanted.encode()) > LONGEST:
        return None
    for folder in folders:
        if (folder / wanted).is_file():
            return folder / wanted
        if folder.is_dir():
            alike = sorted(p for p in folder.iterdir() if p.name.lower() == wanted.lower() and p.is_file())
            if alike:
                return alike[0]
    return None


def load(path: Path, key: str | None) -> Source:
    """The text of a macro file; an encrypted one is opened with the key. Raises Refusal."""
    from aircut.machine import ngx

    try:
        if path.suffix.lower() != ENCRYPTED:
            return Source.load(path)
        if not key:
            raise Refusal(F.ENCRYPTED, "p", name=path.name, reason="no key is given (--key, or AIRCUT_KEY)")
        text = ngx.decrypt(path.read_bytes(), key)
        if long := ngx.long_line(text):
            reason = f"line {long[0]} has {long[1]} bytes; encrypted macros have {ngx.LINE} at most"
            raise Refusal(F.ENCRYPTED, "p", name=path.name, reason=reason)
        return Source(str(path), text)
    except OSError as error:
        raise Refusal(F.CANNOT_READ, "p", reason=error.strerror) from None
    except ngx.NgxError as error:
        raise Refusal(F.ENCRYPTED, "p", name=path.name, reason=str(error)) from None
