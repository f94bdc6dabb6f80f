"""What the operator sees and answers: windows of M109 and M120, the HUD, pictures (000 section 10)."""

import tomllib
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner

import aircut
from aircut import markup
from aircut.cli.main import cli
from aircut.controller import Simulation, World
from aircut.controller.world import File, Reply
from aircut.interpreter.running import Run
from aircut.machine import Machine, Tool, built_in, load
from aircut.markup import Style, Text


def run(text: str, *replies: Reply, machine: Machine | None = None) -> tuple[Run, Simulation]:
    made = machine or built_in("XYZ")
    made.tools |= {1: Tool(1, "end mill", diameter=6.0)}
    interpreter = aircut.loads(text).interpreter(made)
    simulation = Simulation(interpreter, World(File(operator=list(replies))))
    for _ in simulation.run():
        pass
    return interpreter, simulation


def codes(interpreter: Run) -> list[str]:
    return [d.code for d in interpreter.diagnostics]


@pytest.mark.parametrize("code", ["M109", "M120"])
@pytest.mark.parametrize(
    ("words", "buttons"),
    [
        ("", ("Resume",)),
        ("Q0", ("Resume",)),
        ("Q1", ("Stop",)),
        ("Q2", ("Stop", "Resume")),
        ("Q3", ("Stop", "Resume")),
        ("Q100", ("Stop", "Resume")),
    ],
)
@pytest.mark.parametrize("stop", [False, True])
def test_buttons(code: str, words: str, buttons: tuple[str, ...], stop: bool) -> None:
    """A window without a Stop button cannot stop the program; one with nothing else always does."""
    interpreter, simulation = run(f'#500=1\n{code} P"text" {words}\n#500=2\nM2\n', Reply(stop=stop))
    assert [(w.text, w.buttons) for w in simulation.shown] == [("text", buttons)]
    stopped = "Stop" in buttons and (stop or "Resume" not in buttons)
    assert interpreter.state.numbered[500] == (1.0 if stopped else 2.0)
    assert codes(interpreter) == (["operator-stop"] if stopped else [])


def test_fields_begin_with_defaults() -> None:
    text = 'G10 L100 P5731 V987\nM109 Q100 P"five" R5\nM109 Q3 P"one" D2.5\nM109 Q0 P"none"\nM2\n'
    simulation = run(text)[1]
    assert [w.inputs for w in simulation.shown] == [(0.0, 987.0, 0.0, 0.0, 0.0), (2.5,), ()]


def test_stop_leaves_values_as_they_are() -> None:
    text = 'M109 P"a" Q3\n#500=#5721\nM109 P"b" Q3\nM2\n'
    interpreter, _ = run(text, Reply(values=[7.0]), Reply(stop=True, values=[9.0]))
    assert interpreter.state.answer == 7.0


def test_the_five_values_of_the_document() -> None:
    """000 section 10.1: what the user wrote stands in #5730 to #5734, and the second began with 987."""
    text = (
        'G10 L100 P5731 V987\nM109 Q100 P"Enter 5 numbers" R5\n'
        'M109 P"User wrote: 5730 #5730, 5731 #5731, 5732 #5732 , 5733 #5733, 5734 #5734"\nM2\n'
    )
    _, simulation = run(text, Reply(values=[1.0, 2.0, 3.5, -4.0, 5.0]))
    assert simulation.shown[1].text == "User wrote: 5730 1, 5731 2, 5732 3.5 , 5733 -4, 5734 5"


@pytest.mark.parametrize("kind", [0, 1, 2, 3])
def test_windows_show_tags(kind: int) -> None:
    _, simulation = run(f'M109 P"a <B>b</B> <@TD=1>" Q{kind}\nM2\n')
    assert simulation.shown[0].document.nodes == (Text("a "), Text("b", Style.BOLD), Text(" end mill"))


def test_custom_windows_and_the_hud_show_tags_as_they_are() -> None:
    _, simulation = run('M109 P"<B>b</B>" Q100\nM109 P"<B>#500</B>" Q4\nM2\n')
    assert markup.plain(simulation.shown[0].document) == "<B>b</B>"
    assert markup.plain(simulation.hud) == "<B>null</B>"


def test_the_hud_stays_until_it_is_cleared() -> None:
    _, simulation = run('M109 P"first" Q4\nM109 P"second" Q4\nG0 X1\nM2\n')
    assert markup.plain(simulation.hud) == "second" and not simulation.shown  # the program did not wait
    _, simulation = run('M109 P"here" Q4\nM109 P"" Q4\nM2\n')
    assert markup.plain(simulation.hud) == ""


def test_an_empty_window_is_shown() -> None:
    assert [w.text for w in run('M109 P"" Q0\nM2\n')[1].shown] == [""]


def with_media(tmp_path: Path) -> Machine:
    (tmp_path / "machine.toml").write_text('name = "m"\n')
    (tmp_path / "secret.png").write_bytes(b"x")
    (tmp_path / "media" / "steps").mkdir(parents=True)
    (tmp_path / "media" / "image.png").write_bytes(b"x")
    (tmp_path / "media" / "steps" / "One.PNG").write_bytes(b"x")
    return load(tmp_path)


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("image.png", "image.png"),
        ("IMAGE.png", "image.png"),
        ("steps/One.PNG", "steps/One.PNG"),
        ("steps\\one.png", "steps/One.PNG"),
        ("missing.png", None),
        ("steps", None),
        ("../secret.png", None),
        ("steps/../image.png", None),
        ("/etc/hostname", None),
        ("C:\\image.png", None),
    ],
)
@pytest.mark.parametrize("kind", [0, 4])
def test_pictures_come_from_the_media_folder(name: str, file: str | None, kind: int, tmp_path: Path) -> None:
    machine = with_media(tmp_path)
    interpreter, simulation = run(f'M120 P"{name}" Q{kind}\nM2\n', machine=machine)
    assert codes(interpreter) == ([] if file else ["no-picture"])
    assert not interpreter.failed
    if kind == 0:
        assert simulation.shown[0].picture == (tmp_path / "media" / file if file else None)


def test_no_picture_is_missed_without_a_folder_or_by_messages(tmp_path: Path) -> None:
    assert not codes(run('M120 P"missing.png" Q0\nM2\n')[0])
    assert not codes(run('M109 P"missing.png" Q0\nM120 P"" Q4\nM2\n', machine=with_media(tmp_path))[0])


def test_a_machine_without_media_folder(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text('name = "m"\n')
    assert codes(run('M120 P"image.png" Q0\nM2\n', machine=load(tmp_path))[0]) == ["no-picture"]


def test_the_summary_tells_windows(tmp_path: Path) -> None:
    program = tmp_path / "p.ngc"
    program.write_text('M109 P"<B>go</B> on" Q2\nM109 P"<B>hud</B>" Q4\nM120 P"a.png"\nM109 P"x" Q1\nM2\n')
    output = CliRunner().invoke(cli, ["run", str(program)]).output
    for line in ("message  go on  [Stop] [Resume]", "HUD      <B>hud</B>", "picture  a.png  [Resume]", "x  [Stop]"):
        assert line in output, output


def test_the_world_of_the_reference_page_is_one() -> None:
    page = (Path(__file__).parent.parent / "docs" / "reference" / "world.md").read_text("utf-8")
    text = page.split("```toml\n")[1].split("```")[0]
    file = msgspec.convert(tomllib.loads(text), File)
    assert World(file).body is not None and file.operator == [Reply(values=[12.5])]
