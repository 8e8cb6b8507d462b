# SPDX-License-Identifier: Apache-2.0
"""The base of every table of a case: unknown keys are errors, values never change."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


class Part(BaseModel):
    """A table of a case."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


class ShortForm(Part):
    """A table that may also be written as a list of its first values; one key alone takes the whole list."""

    short_form: ClassVar[tuple[str, ...]] = ()

    @model_validator(mode="before")
    @classmethod
    def _take_list(cls, data: Any) -> Any:
        if not isinstance(data, list | tuple):
            return data
        if len(cls.short_form) == 1:
            return {cls.short_form[0]: data}
        return dict(zip(cls.short_form, data, strict=False)) if len(data) <= len(cls.short_form) else data

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        table = {**handler.resolve_ref_schema(handler(core_schema)), "short_form": list(cls.short_form)}
        return {"anyOf": [table, {"type": "array", "items": {"type": ["number", "string"]}}]}
