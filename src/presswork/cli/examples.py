# SPDX-License-Identifier: Apache-2.0
"""The command `examples`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.case.errors import CaseError
from presswork.cli.terminal import exit_on
from presswork.examples import copy_example, list_examples


def examples(
    name: Annotated[
        str | None, typer.Argument(help="The example to copy; none lists them.", show_default=False)
    ] = None,
    to: Annotated[Path, typer.Option(help="Folder to copy into.")] = Path(),
) -> None:
    """List the example cases, or copy one here."""
    if name is None:
        for example, title in list_examples().items():
            typer.echo(f"{example:20s} {title}")
        return
    with exit_on(CaseError):
        typer.echo(copy_example(name, to))
