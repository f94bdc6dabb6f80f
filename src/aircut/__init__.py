"""aircut: a virtual CNC. Compiles NC programs, runs them on a virtual machine, and shows what they do."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from aircut.api import Program, Result, load, loads
    from aircut.canon import Toolpath
    from aircut.diagnostics import Diagnostic
    from aircut.machine import Machine
    from aircut.planner import Plan

__version__ = "0.1.0"

# Loaded when first asked for: a small check must not pay for what it does not use.
_LAZY = {
    "load": "aircut.api",
    "loads": "aircut.api",
    "Plan": "aircut.planner",
    "Program": "aircut.api",
    "Result": "aircut.api",
    "Toolpath": "aircut.canon",
    "Diagnostic": "aircut.diagnostics",
    "Machine": "aircut.machine",
}

__all__ = ["Diagnostic", "Machine", "Plan", "Program", "Result", "Toolpath", "__version__", "load", "loads"]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'aircut' has no attribute {name!r}")
