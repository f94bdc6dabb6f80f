"""The cases of LinuxCNC's language hold in its own interpreter too, line by line and fault by fault."""

from pathlib import Path

import pytest

import cases
import oracle

TEXTS = {path: path.read_text("utf-8") for path in cases.all_cases()}
#: The oracle's axes are always X Y Z A B C: of other machines see test_linuxcnc_axes.
CASES = [path for path, text in TEXTS.items() if "dialect: linuxcnc" in text and "axes: " not in text]


def options(case: cases.Case, folder: Path) -> list[str]:
    """The oracle's options for what a case's head says."""
    said = ["-b"] if "block-delete" in case.head.get("options", "") else []
    if "parameters" in case.head:
        pairs = (pair.split("=") for pair in case.head["parameters"].split())
        file = folder / "parameters.var"
        file.write_text("".join(f"{number}\t{value}\n" for number, value in pairs))
        said += ["-v", str(file)]
    return said


@pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (Debian package linuxcnc-uspace) is not installed")
@pytest.mark.parametrize("path", CASES, ids=lambda p: p.stem)
def test_case_holds_in_the_oracle(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # where both look for subroutines
    case = cases.read(path)
    results = cases.run(case, tmp_path)
    show = case.head.get("show", "motion")
    shown, wrong = [], []
    for at, (program, result) in enumerate(zip(case.programs, results, strict=True), 1):
        answer = oracle.answer(program, tmp_path, options(case, tmp_path))
        shown += cases.listing(answer.listing, show)
        difference = oracle.differ([line.rstrip("\n") for line in result.canon()], answer.listing)
        faults = [
            program.split("\n")[line - 1] for line, severity, *_ in cases.announced(program) if severity == "error"
        ]
        if difference:
            wrong.append(f"program {at}: {difference}")
        if answer.accepted != (not faults):
            wrong.append(f"program {at}: the oracle says {answer.message!r}")
        elif faults and not answer.names(faults[0]):
            wrong.append(f"program {at}: the oracle is at {answer.message!r}, not at {faults[0]!r}")
    wrong += cases.compare_listing(case, shown)
    assert not wrong, "\n".join([case.title, *wrong])
