"""conformance/coverage.tsv is complete, current, and names cases and tests that exist."""

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
CONFORMANCE = ROOT / "conformance"
REQUIREMENTS = ROOT.parent / "shared" / "spec" / "requirements.tsv"


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))


COVERAGE = rows(CONFORMANCE / "coverage.tsv")


def exists(test: str) -> bool:
    """Whether there is such a case, or such a test function."""
    file, _, function = test.partition("::")
    if not function:
        return (CONFORMANCE / f"{test}.case").exists()
    path = ROOT / file
    name = re.escape(function.partition("[")[0])
    return path.exists() and re.search(rf"^def {name}\(", path.read_text("utf-8"), re.MULTILINE) is not None


def test_the_table_is_current() -> None:
    done = subprocess.run([sys.executable, ROOT / "scripts" / "coverage", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(not REQUIREMENTS.exists(), reason="the requirements are not at hand")
def test_every_requirement_has_a_row() -> None:
    assert [row["id"] for row in COVERAGE] == [row["id"] for row in rows(REQUIREMENTS)]


def test_what_is_done_is_held_by_tests_that_exist() -> None:
    for row in COVERAGE:
        tests = row["test"].split()
        assert row["status"] in {"done", "partial", "todo"}, row
        assert bool(tests) == (row["status"] != "todo"), row
        assert all(exists(test) for test in tests), row


def test_every_gap_says_what_is_missing() -> None:
    partial = {row["id"] for row in COVERAGE if row["status"] == "partial"}
    gaps = rows(CONFORMANCE / "partial.tsv")
    assert {row["id"] for row in gaps} == partial
    assert all(row["missing"] for row in gaps)
