# SPDX-License-Identifier: Apache-2.0
"""What all commands share: exit status, messages on standard error, options of the same meaning."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from presswork.law.allowed import allow_all

if TYPE_CHECKING:
    from rich.console import Console

BAD_INPUT, GAVE_UP, INTERRUPTED = 2, 3, 130
"""Exit status: bad input or output folder; the solver gave up; interrupted. 0: all was computed."""

CaseFile = Annotated[Path, typer.Argument(help="The case file (TOML).", show_default=False)]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a key of the case, e.g. --set workpiece.mesh.cells=[30,30]."
    ),
]


def _allow_code(wanted: bool) -> bool:
    """Let the libraries run that cases of this command name."""
    if wanted:
        allow_all()
    return wanted


RunUserCode = Annotated[
    bool,
    typer.Option(
        "--run-user-code",
        callback=_allow_code,
        help="Run the libraries (umat) that the case names.",
    ),
]


@cache
def console() -> Console:
    """Return the console of messages and progress."""
    from rich.console import Console

    return Console(stderr=True, highlight=False, soft_wrap=True)


def refuse(message: str, status: int = BAD_INPUT) -> typer.Exit:
    """Print what is wrong; return what the caller raises to end the program."""
    console().print(f"error: {message}", style="red", markup=False)
    return typer.Exit(status)


@contextmanager
def exit_on(*kinds: type[Exception]) -> Iterator[None]:
    """End the program with a plain message and exit status 2 if an error of these kinds is raised."""
    try:
        yield
    except kinds as error:
        raise refuse(str(error)) from error
