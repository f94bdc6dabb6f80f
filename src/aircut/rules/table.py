"""The rules, one row each: what is wrong, why it matters, a program that breaks it and one that does not.

`docs/reference/rules.md` is made from these rows, and the tests run the examples.
Where a rule looks is said in `motion`, `flow` and `variables`; those of the interpreter
itself (`no-feed`, `no-program-end`, …) are told where the program commits them.
"""

from __future__ import annotations

from typing import NamedTuple

from aircut.diagnostics import Fault
from aircut.diagnostics import faults as F


class Rule(NamedTuple):
    """One rule."""

    fault: Fault
    why: str
    bad: str  # breaks this rule, and no other
    good: str


RULES = (
    Rule(
        F.UNSET_VARIABLE,
        "The variable is null there: the program does something else than was meant, or stops. Arguments of macros, "
        "the machine's tables (#100 to #499, #4000 to #4999, #6000 to #6999), tests for null and computed variables "
        "are left alone, and so is what a loop, a call or a GOTO may have set.",
        "G21 G0 Z5\n#500 = #510\n#510 = 3\nIF [#500 GT 2] THEN G0 X#500\nM2\n",
        "G21 G0 Z5\n#510 = 3\n#500 = #510\nIF [#500 GT 2] THEN G0 X#500\nM2\n",
    ),
    Rule(
        F.UNREACHABLE,
        "Lines behind M2, M30, M99, GOTO, BREAK or RETURN that no label, branch or call leads to: left over, or cut "
        "off by mistake.",
        "G21 G0 Z5\nGOTO 20\nG0 X10\nG0 X20\nN20 G0 X30\nM2\n",
        "G21 G0 Z5\nIF [#4000 GT 0] GOTO 20\nG0 X10\nG0 X20\nN20 G0 X30\nM2\n",
    ),
    Rule(
        F.NO_FEED,
        "The controller takes a feed of its own, which fits neither tool nor material.",
        "G21 M3 S1000\nG0 Z5\nG1 X10\nM2\n",
        "G21 M3 S1000\nG0 Z5\nG1 X10 F300\nM2\n",
    ),
    Rule(
        F.SPINDLE_OFF,
        "A feed move while the spindle stands, or turns with S0, breaks the tool. Moves straight up along Z are "
        "left alone; it is told once for each time that the spindle stands.",
        "G21 F300\nG0 X0 Y0 Z5\nG1 Z-1\nM2\n",
        "G21 F300 S8000 M3\nG0 X0 Y0 Z5\nG1 Z-1\nM2\n",
    ),
    Rule(
        F.RAPID_BELOW_CUT,
        "A rapid downward that ends below Z0 of the work system and below the lowest place of the last cut goes "
        "through material. Left alone are rapids before the first cut while the spindle stands, moves by G53, G28 and "
        "G30, and programs with tilted planes.",
        "G21 F300 S8000 M3\nG0 X0 Y0 Z2\nG1 Z-2\nG0 Z2\nG0 Z-4\nM2\n",
        "G21 F300 S8000 M3\nG0 X0 Y0 Z2\nG1 Z-2\nG0 Z2\nG0 Z-1.5\nG1 Z-4\nM2\n",
    ),
    Rule(
        F.UNUSED_SUBROUTINE,
        "Neither the program nor a subroutine that it calls calls it: left over, or a call names another.",
        "G21 G0 Z5\nM98 P1\nM2\nO1\nG0 X1\nM99\nO2\nG0 X2\nM99\n",
        "G21 G0 Z5\nM98 P1\nM98 P2\nM2\nO1\nG0 X1\nM99\nO2\nG0 X2\nM99\n",
    ),
    Rule(
        F.NO_PROGRAM_END,
        "Without M2 or M30 spindle and coolant stay on, and the modes are not put back. A file that begins with O or "
        "SUB, or that ends by M99, is a macro and is left alone.",
        "G21\nG0 X1\n",
        "G21\nG0 X1\nM30\n",
    ),
    Rule(
        F.NO_UNITS,
        "A program that does not say G20 or G21 is 25.4 times too large or too small on a machine that starts in the "
        "other unit.",
        "G0 X10\nM2\n",
        "G21\nG0 X10\nM2\n",
    ),
    Rule(
        F.UNKNOWN_TOOL,
        "With a tool library of the machine's own it is an error.",
        "T99 M6\nM2\n",
        "T1 M6\nM2\n",
    ),
    Rule(
        F.SPINDLE_LIMIT,
        "The spindle turns slower than the program means, at the same feed.",
        "S100000 M3\nM2\n",
        "S10000 M3\nM2\n",
    ),
    Rule(
        F.EMPTY_PROGRAM,
        "Nothing was written, or nothing was saved.",
        "\n",
        "M2\n",
    ),
    Rule(
        F.BAD_DIRECTIVE,
        "A comment that was meant to switch a rule off does not.",
        "(aircut: ignore spindel-off)\nM2\n",
        "(aircut: ignore spindle-off)\nM2\n",
    ),
)
