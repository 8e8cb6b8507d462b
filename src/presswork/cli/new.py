# SPDX-License-Identifier: Apache-2.0
"""The command `new`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.view import Browser, Port, serve


def new(
    folder: Annotated[Path, typer.Argument(help="Folder for the case and its runs.")] = Path(),
    port: Port = 0,
    browser: Browser = True,
) -> None:
    """Set up a case in the browser: choose a process, fill in a form, see tools and blank, run it."""
    serve(folder, "new", port, browser)
