"""Every conformance case holds."""

from pathlib import Path

import pytest

import cases


@pytest.mark.parametrize("path", cases.all_cases(), ids=lambda p: str(p.relative_to(cases.CONFORMANCE))[:-5])
def test_case(path: Path, tmp_path: Path) -> None:
    case = cases.read(path)
    wrong = cases.compare(case, cases.run(case, tmp_path))
    assert not wrong, "\n".join([case.title, *wrong])
