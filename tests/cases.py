"""Reads conformance cases and compares runs with them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

import aircut
from aircut import dialects
from aircut.api import Result
from aircut.diagnostics import Severity
from aircut.interpreter.running import Limits
from aircut.machine import Machine, Tool, built_in, load

ROOT = Path(__file__).parent.parent
CONFORMANCE = ROOT / "conformance"
MOTION = {"STRAIGHT_TRAVERSE", "STRAIGHT_FEED", "ARC_FEED", "STRAIGHT_PROBE"}
OPENING = 6  # lines of a listing before the program's own
TOLERANCE = 1e-4  # numbers of the listing
PAIR = re.compile(r"(\w[\w ]*?):\s+(.*?)(?=\s{2,}\w+:\s|$)")
COMMAND = re.compile(r"([A-Z][A-Z0-9_]*)\((.*?)\)(?=\s|$)")
NUMBERED = re.compile(r" {0,4}\d+ N[\d. \t/]*")
VALUE = re.compile(r"#(<[^>]+>|\d+)\s*=\s*(null|[-+.\dEeinfa]+)")
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


@dataclass
class Case:
    """One case file."""

    path: Path
    title: str
    head: dict[str, str]
    program: str
    expected: list[str]
    files: dict[str, str] = field(default_factory=dict)

    @property
    def covers(self) -> list[str]:
        return self.head.get("covers", "").split()

    @property
    def dialect(self) -> str:
        return self.head.get("dialect", "rosetta")

    @property
    def programs(self) -> list[str]:
        """The case's programs, each run by itself."""
        return re.split(r"^===[ \t]*\n", self.program, flags=re.MULTILINE)


def read(path: Path) -> Case:
    """Read a case. Raises ValueError where it is not one."""
    parts = re.split(r"^---[ \t]*\n", path.read_text("utf-8"), flags=re.MULTILINE)
    if len(parts) != 3:
        raise ValueError(f"{path}: a case has three parts between lines of ---")
    lines = parts[0].strip().splitlines()
    head: dict[str, str] = {}
    files: dict[str, str] = {}
    name = ""
    for line in lines[1:]:
        if line.startswith("file "):
            name = line[5:].strip()
            files[name] = ""
        elif name:
            files[name] += line + "\n"
        else:
            for match in PAIR.finditer(line):
                head[match[1]] = f"{head.get(match[1], '')} {match[2].strip()}".strip()
    expected = [line for line in parts[2].splitlines() if line.strip()]
    return Case(path, lines[0], head, parts[1], expected, files)


def all_cases() -> list[Path]:
    return sorted(CONFORMANCE.rglob("*.case"))


def machine(case: Case, folder: Path) -> Machine:
    for name, text in case.files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, "utf-8")
    if "machine.toml" in case.files:
        made = load(folder)
    elif case.dialect != "rosetta":
        made = dialects.machine(dialects.load(case.dialect), case.head.get("axes", ""))
    else:
        made = built_in(case.head.get("axes", "XYZ"))
    if "error-on-missing-feed" in case.head.get("options", ""):
        made.options = msgspec.structs.replace(made.options, missing_feed="error")
    if entry := re.search(r"entry=(\w+)", case.head.get("options", "")):
        made.options = msgspec.structs.replace(made.options, entry=entry[1])
    given = {int(n): float(v) for n, v in (pair.split("=") for pair in case.head.get("parameters", "").split())}
    if case.dialect == "rosetta":
        made.variables |= given
    else:
        made.parameters = given
    if "tools" in case.head:
        made.own_tools = True
        made.tools = {}
        for text in case.head["tools"].split():
            number, _, data = text.partition(":")
            fields = dict(pair.split("=") for pair in data.split(",") if pair)
            kinds = {"slot": int, "type": int, "name": str}
            tool = Tool(int(number), **{k: kinds.get(k, float)(v) for k, v in fields.items()})
            made.tools[tool.id] = tool
    if case.files:
        made.macros = (folder,)
    return made


def run(case: Case, folder: Path) -> list[Result]:
    """Run the programs of a case. Where flow is not known before it runs, the first error ends a run."""
    options = case.head.get("options", "")
    budget = re.search(r"max-blocks=(\d+)", options)
    limits = Limits(blocks=int(budget[1])) if budget else Limits()
    results = []
    for text in case.programs:
        program = aircut.loads(text, case.dialect, case.path.name)
        results.append(program.run(
            machine(case, folder), keep_going=case.dialect == "rosetta", limits=limits,
            block_delete="block-delete" in options, optional_stop="optional-stop" in options,
        ))  # fmt: skip
    return results


