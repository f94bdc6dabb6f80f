"""Random expressions, written as NC text, have the value that Python's own arithmetic gives them.

The rules are written here a second time, from the documents (000 section 3.1, decisions
AMB-EXP-1 to AMB-EXP-9, AMB-VAR-7, AMB-LEX-12), on trees: precedence is in the writing only.
"""

import math
from decimal import ROUND_HALF_UP, Decimal
from typing import NamedTuple

import numpy
from hypothesis import example, given, settings
from hypothesis import strategies as st

import aircut
from aircut.diagnostics import Refusal
from aircut.interpreter.compiling import FAILURES, compile_value, walk
from aircut.language.expressions import Parser

PI = numpy.longdouble("3.14159265358979323846264338327950288")  # angles are reckoned in the widest float there is
LEVELS = ["AND OR XOR & | ^", "EQ NE GT GE LT LE", "+ -", "* / MOD", "**"]
LEVEL = {name: level for level, names in enumerate(LEVELS) for name in names.split()}
FUNCTIONS = ["ABS", "ACOS", "ASIN", "COS", "EXP", "FIX", "FUP", "ROUND", "LN", "SIN", "SQRT", "TAN"]
VARIABLES = {1: 3.0, 2: -7.5, 3: 0.0, 4: 0.25, 5: None, 6: 1e300}


class Fault(Exception):
    """What must be told instead of a value: the code of a fault, or of several one."""


# --- trees


class Literal(NamedTuple):
    texts: tuple[str, str]  # two numbers: lines that differ in them alone share their compiled form


class Read(NamedTuple):
    number: int


class Minus(NamedTuple):
    of: tuple


class Operation(NamedTuple):
    name: str
    left: tuple
    right: tuple


class Function(NamedTuple):
    name: str
    of: tuple


class Atan(NamedTuple):
    y: tuple
    x: tuple


number = st.one_of(
    st.integers(0, 12).map(str),
    st.integers(0, 2**33).map(str),
    st.sampled_from(["0", "0.5", ".5", "1.", "2.5", "1.5", "0.0001", "0.00009", "1000000", "90", "45", "007"]),
    st.decimals(0, 1000, places=3).map(str),
)
leaf = st.one_of(st.tuples(number, number).map(Literal), st.sampled_from(sorted(VARIABLES)).map(Read))


def larger(trees):
    return st.one_of(
        st.builds(Operation, st.sampled_from(sorted(LEVEL)), trees, trees),
        st.builds(Operation, st.sampled_from(sorted(LEVEL)), trees, trees),
        st.builds(Minus, trees),
        st.builds(Function, st.sampled_from(FUNCTIONS), trees),
        st.builds(Atan, trees, trees),
    )


trees = st.recursive(leaf, larger, max_leaves=12)


def written(tree, which=0, level=0, side="left"):
    """NC text of a tree, with brackets only where the precedence needs them."""
    match tree:
        case Literal(texts):
            return texts[which]
        case Read(n):
            return f"#{n}"
        case Minus(of):
            inner = written(of, which)
            return f"-[{inner}]" if isinstance(of, Operation | Minus) else f"-{inner}"
        case Function(name, of):
            return f"{name}[{written(of, which)}]"
        case Atan(y, x):
            return f"ATAN[{written(y, which)}]/[{written(x, which)}]"
        case Operation(name, left, right):
            own = LEVEL[name]
            text = f"{written(left, which, own)} {name} {written(right, which, own, 'right')}"
            return f"[{text}]" if own < level or (own == level and side == "right") else text
    raise AssertionError(tree)


# --- values


def finite(value):
    if not math.isfinite(value):
        raise Fault("overflow")
    return value


def values_of(*trees, which, null=False):
    """Values of the operands or arguments of one operation; all their faults together."""
    values, faults = [], set()
    for tree in trees:
        try:
            values.append(value_of(tree, which))
            if values[-1] is None and not null:
                faults.add("null-value")
        except Fault as fault:
            faults |= set(fault.args)
    if faults:
        raise Fault(*faults)
    return values


