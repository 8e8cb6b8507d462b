# SPDX-License-Identifier: Apache-2.0
"""The part of a case for the contact between bodies; laws and names are those of tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.forming import ContactHeat
from presswork.case.part import Part
from presswork.case.units import Number, fault


def require_friction(part: Part, contact: model.ToolContactLaw, pieces: Sequence[str] = ()) -> None:
    """Check that the keys m and mu are there where the law of contact needs them, and nowhere else.

    `pieces`: keys below the part's that give an m or mu of their own, e.g. `profile.2.mu`.
    """
    needs = model.FRICTION_KEYS.get(contact, ())
    for key in needs:
        if key not in part.model_fields_set:
            raise fault("missing key", f'contact = "{contact}" needs {" and ".join(needs)}', key=key)
    for key in [*(key for key in ("m", "mu") if key in part.model_fields_set), *pieces]:
        if key.rsplit(".", 1)[-1] not in needs:
            raise fault(f'has no meaning with contact = "{contact}"', "remove it, or choose a friction law", key=key)


class Contact(Part):
    """Contact between two bodies, or of a body with itself."""

    between: tuple[str, str] = Field(
        description='the two bodies, "workpiece" or names of [bodies]; the same twice: a surface that folds onto itself'
    )
    contact: model.ContactLaw = Field(
        description="frictionless, sticking, or friction: shear (tau = m k), coulomb (tau = mu p), coulomb_capped"
    )
    m: Number = Field(default=0.0, ge=0.0, le=1.0, description="friction factor of shear and coulomb_capped, 0 to 1")
    mu: Number = Field(default=0.0, ge=0.0, description="coefficient of friction of coulomb and coulomb_capped")
    slave: str | None = Field(
        default=None,
        description="the body on whose nodes pressure is computed; without it: the one with the finer boundary",
    )
    joint: bool = Field(
        default=False,
        description="the two are sheets joined by forming, in axisymmetry: interlock, neck and bottom are measured",
    )
    heat: ContactHeat | None = Field(default=None, description="how heat passes; without it: none does")

    @model_validator(mode="after")
    def _check_friction(self) -> Self:
        require_friction(self, self.contact)
        return self

    @model_validator(mode="after")
    def _check_slave(self) -> Self:
        if self.slave is not None and self.slave not in self.between:
            raise fault("is not one of the two bodies", f"take one of {' and '.join(self.between)}", key="slave")
        return self
