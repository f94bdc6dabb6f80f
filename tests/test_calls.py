"""Calls for any arguments and to any depth (000 sections 2.5, 3.3; AMB-FLOW-7)."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import aircut
from aircut.machine import built_in

#: Source: 000 section 2.5, the table of arguments.
PLACES = (1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26)
LETTERS = dict(zip("ABCIJKDEFHMQRSTUVWXYZ", PLACES, strict=True))
NUMBERS = st.floats(-9999.0, 9999.0).map(lambda value: round(value, 4))


@settings(max_examples=150, deadline=None)
@given(
    before=st.dictionaries(st.integers(1, 33), NUMBERS),
    given_=st.dictionaries(st.sampled_from(sorted(LETTERS)), NUMBERS),
    inside=st.dictionaries(st.integers(1, 33), st.one_of(st.none(), NUMBERS)),
    call=st.sampled_from(["G65 P1", "CALL P1", "G65 P1 L3", "G65 P2"]),
)
def test_the_callers_variables_come_back(
    before: dict[int, float], given_: dict[str, float], inside: dict[int, float | None], call: str
) -> None:
    """Whatever the macro gets and does to its own, also by M98 (which shares) and in repetitions."""
    words = " ".join(f"{letter}{value:.4f}" for letter, value in given_.items())
    lines = [f"#{number}={value:.4f}" for number, value in before.items()]
    lines += [f"{call} {words}", *(f"#{600 + n}=#{n}" for n in range(1, 34)), "M2"]
    lines += ["O1", *(f"#{700 + n}=#{n}" for n in range(1, 34))]
    lines += [f"#{number}={'#0' if value is None else format(value, '.4f')}" for number, value in inside.items()]
    lines += ["M98 P3", "M99", "O2", f"G65 P1 {words}", "#1=77 #33=78", "M99", "O3", "#2=79", "M99"]
    interpreter = aircut.loads("\n".join(lines) + "\n").interpreter()
    for _ in interpreter.run():
        pass
    assert not interpreter.failed, interpreter.diagnostics
    values = interpreter.state.numbered
    wanted = {LETTERS[letter]: value for letter, value in given_.items()}
    for number in range(1, 34):
        assert values[600 + number] == before.get(number), number
        assert values[700 + number] == wanted.get(number), number  # nothing but the arguments came in


def nested(depth: int, folder: Path, call: str) -> tuple[list[str], float | None]:
    """Macros in files of their own, each calling the next; how deep it got."""
    for n in range(1, depth + 1):
        onward = call.format(n + 1) if n < depth else ""
        (folder / f"O{n}.ngc").write_text(f"#500=[#500 + 1]\n{onward}\nM99\n")
    made = built_in("XYZ")
    made.macros = (folder,)
    interpreter = aircut.loads(f"#500=0\n{call.format(1)}\n#501=1\nM2\n").interpreter(made)
    for _ in interpreter.run():
        pass
    return [d.code for d in interpreter.diagnostics], interpreter.state.numbered[500]


@pytest.mark.parametrize("call", ["G65 P{} A1", "M98 P{}", "CALL P{}", 'G65 P"O{}.ngc"'])
def test_macros_nested_to_100_and_101(call: str, tmp_path: Path) -> None:
    assert nested(100, tmp_path, call) == ([], 100.0)
    assert nested(101, tmp_path, call) == (["too-deep"], 100.0)
