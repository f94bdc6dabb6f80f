"""What buttons of the controller run beside programs: the tool changer's panel.

Sources: 000 and 004 section 2.2.3; decision AMB-NAM-9: the macro finds the action in #13 and `#<_args.m>`.
"""

from __future__ import annotations

from aircut.interpreter.running import Mode, Run, Settings
from aircut.interpreter.table import Dialect
from aircut.machine import Machine
from aircut.source import Source

PICK_PLACE = "atcm_pick_place_tool.ngc"
NAME = "panel"  # the file that diagnostics name
#: Actions, and the named parameters that hold their numbers.
ACTIONS = {
    "pick": "pick_place.mode_pick",
    "place": "pick_place.mode_place",
    "place-pick": "pick_place.mode_place_pick",
}


def pick_place(action: str, dialect: Dialect, machine: Machine, settings: Settings | None = None) -> Run:
    """The run of the panel's pick, place or place-pick. Raises KeyError for another action."""
    text = f'G65 P"{PICK_PLACE}" M#<{ACTIONS[action]}>\n'
    settings = (settings or Settings())._replace(mode=Mode.MACRO)
    return dialect.interpreter(Source(NAME, text.encode()), dialect, machine, settings)
