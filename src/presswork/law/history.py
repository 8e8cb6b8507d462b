# SPDX-License-Identifier: Apache-2.0
"""What a law keeps at a point behind its stress, by name: every law declares the parts of its history in their order.

Laws of the core list theirs (cpp/material/history.hpp), a law from a shared library those that it declares
(docs/adding_a_law.md).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from presswork import _core
from presswork.model import FloatArray

STRESS = "stress"
"""Before what a law keeps, where both are in one array [MPa]."""
EQPS, RISE, AXES, BACK_STRESS, TEMPERATURE = "eqps", "rise", "axes", "back_stress", "temperature"
"""Equivalent plastic strain; rise of temperature by plastic work [K]; directions of the law's axes; parts of the back
stress [MPa]; temperature of the last increment less that of the start [K]."""
PHASE_STRAIN, PHASE_TRIP = "phase_strain", "phase_trip"
"""Strain of free growth, and sum of K phi [1/MPa], of the mixture of phases of the last increment."""
POROSITY, GROWN = "porosity", "grown"
"""Names of the history of a metal with pores: porosity, and the plastic strain that the metal has gained since it was
last averaged."""
DEFORMATION_GRADIENT, ENERGY, HEAT, WORK = "deformation_gradient", "energy", "heat", "work"
"""Names of the history of a law from a shared library, by columns: deformation gradient of the whole deformation;
elastic, plastic and creep energy; heat that the last increment has made, and its work, all per volume [MPa]."""


@dataclass(frozen=True)
class Part:
    """One quantity that a law keeps."""

    name: str
    size: int
    is_axes: bool = False
    """Whether it is unit vectors at right angles: x in the plane (2), x and y in space (6)."""


@dataclass(frozen=True)
class History:
    """The parts of an array (..., size) that holds what a law keeps, in their order."""

    parts: tuple[Part, ...] = ()

    @property
    def size(self) -> int:
        """Values of all parts."""
        return sum(part.size for part in self.parts)

    def __contains__(self, name: str) -> bool:
        """Return whether there is a part of this name."""
        return any(part.name == name for part in self.parts)

    def __getitem__(self, name: str) -> slice:
        """Return where a part is. Raises KeyError if there is none of this name."""
        first = 0
        for part in self.parts:
            if part.name == name:
                return slice(first, first + part.size)
            first += part.size
        known = ", ".join(part.name for part in self.parts) or "nothing"
        raise KeyError(f"the law keeps no {name!r}: it keeps {known}")

    def of(self, name: str, values: FloatArray) -> FloatArray:
        """Return a view of a part (..., n) in an array of all (..., size), of a part of one value (...)."""
        found = values[..., self[name]]
        return found[..., 0] if found.shape[-1] == 1 else found

    def without(self, *names: str) -> History:
        """Return the parts of an array that leaves some out."""
        return History(tuple(part for part in self.parts if part.name not in names))

    def behind(self, name: str, size: int) -> History:
        """Return the parts of an array that holds another one before these."""
        return History((Part(name, size), *self.parts))

    @property
    def axes(self) -> Iterator[slice]:
        """Where the parts are that are directions of axes."""
        return (self[part.name] for part in self.parts if part.is_axes)


Law = _core.VonMises | _core.AdiabaticMises | _core.SheetLaw | _core.PlaneLaw | _core.SolidLaw | _core.Umat


def list_history(law: Law, components: int) -> History:
    """Return what a point keeps for a law behind its stress of 3, 4 or 6 components: first its plastic strain."""
    return History(tuple(Part(*part) for part in _core.list_history(law, components)))
