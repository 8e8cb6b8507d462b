# SPDX-License-Identifier: Apache-2.0
"""The material of a sheet in a case: its laws given there, or taken from the library or from a material file."""

from __future__ import annotations

import logging
from typing import Annotated, Any, Self

from pydantic import Discriminator, Field, GetJsonSchemaHandler, Tag, ValidationInfo, model_validator
from pydantic.config import JsonDict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from presswork.case.material.grain import Grain
from presswork.case.material.heating import HEAVIEST, LIGHTEST, require_density
from presswork.case.material.library import take_named
from presswork.case.material.sheet import SheetLaws
from presswork.case.material.umat import UmatMaterial, kind_of_material
from presswork.case.names import FileName
from presswork.case.units import Density, fault

logger = logging.getLogger(__name__)

WAVE_SPEED = 5.1e6
"""Wave speed of a bar of steel, aluminium, magnesium or titanium, within 4 % [mm/s]."""
COMPUTED = ("swift_hill", "marciniak_kuczynski")
"""Forming limits that are computed from the other laws of the sheet, which must harden isotropically."""


class ShellMaterial(SheetLaws):
    """Laws of an elastic-plastic sheet; x, laid into the sheet, is the rolling direction."""

    library: FileName | None = Field(
        default=None,
        description='name of a material of the library, or "my_steel.toml", a material file beside the case; keys '
        "given beside it replace its own",
    )

    @model_validator(mode="before")
    @classmethod
    def _take_from_library(cls, data: Any, info: ValidationInfo) -> Any:
        if isinstance(data, dict) and "umat" in data:
            raise fault("one step takes no UMAT", "give young, poisson and hardening", key="umat")
        sheet = take_named(data, info)
        if sheet is None:
            return data
        taken = sheet.material.model_dump(exclude={"density", "thermal"} - set(cls.model_fields))
        limit = taken["forming_limit"]
        if data.get("kinematic") is not None and "forming_limit" not in data and limit and limit["law"] in COMPUTED:
            taken["forming_limit"] = None
            logger.warning(
                "library = %s: its forming limit is computed for isotropic hardening, and the case adds back stresses: "
                "none is taken; give forming_limit = keeler or points",
                data["library"],
            )
        return {**taken, **data}

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Require the laws only where no library gives them."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        required = schema.pop("required", [])
        schema["if"], schema["else"] = {"required": ["library"]}, {"required": required}
        return schema


class HeavyShellMaterial(ShellMaterial):
    """A sheet material with its density and grain size."""

    density: Density | None = Field(
        default=None,
        description='density [t/mm^3], e.g. "7850 kg/m^3"; without it: that of a metal with this Young\'s modulus in '
        "which sound runs at 5.1 km/s, as in steel, aluminium, magnesium and titanium",
    )

    grain: Grain | None = Field(default=None, description="grain size in hot forming")

    @model_validator(mode="after")
    def _check_density(self) -> Self:
        require_density(self.density)
        return self

    def find_density(self) -> float:
        """Return the density given, or that of a common metal with this Young's modulus [t/mm3]."""
        return self.young / WAVE_SPEED**2 if self.density is None else self.density

    def is_metal(self) -> bool:
        """Whether the density found is that of a metal."""
        return LIGHTEST < self.find_density() < HEAVIEST


_TABLES: JsonDict = {"laws": "#/$defs/HeavyShellMaterial", "umat": "#/$defs/UmatMaterial"}
SheetTable = Annotated[
    Annotated[HeavyShellMaterial, Tag("laws")] | Annotated[UmatMaterial, Tag("umat")],
    Discriminator(kind_of_material),
    Field(json_schema_extra={"discriminator": {"mapping": _TABLES}}),
]
