"""Memory in bulk: taken in large pages where the system has them, and not filled with anything before its use."""

from __future__ import annotations

import mmap


def fresh(size: int) -> mmap.mmap:
    """Memory of its own, all zeros, given back when nobody looks at it any more."""
    if not hasattr(mmap, "MAP_PRIVATE"):
        return mmap.mmap(-1, size)
    memory = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    if hasattr(mmap, "MADV_HUGEPAGE"):
        memory.madvise(mmap.MADV_HUGEPAGE)
    return memory
