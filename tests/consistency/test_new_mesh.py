# SPDX-License-Identifier: Apache-2.0
"""What becomes of every array of every owner where a body is meshed anew: nothing is silently zero or lost."""

from __future__ import annotations

import importlib
import pkgutil
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import presswork
from presswork import Case, build_model
from presswork.body.heat import PointShapes
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.interaction.tool_arrays import ContactArrays
from presswork.law.history import AXES
from presswork.model import FloatArray, Model
from presswork.outcome import StartError
from presswork.process.begin import begin
from presswork.process.implicit import bodies_in_plane
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change import carrying
from presswork.process.mesh_change.carrying import find_undeclared
from presswork.state import ANEW, RUN, Arrays

REFUSED = {
    "beads": "of explicit sheets, which are refined, not remeshed",
    "drawbeads": "sheets are refined, not remeshed",
    "former": "of shells",
    "sensitivities": "found anew on each mesh (process/derivatives/on_new_meshes.py)",
    "shells": "of shells",
    "sheet_contact": "of explicit sheets",
    "sheet_tools": "of explicit sheets",
    "shell_contact": "of explicit sheets",
    "sheet_pressures": "of explicit sheets, which are refined, not remeshed",
    "sheet_heat": "sheets are refined, not remeshed",
    "space_tools": "of shells",
    "inertia": "the key solver.inertia is refused with [remesh]",
}
"""Owners whose arrays cannot pass to a new mesh of a solid, and why no run asks for it."""

LAWS: dict[str, dict[str, Any]] = {
    "von Mises": {},
    "hill1948": {"yield_function": {"law": "hill1948", "r00": 0.8, "r45": 0.4, "r90": 0.55}},
    "chaboche": {"kinematic": {"law": "chaboche", "C": [3000, 800], "gamma": [60, 0]}},
    "rate": {"rate": {"law": "cowper_symonds", "D": 40, "q": 5}},
    "self-heating": {
        "heating": {"melting": 1400, "exponent": 1.1, "heat_capacity": "460 J/(kg*K)", "start": 40},
        "density": "7850 kg/m^3",
    },
    "damage": {"damage": {"criterion": "freudenthal"}},
}


def forging(law: dict[str, Any] | None = None, *, element: str = "quad4_fbar", hot: bool = False) -> Case:
    """A billet under a platen with shear friction; hot: it conducts heat, and the platen warms up."""
    steel = {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300}}
    tool: dict[str, Any] = {"profile": [[-1, 15], [60, 15]], "contact": "shear", "m": 0.2}
    if hot:
        steel |= {"density": "7850 kg/m^3", "thermal": {"conductivity": 30, "specific_heat": "600 J/(kg*K)"}}
        tool["heat"] = {
            "temperature": 200, "warms_up": True, "conductance": "10 kW/(m^2*K)", "conductivity": 25,
            "specific_heat": "460 J/(kg*K)", "density": "7800 kg/m^3",
        }  # fmt: skip
    return Case(
        title="forging",
        analysis="axisymmetric",
        workpiece={"material": "steel", "element": element, "mesh": {"size": [10, 15], "cells": [8, 12]}},
        materials={"steel": steel | (law or {})},
        tools={"punch": tool},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "duration": 0.1, "tools": {"punch": {"stroke": 1.0, "direction": [0, -1]}}}],
        heat={"initial_temperature": 900} if hot else None,
        solver={"initial_increment": 0.5, "max_increment": 0.5},
        output={"steps": 1},
        remesh={},
    )


def first_increment(case: Case) -> Any:
    recording = begin(build_model(case), 1)
    next(recording.advance())
    return recording


