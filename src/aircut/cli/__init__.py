"""The command line."""

from aircut.cli.main import main

__all__ = ["main"]
