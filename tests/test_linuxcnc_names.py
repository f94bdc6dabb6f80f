"""Named parameters from run to run: kept with the machine, in no file."""

from pathlib import Path

from click.testing import CliRunner

import aircut
from aircut import dialects
from aircut.api import Result
from aircut.cli.main import cli
from aircut.machine import Machine

SET = "#<_global>=4711 #<local>=2 #31=5\no1 call\nM2\no1 sub\n#<inner>=3\n#<_made>=6\no1 endsub\n"
SHOW = "(PRINT,#<_global> #<local> #<inner> #<_made> #31)\nM2\n"


def run(text: str, machine: Machine) -> Result:
    return aircut.loads(text, "linuxcnc").run(machine)


def printed(result: Result) -> list[str]:
    return [event.values[0] for event in result.events if event.name == "PRINT"]


def made() -> Machine:
    return dialects.machine(dialects.load("linuxcnc"))


def test_globals_and_locals_of_the_program_are_there_in_the_next_run() -> None:
    """Locals of subroutines vanish; numbered parameters are zero again but for the persistent ones."""
    machine = made()
    assert run(SET, machine).ok
    assert printed(run(SHOW, machine)) == ["4711.000000 2.000000 ###### 6.000000 0.000000"]
    assert printed(run(SHOW, made())) == ["###### ###### ###### ###### 0.000000"]


def test_they_are_kept_when_a_run_ends_in_a_subroutine_or_by_an_error() -> None:
    for end in ("M2", "G1 X1", "(ABORT,no)"):
        machine = made()
        run(f"#<local>=2\no1 call\nM2\no1 sub\n#<inner>=3\n{end}\no1 endsub\n", machine)
        assert printed(run("(PRINT,#<local> #<inner>)\nM2\n", machine)) == ["2.000000 ######"]


def test_the_documents_example_tells_the_value_when_it_is_run_again() -> None:
    text = (
        "o10 if [EXISTS[#<_global>]]\n(PRINT,exists: #<_global>)\no10 else\n(PRINT,does not)\n"
        "o10 endif\n#<_global>=4711\nM2\n"
    )
    machine = made()
    assert [printed(run(text, machine)) for _ in range(2)] == [["does not"], ["exists: 4711.000000"]]


def test_no_file_holds_them(tmp_path: Path) -> None:
    program, parameters = tmp_path / "p.ngc", tmp_path / "p.var"
    parameters.write_text("31\t1\n5161\t0\n")
    for text in (SET, SHOW):
        program.write_text(text)
        done = CliRunner().invoke(
            cli, ["run", str(program), "--dialect", "linuxcnc", "--parameters", str(parameters), "--format", "canon"]
        )
        assert done.exit_code == 0
    assert "###### ###### ###### ###### 5.000000" in done.output
    assert "global" not in parameters.read_text() and "4711" not in parameters.read_text()
