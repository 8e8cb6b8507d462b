# SPDX-License-Identifier: Apache-2.0
"""The command `check`."""

from __future__ import annotations

import typer

from presswork import api
from presswork.case import read_case
from presswork.cli.case_files import reading
from presswork.cli.terminal import CaseFile, RunUserCode, Settings, refuse


def check(
    case: CaseFile,
    set_: Settings = None,
    run_user_code: RunUserCode = False,
) -> None:
    """Validate a case and describe what would be computed; code that it names runs only if allowed."""
    with reading():
        checked = api.check(read_case(case, set_ or []))
    typer.echo(checked.description)
    if checked.fault:
        raise refuse(f"{case}: {checked.fault}")