def value_of(tree, which=0):
    """Value of a tree; None is null. Raises Fault."""
    match tree:
        case Literal(texts):
            return float(texts[which])
        case Read(n):
            return VARIABLES[n]
        case Minus(of):
            return -values_of(of, which=which)[0]
        case Function(name, of):
            return function(name, *values_of(of, which=which))
        case Atan(y, x):
            angle = degrees(math.atan2(*values_of(y, x, which=which)))
            return 180.0 if angle <= -180.0 else angle
        case Operation(name, left, right):
            if LEVEL[name] == 1:
                return float(related(name, *values_of(left, right, which=which, null=True)))
            return finite(operation(name, *values_of(left, right, which=which)))
    raise AssertionError(tree)


def related(name, a, b):
    if name in ("EQ", "NE"):
        same = (a is None and b is None) or (a is not None and b is not None and abs(a - b) < 0.0001)
        return same == (name == "EQ")
    a, b = a or 0.0, b or 0.0
    return {"GT": a > b, "GE": a >= b, "LT": a < b, "LE": a <= b}[name]


def operation(name, a, b):
    match name:
        case "+":
            return a + b
        case "-":
            return a - b
        case "*":
            return a * b
        case "/" | "MOD":
            if b == 0:
                raise Fault("division-by-zero")
            return a / b if name == "/" else a % abs(b)
        case "**":
            if a == 0 and b < 0:
                raise Fault("division-by-zero")
            if a < 0 and not b.is_integer():
                raise Fault("domain-error")
            try:
                return a**b
            except OverflowError:
                raise Fault("overflow") from None
        case "AND":
            return float(a != 0 and b != 0)
        case "OR":
            return float(a != 0 or b != 0)
        case "XOR":
            return float((a != 0) != (b != 0))
    m, n = integer(a), integer(b)
    return float({"&": m & n, "|": m | n, "^": m ^ n}[name])


def integer(value):
    whole = Decimal(value).to_integral_value(ROUND_HALF_UP)
    if abs(value - int(whole)) > 0.0001 or not -(2**31) <= whole < 2**32:
        raise Fault("not-integer-operand")
    return int(whole)


def degrees(radians):
    return float(numpy.longdouble(radians * 180.0) / PI)


def turned(of, angle):
    if math.isinf(angle):
        raise ValueError
    return float(of(numpy.longdouble(angle) * PI / 180))


def function(name, x):
    low, high = {"LN": (5e-324, math.inf), "SQRT": (0, math.inf)}.get(name, (-math.inf, math.inf))
    if name in ("ASIN", "ACOS"):
        low, high = -1 - 1e-9, 1 + 1e-9
    if not low <= x <= high:
        raise Fault("domain-error")
    try:
        return {
            "ABS": lambda: abs(x),
            "ACOS": lambda: degrees(math.acos(min(1, max(-1, x)))),
            "ASIN": lambda: degrees(math.asin(min(1, max(-1, x)))),
            "COS": lambda: turned(numpy.cos, x),
            "SIN": lambda: turned(numpy.sin, x),
            "TAN": lambda: turned(numpy.tan, x),
            "EXP": lambda: math.exp(x),
            "LN": lambda: math.log(x),
            "SQRT": lambda: math.sqrt(x),
            "FIX": lambda: float(math.floor(x)),
            "FUP": lambda: float(math.ceil(x)),
            "ROUND": lambda: float(Decimal(x).to_integral_value(ROUND_HALF_UP)),
        }[name]()
    except OverflowError:
        raise Fault("overflow") from None


def allowed(tree, which=0):
    """The value, or the codes of the faults, of which one must be told."""
    try:
        return [value_of(tree, which)]
    except Fault as fault:
        return list(fault.args)


# --- the program and its parts

SETUP = "".join(f"#{n} = {value:f}\n" for n, value in VARIABLES.items() if value is not None)


