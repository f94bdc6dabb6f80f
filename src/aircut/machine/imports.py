"""Tool libraries in files: our tools.toml, LinuxCNC's tool table, and the tool libraries of Autodesk Fusion.

Reading tells what it passed over as values, not as errors: a library of five hundred tools
is of use even if one of them has no number. Writing is tools.toml only.

Fusion's format is not published; what is read here was found in libraries and in programs
that read them. A library is an object whose `data` lists the tools, as .json or as tools.json
in a .tools archive. Of a tool:

- `post-process.number` is its number. `length-offset` and `diameter-offset` beside it are
  numbers of registers (H and D), not lengths; they are not imported, and a length
  register of another number is told, for G43 H would read that tool's length.
- `geometry` is in the tool's own `unit` (`expressions.tool_unit` in older files):
  DC is the diameter. OAL, LB and LCF are lengths of the cutter, not from the spindle's
  gauge line; none of them is a tool length offset.
- `geometry.assemblyGaugeLength` is the length from gauge line to tip that Fusion's own
  posts use; where it is missing, the holder's `gaugeLength` (in the holder's unit) and LB
  add up to it; else the length is 0, to be measured. Without a holder,
  assemblyGaugeLength is as long as the cutter reaches out of nothing: check it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import msgspec

from aircut.files import replacing
from aircut.machine import tools as tool_library
from aircut.machine import tooltable
from aircut.machine.config import MachineError
from aircut.machine.tools import Tool

MAX_TEXT = 16 * 2**20  # bytes of a tools.toml or a tool table
MAX_JSON = 64 * 2**20  # bytes of a Fusion library, unpacked
MAX_OBJECTS = 1_000_000  # in a Fusion library; each costs memory
MAX_WARNINGS = 100
MAX_NUMBER = 2**31 - 1
LAST_TYPE = 8

BOM = b"\xef\xbb\xbf"
ZIP = b"PK\x03\x04"
MEMBER = "tools.json"
MEMBER_ENTRY = b"PK\x01\x02"  # begins each entry of an archive's directory
MAX_MEMBERS = 1000

#: Fusion's names of tool types, and ours (machine.tools.Tool.type). Others are 0, generic.
TYPES = {
    "flat end mill": 1,
    "bull nose end mill": 1,
    "face mill": 1,
    "ball end mill": 2,
    "drill": 3,
    "spot drill": 3,
    "center drill": 3,
    "probe": 4,
    "slot mill": 5,  # a disc on a thin shank: slitting saws, T-slot and keyseat cutters
    "plasma cutter": 6,
    "turning general": 8,
    "turning boring": 8,
    "turning grooving": 8,
    "turning threading": 8,
}
#: Entries of a library that are no tools, but what tools are held by.
NOT_TOOLS = ("holder", "tool block")
UNITS = {"millimeters": 1.0, "inches": 25.4}


class Library(NamedTuple):
    """What a file held. warnings: what was passed over, each with its place; at most about a hundred."""

    tools: dict[int, Tool]
    warnings: tuple[str, ...]


def read_tools(path: Path, unit_mm: float = 1.0) -> dict[int, Tool]:
    """The tools of a file by number, whatever its format. Lengths mm.    Arguments and errors: `read_library`."""
    return read_library(path, unit_mm).tools


def read_library(path: Path, unit_mm: float = 1.0) -> Library:
    """The tools of a file by number, and what was passed over.

    The format is told by the content, or where that may be either, by the suffix: an
    archive or JSON is Fusion's; .tbl is LinuxCNC's; otherwise tools.toml.
    unit_mm: mm in a unit of a LinuxCNC table, which does not name its own: 25.4 for an
    inch machine. The other formats name theirs.
    Of tools with the same number the first counts, as in LinuxCNC; in tools.toml it is an error.
    Raises MachineError with the file and the place.
    """
    if not 0.0 < unit_mm < math.inf:
        raise MachineError(f"{path}: a unit of {unit_mm:g} mm is not a unit of length")
    data = content(path)
    suffix = path.suffix.lower()
    if data.startswith(ZIP):
        return fusion(path, unpacked(path, data))
    if data.lstrip().startswith(b"{") or suffix in (".json", ".tools"):
        return fusion(path, data)
    if len(data) > MAX_TEXT:
        raise MachineError(f"{path}: too large for a tool library, at most {MAX_TEXT} bytes")
    if suffix == ".tbl" or (suffix != ".toml" and looks_like_table(data)):
        return table(path, data, unit_mm)
    return Library(toml(path, data), ())


def read_slots(path: Path, unit_mm: float) -> list[Tool] | None:
    """The tools of a LinuxCNC table by slot; None for a library of another format. Raises MachineError."""
    data = content(path)
    if path.suffix.lower() == ".tbl" or (path.suffix.lower() != ".toml" and looks_like_table(data)):
        return tooltable.slots(data.decode("utf-8", "replace"), unit_mm)
    return None


def write_tools(path: Path, tools: dict[int, Tool]) -> None:
    """Write a tools.toml whole or not at all; `read_tools` gives the same tools again.

    Comments of a file that was there are lost. Raises MachineError.
    """
    text = "# Tool library. Lengths mm.\n" + "".join(map(toml_table, checked(path, tools.values())))
    try:
        with replacing(path, binary=True) as file:
            file.write(text.encode("utf-8"))
    except UnicodeEncodeError:
        raise MachineError(f"{path}: a tool's name is not text") from None
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None


# --- reading


def content(path: Path) -> bytes:
    """The bytes of the file, without a byte order mark. Raises MachineError."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_JSON + 1)
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    if len(data) > MAX_JSON:
        raise MachineError(f"{path}: too large for a tool library, at most {MAX_JSON} bytes")
    return data.removeprefix(BOM)


