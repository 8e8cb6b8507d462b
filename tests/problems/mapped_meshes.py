# SPDX-License-Identifier: Apache-2.0
"""Whole runs that get the new meshes of another run, each where their own material is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, Mesh, Model
from presswork.process.derivatives.differentiated import begin_differentiated
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.implicit.increments import IncrementRun, find_position
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change.carrying import carry_to_mesh
from presswork.process.mesh_change.mesh_reasons import DUE
from presswork.process.mesh_change.new_epoch import NewEpoch
from presswork.process.run import Row, Run
from presswork.remesh.carrier import Carrier
from presswork.results.history import name_derivative
from tests.problems.differentiated import APART, EXACT, largest_error, set_value, upset_block, upset_cylinder


@dataclass(frozen=True)
class MadeMesh:
    """A new mesh of a run."""

    mesh: Mesh
    carrier: Carrier
    position: FloatArray
    """Of the nodes of the mesh before (n_points, 2 | 3) [mm]."""
    number: int
    """Of the increment after which it was made."""


class Noting:
    """Notes the new meshes of a run with derivatives, and lets its neighbours follow it."""

    def __init__(self, run: IncrementRun) -> None:
        assert run.neighbours is not None
        self._run, self._neighbours = run, run.neighbours
        self.made: list[MadeMesh] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._neighbours, name)

    def leave_mesh(self, new: NewEpoch) -> None:
        """Note the new mesh."""
        position = find_position(self._run.procedure)
        self.made.append(MadeMesh(new.procedure.model.mesh, new.carrier, position, self._run.number))
        self._neighbours.leave_mesh(new)


class GivenBodies:
    """A body that gets the new meshes of another run, when that has had them.

    A node of such a mesh keeps its place in its old cell, and values come from the same points.
    """

    parts = (1.0,)
    waits_first = False

    def __init__(self, run: IncrementRun, given: Sequence[MadeMesh]) -> None:
        self._run, self._given = run, given

    def find_obstacle(self) -> str:
        """Return that nothing prevents new meshes."""
        return ""

    def find(self) -> list[None]:
        """Return one body, of which nothing is known."""
        return [None]

    def find_reason(self, number: int, old: None, wait: float, *, is_first: bool) -> str | None:
        """Return why there is a new mesh now: where the other run has had one, and nowhere else."""
        return DUE if self._next_is_due() else None

    def _next_is_due(self) -> bool:
        run = self._run
        return run.epoch < len(self._given) and self._given[run.epoch].number == run.number

    def make(self, old: Sequence[Any], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on the other run's mesh."""
        assert self._next_is_due(), f"increment {self._run.number + 1} fails here, which it does not in the other run"
        given, before = self._given[self._run.epoch], self._run.procedure
        position = find_position(before)
        points = given.mesh.points + given.carrier.motion(position - given.position)
        carrier = given.carrier.beside(position, points)
        mesh = replace(given.mesh, points=points)
        return carry_to_mesh(before, mesh, carrier), carrier

    def note_meshes(self, bodies: set[int] | None, *, is_new: bool, is_refused: bool) -> None:
        """Note nothing."""

    def arrays(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def load_arrays(self, arrays: Mapping[str, Any]) -> None:
        """Take up nothing."""


def begin_with_meshes(model: Model, given: Sequence[MadeMesh]) -> ImplicitForming:
    """Return a run that takes the new meshes of another run, and makes none itself."""
    assert model.remeshing is not None
    run = ImplicitForming(replace(model, remeshing=replace(model.remeshing, every=0.0)), threads=1)
    run.add_mesh_change(NewMeshes(run, GivenBodies(run, given)))
    return run


def upset_with_new_meshes(stroke: float = 4.0, increment: float = 0.1) -> dict[str, Any]:
    """Return the data of a cylinder upset with shear friction that gets three new meshes, without derivatives."""
    data = upset_cylinder(
        points={"rim": [9.5, 0], "core": [3.1, 4.2]},
        remesh={"every": 0.4, "size": 1.6},
        solver=EXACT | {"initial_increment": increment, "max_increment": increment, "force_tolerance": 1e-11},
    )
    data["stages"][0]["tools"]["punch"]["stroke"] = stroke
    return data


def upset_block_with_new_meshes(stroke: float = 1.2) -> dict[str, Any]:
    """Return the data of a block of tetrahedra upset with friction that gets new meshes, without derivatives."""
    data = upset_block("tet4_mini", {"contact": "coulomb", "mu": 0.1})
    data["workpiece"]["mesh"]["cells"] = [3, 3, 3]
    data["stages"][0]["tools"]["punch"]["stroke"] = stroke
    return data | {
        "points": {"rim": [9.5, 9.3, 0.4], "core": [3.1, 4.2, 3.3]},
        "remesh": {"every": 0.4, "size": 3.3},
        "solver": EXACT | {"initial_increment": 0.1, "max_increment": 0.1, "force_tolerance": 1e-11},
    }


def differentiate_with_meshes(
    data: dict[str, Any], of: Sequence[str], by: Mapping[str, float], *, apart: float = APART, within: float = np.inf
) -> tuple[dict[tuple[str, str], tuple[FloatArray, FloatArray]], int]:
    """Return derivatives row by row, in the run and by central differences of whole runs with its meshes; and how many
    new meshes there were.

    apart: of a number, by how much whole runs differ. within: as in `differentiate`.
    """
    asked = {"gradients": {"of": list(of), "by": list(by)}}
    in_space = data["analysis"] == "solid"
    kind = SpaceCase if in_space else Case
    own = begin_differentiated(build_model(kind.model_validate(data | asked)), 1)
    assert isinstance(own.run, ImplicitForming)
    noting = own.run.neighbours = Noting(own.run)
    rows = _go_through(own)
    found: dict[tuple[str, str], tuple[FloatArray, FloatArray]] = {}
    for key, value in by.items():
        change = apart * abs(value)
        for step in (change, 2.0 * change, 0.5 * change):
            left = [name for name in of if (key, name) not in found or largest_error(*found[key, name]) > within]
            if not left:
                break
            changed = (kind.model_validate(set_value(data, key, value + way)) for way in (step, -step))
            more, less = (_go_through(begin_with_meshes(build_model(case), noting.made)) for case in changed)
            counts = [len(run) for run in (rows, more, less)]
            assert len(set(counts)) == 1, f"runs of {counts} increments by {key} cannot be compared"
            for name in left:
                slope = np.array(
                    [(float(m[name]) - float(s[name])) / (2.0 * step) for m, s in zip(more, less, strict=True)]
                )
                both = np.array([row[name_derivative(name, key)] for row in rows]), slope
                found[key, name] = min(found.get((key, name), both), both, key=lambda pair: largest_error(*pair))
    return found, len(noting.made)


def _go_through(run: Run) -> list[Row]:
    return [run.row(report) for report in run.advance()]
