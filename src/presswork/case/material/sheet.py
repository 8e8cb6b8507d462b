# SPDX-License-Identifier: Apache-2.0
"""A sheet material: elasticity, yield function and hardening, as a table of a case or of a material file."""

from __future__ import annotations

import functools
from typing import Any

from pydantic import Field, ValidationError

from presswork.case.errors import CaseError
from presswork.case.material.laws import FormingLimit
from presswork.case.material.plastic import PlasticLaws
from presswork.case.reader import list_problems


class SheetLaws(PlasticLaws):
    """The laws of an elastic-plastic sheet in plane stress; x is the rolling direction."""

    forming_limit: FormingLimit | None = Field(default=None, description="forming limit curve")


@functools.cache
def _schema() -> dict[str, Any]:
    return SheetLaws.model_json_schema()


def check_sheet_material(data: object, source: str | None = None) -> SheetLaws:
    """Turn a table into a SheetLaws. Raises CaseError with every problem, named by key."""
    try:
        return SheetLaws.model_validate(data)
    except ValidationError as error:
        raise CaseError(list_problems(error, data, _schema()), source) from None
