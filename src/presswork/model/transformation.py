# SPDX-License-Identifier: Apache-2.0
"""Transformation of austenite on cooling: what follows from a steel's composition, and what is given directly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

PHASES = ("ferrite", "pearlite", "bainite", "martensite")
"""What austenite becomes; the rest of a point is austenite."""
ELEMENTS_OF_STEEL = ("C", "Mn", "Si", "Ni", "Cr", "Mo")
"""Elements that the kinetics know of."""


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
