"""The documentation is what the tables and the house say."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from aircut.diagnostics import faults
from aircut.interpreter.rosetta import CODES

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def test_reference_pages_are_current() -> None:
    done = subprocess.run([sys.executable, ROOT / "scripts" / "reference", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text("utf-8")):
        assert (page.parent / target).exists(), target


def test_every_package_is_in_the_architecture() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    for path in (ROOT / "src" / "aircut").iterdir():
        if not path.name.startswith("_") and path.name != "py.typed":
            assert f"`aircut.{path.stem}`" in text, path.name


def test_python_examples_in_the_docs_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    for page in PAGES:
        for code in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
            exec(compile(code, page.name, "exec"), {})


def test_every_fault_is_used() -> None:
    used = "".join(path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py") if path.name != "faults.py")
    names = [name for name, value in vars(faults).items() if isinstance(value, faults.Fault)]
    assert [name for name in names if f"F.{name}" not in used] == []


def test_codes_are_named_once() -> None:
    names = [row.name for row in CODES]
    assert len(names) == len(set(names))
