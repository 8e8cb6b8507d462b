# SPDX-License-Identifier: Apache-2.0
"""The command `edit`."""

from __future__ import annotations

from urllib.parse import quote

from presswork.cli.terminal import CaseFile, refuse
from presswork.cli.view import Browser, Port, serve


def edit(case: CaseFile, port: Port = 0, browser: Browser = True) -> None:
    """Edit a case in the browser: a form with units and ranges, checked and drawn at every change."""
    if not case.is_file():
        raise refuse(f"there is no case {case}")
    serve(case.resolve().parent, f"edit?case={quote(case.resolve().name)}", port, browser)
