"""Motion in time: from a toolpath to a plan of speeds, and where the tool is when.

See docs/explanation/time.md for the model.
"""

from aircut.planner.clock import KINDS, Overrides, Pause, Regime
from aircut.planner.limits import Limits, PlanError, limits, of_machine
from aircut.planner.plan import Plan, Samples
from aircut.planner.planning import plan, plan_moves

__all__ = [
    "KINDS",
    "Limits",
    "Overrides",
    "Pause",
    "Plan",
    "PlanError",
    "Regime",
    "Samples",
    "limits",
    "of_machine",
    "plan",
    "plan_moves",
]
