"""`aircut encrypt` and `aircut decrypt`: macros that others may run but not read."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import click

from aircut.machine import ngx

VARIABLE = "AIRCUT_KEY"


def encrypt(file: Path, output: Path, key: str | None) -> int:
    """Write an encrypted macro; returns the exit status. key: None to take it from AIRCUT_KEY or ask.

    Raises click.ClickException.
    """
    if output.suffix.lower() != ".ngx":
        raise click.UsageError(f"{output}: encrypted macros are found by the extension .ngx")
    return convert(file, output, key, ngx.encrypt, new=True)


def decrypt(file: Path, output: Path, key: str | None) -> int:
    """Write the text of an encrypted macro; returns the exit status. key: as for `encrypt`.

    Raises click.ClickException.
    """
    return convert(file, output, key, ngx.decrypt, new=False)


def convert(file: Path, output: Path, key: str | None, change: Callable[[bytes, str], bytes], new: bool) -> int:
    """Read, change, write whole or not at all. new: the key is being chosen, so it is asked for twice."""
    from aircut.files import replacing

    try:
        if output.exists() and output.samefile(file):
            raise click.UsageError(f"{output} is the input: write elsewhere")
        with file.open("rb") as source:
            data = source.read(ngx.MAX_BYTES + 4096)  # more is refused by its size
    except OSError as error:
        raise click.ClickException(f"cannot read {file}: {error.strerror}") from None
    try:
        changed = change(data, key_from(key, new))
    except ngx.NgxError as error:
        place = f"{file}:{error.line}" if error.line else str(file)
        click.echo(f"{place}: error: {error}", err=True)
        return 1
    try:
        with replacing(output, binary=True) as out:
            out.write(changed)
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    return 0


def key_from(key: str | None, new: bool) -> str:
    """The key: as given, else from the environment, else asked for without showing it. Raises click.UsageError."""
    key = key if key is not None else os.environ.get(VARIABLE)
    if key is None:
        if not sys.stdin.isatty():
            raise click.UsageError(f"no key: give --key, or set {VARIABLE}")
        key = str(click.prompt("Key", hide_input=True, confirmation_prompt=new, err=True))
    if not key:
        raise click.UsageError("the key is empty")
    return key
