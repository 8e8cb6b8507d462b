# SPDX-License-Identifier: Apache-2.0
"""What the phases of a steel make of strain and flow stress at a point (docs/theory/phases.md).

The compiled law is given three values, each since the start (cpp/material/law.hpp): the strain of free growth, the sum
of K phi of transformation plasticity, and the factor of the mixture on the flow stress.
"""

from __future__ import annotations

import numpy as np

from presswork.law.elastic_plastic import make_hardening_law
from presswork.law.thermoelastic import expand, find_strain
from presswork.model import FloatArray, Material, Phase, PhaseMechanics

SIZE = 3
"""Values that a point is given."""
STRAIN, TRIP, FLOW = range(SIZE)
"""Their places: strain; sum of K phi [1/MPa]; factor on the flow stress."""


def saturate(fraction: FloatArray) -> FloatArray:
    """Return phi of a phase's fraction: the part of transformation plasticity that has happened (Desalos 1981)."""
    return np.asarray(fraction * (2.0 - fraction))


class PhaseMixture:
    """The mixture of one steel."""

    def __init__(self, material: Material, mechanics: PhaseMechanics) -> None:
        self._phases = mechanics.phases
        self._curves = [expand(phase.expansion, None) for phase in self._phases]
        at = np.array(mechanics.reference)
        self._offsets = [
            phase.strain - float(find_strain(curve, at))
            for phase, curve in zip(self._phases, self._curves, strict=True)
        ]
        self._yields = self._phases[0].yield_stress is not None
        self._base = make_hardening_law(material).flow_stress(np.zeros(1))[0][0] if self._yields else 1.0

    def strain_of(self, number: int, temperature: FloatArray) -> FloatArray:
        """Return the strain of a phase, austenite first, over that of austenite at the reference temperature."""
        return self._offsets[number] + find_strain(self._curves[number], temperature)

    def at(self, fractions: FloatArray, temperature: FloatArray) -> FloatArray:
        """Return the values (..., 3) of fractions of PHASES (4, ...) at temperatures (...) [degrees C]."""
        shares = [1.0 - fractions.sum(axis=0), *fractions]
        made = np.zeros((*np.shape(temperature), SIZE))
        for number, (share, phase) in enumerate(zip(shares, self._phases, strict=True)):
            made[..., STRAIN] += share * self.strain_of(number, temperature)
            made[..., TRIP] += phase.trip * saturate(share) if number else 0.0
            made[..., FLOW] += share * self._factor(phase, temperature)
        return made

    def _factor(self, phase: Phase, temperature: FloatArray) -> FloatArray | float:
        if phase.yield_stress is None:
            return 1.0
        return np.asarray(np.interp(temperature, *phase.yield_stress.T) / self._base)