def looks_like_table(data: bytes) -> bool:
    """Whether the first line that says anything is LinuxCNC's: a comment with ; or a word such as T1."""
    return re.match(rb"\s*(;|[a-zA-Z][+-]?\.?[0-9])", data) is not None


def toml(path: Path, data: bytes) -> dict[int, Tool]:
    try:
        tools = tool_library.parse(data.decode("utf-8"))
    except RecursionError:
        raise MachineError(f"{path}: nested too deeply") from None
    except (ValueError, msgspec.ValidationError) as error:
        raise MachineError(f"{path}: {error}") from None
    checked(path, tools.values())
    return tools


def checked(path: Path, tools: Iterable[Tool]) -> list[Tool]:
    """The tools by number, found fit to be stored. Raises MachineError."""
    found: dict[int, Tool] = {}
    for tool in tools:
        if tool.id < 1 or tool.id in found:
            raise MachineError(f"{path}: tool {tool.id}: ids are above zero, and each stands once")
        if not 0 <= tool.type <= LAST_TYPE:
            raise MachineError(f"{path}: tool {tool.id}: type is 0 to {LAST_TYPE}, not {tool.type}")
        if tool.slot < 0:
            raise MachineError(f"{path}: tool {tool.id}: slot is not below 0")
        for name, value in msgspec.structs.asdict(tool).items():
            if isinstance(value, float) and not math.isfinite(value):
                raise MachineError(f"{path}: tool {tool.id}: {name} must be a finite number")
        found[tool.id] = tool
    return [found[id] for id in sorted(found)]


