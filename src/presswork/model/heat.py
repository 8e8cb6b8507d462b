# SPDX-License-Identifier: Apache-2.0
"""Heat: what a material conducts and stores, and what heats and cools a body in a stage.

Temperatures are in degrees C. A table holds rows of an argument and a value (n, 2), the arguments increasing: linear
between them, constant beyond; a single row is a constant. The argument is the temperature [degrees C] or the time since
the stage began [s].
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from presswork.model.arrays import FloatArray, IntArray
from presswork.model.mesh import Mesh

STEFAN_BOLTZMANN = 5.670374419e-11
"""[N/(mm s K^4)] (CODATA 2018)."""
COLDEST, HOTTEST = -200.0, 4000.0
"""Temperatures of no forming [degrees C]."""
ZERO_CELSIUS = 273.15
"""[K]"""


@dataclass(frozen=True, kw_only=True)
class Thermal:
    """Conduction and storage of heat in a material of constant mass."""

    density: float
    """[t/mm3] at the start: the mesh has the dimensions that the body has then."""
    conductivity: FloatArray
    """Conductivity by temperature [N/(s K)], which is W/(m K)."""
    specific_heat: FloatArray
    """Specific heat by temperature [mm2/(s2 K)]."""
    latent_heat: float = 0.0
    """Heat taken up from the start to the end of a transformation, evenly in temperature [mm2/s2]."""
    transformation: tuple[float, float] = (0.0, 1.0)
    """Start and end [degrees C]."""


@dataclass(frozen=True)
class PrescribedTemperature:
    """Temperature of a node set."""

    node_set: str
    value: FloatArray
    """Temperature by time [degrees C]."""


@dataclass(frozen=True)
class HeatFlux:
    """Heat that flows into a set of edges, in space of faces."""

    side_set: str
    value: FloatArray
    """Flux by time [N/(mm s)], which is kW/m2."""


@dataclass(frozen=True)
class Convection:
    """Heat given to surroundings in proportion to the difference of temperature."""

    side_set: str
    coefficient: FloatArray
    """Coefficient by temperature of the surface [N/(mm s K)]."""
    ambient: FloatArray
    """Ambient temperature by time [degrees C]."""


@dataclass(frozen=True)
class Radiation:
    """Heat exchanged with large black surroundings by Stefan and Boltzmann's law."""

    side_set: str
    emissivity: float
    ambient: FloatArray
    """Ambient temperature by time [degrees C]."""


@dataclass(frozen=True)
class HeatContact:
    """Heat that flows between two bodies where their boundaries lie on each other."""

    name: str
    between: tuple[int, int]
    conductance: FloatArray
    """Rows of contact pressure [MPa] and conductance [N/(mm s K)] (n, 2); without forming there is no pressure."""
    gap: float = 0.0
    """Width of a gap [mm] across which no more heat passes; from contact on, conductance falls evenly to there."""


@dataclass(frozen=True)
class Surroundings:
    """What takes heat from surfaces that touch no tool, by convection and radiation."""

    ambient: float
    """[degrees C]"""
    emissivity: float = 0.0
    coefficient: float = 0.0
    """[N/(mm s K)]."""


@dataclass(frozen=True)
class DieMesh:
    """The mesh of a tool, in which heat is conducted; it moves with the tool."""

    mesh: Mesh
    """Mesh in its place at the start, of cells with nodes at corners."""
    thermal: Thermal
    profile: IntArray
    """Boundary edges on the tool's profile (n, 2): other sides are insulated."""
    back: IntArray
    """Nodes held at back_temperature (n,)."""
    back_temperature: float = 0.0
    """[degrees C]"""


@dataclass(frozen=True)
class ToolHeat:
    """A tool of constant temperature, one whose steel takes up heat behind the nodes that touch it, or a meshed one."""

    temperature: float
    """Temperature at the start [degrees C]."""
    conductance: FloatArray
    """Rows of contact pressure [MPa] and conductance [N/(mm s K)] (n, 2)."""
    gap: float = 0.0
    """Gap, as in HeatContact."""
    effusivity: float | None = None
    """sqrt(conductivity density specific heat) [N/(mm K s^0.5)]; None: that of the workpiece."""
    steel: tuple[float, float] | None = None
    """Properties of a tool that takes up heat: conductivity [N/(s K)], heat capacity per volume [N/(mm2 K)]."""
    die: DieMesh | None = None
    """Mesh of a tool that conducts heat on one of its own."""


@dataclass(frozen=True, kw_only=True)
class HeatStage:
    """What heats and cools the bodies in a stage; sides that no entry names are insulated."""

    temperatures: tuple[PrescribedTemperature, ...] = ()
    fluxes: tuple[HeatFlux, ...] = ()
    convections: tuple[Convection, ...] = ()
    radiations: tuple[Radiation, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Heat:
    """Heat of a model."""

    initial: tuple[float, ...]
    """Temperature of each body at the start [degrees C]."""
    alone: bool = True
    """Whether bodies are heated and cooled without forming; otherwise heat accompanies forming."""
    surroundings: Surroundings | None = None
    """In forming: what free surfaces lose heat to; None: they are insulated."""
    tools: Mapping[str, ToolHeat] = field(default_factory=dict)
    """In forming: tools that take heat, by name; other tools are insulated."""
    plastic_fraction: float = 0.9
    """In forming: part of the plastic work that becomes heat (Taylor & Quinney 1934)."""
    effusivity: tuple[float, ...] = ()
    """In forming: effusivity of each body at the start [N/(mm K s^0.5)]."""
    contacts: tuple[HeatContact, ...] = ()
    tolerance: float = 1.0
    """Largest error that a time step may add at any node, as estimated [K]."""
    initial_step: float = 1e-4
    """First time step of each stage, over its duration."""
    max_change: float = 50.0
    """In implicit forming: largest change of a temperature given to a law in an increment, which is cut to it [K]."""
    max_step: float = 0.05
    """Largest time step over the duration of the stage."""
    fixed_step: float | None = None
    """All steps are of this part of the stage, whatever their errors."""
    levels: int = 5
    """Number of levels of a sheet: equally spaced temperatures through its thickness, on both faces and between."""


@dataclass(frozen=True)
class Series:
    """Parts formed one after another, each by all stages, between tools that stay warm."""

    parts: int
    pause: float = 0.0
    """Pause between parts: the tools lie open [s]."""
