"""Every kind of fault, one row each.

Codes are the vendor's numbers where its documents give one, else a slug
(decision AMB-EXE-4). The reference page is made from these rows.
"""

from aircut.diagnostics.diagnostic import Fault, Severity

WARNING = Severity.WARNING

# --- Files and characters

CANNOT_READ = Fault("cannot-read", "cannot read the file: {reason}")
EMPTY_PROGRAM = Fault("empty-program", "there is nothing to run in this file", severity=WARNING)
NOT_UTF8 = Fault("not-utf8", "this is UTF-16 text", "save the program as UTF-8")
INVALID_UTF8 = Fault(
    "invalid-utf8",
    "byte 0x{byte:02x} is not UTF-8; the line is read as Windows-1252",
    severity=WARNING,
    why="Only comments and strings may hold characters beyond ASCII; elsewhere they are illegal characters.",
)
ILLEGAL_CHARACTER = Fault("illegal-character", "{character} has no place here", "{hint}")
LINE_TOO_LONG = Fault(
    "line-too-long",
    "the line has {length:,} characters; the limit is {limit:,}",
    why="A limit against damaged files (`Limits.line`); NC programs have lines of some hundred characters at most.",
)
UNCLOSED_COMMENT = Fault("unclosed-comment", "the comment is not closed", "a comment ends with ) on its own line")
NESTED_COMMENT = Fault("nested-comment", "a comment inside a comment", "use square brackets inside comments")
STRAY_PARENTHESIS = Fault("stray-parenthesis", ") without a ( before it")
PYTHON_COMMENT = Fault(
    "python-comment",
    "Python in a comment is not run",
    "LinuxCNC would run it here; what it does to variables or the machine is missing from this run",
    WARNING,
)
PYTHON_REMAP = Fault(
    "python-remap",
    "the INI file remaps {code} to Python ({option}), which is not run here",
    "remap it to a subroutine alone (ngc=), or run the program without this REMAP line",
)
IDLE_REMAP = Fault(
    "idle-remap",
    "[RS274NGC]REMAP={code}: LinuxCNC lets no remap of it come into force",
    "the code stays what it is built in as, there and here",
    WARNING,
)
MISPLACED_COMMENT = Fault("misplaced-comment", "a comment inside a word", "put the comment before or after the word")
UNCLOSED_STRING = Fault("unclosed-string", "the string is not closed", 'a string ends with " on the same line')
MISPLACED_STRING = Fault(
    "misplaced-string",
    "a string is no value for {word} here",
    "strings name a subroutine (P, O, SUB) or are a message",
)
MISPLACED_SLASH = Fault("misplaced-slash", "/ may only begin a line (block delete) or divide inside [ ]")
MISPLACED_PERCENT = Fault("misplaced-percent", "% must stand alone on its line")

# --- Words and numbers

BAD_NUMBER = Fault("bad-number", "{text} is no number")
MISSING_VALUE = Fault(
    "missing-value", "{word} has no value", "a word is a letter and a number, #variable or [expression]"
)
REPEATED_WORD = Fault("repeated-word", "two {word} words in one block")
UNKNOWN_CODE = Fault("unknown-code", "{code} is not a code of this language")
UNSUPPORTED_CODE = Fault("unsupported-code", "the controller does not support {code}")
MODAL_CONFLICT = Fault("modal-conflict", "{first} and {second} are of one modal group: {group}", "use two blocks")
SOLE_CODE = Fault("sole-code", "{code} must be the only G or M code of its block", "{other} needs a block of its own")
AXIS_CONFLICT = Fault("axis-conflict", "{first} and {second} both want the axis words", "use two blocks")
AMBIGUOUS_WORD = Fault("ambiguous-word", "{word} could belong to {first} or to {second}", "use two blocks")
UNUSED_WORD = Fault("unused-word", "nothing in this block uses {word}")
NO_MOTION_MODE = Fault(
    "no-motion-mode",
    "axis words, but no motion mode is active",
    "program G0, G1, G2 or G3 before or with them",
)
G80_AXES = Fault("g80-axes", "axis words with G80, which moves nothing")
MISSING_WORD = Fault("missing-word", "{code} needs {word}", "{meaning}")
MISSING_AXES = Fault("missing-axes", "{code} needs at least one axis word")
AXIS_DISABLED = Fault(
    "axis-disabled",
    "the machine has no {axis} axis",
    "give it one in machine.toml, or run with --axes {wanted}",
)
INDEXER = Fault("indexer", "the locked axis {axis} moves {how} only", "[AXIS_{axis}]LOCKING_INDEXER_JOINT locks it")
BAD_VALUE = Fault("bad-value", "{word}{value:g} is out of range: {wanted}")
NOT_INTEGER = Fault("not-integer", "{word}{value:g} must be a whole number")
MISPLACED_LABEL = Fault("misplaced-label", "N must be the first word of a block")
MISPLACED_WORDS = Fault("misplaced-words", "only a comment may follow {what}")
OTHER_LANGUAGE = Fault(
    "other-language",
    "{word} is a statement of LinuxCNC's language",
    "run the program with the dialect linuxcnc; here subroutines are O1000 … M99, loops WHILE [ ] DO1 … END1",
    why="Programs of LinuxCNC name and number their statements by O-words, which here declare subroutines alone.",
)
MISFIT = Fault("misfit", "{code} works with {fits} only, not with {motion}")

