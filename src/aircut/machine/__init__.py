"""The machine's data: axes, options, tools, and what it remembers between runs."""

from pathlib import Path

from aircut.machine.config import Axis, Machine, MachineError, Options, built_in, load
from aircut.machine.tools import Tool

#: Folder of the macros that every machine has: G250, G390.
INSTALLED = Path(__file__).parent / "macros"

__all__ = ["INSTALLED", "Axis", "Machine", "MachineError", "Options", "Tool", "built_in", "load"]
