# SPDX-License-Identifier: Apache-2.0
"""Snap-through of the hinged roof by arc length, against the tables of Sze, Liu & Lo (2004)."""

from __future__ import annotations

import contextlib
import itertools
from dataclasses import replace

import numpy as np
import pytest

from presswork.implicit.arc_length import ArcLengthProcedure
from presswork.implicit.progress import Progress
from presswork.implicit.remedy import find_remedy
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import ElementName, Model, PrescribedDisplacement, Stage
from presswork.outcome import GaveUpError
from tests.problems.plane_solids import elastic
from tests.problems.shells import X, Y, Z, fixing, patch, shell_model, symmetry
from tests.verification.test_shell_large_rotation import TABLES, lines, pinched_cylinder


def hinged_roof(thickness: float, n: int, element: ElementName = "shell4_mitc_plus", **solver: object) -> Model:
    """A quarter: u = 0 the middle of its length along y, v = 0 the crown; straight edges hinged, ends free."""
    radius = 2540.0
    mesh = patch(
        lambda u, v: np.column_stack([radius * np.sin(v), u, radius * np.cos(v)]),
        lines(254.0, n), lines(0.1, n), element=element, thickness=thickness,
        normal=lambda u, v: np.column_stack([np.sin(v), 0 * u, np.cos(v)]),
    )  # fmt: skip
    held = [("left", symmetry(Y)), ("bottom", symmetry(X)), ("top", fixing(X, Y, Z))]
    return shell_model(mesh, elastic(3102.75, 0.3), held, forces=[("bottom_left", (0, 0, -750.0))], **solver)


def follow(model: Model) -> np.ndarray:
    """Load fraction and deflection under the load, point by point."""
    procedure = ArcLengthProcedure(model, threads=1)
    node = model.mesh.node_sets["bottom_left"]
    path = [(0.0, 0.0)]
    for report in procedure.advance():
        path.append((report.fraction, -float(procedure.state.nodes.displacement[node, Z].mean())))
    return np.array(path)


@pytest.mark.parametrize(("thickness", "element", "n", "first", "tolerance"), [
    (12.7, "shell4_mitc_plus", 8, 0.02, 0.012), (6.35, "shell9_mitc", 4, 0.002, 0.004),
])  # fmt: skip
def test_hinged_roof(thickness, element, n, first, tolerance) -> None:
    """Every tabulated point lies on our path: distance over the path's extent in load and deflection."""
    path = follow(hinged_roof(thickness, n, element, initial_increment=first, target_iterations=4))
    table = np.array(TABLES["hinged_roof"][f"thickness_{thickness:g}"])
    table = table[table[:, 0] <= 1.0]
    extent = np.ptp(table, axis=0)
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in itertools.pairwise(path)]) / extent
    distance = np.linalg.norm(table[:, None] / extent - dense, axis=2).min(axis=1)
    assert distance.max() < tolerance


def test_arc_length_passes_both_limit_loads() -> None:
    path = follow(hinged_roof(12.7, 8, initial_increment=0.02, target_iterations=4))
    peak = path[:, 0][: int(np.argmax(path[:, 1] > 14.0))].max()
    assert peak == pytest.approx(0.7421, rel=0.01)
    assert path[(path[:, 1] > 15) & (path[:, 1] < 25), 0].min() == pytest.approx(0.1729, rel=0.05)
    assert path[-1, 0] == pytest.approx(1.0, abs=1e-9)


def test_load_control_jumps_over_the_path_between_the_limit_loads() -> None:
    model = hinged_roof(12.7, 8, initial_increment=0.05, max_increment=0.05)
    procedure = ImplicitProcedure(model, threads=1)
    node = model.mesh.node_sets["bottom_left"]
    deflections = [0.0]
    with contextlib.suppress(GaveUpError):
        for _ in procedure.advance():
            deflections.append(-float(procedure.state.nodes.displacement[node, Z].mean()))
    assert not any(12.0 < d < 24.0 for d in deflections)


