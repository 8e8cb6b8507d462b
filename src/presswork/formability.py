# SPDX-License-Identifier: Apache-2.0
"""Whether a sheet splits or wrinkles, from its strains: the limit curve, the margin to it, six zones, thinning.

Strains are true (logarithmic), those of the middle of the sheet. How curves are found is in case/forming_limit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

ZONES = ("safe", "risk of cracks", "cracks", "insufficient stretch", "wrinkling tendency", "wrinkles unless held")
"""Names of the zones, by the number that find_zones gives."""
ZONE = "zone_"
"""Beginning of what results store of a zone of a welded blank, before its number."""
CRACKS = ZONES.index("cracks")
POLAR, STRESS = "forming_limit_margin_polar", "forming_limit_margin_stress"
PATH_MARGINS = (POLAR, STRESS)
"""Fields that follow the paths of a sheet's layers (evolution/forming_path.py), the second where stress follows from
plastic strain alone."""
LEAST_STRETCH = 0.02
"""Strain below which a sheet counts as stretched too little: 2 %, the custom of outer panels."""

Info = Mapping[str, str | float | FloatArray]


@dataclass(frozen=True)
class FormingLimitCurve:
    """Largest major strain against minor strain, straight between points, the end pieces going on."""

    minor: FloatArray
    """Minor strains, increasing, shape (n,)."""
    major: FloatArray
    """Limit of the major strain, shape (n,)."""
    method: str
    """How the curve was found, in words."""

    def limit(self, minor: FloatArray) -> FloatArray:
        """Return the limit of the major strain at minor strains, never below the line major = minor."""
        minor = np.asarray(minor, dtype=float)
        i = np.clip(np.searchsorted(self.minor, minor), 1, len(self.minor) - 1)
        slope = (self.major[i] - self.major[i - 1]) / (self.minor[i] - self.minor[i - 1])
        return np.asarray(np.maximum(self.major[i - 1] + slope * (minor - self.minor[i - 1]), minor))

    def meet(self, ratio: FloatArray) -> FloatArray:
        """Return the major strain at which straight paths minor = ratio * major meet the curve; inf where none does."""
        ratio = np.asarray(ratio, dtype=float)
        i = np.clip(np.searchsorted(np.maximum.accumulate(self.minor / self.major), ratio), 1, len(self.minor) - 1)
        slope = (self.major[i] - self.major[i - 1]) / (self.minor[i] - self.minor[i - 1])
        height = self.major[i] - slope * self.minor[i]
        nears = 1.0 - slope * ratio
        return np.asarray(np.divide(height, nears, out=np.full(ratio.shape, np.inf), where=nears > 0.0))

    def lowest(self) -> tuple[float, float]:
        """Return minor and major strain of the lowest point."""
        i = int(np.argmin(self.major))
        return float(self.minor[i]), float(self.major[i])


@dataclass(frozen=True)
class Formability:
    """What a sheet's strains are judged by."""

    curve: FormingLimitCurve | None = None
    """None: cracks are not judged."""
    safety_margin: float = 0.1
    """Part of the limit's height held in reserve."""
    r: float = 1.0
    """Normal anisotropy (r00 + 2 r45 + r90)/4, by which uniaxial tension narrows the sheet."""
    note: str = ""
    """What to know of the curve; empty if nothing."""

    def to_info(self, prefix: str = "") -> dict[str, str | float | FloatArray]:
        """Return it as a results file keeps it, under names of their own that begin with a prefix."""
        info: dict[str, str | float | FloatArray] = {
            "safety_margin": self.safety_margin,
            "normal_anisotropy": self.r,
        }
        if self.curve is not None:
            info["forming_limit"] = self.curve.method
            info["forming_limit_minor"], info["forming_limit_major"] = self.curve.minor, self.curve.major
        return {f"{prefix}{name}": value for name, value in info.items()}

    @classmethod
    def from_info(cls, info: Info, prefix: str = "") -> Formability:
        """Read it back from what a results file keeps; of a file without it, what is known of no sheet."""
        info = {name.removeprefix(prefix): value for name, value in info.items() if name.startswith(prefix)}
        curve = None
        if "forming_limit" in info:
            minor, major = (np.asarray(info[f"forming_limit_{name}"], dtype=float) for name in ("minor", "major"))
            curve = FormingLimitCurve(minor, major, str(info["forming_limit"]))
        plain = cls()
        margin, r = info.get("safety_margin", plain.safety_margin), info.get("normal_anisotropy", plain.r)
        return cls(curve, float(np.asarray(margin)), float(np.asarray(r)))