def test_every_owner_in_the_package_says_what_becomes_of_each_array() -> None:
    """A new owner is found by itself: it declares its arrays, or is refused for a reason that stands above."""
    for module in pkgutil.walk_packages(presswork.__path__, "presswork."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    owners = [kind for kind in _subclasses(Arrays) if kind.__module__.startswith("presswork.")]
    assert len(owners) >= 10
    for kind in owners:
        names = set(kind.names())
        assert set(kind.on_new_mesh) <= names, kind
        if kind.owner not in REFUSED:
            assert names == set(kind.on_new_mesh), f"{kind.__name__}: {names - set(kind.on_new_mesh)} would be lost"


def _subclasses(kind: type[Any]) -> list[type[Any]]:
    return [own for child in kind.__subclasses__() for own in (child, *_subclasses(child))]


def linear(points: FloatArray, shape: tuple[int, ...], scale: float) -> FloatArray:
    """Return a field that is linear in the place, another one in each component (n, *shape)."""
    count = int(np.prod(shape, dtype=int))
    slopes = 1.0 + np.arange(2 * count).reshape(2, count) % 7
    return scale * (5.0 + points @ (0.1 * slopes)).reshape(len(points), *shape)


@pytest.mark.parametrize(
    ("law", "element", "hot"),
    [(law, "quad4_fbar", False) for law in LAWS]
    + [("von Mises", "quad4_1pt", False), ("von Mises", "quad4_fbar", True)],
)
def test_linear_states_survive_a_new_mesh(monkeypatch, law: str, element: str, hot: bool) -> None:
    """Every array that is a field is given a linear state: it is found on the new mesh to 1e-10 of its size.

    The stress stays far below the flow stress, so that no law scales it. Where heat is conducted, the temperature of
    the points follows that of the nodes.
    """
    recording = first_increment(forging(LAWS[law], element=element, hot=hot))
    before = recording.procedure
    state, mesh = before.state, before.model.mesh
    position = mesh.points + state.nodes.displacement
    at_points = place(before.model, position)
    for arrays in state:
        for name, becomes in arrays.on_new_mesh.items():
            values = getattr(arrays, name)
            if becomes.kind == "point":
                for own in _list_blocks(values):
                    own[:] = linear(at_points, own.shape[2:], 1e-2).reshape(own.shape)
            elif becomes.kind in ("node", "motion"):
                setattr(arrays, name, linear(position, values.shape[1:], 1.0))
            elif becomes.kind == "surface":
                along = np.moveaxis(values, becomes.axis, 0)
                along[:] = linear(position, along.shape[1:], 1.0)
    if state.cells.history[0].shape[2]:
        state.cells.find_kept(0, AXES)[:] = (0.6, 0.8)  # the directions of the law's axes, which stay unit vectors
    carried = {}

    def look(run_n, run, carrier):
        real(run_n, run, carrier)
        carried["state"], carried["run"] = run.state.duplicate(), run

    real = carrying.carry_surface
    monkeypatch.setattr(carrying, "carry_surface", look)
    monkeypatch.setattr("presswork.implicit.heat_of_forming.HeatOfForming.keep_stored", lambda *_: None)
    recording.observers.find(NewMeshes).remesh("asked for")
    after, run = carried["state"], carried["run"]
    mesh = run.model.mesh
    at_points = place(run.model, mesh.points)
    on_line = np.unique(mesh.boundary_edges)
    seen = 0
    for arrays in after:
        for name, becomes in arrays.on_new_mesh.items():
            values = getattr(arrays, name)
            if becomes.kind == "point" and _list_blocks(values) and not (hot and name == "temperature"):
                found = np.concatenate([v.reshape(len(at_points), -1) for v in _list_blocks(values)], axis=1)
                wanted = [
                    linear(at_points, v.shape[2:], 1e-2).reshape(len(at_points), -1) for v in _list_blocks(values)
                ]
                wanted = np.concatenate(wanted, axis=1)
                if name == "history":
                    wanted[..., after.cells.kept[0][AXES]] = (0.6, 0.8)
            elif becomes.kind in ("node", "motion"):
                found, wanted = values, linear(mesh.points, values.shape[1:], 1.0)
            elif becomes.kind == "surface":
                found = np.moveaxis(values, becomes.axis, 0)
                wanted = linear(mesh.points, found.shape[1:], 1.0)
                # a boundary that bends is a cubic: on straight sides the arc is the place
                straight = np.isclose(mesh.points[:, 1], mesh.points[:, 1].max(), atol=1e-9)
                own = on_line[straight[on_line]]
                found, wanted = found[own], wanted[own]
            else:
                continue
            seen += 1
            assert np.abs(found - wanted).max() < 1e-10 * np.abs(wanted).max(), f"{arrays.owner}.{name}"
    assert seen >= 3 + 2 * hot + (law != "von Mises")


def _list_blocks(values: Any) -> list[FloatArray]:
    """Return the arrays of the only block that hold anything, of every name."""
    return [of[0] for of in (values.values() if isinstance(values, dict) else [values]) if of[0].size]


def place(model: Model, position: FloatArray) -> FloatArray:
    """Integration points of the only block (n, 2), by the shape functions of the element."""
    shapes = PointShapes(model)
    return np.stack([shapes.to_points(0, position[:, k]).ravel() for k in (0, 1)], axis=1)


def test_friction_goes_along_per_area_and_nothing_else_of_a_run_changes() -> None:
    recording = first_increment(forging())
    before = recording.procedure
    force_n = before.state[ContactArrays].drag.sum()
    run_n = {(a.owner, n): np.array(getattr(a, n)) for a in before.state for n, k in a.on_new_mesh.items() if k == RUN}
    seen = {}
    real = carrying.carry_surface

    def look(old, new, carrier):
        real(old, new, carrier)
        seen["state"] = new.state.duplicate()

    carrying.carry_surface = look
    try:
        assert recording.observers.find(NewMeshes).remesh("asked for")
    finally:
        carrying.carry_surface = real
    assert seen["state"][ContactArrays].drag.sum() == pytest.approx(force_n, rel=0.05)
    for arrays in seen["state"]:
        for name, becomes in arrays.on_new_mesh.items():
            if becomes == RUN:
                assert np.array_equal(getattr(arrays, name), run_n[arrays.owner, name]), f"{arrays.owner}.{name}"


def test_heat_is_kept_to_round_off_and_even_temperatures_stay() -> None:
    recording = first_increment(forging(hot=True))
    heat = recording.procedure.heat
    stored, span = (
        heat.forming.stored(recording.procedure.state[HeatArrays]),
        np.ptp(recording.procedure.state[HeatArrays].temperature),
    )
    assert span > 50.0
    assert recording.observers.find(NewMeshes).remesh("asked for")
    after = recording.procedure
    assert after.heat.forming.stored(after.state[HeatArrays]) == pytest.approx(stored, rel=1e-12)
    columns = after.state[HeatArrays].columns
    assert columns.max() > 210.0, "the steel behind the surface stays warm"
    after.state[HeatArrays].temperature[:] = 400.0
    recording.made_at = -1
    assert recording.observers.find(NewMeshes).remesh("asked for again")
    even = recording.procedure.state[HeatArrays].temperature
    assert np.ptp(even) < 1e-10


@dataclass
class ForgottenArrays(Arrays):
    owner = "forgotten"
    value: FloatArray
    """(n_points,)"""


def test_a_run_with_an_array_that_says_nothing_is_refused() -> None:
    recording = first_increment(forging())
    state = recording.procedure.state
    assert not find_undeclared(state)
    state.add(ForgottenArrays(np.zeros(3)))
    assert find_undeclared(state) == ["forgotten.value"]
    model = build_model(forging())
    real = bodies_in_plane.find_undeclared
    bodies_in_plane.find_undeclared = lambda _: ["forgotten.value"]
    try:
        with pytest.raises(StartError, match=r"forgotten\.value"):
            begin_forming(model, threads=1)
    finally:
        bodies_in_plane.find_undeclared = real


def test_arrays_found_anew_are_those_that_equilibrium_or_the_mesh_gives() -> None:
    """They are zero or at rest before equilibrium is found, and none of them is afterwards where it was not before."""
    recording = first_increment(forging())
    before = recording.procedure.state
    filled = {(a.owner, n) for a in before for n, k in a.on_new_mesh.items() if k == ANEW and _is_filled(getattr(a, n))}
    assert recording.observers.find(NewMeshes).remesh("asked for")
    after = recording.procedure.state
    again = {(a.owner, n) for a in after for n, k in a.on_new_mesh.items() if k == ANEW and _is_filled(getattr(a, n))}
    assert filled - again <= {("nodes", "displacement")}, "displacements begin anew"


def _is_filled(value: Any) -> bool:
    return any(np.any(v) for v in value) if isinstance(value, list) else bool(np.any(value))
