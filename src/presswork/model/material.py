# SPDX-License-Identifier: Apache-2.0
"""Materials: elasticity, hardening, and what a sheet, heat or a law from a library adds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from presswork import _core
from presswork.formability import Formability
from presswork.model.arrays import FloatArray
from presswork.model.grain import Grain
from presswork.model.gtn import Gtn
from presswork.model.heat import Thermal
from presswork.model.transformation import PhaseMechanics, Transformation

UmatJacobian = Literal["stress_increment", "jaumann_kirchhoff"]
NEVER = 1e3
"""Yield stress of a material that never yields, over Young's modulus."""
STRESSES = ("yield_stress", "saturation_stress", "K", "modulus")
"""Parameters of hardening laws that are stresses."""


@dataclass(frozen=True)
class Hardening:
    """Flow stress against equivalent plastic strain, of hot laws also against strain rate and temperature.

    See docs/theory/material.md for the laws' formulas.
    """

    law: str
    """Name of one of _core.HardeningLaw."""
    parameters: FloatArray
    """Parameters in the order of _core.parameter_names of the law, stresses in MPa; of a table its rows one after the
    other: plastic strain and stress, of monotone_table also the slope."""

    @property
    def is_hot(self) -> bool:
        """Whether the flow stress is one of strain, strain rate and temperature together."""
        return _core.is_hot(_core.HardeningLaw[self.law])

    @property
    def window(self) -> FloatArray | None:
        """Lowest and highest strain, rate [1/s] and temperature [degrees C] of a hot law (3, 2); None of others."""
        if not self.is_hot:
            return None
        named = self.named()
        if named:
            ends = [[named[f"{name}_{end}"] for end in ("min", "max")] for name in ("strain", "rate", "temperature")]
            return np.array(ends)
        counts = self.parameters[:3].astype(int)
        axes = np.split(self.parameters[3 : 3 + counts.sum()], np.cumsum(counts)[:2])
        return np.array([[axis[0], axis[-1]] for axis in axes])

    def named(self) -> dict[str, float]:
        """Return the parameters by name; of a table none."""
        names = _core.parameter_names(_core.HardeningLaw[self.law])
        return {} if names == ["points"] else dict(zip(names, map(float, self.parameters), strict=True))

    def scale(self, factor: float) -> Hardening:
        """Return the law, not a hot one, whose flow stress is so many times larger."""
        names = _core.parameter_names(_core.HardeningLaw[self.law])
        if names == ["points"]:
            stresses = np.arange(len(self.parameters)) % (3 if self.law == "monotone_table" else 2) > 0
        else:
            stresses = np.isin(names, STRESSES)
        return replace(self, parameters=np.where(stresses, factor * self.parameters, self.parameters))


def never_yield(young: float) -> Hardening:
    """Return the hardening of an elastic material of Young's modulus `young` [MPa]."""
    return Hardening("linear", np.array([NEVER * young, 0.0]))


@dataclass(frozen=True)
class YieldFunction:
    """Anisotropic yield function; see docs/theory/sheet_material.md for the formulas."""

    law: Literal["hill1948", "barlat1989", "yld2000", "yld2004"]
    parameters: tuple[float, ...]
    """hill1948: F, G, H, L, M, N; barlat1989: a, c, h, p; yld2000: alpha 1 to 8; yld2004: c12, c13, c21, c23, c31, c32,
    c44, c55, c66 of the first transformation, then of the second."""
    exponent: int = 2
    """Exponent, 6 or 8, of all but hill1948."""


@dataclass(frozen=True)
class Kinematic:
    """Back stresses; see docs/theory/sheet_material.md for the laws."""

    law: Literal["chaboche", "yoshida_uemori"]
    parameters: Mapping[str, tuple[float, ...]]
    """chaboche: C [MPa] and gamma of each back stress; yoshida_uemori: B, C, m, b, Rsat, h, one each [MPa]."""


@dataclass(frozen=True)
class Rate:
    """Factor on the flow stress by plastic strain rate."""

    law: Literal["cowper_symonds", "johnson_cook", "logarithmic"]
    parameters: Mapping[str, float]
    """cowper_symonds: D [1/s], q; johnson_cook, logarithmic: C, reference_rate [1/s]."""


@dataclass(frozen=True, kw_only=True)
class Heating:
    """Softening by 1 - T*^exponent, T* from 0 at `reference` to 1 at `melting`, and adiabatic heating by plastic work.

    Without melting nothing softens. Temperatures in degrees C; heat_capacity [mm2/(s2 K)] (steel has 4.6e8, that is
    460 J/(kg K)), None: the temperature stays as it starts; plastic_fraction: of the plastic work that becomes heat
    (Taylor & Quinney 1934).
    """

    melting: float | None = None
    exponent: float = 1.0
    heat_capacity: float | None = None
    plastic_fraction: float = 0.9
    reference: float = 20.0
    start: float = 20.0