@given(st.lists(trees, min_size=1, max_size=6))
@settings(max_examples=300, deadline=None)
def test_a_program_computes_as_python_does(made):
    """Each tree twice, with other literals, so that the second line runs the first one's compiled form."""
    pairs = [(tree, which) for tree in made for which in (0, 1)]
    texts = [f"#{500 + i} = [{written(tree, which)}]\n" for i, (tree, which) in enumerate(pairs)]
    result = aircut.loads(SETUP + "".join(texts) + "M2\n").run(keep_going=True)
    first = SETUP.count("\n") + 1
    told = {d.span.line - first: d.code for d in result.diagnostics}
    assert len(told) == len(result.diagnostics)
    for i, (tree, which) in enumerate(pairs):
        assert told.get(i, result.variables.get(500 + i)) in allowed(tree, which), texts[i]


@given(trees)
@settings(max_examples=500, deadline=None)
def test_compiled_and_walked_agree(tree):
    text = f"[{written(tree)}]"
    interpreter = aircut.loads("M2\n").interpreter()
    state = interpreter.state
    for n, value in VARIABLES.items():
        state.locals[n] = value
    node = Parser(text.lower().replace(" ", "")).value()
    try:
        walked = walk(node, state)
    except Refusal as refusal:
        walked = refusal.fault.code
    assert walked in allowed(tree), text
    compiled = compile_value(node, interpreter.dialect)
    try:
        value = compiled(state, ())
    except (*FAILURES, Refusal):
        assert isinstance(walked, str), text  # the walk then says what it was
    else:
        assert value == walked, text


@given(trees)
@settings(max_examples=200, deadline=None)
def test_more_brackets_change_nothing(tree):
    """The text with brackets around every operation means the same."""

    def full(tree):
        match tree:
            case Operation(name, left, right):
                return f"[{full(left)} {name} {full(right)}]"
            case Minus(of):
                return f"-[{full(of)}]"
            case Function(name, of):
                return f"{name}[{full(of)}]"
            case Atan(y, x):
                return f"ATAN[{full(y)}]/[{full(x)}]"
        return f"[{written(tree)}]"

    text = f"{SETUP}#500 = [{written(tree)}]\n#501 = [{full(tree)}]\nM2\n"
    result = aircut.loads(text).run(keep_going=True)
    codes = [d.code for d in result.diagnostics]
    assert result.variables.get(500) == result.variables.get(501), text
    assert len(codes) == 2 * len(codes[:1]) and len(set(codes)) <= 1, text


@given(st.lists(st.sampled_from(sorted(LEVEL)), min_size=100, max_size=600), st.data())
@settings(max_examples=20, deadline=None)
def test_long_chains(names, data):
    """Hundreds of operators in a row, grouped by precedence alone."""
    names = [name for name in names if name not in ("**", "*", "/", "MOD", "&", "|", "^")]
    numbers = [str(data.draw(st.integers(0, 9))) for _ in range(len(names) + 1)]
    text = numbers[0] + "".join(f" {name} {n}" for name, n in zip(names, numbers[1:], strict=True))
    result = aircut.loads(f"#500 = [{text}]\nM2\n").run()
    assert result.ok
    assert result.variables[500] == value_of(grouped(numbers, names))


def grouped(numbers, names):
    """The tree of a chain: the tightest operators first, each level from the left."""
    items = [Literal((n, n)) for n in numbers]
    names = list(names)
    for level in reversed(range(len(LEVELS))):
        at = 0
        while at < len(names):
            if LEVEL[names[at]] == level:
                items[at : at + 2] = [Operation(names.pop(at), items[at], items[at + 1])]
            else:
                at += 1
    return items[0]


@given(st.integers(1, 95))
@example(95)
@settings(deadline=None)
def test_deep_nesting(depth):
    """Brackets, functions and signs within each other."""
    tree = Literal(("2", "2"))
    for i in range(depth):
        tree = [Minus(tree), Function("ABS", tree), Operation("-", Literal(("1", "1")), Minus(tree))][i % 3]
    result = aircut.loads(f"#500 = [{written(tree)}]\nM2\n").run()
    assert result.variables[500] == value_of(tree)
