# SPDX-License-Identifier: Apache-2.0
"""Solids in space on the host build of the code for cards: the same run as by the CPU, with every law."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.body.laws_of_solids import make_law
from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.evolution.damage import DamageLaw
from presswork.explicit.device import Device
from presswork.explicit.dynamics import RENEWAL
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.shells import ExplicitShells, Precision, ShellOptions
from presswork.explicit.space import SpaceDynamics
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.geometry.tool_surface import make_surface
from presswork.model import Damage, Plane, SolverSettings
from presswork.observe.memory.of_model import list_memories
from presswork.outcome import StartError
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.recorder import run_model
from tests.consistency.test_device_laws import law_of as sheet_law
from tests.consistency.test_device_resident import HANDFUL, LITTLE
from tests.consistency.test_explicit_shells import mesh as mesh_of_shells
from tests.consistency.test_matrix import BASE, FEATURES, REFUSED, USER, solid_case, space_case
from tests.consistency.test_mixed_dynamics import set_going, shells_of, solids_of
from tests.problems import space_solids
from tests.regression.whole_runs import run_to_end, stop_after
from tests.verification.test_explicit_tools_in_space import BLOCK, DISC, to_explicit

ELEMENTS = ("hex8_1pt", "tet4_nodal")
CYCLES = 60
AGREEMENT = 1e-11
"""Of the largest value: round-off, and what Newton's method leaves of a flow stress."""
WHOLE_RUN = 1e-7
"""Of the largest value of a whole run."""
LAWS = [name for name in FEATURES if name not in USER and (name, "implicit space") not in REFUSED]


def law_of(feature: str) -> Any:
    case = SpaceCase.model_validate(space_case({**BASE, **FEATURES[feature]}))
    return make_law(build_model(case).materials[0], SolverSettings(), 6)


def press(device: Device, element: str, law: Any, n: int = 3, **of_material: Any) -> ExplicitSpaceSolids:
    """Press a distorted box between two tools with friction, one side held by a plane askew; some mass added."""
    mesh = space_solids.box(element, (3.0, 3.0, 3.0), (n, n, n), distort=0.1)  # type: ignore[arg-type]
    run = ExplicitSpaceSolids(mesh, [SpaceMaterial(law, 2.7e-9, **of_material)], device=device)
    low, high = (make_surface(Plane((0.0, 0.0, side)), smooth=True) for side in (1.0, -1.0))
    run.add_wall("low", low, mu=0.1)
    run.add_wall("high", high, position=(0.0, 0.0, 3.0), mu=0.2).velocity = (0.0, 0.0, -4e4)
    on_side = np.flatnonzero(mesh.points[:, 0] == 0.0)
    run.fix_normal(on_side, np.array([0.8, 0.6, 0.0]))
    run.velocity = np.random.default_rng(5).uniform(-2e3, 2e3, mesh.points.shape)
    run.scale_mass(1.3 * run.stable_step())
    return run


def everything(run: ExplicitSpaceSolids) -> list[np.ndarray]:
    e = run.energies()
    kinds = [e.internal, e.hourglass, e.kinetic, e.external, e.damping, e.contact, e.friction]
    found = [run.position, run.velocity, run.stress, run.equivalent_plastic_strain, run.internal_force]
    walls = [x for wall in run._walls for x in (wall.impulse, wall.nodal_force, wall.pressed, wall.friction_work)]
    return [*found, run.reaction_impulse, np.array(kinds), *walls]


