# SPDX-License-Identifier: Apache-2.0
"""How the phases of a steel expand and yield: keys of heat treatment."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.heat.quantities import Rows, Temperature, to_array, to_table, to_temperature
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.thermoelastic import Coefficients
from presswork.case.part import Part
from presswork.case.units import STRESS, Number, fault, to_number

if TYPE_CHECKING:
    from presswork.case.material.plastic import PlasticLaws

LARGEST_STRAIN = 0.03
"""Strain of formation: martensite of 1 % carbon has 0.012 at room temperature."""
LARGEST_TRIP = 1e-3
"""Coefficient of transformation plasticity [1/MPa]; steels have 2e-5 to 2e-4."""


def _to_yield_stress(value: object) -> float:
    number = to_number(value, STRESS)
    if not number > 0.0:
        raise fault(f"a yield stress of {number:g} MPa is none", 'e.g. [[20, 1500], [400, "1100 MPa"]]')
    return number


_ROW = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2}
YieldRows = Annotated[Rows, BeforeValidator(lambda v: to_table(v, to_temperature, _to_yield_stress))]


class Austenite(Part):
    """Thermal strain and yield stress of a phase."""

    expansion: Coefficients = Field(
        description="coefficient of thermal expansion [1/K], or rows [degrees C, it]; austenite has about 2.2e-5, the "
        "other phases 1.2e-5 to 1.5e-5"
    )
    yield_stress: YieldRows | None = Field(
        default=None,
        description="flow stress at no plastic strain [MPa], or rows [degrees C, it]: phases are mixed by their "
        "fractions, and `hardening` is how the mixture hardens from there; of all phases or of none",
    )

    hardness: Number | None = Field(
        default=None,
        gt=0,
        description="Vickers hardness of the phase at room temperature [HV]; of all phases or of none; without it: by "
        "the composition",
    )

    def to_model(self) -> model.Phase:
        """Return the Model's."""
        return model.Phase(
            expansion=to_array(self.expansion),
            yield_stress=None if self.yield_stress is None else to_array(self.yield_stress),
            hardness=self.hardness,
        )


class FormedPhase(Austenite):
    """The same of a phase that austenite becomes."""

    strain: Number = Field(
        description="by how much it is longer than austenite at the reference temperature, e.g. 0.009: a third of the "
        "change of volume"
    )
    trip: Number = Field(
        default=0.0,
        description="coefficient K of transformation plasticity [1/MPa]: under a constant stress s a specimen is K s "
        "longer after the whole transformation; Greenwood and Johnson: 5/6 of the change of volume over the yield "
        "stress of austenite",
    )

    @model_validator(mode="after")
    def _check_range(self) -> Self:
        if not 0.0 <= self.strain <= LARGEST_STRAIN:
            remedy = f"from 0 to {LARGEST_STRAIN:g}; martensite has 0.008 to 0.012 at 20 degrees C"
            raise fault(f"{self.strain:g} is the strain of formation of no phase of steel", remedy, key="strain")
        if not 0.0 <= self.trip <= LARGEST_TRIP:
            remedy = f"in 1/MPa, from 0 to {LARGEST_TRIP:g}, e.g. 5e-5"
            raise fault(f"{self.trip:g} 1/MPa is the transformation plasticity of no steel", remedy, key="trip")
        return self

    def to_model(self) -> model.Phase:
        """Return the Model's."""
        return replace(super().to_model(), strain=self.strain, trip=self.trip)


class Phases(Part):
    """Strain and yield stress by phase; bodies in implicit runs."""

    reference: Temperature = Field(
        default=20.0, description="temperature at which the lengths of phases are compared [degrees C]"
    )
    austenite: Austenite = Field(description="the phase at the start")
    ferrite: FormedPhase | None = Field(default=None, description="needed where the kinetics have it")
    pearlite: FormedPhase | None = Field(default=None, description="needed where the kinetics have it")
    bainite: FormedPhase | None = Field(default=None, description="needed where the kinetics have it")
    martensite: FormedPhase = Field(description="what forms below Ms")

    @model_validator(mode="after")
    def _check_yield(self) -> Self:
        given = {name: getattr(self, name) for name in ("austenite", *model.PHASES)}
        for name, phase in given.items():
            for key in ("yield_stress", "hardness") if phase is not None else ():
                if (getattr(phase, key) is None) != (getattr(self.austenite, key) is None):
                    lacking = name if getattr(phase, key) is None else "austenite"
                    remedy = "give it for all phases, or for none"
                    raise fault("missing key: another phase has it", remedy, key=f"{lacking}.{key}")
        return self

    def find_missing(self, made: model.Transformation) -> str | None:
        """Return a phase that the kinetics have and these keys lack."""
        return next((name for name in made.forming if getattr(self, name) is None), None)

    def to_model(self) -> model.PhaseMechanics:
        """Return the Model's; phases that never form are taken for martensite."""
        formed = [getattr(self, name) or self.martensite for name in model.PHASES]
        return model.PhaseMechanics((self.austenite.to_model(), *(p.to_model() for p in formed)), self.reference)


def check_phases(phases: Phases | None, material: PlasticLaws) -> None:
    """Refuse laws of a material that do not go with phases; errors are those of the key `transformation`."""
    if phases is None:
        return
    if material.expansion is not None:
        raise fault("the phases expand by their own coefficients", "remove it", key="expansion")
    if material.kinematic is not None:
        raise fault("back stresses are not mixed by phase", "remove it, or transformation.phases", key="kinematic")
    if phases.austenite.yield_stress is None:
        return
    if material.hardening is None or isinstance(material.hardening, HotLaw):
        remedy = 'give one of strain alone, which they scale, e.g. {law = "linear", yield_stress = 200, modulus = 500}'
        raise fault("yield stresses of phases need a hardening law at rest", remedy, key="hardening")
    if material.heating is not None and material.heating.melting is not None:
        raise fault("the phases soften by their own yield stresses", "remove it", key="heating.melting")