def test_arc_length_does_not_follow_the_path_backwards() -> None:
    """The pinched cylinder on 16 x 16 cells turns at 43.4 mm, so sharply that a long arc meets the way it came."""
    model = pinched_cylinder(16, control="arc_length", initial_increment=0.02)
    procedure = ArcLengthProcedure(model, threads=1)
    node = model.mesh.node_sets["bottom_left"]
    down = [
        -float(procedure.state.nodes.displacement[node, Z].mean()) for _ in itertools.islice(procedure.advance(), 42)
    ]
    assert 42.0 < max(down[:32]) < 44.0
    assert min(down[32:]) > 41.5
    assert down[-1] > max(down[:32]), "and on"


def test_arc_length_unloads_where_a_stage_gives_no_load() -> None:
    """Its lower limit load is above zero: an elastic roof that has snapped through comes all the way back."""
    model = hinged_roof(12.7, 4, initial_increment=0.02)
    model = replace(model, stages=(model.stages[0], Stage("off")))
    procedure = ArcLengthProcedure(model, threads=1)
    steps = sum(1 for _ in itertools.islice(procedure.advance(), 100))
    assert procedure.state[Progress].stage == 2
    assert steps < 100
    assert np.abs(procedure.state.nodes.displacement[:, :3]).max() < 1e-3


@pytest.mark.parametrize("target", [3, 4, 6, 8, 10])
def test_arc_length_takes_few_increments_whatever_the_iterations_aimed_at(target) -> None:
    """Arcs of 3 and 4 iterations would be hundreds, or shrink to nothing: even short arcs take nearly as many."""
    path = follow(hinged_roof(6.35, 4, initial_increment=0.02, target_iterations=target))
    assert path[-1, 0] == pytest.approx(1.0, abs=1e-9)
    assert 12 < len(path) < 50


@pytest.mark.parametrize("increment", [0.18, 0.2, 0.22, 0.25, 0.33, 1.0])
def test_increments_of_any_size_come_to_the_stable_branch(increment) -> None:
    """The thin roof snaps at 0.2 of the load. Newton's method would go on from there along an unstable branch to 35.9.

    The pinched cylinder does so, too (validation/test_shells.py).
    """
    model = hinged_roof(6.35, 4, initial_increment=increment, max_increment=increment)
    procedure = ImplicitProcedure(model, threads=1)
    assert [report.fraction for report in procedure.advance()][-1] == 1.0
    deflection = -float(procedure.state.nodes.displacement[model.mesh.node_sets["bottom_left"], Z].mean())
    load, table = np.array(TABLES["hinged_roof"]["thickness_6.35"])[-2:].T
    assert deflection == pytest.approx(np.interp(1.0, load, table), rel=0.021)


def test_a_stop_at_a_limit_load_names_its_remedy() -> None:
    """The thin roof: control by load stops at the limit load that arc length passes; few iterations, lest it jumps."""
    limit = 0.2040
    model = hinged_roof(6.35, 4, initial_increment=0.01, max_increment=0.01, min_increment=1e-4, max_iterations=7)
    procedure = ImplicitProcedure(model, threads=1)
    advice = r"negative pivot.*reaches a limit.*solver\.control = \"arc_length\".*or set solver\.inertia = 1"
    with pytest.raises(GaveUpError, match=advice):
        list(procedure.advance())
    assert procedure.state[Progress].fraction == pytest.approx(limit, rel=2e-3)
    path = follow(replace(model, solver=replace(model.solver, control="arc_length", max_iterations=20)))
    falls = int(np.argmax(np.diff(path[:, 0]) < 0.0))
    assert path[falls, 0] == pytest.approx(limit, rel=2e-2)
    assert path[-1, 0] == pytest.approx(1.0, abs=1e-9)


def test_arc_length_is_advised_to_shells_under_loads_alone() -> None:
    model = hinged_roof(6.35, 2)
    pushed = replace(model.stages[0], forces=(), prescribed=(PrescribedDisplacement("bottom_left", Z, -1.0),))
    assert "arc_length" in find_remedy(model, 1)
    assert "arc_length" not in find_remedy(replace(model, stages=(pushed,)), 1)
    assert "Set solver.inertia = 1" in find_remedy(replace(model, stages=(pushed,)), 2)
    assert "finer mesh" in find_remedy(model, 0)