@dataclass(frozen=True)
class Damage:
    """Criterion of ductile fracture; see docs/theory/damage.md for the formulas."""

    criterion: Literal[
        "cockcroft_latham",
        "rice_tracey",
        "oyane",
        "freudenthal",
        "johnson_cook",
        "modified_mohr_coulomb",
        "hosford_coulomb",
        "bai_wierzbicki",
    ]
    parameters: Mapping[str, float] = field(default_factory=dict)
    """rice_tracey: factor, exponent; oyane: A; johnson_cook: d1 to d5, reference_rate [1/s], reference and melting
    [degrees C]; modified_mohr_coulomb: A, c2 [MPa], n, c1, c3; hosford_coulomb: a, b, c, n; bai_wierzbicki: d1 to d6;
    the others have none."""
    critical: float | None = None
    """Damage at which a crack begins; None: it is not known."""
    length: float | None = None
    """Radius of the neighbourhood of the material whose mean decides [mm]; None: that of observe/damage_length.py."""


@dataclass(frozen=True, kw_only=True)
class Thermoelastic:
    """Thermal expansion, and elastic constants by temperature; rows of temperature [degrees C] and value (n, 2).

    Values are linear between rows and constant beyond.
    """

    expansion: FloatArray | None = None
    """Coefficient of thermal expansion [1/K]: of the next degree or, with secant_from, the mean one from there on."""
    secant_from: float | None = None
    """Temperature from which the coefficient is the mean one [degrees C]."""
    young_factor: FloatArray | None = None
    """Young's modulus over that of the material."""
    poisson: FloatArray | None = None
    """Poisson's ratio, in place of that of the material."""


@dataclass(frozen=True)
class Umat:
    """A material law from a shared library with Abaqus's interface UMAT."""

    library: str
    """Full path of the shared library."""
    props: tuple[float, ...]
    """PROPS, in mm, s, MPa as the routine expects them."""
    n_state: int
    """NSTATV."""
    jacobian: UmatJacobian = "stress_increment"
    """What DDSDDE is the derivative of; see docs/theory/material.md."""
    thread_safe: bool = False
    """Several threads may call it at once."""
    plastic_strain: int = 0
    """Which state variable is the equivalent plastic strain, from 1; 0: none."""
    yield_stress: float = 0.0
    """First flow stress [MPa], by which forces and energies of a stamping are judged; 0: not given."""


@dataclass(frozen=True)
class Material:
    """Isotropic elasticity with plasticity of any kind, or a UMAT."""

    name: str
    young: float
    """Young's modulus [MPa]; of a UMAT that of its first tangent, by which stiffness and energy are judged."""
    poisson: float
    hardening: Hardening | None
    """Hardening law; None for a UMAT."""
    yield_function: YieldFunction | None = None
    """Yield function, x along the rolling direction; None is von Mises."""
    kinematic: Kinematic | None = None
    rate: Rate | None = None
    young_decrease: tuple[float, float] | None = None
    """Young's modulus after large plastic strain [MPa], and the rate at which it falls to that."""
    rolling_direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Unit vector of a solid's rolling direction; that of a sheet is in the Model."""
    umat: Umat | None = None
    """The law, instead of hardening."""
    density: float = 0.0
    """[t/mm3]; needed for dynamics and heating."""
    heating: Heating | None = None
    """Softening and heating; None: the material does not depend on temperature."""
    thermoelastic: Thermoelastic | None = None
    """None: it does not expand, and its elastic constants do not depend on temperature."""
    thermal: Thermal | None = None
    """Conduction and storage of heat; None: it conducts no heat."""
    damage: Damage | None = None
    """Criterion of fracture; None: in solids that of Cockcroft and Latham, without a critical value."""
    gtn: Gtn | None = None
    """Pores, of a material whose `umat` is then presswork's own; None: it is dense."""
    grain: Grain | None = None
    """Grain size in hot forming; None: it is not computed."""
    transformation: Transformation | None = None
    """What austenite becomes on cooling; None: nothing is computed."""
    formability: Formability = field(default_factory=Formability)
    """Forming limit that the strains of a sheet are compared with."""

    @property
    def phases(self) -> PhaseMechanics | None:
        """How its phases strain and yield, where they differ."""
        return self.transformation.mechanics if self.transformation is not None else None

    @property
    def is_elastic(self) -> bool:
        """Whether it never yields."""
        h = self.hardening
        return h is not None and h.law == "linear" and float(h.parameters[0]) >= NEVER * self.young
