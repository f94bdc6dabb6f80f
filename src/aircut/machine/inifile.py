"""LinuxCNC's INI file, as far as its stand-alone interpreter (`rs274 -i`) is moved by it.

That interpreter keeps X Y Z A B C and inches whatever COORDINATES and LINEAR_UNITS say, and asks neither
PARAMETER_FILE nor TOOL_TABLE nor RS274NGC_STARTUP_CODE nor USER_M_PATH: they belong to the whole LinuxCNC.
Names and sections are told apart by case; of a name given twice the first counts.
"""

from __future__ import annotations

import os
import re
from math import sqrt
from pathlib import Path

from aircut.machine import remaps
from aircut.machine.config import MachineError
from aircut.machine.remaps import Remap

WHOLE = re.compile(r"[+-]?\d{1,9}", re.ASCII)
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|[+-]?(?:inf|nan)", re.ASCII | re.IGNORECASE)
NAME = re.compile(r"_ini\[([^\]]*)\](.+)")
MAX_TEXT = 16 * 2**20  # bytes
INCH = 25.4  # mm
SPINDLES = 8  # at most
#: Least and greatest tolerance of an arc's radii: mm, then inches.
TOLERANCES = {"MM": (0.001, 2 * sqrt(2) * 0.01), "INCH": (0.00004, 2 * sqrt(2) * 0.001)}


