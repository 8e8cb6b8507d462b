# SPDX-License-Identifier: Apache-2.0
"""Study files (TOML): read and checked by the class of their keys."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from presswork.case import CaseError
from presswork.case.reader import list_problems, read_toml

Keys = TypeVar("Keys", bound=BaseModel)


def read_study_file(path: Path | str, kind: type[Keys]) -> tuple[Keys, str]:
    """Read and check a study file; return its text, too. Raises CaseError with every problem found."""
    path = Path(path)
    data, text = read_toml(path)
    try:
        return kind.model_validate(data), text
    except ValidationError as error:
        raise CaseError(list_problems(error, data, kind.model_json_schema()), path) from None
