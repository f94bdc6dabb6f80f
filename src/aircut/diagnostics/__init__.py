"""What can go wrong and how it is told: faults (the kinds) and diagnostics (the occasions)."""

from aircut.diagnostics.diagnostic import Diagnostic, Fault, Frame, Refusal, Severity, Span
from aircut.diagnostics.faults import FAULTS

__all__ = ["FAULTS", "Diagnostic", "Fault", "Frame", "Refusal", "Severity", "Span"]
