"""`aircut`: run, check, time, plot.

Exit status: 0 fine, 1 the program has an error, 2 wrong usage, 130 interrupted.
Heavy imports wait until they are needed.
"""

from __future__ import annotations

import gc
import sys
from pathlib import Path
from typing import Any

import click

from aircut import __version__

gc.set_threshold(50_000, 20, 50)  # at the start much is made that stays: no use in looking through it for garbage

FORMATS = ("summary", "canon", "json")
TIME_FORMATS = ("table", "json", "csv")
CHECK_FORMATS = ("text", "json", "sarif", "github", "vendor")
CURVES = ("path", "speed", "acceleration", "jerk", "axis")
PICTURES = (".png", ".svg", ".html")

FILE = click.Path(path_type=Path)
FOLDER = click.Path(path_type=Path, file_okay=False, exists=True)


def machine_options(command: Any) -> Any:
    """Options that all commands share: the language and the machine."""
    for option in (
        click.option("--max-moves", type=click.IntRange(1), default=None, help="Stop after this many moves."),
        click.option("--max-blocks", type=click.IntRange(0), default=100_000_000, show_default=True,
                     help="Stop after this many blocks run again by loops, GOTO and calls."),
        click.option("--optional-stop", is_flag=True, help="M1 waits for the operator."),
        click.option("--block-delete/--no-block-delete", default=False, help="Skip lines that begin with /."),
        click.option("--parameters", type=FILE, metavar="FILE.var",
                     help="Variables to start from; rewritten after a run."),
        click.option("--tools", type=click.Path(path_type=Path, dir_okay=False, exists=True), metavar="FILE",
                     help="Tool library: tools.toml, LinuxCNC's .tbl, or Fusion 360's JSON."),
        click.option("--tool-unit", type=click.Choice(["mm", "inch"]), default=None,
                     help="Unit of a LinuxCNC .tbl, which does not name its own (else mm; inch in dialect linuxcnc)."),
        click.option("--key", envvar="AIRCUT_KEY", metavar="KEY", help="Key of encrypted macros (or AIRCUT_KEY)."),
        click.option("--macros", type=FOLDER, multiple=True, metavar="DIR", help="Folder of macro files; repeatable."),
        click.option("--entry", type=click.Choice(["nist", "easy", "normal"]), default=None,
                     help="How cutter compensation begins, and whether what the tool cannot reach is left out."),
        click.option("--axes", default=None, metavar="LETTERS",
                     help="Axes of the built-in machine, as XYZA; in dialect linuxcnc also U, V, W."),
        click.option("--ini", type=click.Path(path_type=Path, dir_okay=False, exists=True), metavar="FILE.ini",
                     help="LinuxCNC's configuration, as rs274 -i takes it (dialect linuxcnc)."),
        click.option("--machine", "folder", type=FOLDER, metavar="DIR", help="The machine's folder."),
        click.option("--dialect", type=click.Choice(["rosetta", "linuxcnc"]), default="rosetta", show_default=True),
    ):  # fmt: skip
        command = option(command)
    return command


def world_options(command: Any) -> Any:
    """Options of the virtual world."""
    for option in (
        click.option(
            "--world",
            type=click.Path(path_type=Path, dir_okay=False, exists=True),
            metavar="FILE.toml",
            help="The world to simulate (else world.toml of the machine's folder).",
        ),
        click.option("--simulate", is_flag=True, help="Run against a virtual world: probe, inputs, operator."),
    ):
        command = option(command)
    return command


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="aircut")
def cli() -> None:
    """A virtual CNC: find out what an NC program really does before metal is at risk."""


@cli.command()
@click.argument("file", type=FILE, required=False)
@machine_options
@world_options
@click.option("--mdi", "typed", multiple=True, metavar="COMMAND", help="Run this instead of a file; repeatable.")
@click.option("--as-macro", is_flag=True, help="Run the file as a macro: it may end without M2 or M30.")
@click.option(
    "--from-line",
    type=click.IntRange(1),
    metavar="N",
    help="Start at line N: all before it is interpreted for its state, without motion.",
)
@click.option("--resume", is_flag=True, help="Go on where the last run on the machine was stopped.")
@click.option("--stop-line", type=click.IntRange(1), metavar="N", help="Stop before line N, to be resumed.")
@click.option("--format", "style", type=click.Choice(FORMATS), default="summary", show_default=True)
@click.option(
    "--logs", type=FOLDER, metavar="DIR", help="Write the files of LOGOPEN and PROBEOPEN below this folder (linuxcnc)."
)
@click.option("-o", "--output", type=FILE, help="Write here instead of to the terminal.")
def run(file: Path | None, style: str, output: Path | None, typed: tuple[str, ...], **options: Any) -> None:
    """Run a program on the virtual machine and tell what it does."""
    if (file is None) == (not typed):
        raise click.UsageError("give either a FILE or --mdi COMMAND")
    beside = [name for name in ("from_line", "stop_line", "resume", "as_macro") if options[name]]
    if typed and (beside or output is not None or options["logs"] or style != "summary"):
        raise click.UsageError("--mdi writes canonical commands to the terminal, and starts and stops nowhere else")
    if options["as_macro"] and len(beside) > 1:
        raise click.UsageError("--as-macro runs the whole file")
    if file is None:
        from aircut.cli import mdi

        sys.exit(mdi.commands(typed, options))
    from aircut.cli import running

    sys.exit(running.run(file, style, output, options))


