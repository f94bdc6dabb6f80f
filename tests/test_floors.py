"""Imports go down the floors of the house, never up."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "aircut"
FLOORS = {
    "kernels": 0,
    "geometry": 0,
    "files": 0,
    "memory": 0,
    "source": 1,
    "diagnostics": 1,
    "canon": 1,
    "markup": 1,
    "language": 2,
    "machine": 3,
    "interpreter": 4,
    "dialects": 4,
    "rules": 5,
    "planner": 5,
    "controller": 6,
    "export": 7,
    "api": 7,
    "cli": 8,
    "web": 8,
    "lsp": 8,
    "testing": 8,
}


def floor_of(module: str) -> int:
    return FLOORS[module.split(".")[1]]


def imports(path: Path) -> list[str]:
    """Modules of the house that a file imports, type-checking imports left out."""
    tree = ast.parse(path.read_text("utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node.body = []
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("aircut"):
            below = [f"{node.module}.{alias.name}" for alias in node.names]
            found += below if node.module == "aircut" else [node.module]
        elif isinstance(node, ast.Import):
            found += [alias.name for alias in node.names if alias.name.startswith("aircut.")]
    return [name for name in found if not name.startswith("aircut.__") and name != "aircut"]


@pytest.mark.parametrize("path", sorted(SOURCE.rglob("*.py")), ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_go_down(path: Path) -> None:
    name = path.relative_to(SOURCE).parts[0].removesuffix(".py")
    if name in ("__init__", "__main__"):
        return  # the front door names what it lazily opens
    assert name in FLOORS, f"{name} has no floor yet"
    for module in imports(path):
        assert floor_of(module) <= FLOORS[name], f"{path.name} on floor {FLOORS[name]} imports {module} above it"


def test_geometry_and_kernels_know_only_themselves() -> None:
    known = {"geometry": {"geometry", "kernels"}, "kernels": {"kernels"}}
    for package, packages in known.items():
        for path in (SOURCE / package).glob("*.py"):
            assert all(name.split(".")[1] in packages for name in imports(path)), path


def test_no_branch_on_the_dialect() -> None:
    for path in (SOURCE / "interpreter").glob("*.py"):
        assert "dialect.name ==" not in path.read_text("utf-8"), path