def compare(runs: list[ExplicitSpaceSolids], within: float) -> None:
    for expected, found in zip(*map(everything, runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=within * max(np.abs(expected).max(), 1e-300))


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("feature", LAWS)
def test_every_law_of_a_solid_runs_on_a_device(feature: str, element: str) -> None:
    """Motion, stress, history, forces and work of tools, reactions and energies after plastic flow."""
    law = law_of(feature)
    runs = [press(device, element, law, 2) for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES, damping=50.0)
    assert runs[0].equivalent_plastic_strain.max() > 0.01
    compare(runs, AGREEMENT)


@pytest.mark.parametrize("element", ELEMENTS)
def test_cells_are_computed_at_their_own_temperatures(element: str) -> None:
    law = law_of("adiabatic heating")
    runs = [press(device, element, law) for device in ("cpu", "host")]
    plain = press("cpu", element, law)
    for run in (*runs, plain):
        if run is not plain:
            run.degrees = [np.linspace(40.0, 500.0, len(run.stress))[:, None]]
        run.advance(CYCLES)
    assert np.abs(runs[0].stress - plain.stress).max() > 30.0
    compare(runs, AGREEMENT)


@pytest.mark.parametrize("element", ELEMENTS)
def test_threads_and_a_second_run_do_not_change_a_bit(element: str) -> None:
    before, law, found = _core.max_threads(), law_of("swift"), []
    for threads in (1, 2, 3, 3):
        _core.set_threads(threads)
        run = press("host", element, law, 11)
        run.advance(12)
        found.append(everything(run))
    _core.set_threads(before)
    for other in found[1:]:
        for a, b in zip(found[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize(("first", "second"), [("host", "host"), ("cpu", "host"), ("host", "cpu")])
def test_a_dump_goes_on_across_devices(first: Device, second: Device, element: str) -> None:
    law = law_of("all of them")
    whole, begun, resumed = (press(device, element, law) for device in (second, first, second))
    whole.advance(60)
    begun.advance(35)
    resumed.restore(begun.dump())
    resumed.advance(25)
    for expected, found in zip((whole.position, whole.stress), (resumed.position, resumed.stress), strict=True):
        if first == second:
            np.testing.assert_array_equal(found, expected)
        else:
            np.testing.assert_allclose(found, expected, rtol=0, atol=AGREEMENT * np.abs(expected).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_first_cell_that_fails_is_named_as_by_the_loop(element: str) -> None:
    """Two sides are pushed through each other: in one call, and the cycle is named."""
    told = []
    for device in ("cpu", "host"):
        mesh = space_solids.box(element, (3.0, 1.0, 1.0), (3, 1, 1))  # type: ignore[arg-type]
        run = ExplicitSpaceSolids(mesh, [SpaceMaterial(law_of("linear"), 2.7e-9)], device=device)
        run.fix("left", "uvw")
        run.fix("right", "u", -1e7)
        with pytest.raises(ExplicitError, match="turned inside out in cycle") as error:
            run.advance(50)
        told.append(str(error.value).split(": shorten")[0])  # the step that cells allow then is of no use
    assert told[0] == told[1]


def rows_of(case: dict[str, Any], device: str) -> list[dict[str, Any]]:
    case = copy.deepcopy(case)
    case["explicit"]["device"] = device
    taken = begin(build_model(SpaceCase(**case)), threads=1)
    return [taken.row(report) for report in taken.advance()]


def sector(motion: dict[str, Any]) -> dict[str, Any]:
    """Return a quarter with cyclic faces between a die that moves so and a lower one that rests on a spring."""
    case = to_explicit(DISC)
    case["workpiece"]["mesh"] |= {"angle": 90, "cells": [2, 2, 2]}
    case["boundary"] = {"cut": {"set": "last_plane", "cyclic": "first_plane"}}
    spring = {"stiffness": 4e5, "preload": 1e3, "direction": [0, 0, -1]}
    case["tools"]["low"] = {"shape": "plane", "normal": [0, 0, 1], "contact": "coulomb", "mu": 0.1, "spring": spring}
    case["stages"][0] |= {"duration": "40 us", "tools": {"die": motion}}
    return case | {"explicit": {"damping": 1e3}, "output": {"steps": 1, "rows": 4}}


def upset(**changes: Any) -> dict[str, Any]:
    case = to_explicit(BLOCK, target_step="0.4 us") | {"output": {"steps": 1, "rows": 6}}
    case["workpiece"]["mesh"]["cells"] = [3, 3, 3]
    return case | changes


RUNS: dict[str, dict[str, Any]] = {
    "turned": sector({"stroke": 0.4, "direction": [0, 0, -1], "turn": 10}),
    "pushed": sector({"force": 2e5, "direction": [0, 0, -1]}),
    "upset": upset(),
    "capped by shear": upset(
        tools={"die": BLOCK["tools"]["die"] | {"contact": "coulomb_capped", "m": 0.2, "mu": 0.3}}
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", RUNS)
def test_a_run_from_a_case_is_the_same_on_a_device(name: str) -> None:
    """Forces, ways, torques and energies of every row."""
    expected, found = (rows_of(RUNS[name], device) for device in ("cpu", "host"))
    assert len(expected) == len(found)
    for key, value in expected[-1].items():
        if not isinstance(value, float) or "second" in key:
            continue
        values = [np.array([row[key] for row in rows]) for rows in (expected, found)]
        np.testing.assert_allclose(
            values[1], values[0], rtol=0, atol=WHOLE_RUN * max(np.abs(values[0]).max(), 1e-6), err_msg=key
        )


@pytest.mark.parametrize("motion", ["turned", "pushed"])
def test_a_row_takes_back_places_reactions_and_stresses_alone(motion: str) -> None:
    """In a row that no checkpoint follows, where tools turn and forces and springs place them."""
    case = copy.deepcopy(RUNS[motion])
    case["workpiece"]["mesh"]["cells"], case["explicit"]["device"] = [4, 4, 4], "host"
    taken = begin(build_model(SpaceCase(**case)), threads=1)
    assert isinstance(taken, ExplicitForming)
    rows, solids, memories = taken.advance(), taken.solids, list_memories(taken.model)
    next(rows)
    memories.look(taken, {})
    before, cycle = solids.traffic, solids.cycle
    taken.row(next(rows))
    memories.look(taken, {})
    moved, calls = solids.traffic, -(-(solids.cycle - cycle) // RENEWAL)
    loose = 3 + 6 + 3 * len(taken.walls)  # places, velocities with spins, forces of tools that may hold a loose body
    looked_at = 8.0 * ((4 + 6 + loose) * len(solids.start) + (7 + 1) * len(solids.stress))  # 1: damage
    assert 0.0 <= moved.fetched - before.fetched - looked_at < LITTLE * calls
    assert moved.sent - before.sent < HANDFUL * calls


def test_what_a_row_sums_up_outlives_a_change_of_the_loop() -> None:
    """Where a state was kept on the device before: mass is added within a row."""
    case = copy.deepcopy(RUNS["turned"])
    case["explicit"]["device"] = "host"
    taken = begin(build_model(SpaceCase(**case)), threads=1)
    assert isinstance(taken, ExplicitForming)
    next(taken.advance())
    solids, wall = taken.solids, taken.walls[0]
    wall.begin_sums()
    solids.reset_reaction()
    solids.keep()
    solids.advance(20)
    expected = [wall.pressed, wall.friction_work, solids.reaction_impulse]
    assert all(values.any() for values in expected)
    solids.scale_mass(1.5 * solids.dt)
    for before, after in zip(expected, (wall.pressed, wall.friction_work, solids.reaction_impulse), strict=True):
        np.testing.assert_array_equal(after, before)


def test_a_run_begun_on_the_cpu_is_resumed_on_a_device(tmp_path: Any) -> None:
    case = upset()
    model = build_model(SpaceCase(**case))
    expected = run_to_end(model, tmp_path / "cpu")
    case["explicit"]["device"] = "host"
    on_host, folder = build_model(SpaceCase(**case)), tmp_path / "both"
    assert run_model(model, folder, threads=1, on_increment=stop_after(3)).status == "interrupted"
    outcome = run_model(on_host, folder, threads=1, resume=True)
    assert outcome.status == "completed", outcome.reason
    for key in ("die.force", "internal_energy"):
        values = expected.history[key]
        np.testing.assert_allclose(outcome.result.history[key], values, rtol=0, atol=WHOLE_RUN * np.abs(values).max())


def test_what_no_device_computes_of_solids_is_refused_before_it_starts() -> None:
    case = upset()
    case["explicit"]["device"] = "host"
    case["workpiece"]["element"] = "hex8_fbar"
    with pytest.raises(StartError, match="does not compute solids other than hex8_1pt and tet4_nodal"):
        begin(build_model(SpaceCase(**case)), threads=1)
    plane = solid_case({**BASE}, "explicit solids") | {"explicit": {"device": "cuda"}}
    with pytest.raises(CaseError, match=r"explicit\.device = \"cuda\": a mesh in the plane has too few cells"):
        build_model(Case.model_validate(plane))


@pytest.mark.parametrize("element", ELEMENTS)
def test_shells_and_solids_in_one_run_agree(element: str) -> None:
    """A skin on a block, beyond yield: shells and solids share nodes, and their blocks a cycle."""
    mesh = space_solids.box(element, (3.0, 3.0, 1.0), (3, 3, 1))  # type: ignore[arg-type]
    points, faces = mesh.points, mesh.boundary_faces
    blocks = [
        shells_of(faces[(points[faces, 2] == 1.0).all(axis=1)]),
        solids_of(mesh.blocks[0].connectivity, element, general=True),
    ]
    runs = [SpaceDynamics(points, blocks, device=device) for device in ("cpu", "host")]
    for run in runs:
        set_going(run, points)
        run.velocity = 3.0 * run.velocity
        run.advance(200)
    assert runs[0].solid_state(1).equivalent_plastic_strain.max() > 0.01
    for expected, found in zip(*([run.position, run.velocity, run.thickness] for run in runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=AGREEMENT * np.abs(expected).max())


CRITERIA: dict[str, dict[str, float]] = {
    "cockcroft_latham": {},
    "rice_tracey": {"factor": 0.283, "exponent": 1.5},
    "oyane": {"A": 0.4},
    "freudenthal": {},
    "johnson_cook": {
        "d1": 0.05,
        "d2": 3.4,
        "d3": -2.1,
        "d4": 0.002,
        "d5": 0.6,
        "reference_rate": 1.0,
        "reference": 20.0,
        "melting": 660.0,
    },
    "modified_mohr_coulomb": {"A": 740.0, "n": 0.15, "c1": 0.0345, "c2": 338.6, "c3": 1.1},
    "hosford_coulomb": {"a": 1.7, "b": 0.7, "c": 0.05, "n": 0.1},
    "bai_wierzbicki": {"d1": 0.6, "d2": 1.7, "d3": 0.3, "d4": 0.2, "d5": 0.8, "d6": 1.1},
}


@pytest.mark.parametrize("element", ELEMENTS)
def test_damage_of_solids_grows_on_a_device(element: str) -> None:
    """By every criterion, with a law that heats."""
    laws = tuple(DamageLaw(Damage(name, numbers)) for name, numbers in CRITERIA.items())  # type: ignore[arg-type]
    runs = [press(device, element, law_of("adiabatic heating"), damage=laws, start=40.0) for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES)
        run.advance(CYCLES)
    expected, found = (run.damage for run in runs)
    assert len(expected) == len(CRITERIA)
    for name, (values,) in expected.items():
        assert values.max() > 0.0
        np.testing.assert_allclose(found[name][0], values, rtol=0, atol=AGREEMENT * values.max(), err_msg=name)


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_damage_of_shells_grows_on_a_device(element: str, precision: Precision) -> None:
    points, cells = mesh_of_shells(4)
    laws = (DamageLaw(Damage("cockcroft_latham")), DamageLaw(Damage("johnson_cook", CRITERIA["johnson_cook"])))
    found = []
    for device in ("cpu", "host"):
        options = ShellOptions(element=element, n_points=3)  # type: ignore[arg-type]
        run = ExplicitShells(
            points, cells, 0.8, sheet_law("swift"), 2.7e-9, damage=laws, options=options, precision=precision,
            device=device,
        )  # fmt: skip
        run.fix(np.flatnonzero(points[:, 0] == 0), "uvwpqr")
        run.fix(np.flatnonzero(points[:, 0] == 48), "u", 20000.0)
        run.advance(CYCLES)
        found.append([np.asarray(values) for values in run.damage.values()])
    for expected, own in zip(*found, strict=True):
        assert expected.max() > 0.001
        within = 1e-9 if precision == "double" else 1e-4
        np.testing.assert_allclose(own, expected, rtol=0, atol=within * expected.max())
