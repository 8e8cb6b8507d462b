# SPDX-License-Identifier: Apache-2.0
"""How a procedure computes, and what is saved."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from presswork.model.elements import ExplicitElement

Integrator = Literal["backward_euler", "radial_return", "direct", "tangent_radial_return", "secant", "substepping"]
StrainMeasure = Literal["log", "stretch", "green_lagrange", "small"]
Displacements = Literal["large", "small"]
FrictionTangent = Literal["return_mapping", "bond", "residual"]
LinearSolverChoice = Literal["auto", "direct", "multigrid"]
LARGE = 50_000
"""Freedoms of a body in space from which multigrid takes less time and memory than factors."""


@dataclass(frozen=True)
class TangentTerms:
    """Which parts of the thesis's tangent are built; used only with SolverSettings.tangent = "thesis"."""

    strain_matrix: Literal["B0", "Bbar"] = "B0"
    """K_o = int B^T D B with the linear B0, or with the Green-Lagrange B0 + B_L on both sides."""
    k_e: bool = True
    k_u: bool = True
    k_v: bool = False
    modulus: Literal["consistent", "continuum"] = "continuum"
    """D of K_o: the derivative of the integrator, or the elastic-plastic matrix of the rate equation (Yamada)."""


@dataclass(frozen=True)
class SolverSettings:
    """How the implicit procedure integrates and iterates."""

    @property
    def is_small(self) -> bool:
        """Whether displacements are small."""
        return self.displacements == "small"

    newton: Literal["full", "modified"] = "full"
    tangent: Literal["consistent", "thesis"] = "consistent"
    terms: TangentTerms = TangentTerms()
    symmetric: bool = True
    """Factorise the symmetric part of the tangent (see docs/theory/solver.md for what it costs in iterations)."""
    linear_solver: LinearSolverChoice = "auto"
    """How linear systems are solved: by factors, or iterating with multigrid; auto: by the size of the body."""
    pressure_stiffness: bool = True
    """K_t: the follower stiffness of pressures."""
    friction_tangent: FrictionTangent = "return_mapping"
    """What friction adds to the tangent; the result does not depend on it."""
    line_search: bool = True
    force_tolerance: float = 1e-4
    """Largest out-of-balance force over the largest internal nodal force."""
    displacement_tolerance: float = 1e-3
    """Largest correction over the largest displacement of the increment."""
    max_iterations: int = 20
    initial_increment: float = 0.01
    """Fraction of the stage."""
    min_increment: float = 1e-5
    max_increment: float = 0.02
    increment_tolerance: float = 0.005
    """Largest relative error by the length of increments: of stress and creep where flow depends on the rate of strain,
    of the neck where flow localises, of grain and phases."""
    target_iterations: int = 6
    """Increments grow while they take fewer iterations than this."""
    displacements: Displacements = "large"
    """small: equilibrium on the undeformed body, strain linear in the displacement."""
    strain_measure: StrainMeasure = "log"
    integrator: Integrator = "backward_euler"
    substeps: int = 10
    """Sub-increments of the "substepping" integrator."""
    hourglass_stiffness: float = 0.05
    """quad4_1pt: hourglass stiffness as a fraction of the material's current shear modulus."""
    control: Literal["load", "arc_length"] = "load"
    """What an increment prescribes: a part of the stage, or, on shells under loads alone, the length of path."""
    kirchhoff_penalty: float = 0.0
    """Shells: transverse shear stiffness added to the tangent alone, over the elastic one (C_p of K_p)."""
    contact_stiffness: float = 0.1
    """Shells on tools in space: stiffness of contact over that of the sheet across its thickness."""
    inertia: float = 0.0
    """Mass over that of the material, for inertia by backward Euler in the time of the stages."""
    damping: float = 0.0
    """Damping in proportion to this mass [1/s]."""


@dataclass(frozen=True)
class OutputSettings:
    """What is saved, and when."""

    every: int = 0
    """Save fields every so many increments; 0 saves at `steps` equally spaced times of each stage."""
    steps: int = 20
    at: tuple[float, ...] = ()
    """Further stage fractions at which an increment ends and fields are saved, counted in the last stage."""
    checkpoint_every: int = 10
    """Increments between checkpoints; in an explicit run rows of the history."""
    rows: int = 200
    """Explicit: rows of the history of each stage."""
    dynain: bool = False
    """Stampings: whether each operation's part is written as a dynain."""

    def is_closer_than(self, increment: float) -> bool:
        """Return whether the equal steps lie closer together than increments of this fraction of a stage."""
        return self.steps * increment > 1 + 1e-9


@dataclass(frozen=True)
class ExplicitSolid:
    """How the explicit procedure computes a solid."""

    velocity: tuple[float, ...] = (0.0, 0.0)
    """(2,), in space (3,): velocity of the whole workpiece at the start [mm/s]."""
    target_step: float | None = None
    """Time step to reach by adding mass [s]; None: no mass is added."""
    damping: float = 0.0
    """Mass damping [1/s]."""
    hourglass_stiffness: float = 0.05
    """quad4_1pt and hex8_1pt: fraction of the shear modulus."""
    safety: float = 0.9
    """Time step over the bound of the stable step."""
    velocity_of_others: tuple[tuple[float, ...], ...] = ()
    """velocity of each body after the workpiece."""
    device: Literal["cpu", "host", "cuda"] = field(default="cpu", repr=False)
    """What computes the cycles of solids in space, as of ExplicitSheet."""


@dataclass(frozen=True)
class ExplicitSheet:
    """How the explicit procedure computes a sheet and steps through time."""

    element: ExplicitElement = "shell4_1pt"
    """Element of the blank."""
    target_step: float | None = None
    """Time step [s] that mass is added for; None: no mass is added, the step follows from the mesh."""
    safety: float = 0.9
    """Time step over the bound of the stable step."""
    step_bound: Literal["shells", "mesh"] = "shells"
    """Whose stable step that is: the worst shell's by itself, or that of the mesh as a whole, which is longer."""
    damping: float = 0.0
    """Mass damping [1/s]."""
    precision: Literal["double", "single"] | None = None
    """Precision of shells and velocities; positions and energies are always double.

    None: single where it is faster, for von Mises with isotropic hardening alone, else double.
    """
    device: Literal["cpu", "host", "cuda"] = field(default="cpu", repr=False)
    """What computes the cycles: the CPU, an NVIDIA card, or the card's code on the CPU.

    A checkpoint goes on on any of them: it is not part of what names a model.
    """
    contact_points: Literal["nodes", "edges"] = "edges"
    """Where the blank touches tools: at nodes alone, or where a tool is sharp also at the edges between them."""
    ironing: bool = True
    """Whether two tools squeeze a sheet that is thicker than the room between them."""