# --- Expressions and variables

EXPECTED = Fault("expected", "expected {wanted}, found {found}", "{hint}")
UNCLOSED_BRACKET = Fault("unclosed-bracket", "[ without its ]")
EXPRESSION_TOO_DEEP = Fault("expression-too-deep", "brackets nested more than {limit} deep")
UNKNOWN_FUNCTION = Fault("unknown-function", "there is no function {name}")
NULL_VALUE = Fault(
    "null-value",
    "{what} is null (has no value): {operation}",
    "a null variable may be copied and compared; give it a value, or test it with IF [{what} NE #0]",
)
NO_VARIABLE = Fault("no-variable", "there is no variable #{number}", "{hint}")
READ_ONLY = Fault("read-only", "{what} cannot be assigned: {title}")
UNDEFINED_NAME = Fault("undefined-name", "#<{name}> has not been given a value", "test it with EXISTS[#<{name}>]")
BAD_INDEX = Fault("bad-index", "{value} is no index: {wanted}")
DIVISION_BY_ZERO = Fault("division-by-zero", "division by zero")
DOMAIN = Fault("domain-error", "{function} of {value:g} has no value")
NO_VALUE = Fault("no-value", "this expression has no value")
OVERFLOW = Fault("overflow", "the result of {operation} is too large")
NOT_INTEGER_OPERAND = Fault("not-integer-operand", "{operator} works on 32-bit integers, not on {value:g}")
BAD_EXISTS = Fault("bad-exists", "EXISTS takes one named variable, as in EXISTS[#<name>]")

# --- Flow

UNMATCHED_END = Fault("unmatched-end", "{what} without {opener}", "{hint}")
UNCLOSED_BLOCK = Fault("unclosed-block", "{what} is not closed by {closer}")
ID_IN_USE = Fault("id-in-use", "id {id} is in use by the {opener} in line {line}")
ELSE_TWICE = Fault("else-twice", "{what} after ELSE{id}", "ELSE is the last branch, and there is one")
NOT_A_LOOP = Fault("not-a-loop", "BREAK{id}: no WHILE … DO{id} is open here")
NO_TARGET = Fault("no-target", "GOTO {label}: no block N{label} in {place}")
JUMP_INTO_BLOCK = Fault("jump-into-block", "GOTO {label} jumps into the block opened in line {line}")
TOO_DEEP = Fault("too-deep", "more than {limit} {what} deep")
BLOCK_BUDGET = Fault(
    "block-budget",
    "stopped after {limit:,} repeated blocks; the loop is at lines {first} to {last}",
    "if the program is meant to run that long, raise --max-blocks",
    why="Blocks run again by loops, GOTO, calls and M47 count; the limit stops programs that never end.",
)
START_OUTSIDE = Fault(
    "start-outside",
    "there is no line {line} to start from: the program has {count}",
)
START_NOT_REACHED = Fault(
    "start-not-reached",
    "the program never comes to line {line}, where it was to start",
    "give a line that the program runs through; lines of subroutines count when they are called",
)
START_COMPENSATED = Fault(
    "start-compensated",
    "the program cannot start at line {line}: radius compensation ({code}) is on there",
    "start before the move that leads in, or after G40",
)
ENDLESS_LOOP = Fault(
    "endless-loop",
    "lines {first} to {last} repeat for ever: a whole pass changes nothing",
    why="A pass through the loop left position, modes and variables exactly as a pass before did.",
)
OUTPUT_LIMIT = Fault(
    "output-limit",
    "stopped after {limit:,} moves",
    "raise --max-moves if the program is meant to be that long",
)

