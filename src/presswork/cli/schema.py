# SPDX-License-Identifier: Apache-2.0
"""The command `schema`."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from presswork.case import json_schema
from presswork.case.errors import CaseError
from presswork.cli.terminal import exit_on


def schema(
    kind: Annotated[
        str | None,
        typer.Argument(
            help="An analysis: axisymmetric, plane_strain, solid, shell, stamping, heat or onestep; none: all.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Print the JSON schema of case files, for editors that complete them."""
    with exit_on(CaseError):
        typer.echo(json.dumps(json_schema(kind), indent=2))
