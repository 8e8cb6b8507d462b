# SPDX-License-Identifier: Apache-2.0
"""The command `materials`."""

import typer

from presswork.case.material.library import list_sheets


def materials() -> None:
    """List the sheet materials of the library."""
    for sheet in list_sheets():
        typer.echo(f"{sheet.key:22s} {sheet.name}: {sheet.summary}")
