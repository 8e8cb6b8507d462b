# SPDX-License-Identifier: Apache-2.0
"""A trimmed sheet springs back as beam theory has it, from stresses that are known in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, Material, Mesh, Stage, TrimLine
from presswork.process.line.released_model import ELEMENTS, hold_rigidly
from presswork.process.mesh_change.transfer import (
    SheetBlock,
    SheetState,
    begin_with,
    carry_to_explicit,
    sheet_of_explicit,
    sheet_of_implicit,
)
from presswork.process.mesh_change.trim import TrimmedSheet, trim_sheet
from tests.problems.bent_strip import INERTIA, YOUNG, bend, moment_of, steel, strip
from tests.problems.plane_solids import linear_hardening
from tests.problems.shells import patch, shell_model

BEYOND = 100.0
CURVATURE = 0.006
"""Three times that of first yield [1/mm]."""


def let_go(trimmed: TrimmedSheet, material: Material) -> ImplicitProcedure:
    """Return a procedure that has let the sheet go."""
    mesh = trimmed.mesh
    sets, held = dict(mesh.node_sets), []
    for node, (x, y, z) in hold_rigidly(mesh.points, (False, False)).items():
        sets[f"held_{node}"] = np.array([node], dtype=np.int32)
        held.append((f"held_{node}", (x, y, z, False, False, False)))
    mesh = Mesh(mesh.points, mesh.blocks, sets, mesh.edge_sets, mesh.boundary_edges)
    model = shell_model(mesh, material, held, stages=[Stage("release")], initial_increment=0.25, max_increment=0.25)
    procedure = ImplicitProcedure(model, threads=1)
    begin_with(trimmed.state, procedure)
    for _ in procedure.advance():
        pass
    return procedure


def curvature(along: FloatArray, up: FloatArray) -> float:
    """Curvature of the circle through points, by least squares."""
    centre, *_ = np.linalg.lstsq(np.column_stack([along, up, np.ones_like(up)]), along**2 + up**2, rcond=None)
    return float(1 / np.sqrt(centre[2] + 0.25 * (centre[0] ** 2 + centre[1] ** 2)))


@pytest.mark.parametrize("formed", ["implicit", "explicit"])
def test_a_piece_of_a_bent_strip_keeps_the_curvature_of_the_closed_form(formed: str) -> None:
    """A strip bent beyond yield, cut askew through its elements: k - M(k)/E I, whatever piece of it is let go."""
    mesh = strip(21, "lobatto", cells=16)
    _, procedure = bend(mesh, replace(steel(), density=7.85e-9), [CURVATURE])
    state = sheet_of_implicit(procedure)
    if formed == "explicit":
        state = SheetState(state.position, sheet_of_explicit(carry_to_explicit(procedure)).blocks)
    low, high = state.position[:, 0].min(), state.position[:, 0].max()
    line = np.array([[low + 1.1, -0.5], [high - 5.4, -0.5], [high - 2.2, 1.5], [low + 6.1, 1.5]])
    trimmed = trim_sheet(mesh, state, (TrimLine("piece", line, "inside"),), ELEMENTS)
    assert {b.connectivity.shape[1] for b in trimmed.mesh.blocks} == {3, 4}
    released = let_go(trimmed, steel())
    old = np.abs(trimmed.mesh.points[:, None] - mesh.points).max(axis=2).min(axis=1) < 1e-9
    points = (trimmed.mesh.points + released.state.nodes.displacement[:, :3])[old]  # new ones lie on chords
    kept = CURVATURE - moment_of(CURVATURE) / (YOUNG * INERTIA)
    assert kept < 0.6 * CURVATURE
    assert curvature(points[:, 0], points[:, 2]) == pytest.approx(kept, rel=1.5e-3)
    assert np.abs(released.state.nodes.reaction).max() < 1e-3, "nothing holds it"


WIDTH, HALF_LENGTH, PEAK = 8.0, 20.0, 60.0


def in_plane(cells: int) -> tuple[Mesh, SheetState]:
    """A strip along x with the stress PEAK (12 (y/b)^2 - 1) along it, in balance as a whole."""
    x, y = np.linspace(-HALF_LENGTH, HALF_LENGTH, 5 * cells + 1), np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, cells + 1)
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), x, y, thickness=1.0, points=3, rule="lobatto")
    block = mesh.blocks[0]
    middle = mesh.points[block.connectivity].mean(axis=1)
    stress = np.zeros((len(middle), 4, 3, 3))
    gauss = np.array([-1, -1, 1, 1]) * 0.5 * WIDTH / cells / np.sqrt(3)
    stress[..., 0] = (PEAK * (12 * ((middle[:, 1, None] + gauss) / WIDTH) ** 2 - 1))[:, :, None]
    axis = np.broadcast_to([1.0, 0.0, 0.0], (len(middle), 4, 3))
    history = np.zeros((len(middle), 4, 3, 1))
    return mesh, SheetState(
        mesh.points, (SheetBlock(block.connectivity, axis, np.ones((len(middle), 4)), stress, history),)
    )


def test_what_shells_have_once_for_all_points_leaves_the_points_their_own_stress() -> None:
    """Fully integrated explicit shells have one thickness and one axis, and stress at four points."""
    mesh, state = in_plane(8)
    (block,) = state.blocks
    once = replace(block, axis=block.axis[:, :1], thickness=block.thickness[:, :1])
    line = np.array([[-BEYOND, -3.0], [BEYOND, 5.0], [BEYOND, BEYOND], [-BEYOND, BEYOND]])
    lines = (TrimLine("strip", line, "inside"),)
    ours = trim_sheet(mesh, SheetState(mesh.points, (once,)), lines, ELEMENTS).state.blocks
    theirs = trim_sheet(mesh, state, lines, ELEMENTS).state.blocks
    assert {block.connectivity.shape[1] for block in ours} == {3, 4}
    for one, other in zip(ours, theirs, strict=True):
        for name in ("axis", "thickness", "stress", "history"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert np.ptp(ours[0].stress[:, :, 0, 0], axis=1).max() > 1.0, "stress differs from point to point"


@pytest.mark.parametrize(("cells", "tolerance"), [(8, 0.06), (16, 0.015), (24, 0.01)])
def test_a_strip_cut_lengthwise_out_of_a_stressed_sheet_bends_in_its_plane(cells: int, tolerance: float) -> None:
    """Elastic: N and M of what is kept, y > c, about its own middle are let go; k = -M/E I of the narrow strip."""
    cut = 0.13 * WIDTH
    elastic = Material("elastic", YOUNG, 0.0, linear_hardening(1e6, 0.0))
    mesh, state = in_plane(cells)
    line = np.array([[-BEYOND, cut], [BEYOND, cut], [BEYOND, BEYOND], [-BEYOND, BEYOND]])
    trimmed = trim_sheet(mesh, state, (TrimLine("strip", line, "inside"),), ELEMENTS)
    released = let_go(trimmed, elastic)
    y = np.linspace(cut, 0.5 * WIDTH, 20_001)
    stress, middle, width = PEAK * (12 * (y / WIDTH) ** 2 - 1), 0.5 * (cut + 0.5 * WIDTH), 0.5 * WIDTH - cut
    moment = np.trapezoid(stress * (y - middle), y)
    expected = moment / (YOUNG * width**3 / 12)
    edge = np.flatnonzero((trimmed.mesh.points[:, 1] > 0.5 * WIDTH - 1e-9) & (np.abs(trimmed.mesh.points[:, 0]) < 10))
    x, v = trimmed.mesh.points[edge, 0], released.state.nodes.displacement[edge, 1]
    found = 2 * np.polyfit(x, v, 2)[0]
    assert np.abs(released.state.nodes.reaction).max() < 1e-6 * PEAK * width
    assert found == pytest.approx(expected, rel=tolerance)