Judged = Sequence[tuple[Formability, int]]
"""What the strains of a sheet's cells are judged by: that of so many cells, then that of so many more."""


def find_margin(major: FloatArray, minor: FloatArray, curve: FormingLimitCurve) -> FloatArray:
    """Return how far strain points lie below the curve at the same minor strain, over its height there.

    1: not stretched, 0: on the curve, negative: beyond. Where the curve, drawn on beyond its ends, falls below its
    lowest point, the height of that counts.
    """
    major, limit = np.asarray(major, dtype=float), curve.limit(minor)
    return np.asarray((limit - major) / np.maximum(limit, curve.lowest()[1]))


def find_zones(
    major: FloatArray,
    minor: FloatArray,
    curve: FormingLimitCurve,
    *,
    r: float = 1.0,
    margin: float = 0.1,
    least_stretch: float = LEAST_STRETCH,
) -> IntArray:
    """Return the zone of formability of strain points, as an index into ZONES.

    cracks: above the curve. risk of cracks: within `margin` of its height (custom: 0.1 for steel, 0.08 for aluminium).
    wrinkles unless held: the sheet thickens, minor < -major; a holder keeps it flat. wrinkling tendency: between that
    and uniaxial tension, minor = -r/(1+r) major. insufficient stretch: |major| and |minor| below `least_stretch`. safe:
    the rest. A point is in the first of these that holds, cracks before all, insufficient stretch before wrinkles.
    """
    major, minor = np.asarray(major, dtype=float), np.asarray(minor, dtype=float)
    reserve = find_margin(major, minor, curve)
    zone = np.zeros(major.shape, dtype=np.int32)
    zone[minor < -r / (1 + r) * major] = 4
    zone[minor < -major] = 5
    zone[(np.abs(major) < least_stretch) & (np.abs(minor) < least_stretch)] = 3
    zone[(reserve < margin) & (zone != 3)] = 1
    zone[reserve < 0] = CRACKS
    return zone


def explain_zones(margin: float) -> tuple[str, ...]:
    """Return what each of ZONES means, in words, as find_zones has it; margin: the part of the limit held in reserve.

    >>> explain_zones(0.1)[1]
    'less than 10 % below the forming limit'
    """
    return (
        "neither cracks nor wrinkles are near",
        f"less than {100 * margin:.4g} % below the forming limit",
        "above the forming limit",
        f"both strains are below {100 * LEAST_STRETCH:g} %: the panel may be soft",
        "compressed across more than in uniaxial tension",
        "the sheet thickens, and folds where no holder keeps it flat",
    )


def find_wrinkling(major: FloatArray, minor: FloatArray, r: float = 1.0) -> FloatArray:
    """Return by how much the sheet is compressed beyond uniaxial tension: -minor - r/(1+r) major, at least 0.

    A strain. It is 0 on the line of uniaxial tension, and major/(1+r) where the sheet begins to thicken. It shows where
    the sheet would fold if nothing held it; whether it does depends on the holder and shows in the deformed mesh.
    """
    return np.asarray(np.maximum(-np.asarray(minor) - r / (1 + r) * np.asarray(major), 0.0))


def find_thinning(thickness_strain: FloatArray) -> FloatArray:
    """Return by how many per cent of its first thickness the sheet is thinner; negative where it is thicker."""
    return np.asarray(-100.0 * np.expm1(thickness_strain))