def compare(case: Case, results: list[Result]) -> list[str]:
    """What differs from the case, in words; empty when nothing does."""
    show = case.head.get("show", "motion")
    listed = [command for result in results for command in listing(result.canon(), show)]
    faults = [
        wrong
        for text, result in zip(case.programs, results, strict=True)
        for wrong in compare_faults(case, text, result)
    ]
    return [*faults, *compare_listing(case, listed), *compare_values(case, results[-1])]


def announced(program: str) -> list[tuple[int, str, str, str]]:
    """Line, severity, code and words of the diagnostics that a program's comments tell of."""
    return [
        (at, "error" if kind == "fault" else "warning", code, words.strip())
        for at, line in enumerate(program.split("\n"), 1)
        for kind, code, words in re.findall(r"\b(fault|warning):\s+([^\s;)]*)([^;)]*)", line)
    ]


def compare_faults(case: Case, program: str, result: Result) -> list[str]:
    wanted = announced(program)
    wrong = []
    given = [d for d in result.diagnostics if d.file == case.path.name]
    left = list(given)
    for at, severity, code, words in wanted:
        match = next(
            (d for d in left if (d.span.line, d.severity.value, d.code) == (at, severity, code) and words in d.message),
            None,
        )
        if match is None:
            found = "; ".join(str(d) for d in given if d.span.line == at) or "nothing"
            wrong.append(f"line {at}: expected {severity} {code} {words!r}, got {found}")
        else:
            left.remove(match)
    others = [d for d in result.diagnostics if d.file != case.path.name]
    wrong += [f"unexpected: {d}" for d in [*left, *others] if d.severity is Severity.ERROR]
    return wrong


def listing(lines: Iterable[str], show: str) -> list[str]:
    """What a case shows of a listing, without its number columns."""
    kept = [NUMBERED.sub("", line.rstrip("\n")).lstrip() for line in lines][OPENING:-2]
    if show == "all":
        return kept
    names = MOTION if show == "motion" else set(show.replace(",", " ").split())
    return [line for line in kept if line.split("(")[0] in names or ("PRINT" in names and "(" not in line)]


def compare_listing(case: Case, given: list[str]) -> list[str]:
    wanted = [line for line in case.expected if not line.lstrip().startswith("#")]
    wrong = [
        f"command {at}: expected {w.strip()!r}, got {g!r}"
        for at, (w, g) in enumerate(zip(wanted, given, strict=False), 1)
        if not same(w, g)
    ]
    if len(wanted) != len(given):
        more = list(given[len(wanted) :]) or [w.strip() for w in wanted[len(given) :]]
        wrong.append(f"expected {len(wanted)} commands, got {len(given)}; beyond the shorter: {more[:5]}")
    return wrong


def same(wanted: str, given: str) -> bool:
    """Whether a listing line is as expected: same name and texts, same numbers but for zeros left out."""
    w, g = COMMAND.search(wanted), COMMAND.search(given)
    if w is None or g is None:  # what is printed has no name
        return wanted.rstrip() == given.rstrip()
    if w[1] != g[1]:
        return False
    if NUMBER.sub("0", w[2]) != NUMBER.sub("0", g[2]) and ('"' in g[2] or "CANON" in g[2]):
        return False
    a = [float(n) for n in NUMBER.findall(w[2])]
    b = [float(n) for n in NUMBER.findall(g[2])]
    a += [0.0] * (len(b) - len(a))
    return len(a) == len(b) and all(abs(x - y) <= TOLERANCE for x, y in zip(a, b, strict=True))


def compare_values(case: Case, result: Result) -> list[str]:
    wrong = []
    for line in case.expected:
        match = VALUE.match(line.strip())
        if match is None:
            if line.lstrip().startswith("#"):
                wrong.append(f"cannot read {line!r}")
            continue
        name = match[1]
        if name.startswith("<"):
            given = result.variables.get("".join(name[1:-1].lower().split()))
        else:
            given = result.system(int(name))
        wanted = None if match[2] == "null" else float(match[2])
        if given is None or wanted is None:
            if given is not wanted:
                wrong.append(f"#{name}: expected {match[2]}, got {given}")
        elif abs(given - wanted) > 1e-6 * max(1.0, abs(wanted)) and given != wanted:
            wrong.append(f"#{name}: expected {wanted}, got {given}")
    return wrong
