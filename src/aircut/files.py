"""Files written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any


def below(folder: Path, name: str) -> Path:
    """The path of a file in a folder or below it. Raises ValueError for a name that is none or leads out."""
    path = folder / name
    if not name or "\0" in name or path.is_dir() or not path.resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"“{name}” is no file below {folder}")
    return path


@contextmanager
def replacing(path: Path, binary: bool = False) -> Iterator[IO[Any]]:
    """Open a temporary file beside `path`; it takes its place when all went well, else it is removed.

    Raises OSError.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        file = open(temporary, "wb") if binary else open(temporary, "w", encoding="utf-8", newline="")  # noqa: SIM115
        with file:
            yield file
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
