"""Codes that an INI file of LinuxCNC remaps to subroutines: `[RS274NGC]REMAP=M400 modalgroup=10 argspec=Pq ngc=name`.

Those with Python (`python=`, `prolog=`, `epilog=`) are refused where a program uses them.
"""

from __future__ import annotations

import re
from typing import NamedTuple

CODE = re.compile(r"([gm])0*(\d{1,3}(?:\.\d)?)|[tsf]", re.IGNORECASE | re.ASCII)
ARGUMENTS = re.compile(r"[A-Za-z@^>]+", re.ASCII)
M_GROUPS = range(4, 11)
ANY_M = (200, 999)
#: Built-in M codes of which LinuxCNC's interpreter lets a remap come into force.
BUILT_IN = frozenset(f"m{n}" for n in (0, 1, 6, 9, 60, 61, 62, 63, 64, 65, 66, 67, 68))


class Remap(NamedTuple):
    """One of them. group: LinuxCNC's modal group, 0 for T, S and F. arguments: the letters of argspec, in order."""

    code: str  # "m400", "g88.1", "t"
    label: str  # of the subroutine; empty for Python
    group: int
    arguments: str = ""
    python: str = ""  # the option that is Python


def parse(value: str) -> Remap:
    """The value of a REMAP line. Raises ValueError, which says what is wrong with it."""
    name, *options = value.partition("#")[0].split() or [""]
    match = CODE.fullmatch(name)
    if match is None:
        raise ValueError("a code stands first: G88.1, M400, T, S or F")
    code = f"{match[1]}{match[2]}".lower() if match[1] else name.lower()
    given: dict[str, str] = {}
    for option in options:
        key, equals, text = option.partition("=")
        if not equals or not text:
            raise ValueError(f"{option} is no option: they are written name=value")
        given[key.lower()] = text
    python = next((f"{key}={given[key]}" for key in ("python", "py", "prolog", "epilog") if key in given), "")
    if "ngc" not in given and not python:
        raise ValueError("ngc= names no subroutine")
    arguments = given.get("argspec", "")
    if arguments and not ARGUMENTS.fullmatch(arguments):
        raise ValueError("argspec is made of letters, @, ^ and >")
    label = "" if python else given["ngc"]
    return Remap(code, label, group_of(code, given.get("modalgroup", "")), arguments, python)


def group_of(code: str, text: str) -> int:
    """The modal group. Raises ValueError."""
    if code in ("t", "s", "f"):
        if text:
            raise ValueError("T, S and F have no modal group")
        return 0
    group = int(text) if text.isdecimal() else -1 if text else 1 if code[0] == "g" else 10
    if group not in ((1,) if code[0] == "g" else M_GROUPS):
        raise ValueError("modalgroup is 1 for G codes, 4 to 10 for M codes")
    return group