@cli.command()
@click.argument("files", type=FILE, nargs=-1, required=True)
@machine_options
@click.option("--ignore", multiple=True, metavar="RULE", help="Leave out the warnings of a rule; repeatable.")
@click.option("--format", "style", type=click.Choice(CHECK_FORMATS), default="text", show_default=True)
@click.option("-o", "--output", type=FILE, help="Write here instead of to the terminal.")
def check(files: tuple[Path, ...], style: str, output: Path | None, **options: Any) -> None:
    """Find all faults of programs, without keeping any motion."""
    from aircut.cli import checking

    sys.exit(checking.check(files, style, output, options))


def planner_options(command: Any) -> Any:
    """Options of what plans the motion."""
    percent = click.FloatRange(0.0, 1000.0)
    for option in (
        click.option("--override-spindle", type=percent, default=100.0, metavar="PERCENT", help="Spindle override."),
        click.option("--override-rapid", type=percent, default=100.0, metavar="PERCENT", help="Rapid override."),
        click.option("--override-feed", type=percent, default=100.0, metavar="PERCENT", help="Feed override."),
        click.option("--profile", type=click.Choice(["auto", "trapezoidal", "jerk-limited"]), default=None,
                     help="How speeds change (else as the machine says)."),
    ):  # fmt: skip
        command = option(command)
    return command


@cli.command()
@click.argument("file", type=FILE)
@machine_options
@world_options
@planner_options
@click.option("--lines", type=click.IntRange(0), default=10, show_default=True, help="How many costly lines to tell.")
@click.option("--format", "style", type=click.Choice(TIME_FORMATS), default="table", show_default=True)
@click.option("-o", "--output", type=FILE, help="Write here instead of to the terminal.")
def time(file: Path, style: str, lines: int, output: Path | None, **options: Any) -> None:
    """Tell how long a program takes on the machine, and where the time goes."""
    from aircut.cli import timing

    sys.exit(timing.time(file, style, lines, output, options))


@cli.command()
@click.argument("file", type=FILE)
@machine_options
@world_options
@planner_options
@click.option(
    "--what",
    type=click.Choice(CURVES),
    default="path",
    show_default=True,
    help="The path, or over time: the tool's speed, or of each axis acceleration, jerk or position.",
)
@click.option("-o", "--output", type=FILE, required=True, metavar="OUT.png|.svg|.html", help="The picture.")
def plot(file: Path, output: Path, what: str, **options: Any) -> None:
    """Draw the toolpath: a still picture, or a page with a 3D view; or curves of its motion over time."""
    if what != "path" and output.suffix.lower() == ".html":
        raise click.UsageError("curves are drawn as .png or .svg")
    if output.suffix.lower() not in PICTURES:
        raise click.UsageError(f"cannot draw {output.suffix or output}: give a file ending in {', '.join(PICTURES)}")
    from aircut.cli import plotting

    sys.exit(plotting.plot(file, output, what, options))


@cli.command("mdi")
@machine_options
@world_options
def mdi_(**options: Any) -> None:
    """Type commands by hand: modes and variables stay from one to the next."""
    from aircut.cli import mdi

    sys.exit(mdi.converse(options))


KEY = click.option("--key", metavar="KEY", help="Key of the macro; else AIRCUT_KEY, else asked for.")
OUTPUT = click.option("-o", "--output", type=FILE, required=True, help="The file to write.")


@cli.command()
@click.argument("file", type=FILE)
@OUTPUT
@KEY
def encrypt(file: Path, output: Path, key: str | None) -> None:
    """Encrypt a macro (FILE.ngc -o FILE.ngx): it can be run with the key, not read."""
    from aircut.cli import encrypting

    sys.exit(encrypting.encrypt(file, output, key))


@cli.command()
@click.argument("file", type=FILE)
@OUTPUT
@KEY
def decrypt(file: Path, output: Path, key: str | None) -> None:
    """Get the text of an encrypted macro back."""
    from aircut.cli import encrypting

    sys.exit(encrypting.decrypt(file, output, key))


PASSWORD = click.option(
    "--password", envvar="AIRCUT_PASSWORD", metavar="WORD", help="Else AIRCUT_PASSWORD, or asked for."
)


@cli.group()
def machine() -> None:
    """What a machine remembers between runs: show and set its variables."""


@machine.command()
@click.argument("folder", type=FOLDER)
@click.argument("numbers", metavar="[NUMBER|FIRST-LAST]...", nargs=-1)
def show(folder: Path, numbers: tuple[str, ...]) -> None:
    """Print variables that are not null: all, or those named (mm and degrees)."""
    from aircut.cli import remembering

    remembering.show(folder, numbers)


@machine.command("set")
@click.argument("folder", type=FOLDER)
@click.argument("values", metavar="NUMBER=VALUE...", nargs=-1, required=True)
@PASSWORD
def set_variables(folder: Path, values: tuple[str, ...], password: str | None) -> None:
    """Set variables (mm and degrees); NUMBER=null empties one.

    #100 to #499, #4000 to #4999, offsets; #6000 to #6999 need the machine's password.
    """
    from aircut.cli import remembering

    remembering.set_variables(folder, values, password)


@machine.command("password")
@click.argument("folder", type=FOLDER)
@click.option("--new", metavar="WORD", help="The new password; else asked for.")
@PASSWORD
def set_password(folder: Path, new: str | None, password: str | None) -> None:
    """Set or change the password of the protected variables (#6000 to #6999)."""
    from aircut.cli import remembering

    remembering.set_password(folder, new, password)


def main() -> None:
    """Entry point."""
    try:
        cli(standalone_mode=False)
    except click.UsageError as error:
        error.show()
        sys.exit(2)
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        sys.exit(130)
    except BrokenPipeError:
        # The reader of our output has gone: that is its affair, not an error.
        sys.stderr.close()
        sys.exit(0)
