"""Rules: what `aircut check` warns of beside the faults of the language, and how it is switched off.

A rule is a row (`table.RULES`); what is switched off, and how bad it is, is a Policy
(`policy`). `checked` runs a program and leaves all it has to tell in `run.diagnostics`.
"""

from aircut.rules.checking import checked, settled
from aircut.rules.policy import Policy, RulesError
from aircut.rules.table import RULES, Rule

__all__ = ["RULES", "Policy", "Rule", "RulesError", "checked", "settled"]
