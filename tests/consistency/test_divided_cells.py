# SPDX-License-Identifier: Apache-2.0
"""Cells divided over ranks give the forces, the state and the matrix of all cells by one process."""

import numpy as np
import pytest

from presswork import _core
from presswork.body.divided_solids import DividedMechanics
from presswork.body.make import make_mechanics
from presswork.body.shells import ShellFailed
from presswork.body.solids import Mechanics
from presswork.body.turned_inside_out import TurnedInsideOut
from presswork.model import Stage
from presswork.outcome import Step
from presswork.timing import Timing
from tests.problems.bent_strip import steel
from tests.problems.rank_threads import on_ranks
from tests.problems.shells import CLAMPED, patch, shell_model
from tests.problems.space_solids import SYMMETRY, box, make_model
from tests.unit.contact.shapes import box_triangles

STEP = Step(0, 0.0, 1.0, 1, 0.0, 1.0, 0.0)


def _model(element, *, symmetric=True):
    if element.startswith("shell"):
        return _sheet(element, symmetric)
    mesh = box(element, (3.0, 2.0, 2.0), (3, 2, 2), distort=0.1)
    return make_model(mesh, SYMMETRY, Stage("press"), symmetric=symmetric)


def _sheet(element, symmetric):
    def bend(u, v):
        return np.column_stack([u, v, 0.1 * u**2 + 0.05 * u * v])

    mesh = patch(bend, np.linspace(0.0, 3.0, 5), np.linspace(0.0, 2.0, 4), thickness=0.1, points=3, element=element)
    return shell_model(mesh, steel(), [("left", CLAMPED)], stages=[Stage("press")], symmetric=symmetric)


def _fill(mechanics, model, squeeze=-0.05):
    """Evaluate a squeezed body; return force, state, assembled values and right-hand side of prescribed freedoms."""
    state = mechanics.at_rest()
    trial = state.duplicate()
    increment = np.zeros_like(state.nodes.displacement)
    increment[:, :3] = squeeze * model.mesh.points[:, [1, 2, 0]]
    mechanics.begin_increment(state, STEP)
    force = mechanics.evaluate(state, trial, increment, with_stiffness=True, dt=1.0)
    if isinstance(force, TurnedInsideOut | ShellFailed):
        return force
    mechanics.complete(trial)
    n, f = force.shape
    assembler = mechanics.assembler
    data = np.zeros(len(assembler.indices))
    turned, frames = np.zeros(n, dtype=np.uint8), np.zeros((n, min(f, 3), min(f, 3)))
    turned[::3] = 1
    frames[:] = np.linalg.qr(np.random.default_rng(3).normal(size=frames.shape[1:]))[0]
    mechanics.assemble_stiffness(turned, frames, data)
    corner = model.mesh.blocks[0].connectivity[:, :2].astype(np.int32)  # pairs of nodes as a load that follows has
    blocks = np.random.default_rng(5).normal(size=(len(corner), f, f))
    assembler.add_blocks(np.ascontiguousarray(corner), blocks, turned, frames, data)
    mask = np.zeros((n, f), dtype=np.uint8)
    mask[::4, 1] = 1
    rhs = np.zeros(n * f)
    assembler.constrain(mask.reshape(-1), np.full(n * f, 0.3), 7.0, data, rhs)
    return force, trial, data, rhs


@pytest.mark.parametrize("element", ["hex8_fbar", "tet4_mini", "tet10", "shell4_mitc_plus", "shell3_mitc_plus"])
@pytest.mark.parametrize("symmetric", [True, False])
def test_ranks_together_have_the_forces_the_state_and_the_matrix_of_one_process(element, symmetric):
    model = _model(element, symmetric=symmetric)
    whole = make_mechanics(model, Timing("assembly"))
    force, trial, data, rhs = _fill(whole, model)
    start, columns = whole.assembler.indptr, whole.assembler.indices

    def work(world):
        mechanics = make_mechanics(model, Timing("assembly"), world)
        own_force, own_trial, own_data, own_rhs = _fill(mechanics, model)
        assembler = mechanics.assembler
        return own_force, own_trial, assembler.sum_entries(own_data), own_rhs, assembler, world.rank

    f = force.shape[1]
    seen = np.zeros(len(data), dtype=bool)
    for own_force, own_trial, own_data, own_rhs, assembler, rank in on_ranks(3, work):
        np.testing.assert_allclose(own_force, force, atol=1e-12 * np.abs(force).max())
        assert own_trial.cells.stress[0].tobytes() == trial.cells.stress[0].tobytes()
        assert own_trial.cells.volume[0].tobytes() == trial.cells.volume[0].tobytes()
        own = np.repeat(assembler.division.owner == rank, f)
        np.testing.assert_allclose(own_rhs[own], rhs[own], atol=1e-12 * np.abs(rhs).max())
        for row in np.flatnonzero(own):
            there, here = slice(start[row], start[row + 1]), slice(assembler.indptr[row], assembler.indptr[row + 1])
            assert np.array_equal(assembler.indices[here], columns[there])
            np.testing.assert_allclose(own_data[here], data[there], atol=1e-12 * np.abs(data).max())
            seen[there] = True
    assert seen.all()


def test_all_ranks_hear_of_a_cell_that_one_has_turned_inside_out():
    model = _model("hex8_fbar")
    expected = _fill(Mechanics(model, Timing("assembly")), model, squeeze=-40.0)
    assert isinstance(expected, TurnedInsideOut)
    found = on_ranks(3, lambda world: _fill(DividedMechanics(model, Timing("assembly"), world), model, squeeze=-40.0))
    assert all(isinstance(bad, TurnedInsideOut) for bad in found)
    assert len({bad.cell for bad in found}) == 1


def test_each_rank_looks_for_tools_from_its_own_nodes_and_all_know_what_all_have_seen():
    model = _model("hex8_fbar")
    die = _core.ToolSurface.triangles(*box_triangles((1.2, 1.2, 1.2)))
    places = model.mesh.points

    def nearest(points, reach):
        return die.nearest(np.ascontiguousarray(points), reach)[:2]

    looks = [(nearest, 0.6), (nearest, np.inf), (nearest, 0.0)]
    whole = Mechanics(model, Timing("assembly")).look_near(looks, places)
    assert 0 < np.isfinite(whole[0][0]).sum() < len(places)
    for seen in on_ranks(3, lambda world: DividedMechanics(model, Timing("assembly"), world).look_near(looks, places)):
        for (gap, normal), (own_gap, own_normal) in zip(whole, seen, strict=True):
            assert np.array_equal(own_gap, gap)
            assert np.array_equal(own_normal[np.isfinite(gap)], normal[np.isfinite(gap)])
