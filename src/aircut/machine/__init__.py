"""The machine's data: axes, options, tools, and what it remembers between runs."""

from aircut.machine.config import Axis, Machine, MachineError, Options, built_in, load
from aircut.machine.tools import Tool

__all__ = ["Axis", "Machine", "MachineError", "Options", "Tool", "built_in", "load"]