# --- Calls

NO_SUBROUTINE = Fault("no-subroutine", "there is no subroutine {name}", "{hint}")
DUPLICATE_SUBROUTINE = Fault("duplicate-subroutine", "subroutine {name} is defined in line {line} already")
NO_SUBROUTINE_END = Fault("no-subroutine-end", "subroutine {name} runs to the end without M99, ENDSUB or RETURN")
ENCRYPTED = Fault("encrypted-macro", "the encrypted macro {name} cannot be read: {reason}")
BAD_FILE_NAME = Fault(
    "bad-file-name", "{name} is no macro file name", "macros lie in the macros folders, without a path"
)

# --- Motion, feed, tools

ARC_RADIUS_MISMATCH = Fault(
    "arc-radius-mismatch",
    "the arc's radius is {start:.4f} at its start and {end:.4f} at its end: they differ by {difference:.4f} {unit}",
    "check I, J, K and the end point; under G90.1 they are positions, under G91.1 distances from the start",
)
ARC_NO_CENTER = Fault("arc-no-center", "{code} needs {words} or R")
ARC_ZERO_RADIUS = Fault("arc-zero-radius", "the arc's center is its own start: the radius is zero")
ARC_TOO_LARGE = Fault("arc-too-large", "the arc's radius is beyond all machines")
ARC_CENTER_AND_RADIUS = Fault("arc-center-and-radius", "R and center words in one arc", "give either R or I, J, K")
ARC_RADIUS_TOO_SMALL = Fault(
    "arc-radius-too-small",
    "R{radius:g} cannot reach: half the distance to the end point is {half:.4f} {unit}",
)
ARC_SAME_END = Fault("arc-same-end", "an arc by R must end elsewhere than it starts", "use I, J, K for a full circle")
ARC_NO_END = Fault("arc-no-end", "an arc by R needs an axis word of its plane")
ARC_WRONG_CENTER = Fault("arc-wrong-center", "{word} is no center word in the {plane} plane")
NO_FEED = Fault(
    "no-feed",
    "a feed move, and no F yet: {feed:g} mm/min is used",
    'program F; machine.toml can make this an error (missing_feed = "error")',
    WARNING,
)
MISSING_FEED = Fault("missing-feed", "a feed move, and no F is active", "program F before or with the move")
INVERSE_TIME_FEED = Fault("inverse-time-feed", "under G93 each feed move needs its own F above zero")
UNKNOWN_TOOL = Fault(
    "unknown-tool", "tool {tool} is not in the tool library", "it counts as length 0 and diameter 0", WARNING
)
SPINDLE_LIMIT = Fault(
    "spindle-limit", "S{speed:g} is above the spindle's maximum: {limit:g} rpm is used", severity=WARNING
)
NO_RTCP = Fault(
    "no-rtcp",
    "{code}: the machine has no tool center point control: {why}",
    "machine.toml: kinematics = rotary_table_ac, rotary_table_bc, tilting_spindle_ca or tilting_spindle_ab",
)
RTCP_CONFLICT = Fault("rtcp-conflict", "{code} cannot be used while {other} is in force")
RTCP_TOO_LONG = Fault(
    "rtcp-too-long",
    "this move would need more than {limit:,} pieces to keep the tip on its way",
    "check the angles of the rotary axes",
)
INDEXER = Fault(
    "indexer",
    "{axis} is an indexer and moves {how}",
    "an indexer moves alone, by G0",
)
NO_PROGRAM_END = Fault("no-program-end", "the program has no M2 or M30: it ends here without a reset", severity=WARNING)
POLAR_MIX = Fault("polar-mix", "{word} together with a polar word", "@ and ^ stand for both axes of the plane")
POLAR_MACHINE = Fault("polar-machine", "polar words with G53", "G53 takes positions of the machine's axes")
POLAR_POLE = Fault("polar-pole", "an incremental polar move cannot start at the pole: it has no angle there")
TRAVEL = Fault(
    "travel-limit",
    "{axis} would go to {value:.10g} {unit}, {beyond:.4g} {unit} beyond its limit of {limit:.10g}",
    "positions of the machine's axes, with the tool's offset; the limit is {axis}'s {name} in machine.toml",
)
TRAVEL_IN_CHANGE = TRAVEL._replace(code="travel-limit-in-change", severity=WARNING)
SCALING_WORDS = Fault(
    "scaling-words", "G51 needs P, or I, J and K", "P is the factor of all axes; I, J and K are those of X, Y and Z"
)
ROTATION_CONFLICT = Fault("rotation-conflict", "{code} cannot be used while {other} is in force", "program G69 before")
CENTER_TWICE = Fault("center-twice", "{word} and {axis} are the same coordinate of the center", "give one of them")
ARC_ROTATED = Fault(
    "arc-rotated", "an arc in the {plane} plane, while G68 turns the {other} plane", "program G69 before"
)
TILTED = Fault("tilted", "{code} is not possible in a tilted plane", "program G69 before")
CYCLE_INVERSE_TIME = Fault("cycle-inverse-time", "{code} cannot run under G93", "program G94 and F before")
CYCLE_COMPENSATION = Fault("cycle-compensation", "{code} cannot run with cutter compensation", "program G40 before")
CYCLE_SPINDLE = Fault("cycle-spindle", "{code} needs a turning spindle", "program S and M3 before")
TAPPED_ASIDE = Fault(
    "tapped-aside",
    "outside G17 LinuxCNC exchanges the axes of the feeds of {code}: the tool moves aside in the work",
    "tap in G17, or with G33.1",
    Severity.WARNING,
)
UNCLOSED_NAME = Fault(
    "unclosed-name",
    "the label's name has no >: LinuxCNC passes the line over",
    "close the name: O<name>",
    Severity.WARNING,
)
LOOSE_VALUE = Fault("loose-value", "LinuxCNC takes {word}{value:g}, though it knows {wanted}", "", Severity.WARNING)
CYCLE_ROTARY = Fault("cycle-rotary", "{axis} moves in {code}", "turn rotary axes in a block before")
CYCLE_BELOW = Fault("cycle-below", "{code}: R (at {r:g}) lies below the bottom of the hole ({axis}{bottom:g})")
COMPENSATING = Fault("compensating", "{code} is not possible with cutter radius compensation on", "program G40 before")
COMPENSATION_TILTED = Fault("compensation-tilted", "no cutter radius compensation {mode}", "program {off} before")
COMPENSATION_YZ = Fault("compensation-yz", "{code} works in the XY and XZ planes only", "use G41 or G42")
COMPENSATION_L = Fault("compensation-l", "L, the orientation of a lathe tool, works in the XZ plane only")
SHORT_ENTRY = Fault(
    "short-entry",
    "the first move under compensation is {length:.4f} long, not longer than the radius of {radius:.4f}",
    "lengthen the lead-in, or use the entry option easy",
)
GOUGING_CORNER = Fault(
    "gouging-corner",
    "a tool of radius {radius:.4f} does not fit between the moves of {first} and {second}",
    "use a smaller tool, or the entry option normal, which leaves out what the tool cannot reach",
    why="With the entry options nist and easy the tool must be able to touch every move of the contour (000, 4.3).",
)
GOUGING_ARC = Fault(
    "gouging-arc",
    "a tool of radius {radius:.4f} does not fit into the arc of radius {arc:.4f} of {second}, after {first}",
    "use a smaller tool, or the entry option normal, which leaves out what the tool cannot reach",
)
EXIT_ARC = Fault("exit-arc", "the first move after compensation is an arc", "lead out with a straight move")
PROBE_COMPENSATION = Fault("E0048", "cannot probe with cutter radius compensation", "program G40 before")
PROBE_INVERSE_TIME = Fault("E0047", "cannot probe in inverse time feed mode", "program G94 and F before")
PROBE_NO_FEED = Fault("E0049", "cannot probe with zero feed rate", "program F before")
PROBE_ROTARY = Fault("E0044", "cannot move rotary axes during probing")
PROBE_TOO_CLOSE = Fault("E0162", "start point too close to probe point", "probe over 0.254 mm at least")
PROBE_FAILED = Fault("probe-failed", "probing failed: {reason}", "G38.3 and G38.5 go on and report in #5700")
USER_ERROR = Fault("E0345", "{text}", why="The program itself says that it cannot go on (M109 Q-1, M120 Q-1).")
NO_PICTURE = Fault(
    "no-picture",
    "there is no picture {name} in the machine's media folder",
    "M120 shows files of {folder}",
    WARNING,
)
OPERATOR_STOP = Fault("operator-stop", "the operator pressed Stop: {text}")
INPUT_TIMEOUT = Fault("input-timeout", "{what} {number} did not change within {seconds:g} s")
SLOT_KEPT = Fault("slot-kept", "tool {tool} is in the table, so it stays in slot {slot}", severity=WARNING)
SLOT_TAKEN = Fault("slot-taken", "slot {slot} holds another tool")
TOOL_NOT_DECLARED = Fault(
    "tool-not-declared",
    "the tool change macro ended without M61 or M106: tool {tool} is still in the spindle",
    severity=WARNING,
)
UNKNOWN_PARAMETER = Fault("unknown-parameter", "G10 L{l:g} is not a code of this language")


