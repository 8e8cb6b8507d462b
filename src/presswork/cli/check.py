# SPDX-License-Identifier: Apache-2.0
"""The command `check`."""

from __future__ import annotations

import math

import typer

from presswork.case import describe
from presswork.cli.case_files import load_model
from presswork.cli.terminal import CaseFile, RunUserCode, Settings, refuse
from presswork.model import OneStepModel
from presswork.outcome import StartError
from presswork.process.begin import check_start


def check(
    case: CaseFile,
    set_: Settings = None,
    run_user_code: RunUserCode = False,
) -> None:
    """Validate a case and say in words what would be computed; code that it names runs only if allowed."""
    model = load_model(case, set_, only_described=True)
    typer.echo(describe(model))
    if isinstance(model, OneStepModel):
        return
    if any(material.umat and math.isnan(material.young) for material in model.materials):
        typer.echo("not opened: the libraries of its materials, whose code would run; --run-user-code tries them")
        return
    try:
        check_start(model)
    except StartError as error:
        raise refuse(f"{case}: {error}") from error
