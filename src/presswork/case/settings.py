# SPDX-License-Identifier: Apache-2.0
"""Solver and output settings of a case; names and defaults are those of model.SolverSettings and OutputSettings."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.part import Part
from presswork.case.units import Number, Rate, fault

_TERMS = model.TangentTerms()
_SOLVER = model.SolverSettings()
_OUTPUT = model.OutputSettings()

RAMP = 0.1
"""Share of an explicit stage that starts it smoothly, and share that ends it, where the stage sets none."""

Whole = Annotated[int, Field(strict=True)]
IncrementTolerance = Annotated[
    Number,
    Field(
        gt=0,
        lt=1,
        description="largest relative error by the length of increments: of stress and creep where flow depends on the "
        "strain rate, of the neck where flow localises, of grain and phases",
    ),
]


class Terms(Part):
    """Which parts of the thesis's tangent are built; used only with tangent = "thesis"."""

    strain_matrix: Literal["B0", "Bbar"] = Field(
        default=_TERMS.strain_matrix, description="strain matrix of K_o: linear B0, or Green-Lagrange B0 + B_L"
    )
    k_e: bool = Field(default=_TERMS.k_e, description="build K_e")
    k_u: bool = Field(default=_TERMS.k_u, description="build K_u")
    k_v: bool = Field(default=_TERMS.k_v, description="build K_v")
    modulus: Literal["consistent", "continuum"] = Field(
        default=_TERMS.modulus, description="D of K_o: derivative of the integrator, or of the rate equation"
    )


class Solver(Part):
    """How the implicit procedure integrates and iterates."""

    newton: Literal["full", "modified"] = Field(
        default=_SOLVER.newton, description="factorise in each iteration, or once per increment"
    )
    tangent: Literal["consistent", "thesis"] = Field(default=_SOLVER.tangent, description="tangent stiffness")
    terms: Terms = Field(default=Terms(), description='parts of the tangent with tangent = "thesis"')
    symmetric: bool | None = Field(
        default=None,
        description="factorise the tangent's symmetric part; without it: unless Coulomb's law acts, bodies touch, or a "
        "solid in space with [remesh] meets shear friction",
    )
    pressure_stiffness: bool = Field(default=_SOLVER.pressure_stiffness, description="follower stiffness of pressures")
    friction_tangent: model.FrictionTangent = Field(
        default=_SOLVER.friction_tangent,
        description="what friction adds to the tangent; the answer does not depend on it",
    )
    line_search: bool | None = Field(
        default=None, description="shorten corrections that overshoot; without it: in solids, not in shells"
    )
    force_tolerance: Number = Field(
        default=_SOLVER.force_tolerance, gt=0, lt=1, description="largest out-of-balance over largest nodal force"
    )
    displacement_tolerance: Number = Field(
        default=_SOLVER.displacement_tolerance, gt=0, lt=1, description="largest correction over largest displacement"
    )
    max_iterations: Whole = Field(default=_SOLVER.max_iterations, ge=1, description="iterations before a cut-back")
    initial_increment: Number = Field(
        default=_SOLVER.initial_increment, gt=0, le=1, description="first increment, fraction of the stage"
    )
    min_increment: Number = Field(
        default=_SOLVER.min_increment, gt=0, le=1, description="smallest increment, fraction of the stage"
    )
    max_increment: Number = Field(
        default=_SOLVER.max_increment, gt=0, le=1, description="largest increment, fraction of the stage"
    )
    increment_tolerance: IncrementTolerance = _SOLVER.increment_tolerance
    target_iterations: Whole = Field(
        default=_SOLVER.target_iterations, ge=1, description="increments grow while they take fewer iterations"
    )
    displacements: model.Displacements = Field(
        default=_SOLVER.displacements,
        description="large; or small: geometrically linear, equilibrium on the undeformed body and strain linear in "
        "the displacement",
    )
    strain_measure: model.StrainMeasure = Field(default=_SOLVER.strain_measure, description="strain increment")
    integrator: model.Integrator = Field(default=_SOLVER.integrator, description="integration of the stress")
    substeps: Whole = Field(default=_SOLVER.substeps, ge=1, description='sub-increments of "substepping"')
    hourglass_stiffness: Number = Field(
        default=_SOLVER.hourglass_stiffness, ge=0, description="quad4_1pt: fraction of the current shear modulus"
    )

    control: Literal["load", "arc_length"] = Field(
        default=_SOLVER.control,
        description="what an increment prescribes: load, a part of the stage; arc_length, for shells that snap "
        "through, the length of path",
    )
    kirchhoff_penalty: Number = Field(
        default=_SOLVER.kirchhoff_penalty,
        ge=0,
        description="shells: transverse shear stiffness added to the tangent alone, over the elastic one",
    )

    inertia: Number = Field(
        default=_SOLVER.inertia,
        ge=0,
        description="mass over the material's, in the time of the stages: steadies what nothing holds and what snaps; "
        "solids need the materials' density",
    )
    damping: Rate = Field(default=_SOLVER.damping, ge=0, description="damping in proportion to this mass [1/s]")

    @model_validator(mode="after")
    def _check_damping(self) -> Self:
        if self.damping and not self.inertia:
            raise fault("damps a mass, but inertia is 0", "add inertia = 1, the materials' own mass", key="damping")
        return self

    @model_validator(mode="after")
    def _check_increments(self) -> Self:
        if self.min_increment > self.max_increment:
            raise fault(
                f"min_increment ({self.min_increment:g}) is larger than max_increment ({self.max_increment:g})",
                "make it smaller",
                key="min_increment",
            )
        if not self.min_increment <= self.initial_increment <= self.max_increment:
            bounds = f"min_increment ({self.min_increment:g}) and max_increment ({self.max_increment:g})"
            # a smaller max_increment alone is a plain wish, not a contradiction
            if "initial_increment" in self.model_fields_set:
                raise fault(f"initial_increment is not between {bounds}", "choose it between them", "initial_increment")
        return self