# --- Rules of `aircut check` (rows with examples: rules/table.py)

UNSET_VARIABLE = Fault(
    "unset-variable",
    "{what} is read before it is set: {how}",
    "assign it before, or test it with IF [{what} EQ #0]",
    WARNING,
)
UNREACHABLE = Fault(
    "unreachable-code",
    "{lines} can never run: line {line} always leads elsewhere",
    "delete it, or put a label before it that a GOTO names",
    WARNING,
)
UNUSED_SUBROUTINE = Fault("unused-subroutine", "nothing calls subroutine {name}", severity=WARNING)
SPINDLE_OFF = Fault("spindle-off", "a feed move, and the spindle is not turning: {why}", "program S and M3", WARNING)
RAPID_BELOW_CUT = Fault(
    "rapid-below-cut",
    "a rapid goes down to Z{height:.4g} mm: {depth}",
    "go there by G1, or rapid to a height that is clear first",
    WARNING,
)
NO_UNITS = Fault(
    "no-units",
    "no G20 or G21 before the first move: millimeters are taken",
    "say the units at the start of the program",
    WARNING,
)
BAD_DIRECTIVE = Fault(
    "bad-directive", "this comment switches nothing: {problem}", "write (aircut: ignore RULE), off or on", WARNING
)

# --- LinuxCNC's language

UNDER_COMPENSATION = Fault(
    "under-compensation", "{what} is not possible while cutter radius compensation is on", "program G40 before"
)
NO_TOOL = Fault("no-tool", "tool {tool} is not in the tool table")
POLAR_AND_AXES = Fault("polar-and-axes", "X or Y beside @ and ^", "polar words say where in X and Y")
TOO_MANY_M = Fault("too-many-m", "more than four M words in one block")
WRONG_STATE = Fault("wrong-state", "{what}", "{hint}", why="The code is fine, but not as the machine stands now.")
O_WORD = Fault("o-word", "{what}", "{hint}", why="A word of program flow that does not fit where it stands.")
ABORTED = Fault("aborted", "{text}", why="The program itself says that it cannot go on: (ABORT,text).")
END_MISSING = Fault(
    "end-missing", "the file ends without M2, M30 or a closing %", "the last line of a program is M2, M30 or %"
)

FAULTS: dict[str, Fault] = {fault.code: fault for fault in list(globals().values()) if isinstance(fault, Fault)}
