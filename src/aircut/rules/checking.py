"""A run with the rules beside it."""

from __future__ import annotations

from collections.abc import Iterator

from aircut.diagnostics import Diagnostic
from aircut.diagnostics import faults as F
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.running import Run
from aircut.rules.flow import unreachable, unused
from aircut.rules.motion import Watch
from aircut.rules.page import Page
from aircut.rules.policy import Policy


def checked(run: Run, policy: Policy) -> Iterator[None]:
    """Run a program, yielding now and then; afterwards `run.diagnostics` holds faults and warnings, by line."""
    watch = Watch(run)
    for chunk in run.run():
        watch.add(chunk)
        run.state.out.give_back(chunk)
        yield
    page = Page(run) if isinstance(run, Interpreter) and run.ran else None
    if page is not None and page.macro:  # it runs in its caller's modes
        run.diagnostics[:] = [d for d in run.diagnostics if d.code != F.NO_FEED.code]
    else:
        for diagnostic in watch.found:
            run.tell(diagnostic)
    if page is not None:
        for diagnostic in read(page):
            run.tell(diagnostic)
    settled(run, policy)


def read(page: Page) -> Iterator[Diagnostic]:
    """The rules that read the text when it has run: they know the structure of the RosettaCNC language."""
    if b"#" in page.parts:
        from aircut.rules.variables import unset

        yield from unset(page)
    yield from unreachable(page)
    yield from unused(page)


def settled(run: Run, policy: Policy) -> None:
    """Leave in `run.diagnostics` what the policy and the comments of the files leave, by file and line."""
    sources = {name: unit.source for name, unit in run.units.items()}
    main = run.files[0]
    left = policy.applied(run.diagnostics, sources)
    run.diagnostics[:] = sorted(left, key=lambda d: (d.file != main, d.file, d.span.line))