class Collector:
    """Tools as they are found, the first of each number, and what was wrong on the way."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tools: dict[int, Tool] = {}
        self.warnings: list[str] = []
        self.untold = 0

    def warn(self, place: str, text: str) -> None:
        if len(self.warnings) < MAX_WARNINGS:
            self.warnings.append(f"{self.path}{place}: {text}")
        else:
            self.untold += 1

    def add(self, place: str, tool: Tool) -> None:
        if tool.id in self.tools:
            self.warn(place, f"tool {tool.id} stands twice: the first counts")
        else:
            self.tools[tool.id] = tool

    def library(self) -> Library:
        """Raises MachineError where there is nothing but faults: that is no tool library."""
        if self.warnings and not self.tools:
            raise MachineError(f"{self.warnings[0]} (no tools found)")
        if self.untold:
            self.warnings.append(f"{self.path}: {self.untold} more warnings")
        return Library(self.tools, tuple(self.warnings))


def table(path: Path, data: bytes, unit_mm: float) -> Library:
    """The tools of a LinuxCNC table. Bytes that are not UTF-8 can only stand in a name, and are replaced."""
    found = Collector(path)
    for line, tool, fault in tooltable.read(data.decode("utf-8", "replace"), unit_mm):
        if tool is None:
            found.warn(f":{line}", f"{fault}: line skipped")
        else:
            found.add(f":{line}", tool)
    return found.library()


# --- Fusion


class Geometry(msgspec.Struct, rename={"diameter": "DC", "gauge": "assemblyGaugeLength", "body": "LB"}):
    diameter: float | None = None
    gauge: float | None = None
    body: float | None = None


class PostProcess(msgspec.Struct, rename={"length_offset": "length-offset"}):
    number: int | None = None
    length_offset: int | None = None


class Holder(msgspec.Struct, rename={"gauge": "gaugeLength"}):
    gauge: float | None = None
    unit: str | None = None


class Expressions(msgspec.Struct):
    tool_unit: str | None = None  # in quotes within the string


class Entry(msgspec.Struct, rename={"post": "post-process"}):
    """A tool of a library: the parts that are read."""

    type: str | None = None
    description: str | None = None
    unit: str | None = None
    geometry: Geometry | None = None
    post: PostProcess | None = None
    holder: Holder | None = None
    expressions: Expressions | None = None


class FusionLibrary(msgspec.Struct):
    data: list[Entry]


def unpacked(path: Path, data: bytes) -> bytes:
    """tools.json of a .tools archive. Raises MachineError."""
    import io
    import zipfile
    import zlib

    if data.count(MEMBER_ENTRY) > MAX_MEMBERS:
        raise MachineError(f"{path}: too many files in the archive for a tool library")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            member = archive.getinfo(MEMBER)
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise MachineError(f"{path}: {MEMBER}: packed in a way that is not read")
            with archive.open(member) as file:
                text = file.read(MAX_JSON + 1)  # never more, whatever the archive claims
    except KeyError:
        raise MachineError(f"{path}: an archive without {MEMBER}: not a tool library of Fusion") from None
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, RuntimeError, ValueError) as error:
        raise MachineError(f"{path}: archive cannot be read: {error}") from None
    if len(text) > MAX_JSON:
        raise MachineError(f"{path}: {MEMBER}: too large for a tool library, at most {MAX_JSON} bytes")
    return text.removeprefix(BOM)


def fusion(path: Path, data: bytes) -> Library:
    """The tools of a Fusion library. Raises MachineError."""
    if data.count(b"{") > MAX_OBJECTS:
        raise MachineError(f"{path}: too large for a tool library, at most {MAX_OBJECTS} objects")
    try:
        # Not strict: some programs write numbers as strings.
        library = msgspec.json.decode(data, type=FusionLibrary, strict=False)
    except RecursionError:
        raise MachineError(f"{path}: nested too deeply") from None
    except (ValueError, msgspec.MsgspecError) as error:
        raise MachineError(f"{path}: not a tool library of Fusion: {error}") from None
    found = Collector(path)
    for index, item in enumerate(library.data):
        place = f": data[{index}]"
        if item.type in NOT_TOOLS:
            continue
        try:
            tool = fusion_tool(item)
        except ValueError as error:
            found.warn(place, f"{error}: tool skipped")
            continue
        found.add(place, tool)
        if item.post and item.post.length_offset not in (None, tool.id):
            register = item.post.length_offset
            found.warn(
                place, f"tool {tool.id} uses length register {register}: H{register} is tool {register}'s length"
            )
    return found.library()


def fusion_tool(item: Entry) -> Tool:
    """A tool from an entry. Raises ValueError."""
    number = item.post.number if item.post else None
    if not number:  # Fusion gives 0 to tools that have none yet
        raise ValueError("no tool number")
    if not 1 <= number <= MAX_NUMBER:
        raise ValueError(f"tool numbers are 1 to {MAX_NUMBER}, not {number}")
    unit = item.unit or (item.expressions.tool_unit if item.expressions else None)
    scale = scale_of(unit)
    if scale is None:
        raise ValueError(f"tool {number} is in {unit[:20]!r}, not in millimeters or inches" if unit else "no unit")
    geometry = item.geometry or Geometry()
    diameter = (geometry.diameter or 0.0) * scale
    if not 0.0 <= diameter < math.inf:
        raise ValueError(f"tool {number} has a diameter of {diameter:g} mm")
    length = gauge_length(geometry, item.holder, scale)
    if not 0.0 <= length < math.inf:
        raise ValueError(f"tool {number} has a length of {length:g} mm")
    return Tool(
        number,
        item.description or item.type or "",
        z=round(length, 9),
        diameter=round(diameter, 9),
        type=TYPES.get((item.type or "").lower(), 0),
    )


def gauge_length(geometry: Geometry, holder: Holder | None, scale: float) -> float:
    """Gauge line to tip, mm; 0 where the library does not say. scale: mm in the tool's unit."""
    if geometry.gauge:
        return geometry.gauge * scale
    if holder and holder.gauge and geometry.body:
        holder_scale = scale_of(holder.unit) or scale
        return holder.gauge * holder_scale + geometry.body * scale
    return 0.0


def scale_of(unit: str | None) -> float | None:
    """mm in a unit as Fusion names it, also within quotes; None for others."""
    return UNITS.get((unit or "").strip().strip("'\"").lower())


# --- writing

ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def toml_table(tool: Tool) -> str:
    """A [[tools]] table; what is at its default is left out."""
    values = msgspec.structs.asdict(tool)
    defaults = msgspec.structs.asdict(Tool(0))
    lines = [f"{name} = {toml_value(value)}\n" for name, value in values.items() if value != defaults[name]]
    return "\n[[tools]]\n" + "".join(lines)


def toml_value(value: str | int | float) -> str:
    if isinstance(value, str):
        return '"' + "".join(ESCAPES.get(c) or (c if c.isprintable() else escaped(c)) for c in value) + '"'
    return repr(float(value)) if isinstance(value, float) else repr(int(value))  # not the repr of a subclass


def escaped(character: str) -> str:
    """As TOML writes what cannot be seen. A lone surrogate stays: it is not text, and encoding it fails."""
    code = ord(character)
    if 0xD800 <= code <= 0xDFFF:
        return character
    return f"\\u{code:04X}" if code < 0x10000 else f"\\U{code:08X}"
