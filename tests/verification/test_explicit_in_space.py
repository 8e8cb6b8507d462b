# SPDX-License-Identifier: Apache-2.0
"""Explicit hexahedra of one point and tetrahedra: patch test, rigid motion, frequencies, momentum, and the plane."""

from __future__ import annotations

import copy
import itertools

import numpy as np
import pytest

from presswork import _core, build_model
from presswork.body.laws_of_solids import make_law
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.space.drawn_up import mesh_turned
from presswork.model import Hardening, Material, Plane, SolverSettings
from presswork.process.begin import begin
from tests.problems import space_solids

DENSITY = 7.85e-9
STEEL = Material("steel", 200e3, 0.3, Hardening("swift", np.array([565.0, 0.007, 0.26])))
ELASTIC = Material("steel", 200e3, 0.3, Hardening("linear", np.array([1e9, 0.0])))


ELEMENTS = ["hex8_1pt", "tet4_nodal"]


def make_run(mesh, material: Material = STEEL, **given) -> ExplicitSpaceSolids:
    law = make_law(material, SolverSettings(), 6)
    return ExplicitSpaceSolids(mesh, [SpaceMaterial(law, DENSITY)], **given)


@pytest.mark.parametrize("element", ELEMENTS)
def test_distorted_cells_pass_the_patch_test(element) -> None:
    mesh = space_solids.box(element, (3.0, 2.0, 2.0), (3, 2, 2), distort=0.2)
    run = make_run(mesh, ELASTIC)
    gradient = 1e-6 / run.dt * np.array([[1.0, 0.4, -0.2], [0.3, -0.5, 0.1], [0.2, 0.6, 0.7]])
    run.velocity = mesh.points @ gradient.T
    run.advance(1)
    strain = 0.5e-6 * (gradient + gradient.T) * run.dt / 1e-6
    lame, shear = 200e3 * 0.3 / 1.3 / 0.4, 200e3 / 2.6
    exact = lame * np.trace(strain) * np.eye(3) + 2 * shear * strain
    found = run.stress
    np.testing.assert_allclose(found[:, :3], np.tile(np.diag(exact), (len(found), 1)), rtol=1e-5)
    np.testing.assert_allclose(found[:, 3], exact[0, 1], rtol=1e-4)
    inside = np.setdiff1d(np.arange(len(mesh.points)), np.unique(mesh.boundary_faces))
    force = run.internal_force[:, :3]
    assert np.abs(force[inside]).max() < 1e-9 * np.abs(force).max()


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_rigid_rotation_leaves_no_stress_and_turns_what_there_is(element) -> None:
    mesh = space_solids.box(element, (2.0, 2.0, 2.0), (2, 2, 2), distort=0.2)
    run = make_run(mesh, ELASTIC)
    turn = np.radians(1.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    for _ in range(90):
        x = run.position
        run.velocity = (x @ rotation.T - x) / run.dt
        run.fix("all", "uvw", 0.0)
        for axis, letter in enumerate("uvw"):
            run.fix("all", letter, run.velocity[:, axis])
        run.advance(1)
    np.testing.assert_allclose(run.position[:, 0], -mesh.points[:, 1], atol=1e-9)
    assert np.abs(run.stress).max() < 1e-6


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("distort", [0.0, 0.2])
def test_the_bound_of_the_frequency_is_that_of_the_cells(element, distort: float) -> None:
    """Above the highest frequency of a cube, found from its own elastic matrix; for one hexahedron it is that."""
    mesh = space_solids.box(element, (2.0, 2.0, 2.0), (1, 1, 1))
    points = mesh.points + distort * np.random.default_rng(3).uniform(-1, 1, mesh.points.shape)
    mesh = space_solids.finish_mesh(points, mesh.blocks[0].connectivity, {}, element, 0)
    run = make_run(mesh, ELASTIC)
    bound = float(run.bound_frequencies().max())
    n, mass = 24, np.repeat(run.mass, 3)
    stiffness = np.empty((n, n))
    for j in range(n):
        step = np.zeros((8, 6))
        step[j // 3, j % 3] = 1e-7
        stiffness[:, j] = run.trial_force(step)[:, :3].ravel() / 1e-7
    highest = np.linalg.eigvals(stiffness / mass[:, None]).real.max()
    assert highest < bound * (1 + 1e-6)
    if distort == 0.0 and element == "hex8_1pt":
        assert highest > 0.9 * bound


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_body_in_flight_keeps_its_momentum_and_energy(element) -> None:
    mesh = space_solids.box(element, (3.0, 2.0, 2.0), (6, 4, 4), distort=0.2)
    run = make_run(mesh)
    rng = np.random.default_rng(1)
    run.velocity = np.array([3e4, -2e4, 1e4]) + 3e4 * rng.standard_normal(mesh.points.shape)

    def momenta() -> np.ndarray:
        moved = run.mass[:, None] * run.velocity
        middle = run.position - 0.5 * run.dt * run.velocity
        return np.concatenate([moved.sum(axis=0), np.cross(middle, moved).sum(axis=0)])

    start = momenta()
    run.run_to(20e-6)
    assert run.equivalent_plastic_strain.max() > 0.02
    np.testing.assert_allclose(momenta()[:3], start[:3], rtol=1e-9)
    np.testing.assert_allclose(momenta()[3:], start[3:], atol=2e-3 * np.abs(start).max())
    balance = run.energies()
    assert abs(balance.error_percent) < 1.0


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_and_a_restart_give_the_same_bits(element, threads: int) -> None:
    mesh = mesh_turned(np.full(13, 3.2), None, np.linspace(0, 6, 13), angle=90.0, cells=(9, 12), element=element)

    def start() -> ExplicitSpaceSolids:
        run = make_run(mesh)
        run.fix("left", "u")
        run.fix("bottom", "v")
        run.add_wall("anvil", make_surface(Plane((0.0, 0.0, 1.0)), smooth=True), mu=0.1)
        run.set_velocity("all", (0.0, 0.0, -200e3))
        return run

    before = _core.max_threads()
    try:
        _core.set_threads(1)
        whole = start()
        whole.advance(60)
        _core.set_threads(threads)
        part = start()
        part.advance(25)
        resumed = start()
        resumed.restore(part.dump())
        resumed.advance(35)
    finally:
        _core.set_threads(before)
    one, other = whole.dump(), resumed.dump()
    differ = [name for name in one if name != "run.energy" and one[name].tobytes() != other[name].tobytes()]
    assert not differ
    assert whole.equivalent_plastic_strain.max() > 0.01


BAR = {
    "title": "a bar strikes an anvil",
    "procedure": "explicit",
    "workpiece": {"material": "steel"},
    "materials": {
        "steel": {
            "young": "206.9 GPa", "poisson": 0.3, "density": "7830 kg/m^3",
            "hardening": {"law": "ludwik", "yield_stress": 806, "K": 614, "n": 0.168},
            "rate": {"law": "johnson_cook", "C": 0.0089, "reference_rate": 1},
            "heating": {"melting": 1540, "exponent": 1.1, "heat_capacity": "460 J/(kg*K)"},
        }
    },
    "stages": [{"name": "impact", "duration": "40 us"}],
    "output": {"steps": 1, "rows": 10},
}  # fmt: skip


def end_of(case: Case | SpaceCase):
    run = begin(build_model(case), threads=2)
    rows = [run.row(report) for report in run.advance()]
    return run, rows


def test_taylor_bar_of_hexahedra_is_that_of_axisymmetry() -> None:
    compare_taylor_bars("hex8_1pt")


def compare_taylor_bars(element: str) -> None:
    """Compare a bar in space with one of axisymmetry; of tetrahedra, validation/test_taylor_bar.py does."""
    bar = copy.deepcopy(BAR)
    flat = copy.deepcopy(bar) | {"analysis": "axisymmetric"}
    flat["workpiece"] |= {
        "element": "quad4_1pt",
        "velocity": [0, "-287 m/s"],
        "mesh": {"size": [3.2, 32.4], "cells": [6, 60]},
    }
    flat["tools"] = {"anvil": {"profile": [[-1, 0], [20, 0]], "contact": "frictionless"}}
    flat["boundary"] = {"axis": {"set": "left", "fix": ["x"]}}
    space = copy.deepcopy(bar) | {"analysis": "solid"}
    # as thick as the polygon that its cells are is as large as the circle
    turn = np.pi / 2 / 8
    radius = 3.2 * np.sqrt(turn / np.sin(turn))
    space["workpiece"] |= {
        "element": element,
        "velocity": [0, 0, "-287 m/s"],
        "mesh": {"kind": "cylinder", "radius": radius, "height": 32.4, "angle": 90, "cells": [6, 8, 60]},
    }
    space["tools"] = {"anvil": {"shape": "plane", "normal": [0, 0, 1], "contact": "frictionless"}}
    space["boundary"] = {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}}
    plane, in_space = end_of(Case(**flat)), end_of(SpaceCase(**space))
    one, other = plane[1][-1], in_space[1][-1]
    assert other["z_max"] == pytest.approx(one["y_max"], rel=0.005)
    foot = np.sqrt(np.abs(_foot_area(in_space[0])) * 4 / np.pi)
    assert foot == pytest.approx(one["x_max"], rel=0.02)
    assert one["x_max"] > 5.0
    forces = [sum(row["anvil.force"] for row in rows) for rows in (plane[1], in_space[1])]
    assert forces[1] == pytest.approx(forces[0], rel=0.01)
    assert abs(other["energy_error_percent"]) < 0.5


def _foot_area(run) -> float:
    """Return the area of the lower end's outline (n, 2)."""
    model, x = run.model, run.solids.position
    faces = model.mesh.face_sets["back"]
    corners = x[faces][..., :2]
    after = np.roll(corners, -1, axis=1)
    return float(0.5 * (corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum())


BLOCK = {
    "title": "a block is upset",
    "analysis": "solid",
    "workpiece": {"material": "steel", "mesh": {"size": [10, 10, 7.5], "cells": [6, 6, 5]}},
    "materials": {
        "steel": {
            "young": 200e3, "poisson": 0.3, "density": "7850 kg/m^3",
            "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26},
        }
    },
    "tools": {
        "die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 7.5], "contact": "coulomb", "mu": 0.1}
    },
    "boundary": {
        "x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}, "z": {"set": "back", "fix": ["z"]},
    },
    "stages": [{"name": "press", "duration": "1 ms", "tools": {"die": {"stroke": 4, "direction": [0, 0, -1]}}}],
    "output": {"steps": 1},
}  # fmt: skip


FRICTION = {
    "coulomb": {"contact": "coulomb", "mu": 0.1},
    "shear": {"contact": "shear", "m": 0.3},
    "coulomb_capped": {"contact": "coulomb_capped", "mu": 0.2, "m": 0.2},
}


@pytest.mark.parametrize("law", FRICTION)
def test_block_upsetting_is_that_of_the_implicit_procedure(law) -> None:
    block = copy.deepcopy(BLOCK)
    block["tools"]["die"] = {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 7.5], **FRICTION[law]}
    slow = begin(build_model(SpaceCase(**block)), threads=2)
    implicit = [slow.row(report) for report in slow.advance()]
    case = copy.deepcopy(block) | {"procedure": "explicit"}
    case["output"] = {"steps": 1, "rows": 40}
    case["explicit"] = {"target_step": "0.4 us"}
    fast, rows = end_of(SpaceCase(**case))
    assert rows[-1]["added_mass_percent"] > 10.0
    strokes, forces = (np.array([row[f"die.{name}"] for row in implicit]) for name in ("stroke", "force"))
    for row in rows[19:36]:  # at the end of a row stands the mean force over it
        middle = row["die.stroke"] - 0.5 * (row["die.stroke"] - rows[rows.index(row) - 1]["die.stroke"])
        assert row["die.force"] == pytest.approx(np.interp(middle, strokes, forces), rel=0.02)
    shape = slow.procedure.state.nodes.displacement + slow.model.mesh.points
    np.testing.assert_allclose(fast.solids.position.max(axis=0), shape.max(axis=0), rtol=0.005)
    assert abs(rows[-1]["energy_error_percent"]) < 1.0


@pytest.mark.validation
def test_tetrahedra_are_upset_as_by_the_implicit_procedure() -> None:
    """Against hexahedra: 6 x 6 x 5 cells cut into six, whose linear tetrahedra are stiffer."""
    slow = begin(build_model(SpaceCase(**BLOCK)), threads=2)
    implicit = [slow.row(report) for report in slow.advance()]
    case = copy.deepcopy(BLOCK) | {"procedure": "explicit", "output": {"steps": 1, "rows": 40}}
    case["workpiece"] |= {"element": "tet4_nodal"}
    case["explicit"] = {"target_step": "0.2 us"}
    fast, rows = end_of(SpaceCase(**case))
    strokes, forces = (np.array([row[f"die.{name}"] for row in implicit]) for name in ("stroke", "force"))
    for before, row in itertools.pairwise(rows[19:36]):
        middle = 0.5 * (row["die.stroke"] + before["die.stroke"])
        assert row["die.force"] == pytest.approx(np.interp(middle, strokes, forces), rel=0.04)
    shape = slow.procedure.state.nodes.displacement + slow.model.mesh.points
    np.testing.assert_allclose(fast.solids.position.max(axis=0), shape.max(axis=0), rtol=0.01)
    assert abs(rows[-1]["energy_error_percent"]) < 1.0


def test_a_crank_press_drives_an_explicit_solid_in_space() -> None:
    """The ram slows down towards its bottom as the crank has it; force at equal stroke that of a given speed."""
    case = copy.deepcopy(BLOCK) | {"procedure": "explicit", "output": {"steps": 1, "rows": 20}}
    case["explicit"] = {"target_step": "0.4 us"}
    plain = end_of(SpaceCase(**case))[1]
    case["presses"] = {"crank": {"kind": "crank", "stroke": 60, "rpm": 12000, "rod_ratio": 0.1}}
    case["stages"] = [{"name": "press", "press": "crank", "tools": {"die": {"stroke": 4, "direction": [0, 0, -1]}}}]
    driven = end_of(SpaceCase(**case))[1]
    speeds = np.diff([row["die.stroke"] for row in driven]) / np.diff([row["time"] for row in driven])
    assert speeds[-1] < 0.2 * speeds[0]
    assert driven[-1]["die.stroke"] == pytest.approx(4.0, rel=1e-3)
    middle = [
        np.interp(3.0, *zip(*[(r["die.stroke"], r["die.force"]) for r in rows], strict=True))
        for rows in (plain, driven)
    ]
    assert middle[1] == pytest.approx(middle[0], rel=0.05)
