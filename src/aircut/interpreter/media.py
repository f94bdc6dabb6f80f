"""Pictures of M120: files in the media folder of the machine, named without regard to case.

Sources: 000 section 10.1; decision AMB-MSG-11. A path leads into folders below the media folder, never out of it.
"""

from __future__ import annotations

from pathlib import Path, PurePosixPath


def find(name: str, folder: Path) -> Path | None:
    """The file that a P word names in the media folder; None where there is none."""
    parts = PurePosixPath(name.strip().replace("\\", "/")).parts
    if not parts or any(part in ("/", "..") or ":" in part or "\0" in part for part in parts):
        return None
    at = folder
    for part in parts:
        step = at / part
        if not step.exists():
            alike = sorted(p for p in at.iterdir() if p.name.lower() == part.lower()) if at.is_dir() else []
            if not alike:
                return None
            step = alike[0]
        at = step
    return at if at.is_file() else None
