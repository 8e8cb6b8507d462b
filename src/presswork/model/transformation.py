# SPDX-License-Identifier: Apache-2.0
"""Transformation of austenite on cooling: what follows from a steel's composition, and what is given directly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from presswork.model.arrays import FloatArray

PHASES = ("ferrite", "pearlite", "bainite", "martensite")
"""What austenite becomes; the rest of a point is austenite."""
ELEMENTS_OF_STEEL = ("C", "Mn", "Si", "Ni", "Cr", "Mo")
"""Elements that the kinetics know of."""


@dataclass(frozen=True, kw_only=True)
class Phase:
    """How a phase expands and yields; rows of temperature [degrees C] and value (n, 2), constant beyond."""

    expansion: FloatArray
    """Coefficient of thermal expansion [1/K]."""
    strain: float = 0.0
    """How much longer it is than austenite at the reference temperature."""
    yield_stress: FloatArray | None = None
    """Flow stress without plastic strain [MPa]; None: the phases do not differ."""
    trip: float = 0.0
    """Coefficient K of transformation plasticity as it forms [1/MPa]."""
    hardness: float | None = None
    """[HV]; None: by the composition."""


@dataclass(frozen=True)
class PhaseMechanics:
    """What the phases of a steel do to strain and flow stress."""

    phases: tuple[Phase, ...]
    """Austenite, then PHASES."""
    reference: float = 20.0
    """Temperature at which lengths are compared [degrees C]."""


@dataclass(frozen=True, kw_only=True)
class Transformation:
    """Kinetics of a steel, see docs/theory/microstructure.md. Temperatures in degrees C."""

    martensite_start: float
    martensite_rate: float = 0.011
    """Rate in the law of Koistinen and Marburger [1/K]."""
    composition: Mapping[str, float] = field(default_factory=dict)
    """Mass per cent by element; empty: austenite becomes martensite alone."""
    grain_size: float = 8.0
    """ASTM number of the austenite."""
    ferrite_start: float = 0.0
    """Ae3."""
    pearlite_start: float = 0.0
    """Ae1."""
    bainite_start: float = 0.0
    delay: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Factors on the times that ferrite, pearlite and bainite take, for elements that the composition does not hold:
    boron."""
    latent_heat: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Set free by PHASES [mm2/s2]."""
    times: Mapping[str, FloatArray] = field(default_factory=dict)
    """Times of ferrite, pearlite or bainite, instead of the kinetics by composition: rows of temperature [degrees C],
    times in which 1 and 99 per cent of what forms have formed [s], and the part of austenite that forms (n, 4)."""
    mechanics: PhaseMechanics | None = None
    """None: the phases differ neither in strain nor in flow stress."""

    @property
    def forming(self) -> tuple[str, ...]:
        """The PHASES that austenite can become."""
        if self.times:
            return tuple(name for name in PHASES if name in self.times or name == "martensite")
        return PHASES if self.composition else ("martensite",)

    @property
    def hardness(self) -> tuple[float, ...] | None:
        """Hardness of austenite and PHASES where it is given [HV]."""
        given = [phase.hardness for phase in self.mechanics.phases] if self.mechanics else []
        found = tuple(value for value in given if value is not None)
        return found if len(found) == 1 + len(PHASES) else None