def check_small_displacements(solver: Solver) -> list[Problem]:
    """Return the problems of keys that have no meaning with small displacements."""
    if solver.displacements == "large":
        return []
    fault = "has no meaning with small displacements, in which nothing turns and no load follows"
    keys = ("strain_measure", "terms", "pressure_stiffness")
    problems = [Problem(f"solver.{key}", fault, "remove it") for key in keys if key in solver.model_fields_set]
    if solver.tangent == "thesis":
        fault = "its terms are those of large displacements"
        problems.append(Problem("solver.tangent", fault, 'take "consistent"', "thesis"))
    if solver.control == "arc_length":
        fault = "with small displacements no shell snaps through"
        problems.append(Problem("solver.control", fault, 'take "load"', "arc_length"))
    return problems


class Output(Part):
    """What is saved, and when."""

    every: Whole = Field(default=_OUTPUT.every, ge=0, description="save every so many increments; 0: see steps")
    steps: Whole = Field(
        default=_OUTPUT.steps, ge=1, le=1_000_000, description="equally spaced saved times of each stage"
    )
    at: tuple[Annotated[Number, Field(gt=0, le=1)], ...] = Field(
        default=_OUTPUT.at, description="further saved times, fractions of the last stage"
    )
    checkpoint_every: Whole = Field(
        default=_OUTPUT.checkpoint_every, ge=1, description="increments between checkpoints; explicit: rows"
    )
    rows: Whole = Field(default=_OUTPUT.rows, ge=1, description="explicit: rows of history.csv for each stage")


def build_solver(
    solver: Solver, *, with_coulomb: bool, with_body_contact: bool = False, is_shell: bool = False
) -> model.SolverSettings:
    """Turn a case's solver settings into the Model's; Coulomb friction and contact of bodies keep the whole tangent.

    Shells use no line search: between two shapes full steps pass through large membrane forces.
    """
    values = solver.model_dump(exclude={"terms"})
    if solver.symmetric is None:
        values["symmetric"] = not (with_coulomb or with_body_contact)
    if solver.line_search is None:
        values["line_search"] = not is_shell
    if "initial_increment" not in solver.model_fields_set:
        values["initial_increment"] = min(max(_SOLVER.initial_increment, solver.min_increment), solver.max_increment)
    return model.SolverSettings(**values, terms=model.TangentTerms(**solver.terms.model_dump()))


def build_output(output: Output) -> model.OutputSettings:
    """Turn a case's output settings into the Model's."""
    values = output.model_dump()
    values["at"] = tuple(sorted(set(output.at)))
    return model.OutputSettings(**values)