class Ini:
    """An INI file: its values by section and name, and what the interpreter makes of them.

    orient: degrees added to M19's R. tolerance: mm by which an arc's radii may differ, by mm a program unit.
    wrapped, indexers: rotary axes by number. folders: where subroutines are searched.
    random: an empty spindle holds tool -1, G10 L1 leaves it as it is, and G43 H0 means the slot in use.
    spindles: how many. resets: how often the listing ends with ON_RESET. remaps: codes that are subroutines.
    Raises MachineError for a value that LinuxCNC's interpreter does not start with.
    """

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.values = dict(reversed(list(entries(text))))
        self.resets = 1
        self.orient = self.number("RS274NGC", "ORIENT_OFFSET") or 0.0
        self.tolerance = {1.0: self.limit("MM"), INCH: self.limit("INCH") * INCH}
        self.spindles = self.whole("TRAJ", "SPINDLES", 1)
        if not 1 <= self.spindles <= SPINDLES:
            raise MachineError(f"{path}: [TRAJ]SPINDLES is 1 to {SPINDLES}")
        self.wrapped = frozenset(i for i, a in enumerate("ABC", 3) if self.flag(f"AXIS_{a}", "WRAPPED_ROTARY"))
        joints = {i: self.text(f"AXIS_{a}", "LOCKING_INDEXER_JOINT") for i, a in enumerate("ABC", 3)}
        self.indexers = frozenset(i for i, joint in joints.items() if joint and not joint.startswith("-"))
        usual = all(self.limit(unit) == high for unit, (_, high) in TOLERANCES.items())
        self.keeps_length = self.flag("RS274NGC", "RETAIN_G43")
        self.remaps = self.remapped([value for name, value in entries(text) if name == ("RS274NGC", "REMAP") and value])
        words = any(remap.group == 0 for remap in self.remaps)
        #: Moves mean what they do without the file.
        self.plain = usual and not (self.wrapped or self.indexers or self.keeps_length or words)
        self.spindle_on = self.flag("EMCIO", "TOOL_CHANGE_WITH_SPINDLE_ON")
        self.quill_up = self.flag("EMCIO", "TOOL_CHANGE_QUILL_UP")
        self.at_g30 = self.flag("EMCIO", "TOOL_CHANGE_AT_G30")
        self.random = self.flag("EMCIO", "RANDOM_TOOLCHANGER")
        self.counts_arguments = self.whole("RS274NGC", "OWORD_NARGS", 0) == 1
        self.no_fanuc = self.flag("RS274NGC", "DISABLE_FANUC_STYLE_SUB")
        self.forgets_shift = self.flag("RS274NGC", "DISABLE_G92_PERSISTENCE")

    @property
    def folders(self) -> list[Path]:
        """PROGRAM_PREFIX, then those of SUBROUTINE_PATH: from the working directory, else from beside the file."""
        names = [self.text("DISPLAY", "PROGRAM_PREFIX"), *self.text("RS274NGC", "SUBROUTINE_PATH").split(":")]
        given = [Path(os.path.expanduser(name)) for name in names if name and "\0" not in name]
        return [folder if folder.is_dir() else self.path.parent / folder for folder in given]

    def remapped(self, values: list[str]) -> tuple[Remap, ...]:
        """What REMAP lines say. Raises MachineError."""
        found: dict[str, Remap] = {}
        for value in values:
            try:
                remap = remaps.parse(value)
            except ValueError as error:
                raise MachineError(f"{self.path}: [RS274NGC]REMAP={value}: {error}") from None
            if remap.code in found:
                raise MachineError(f"{self.path}: [RS274NGC]REMAP: {remap.code.upper()} is remapped twice")
            folders = (Path(), *self.folders)
            if not remap.python and not any((folder / f"{remap.label}.ngc").is_file() for folder in folders):
                raise MachineError(f"{self.path}: [RS274NGC]REMAP={value}: there is no file {remap.label}.ngc")
            found[remap.code] = remap
        return tuple(found.values())

    def text(self, section: str, name: str) -> str:
        """A value; empty where there is none."""
        return self.values.get((section, name), "")

    def whole(self, section: str, name: str, otherwise: int) -> int:
        """A whole number; what is none counts as not given."""
        value = self.text(section, name)
        return int(value) if WHOLE.fullmatch(value) else otherwise

    def flag(self, section: str, name: str) -> bool:
        """Whether a whole number is given that is not 0: YES and TRUE are none."""
        return self.whole(section, name, 0) != 0

    def number(self, section: str, name: str) -> float | None:
        """A number, if it is one."""
        value = self.text(section, name)
        return float(value) if NUMBER.fullmatch(value) else None

    def limit(self, unit: str) -> float:
        """The tolerance of an arc's radii, in the unit. Raises MachineError."""
        low, high = TOLERANCES[unit]
        name = f"CENTER_ARC_RADIUS_TOLERANCE_{unit}"
        if ("RS274NGC", name) not in self.values:
            return high
        value = self.number("RS274NGC", name)
        if value is None or not low <= value <= high:
            raise MachineError(f"{self.path}: [RS274NGC]{name} is {low:g} to {high:.7g}")
        return value

    def named(self, name: str) -> float | None:
        """The value of `#<_ini[section]name>`; None where the file has no such number."""
        match = NAME.fullmatch(name) if name.startswith("_ini[") else None
        return self.number(match[1].upper(), match[2].upper()) if match else None


def entries(text: str) -> list[tuple[tuple[str, str], str]]:
    """Sections, names and values in order."""
    found: list[tuple[tuple[str, str], str]] = []
    section: str | None = None
    closed: set[str] = set()  # of a section that stands again the first counts
    for line in text.replace("\\\n", "").splitlines():
        line = line.strip()
        if not line or line[0] in "#;":
            continue
        if line[0] == "[":
            closed.add(section or "")
            section = line[1 : line.index("]")] if "]" in line else None
            continue
        name, equals, value = line.partition("=")
        if equals and section is not None and section not in closed:
            found.append(((section, name.strip()), value.strip()))
    return found


def load(path: Path) -> Ini:
    """Read an INI file. Raises MachineError."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_TEXT + 1)
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    if len(data) > MAX_TEXT:
        raise MachineError(f"{path}: too large for an INI file, at most {MAX_TEXT} bytes")
    return Ini(path, data.decode("utf-8", "replace"))


#: What serves where no file is given.
NO_INI = Ini(Path(), "")
NO_INI.resets = 2
