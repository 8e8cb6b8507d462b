# SPDX-License-Identifier: Apache-2.0
"""Shells and solids in one explicit model: each as alone, energies and momentum, rods, bounds, restarts, threads."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.blocks import Shells, Solids
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.space import SpaceDynamics
from presswork.law.elastic_plastic import make_hardening, make_sheet_law, make_solid_law
from presswork.model import Hardening, Material

HARDENING = Hardening("swift", np.array([565.0, 0.007, 0.26]))
STEEL = Material("steel", 206.9e3, 0.3, HARDENING, density=7.83e-9)
MISES = _core.VonMises(206.9e3, 0.3, *make_hardening(HARDENING))
ELASTIC = _core.VonMises(206.9e3, 0.0, *make_hardening(Hardening("linear", np.array([1e9, 0.0]))))
FACE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])


def sheet(n: int = 6, side: float = 6.0) -> tuple[np.ndarray, np.ndarray]:
    """Points and quadrilaterals of a square, the last one two triangles."""
    grid = np.linspace(0.0, side, n + 1)
    y, x = np.meshgrid(grid, grid, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0.02 * np.sin(x.ravel()) + 5.0], axis=1)
    first = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    last = cells[-1]
    halves = [[last[0], last[1], last[2], last[2]], [last[0], last[2], last[3], last[3]]]
    return points, np.concatenate([cells[:-1], halves]).astype(np.int32)


def bar(n: tuple[int, int, int], size: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra of a box."""
    x, y, z = (np.linspace(0.0, s, k + 1) for s, k in zip(size, n, strict=True))
    points = np.stack([a.ravel() for a in np.meshgrid(x, y, z, indexing="ij")], axis=1)
    number = np.arange(len(points)).reshape(len(x), len(y), len(z))
    corner = [number[i : i + n[0], j : j + n[1], k : k + n[2]].ravel() for k in (0, 1) for i, j in FACE]
    return points, np.stack(corner, axis=1).astype(np.int32)


def shells_of(cells: np.ndarray) -> Shells:
    return Shells(connectivity=cells, thickness=0.8, law=make_sheet_law(STEEL), density=STEEL.density)


def solids_of(cells: np.ndarray, element: str, general: bool = False) -> Solids:
    law = make_solid_law(STEEL) if general else MISES
    return Solids(connectivity=cells, law=law, density=STEEL.density, element=element)


def set_going(run: SpaceDynamics, points: np.ndarray) -> None:
    speed = np.zeros((len(points), 6))
    speed[:, :3] = 2e4 * np.sin(points[:, [1, 2, 0]])
    run.velocity = speed


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_blocks_that_do_not_touch_move_as_each_does_alone(element: str, general: bool) -> None:
    """To the last bit, beyond yield."""
    (flat, quads), (box, hexahedra) = sheet(), bar((4, 2, 3), (6.0, 2.0, 3.0))
    both = SpaceDynamics(
        np.concatenate([flat, box]),
        [shells_of(quads), solids_of(hexahedra + len(flat), element, general)],
    )
    alone = [
        SpaceDynamics(flat, [shells_of(quads)]),
        SpaceDynamics(box, [solids_of(hexahedra, element, general)]),
    ]
    assert both.dt == min(run.dt for run in alone)
    for run, points in ((both, both.start), *((run, run.start) for run in alone)):
        set_going(run, points)
        run.dt = both.dt
        run.advance(200)
    np.testing.assert_array_equal(both.position, np.concatenate([run.position for run in alone]))
    np.testing.assert_array_equal(both.velocity, np.concatenate([run.velocity for run in alone]))
    np.testing.assert_array_equal(both.stress_at_points, alone[0].stress_at_points)
    state, own = both.solid_state(1), alone[1].solid_state(0)
    np.testing.assert_array_equal(state.stress, own.stress)
    assert state.equivalent_plastic_strain.max() > 0.01
    assert both.equivalent_plastic_strain.max() > 0.003
    energies = [run.energies() for run in (both, *alone)]
    assert energies[0].internal == pytest.approx(energies[1].internal + energies[2].internal, rel=1e-12)
    assert all(abs(e.error_percent) < 0.5 for e in energies)


def glued(element: str = "hex8_fbar", n: int = 3) -> tuple[SpaceDynamics, np.ndarray]:
    """A box with a skin of shells on its top."""
    points, cells = bar((n, n, 1), (3.0, 3.0, 1.0))
    top = cells[:, 4:]
    return SpaceDynamics(points, [shells_of(top), solids_of(cells, element)]), points


def test_a_skin_of_shells_on_a_solid_keeps_momentum_and_energy() -> None:
    run, points = glued()
    set_going(run, points)
    momentum = run.mass[:, 0] @ run.velocity[:, :3]
    run.advance(400)
    np.testing.assert_allclose(run.mass[:, 0] @ run.velocity[:, :3], momentum, rtol=1e-9)
    balance = run.energies()
    assert balance.internal > 0.2 * (balance.internal + balance.kinetic)
    assert abs(balance.error_percent) < 0.5
    assert run.mass[:, 0].sum() == pytest.approx(7.83e-9 * 9.0 * (1.0 + 0.8), rel=1e-12)


@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_a_rod_of_hexahedra_swings_in_its_first_period(element: str) -> None:
    """Fixed at one end, without lateral contraction: 4 L/c, c^2 = E/density (Timoshenko, Vibration Problems)."""
    length = 20.0
    points, cells = bar((20, 1, 1), (length, 1.0, 1.0))
    solids = Solids(connectivity=cells, law=ELASTIC, density=7.83e-9, element=element)
    run = SpaceDynamics(points, [solids])
    run.fix(np.flatnonzero(points[:, 0] == 0.0), "uvw")
    speed = np.zeros((len(points), 6))
    speed[:, 0] = 1e3 * np.sin(0.5 * np.pi * points[:, 0] / length)
    run.velocity = speed
    tip, times, ways = len(points) - 1, [], []
    while run.time < 1.3 * 4.0 * length * np.sqrt(7.83e-9 / 206.9e3):
        run.advance(1)
        times.append(run.time), ways.append(run.position[tip, 0] - length)
    sign = np.flatnonzero(np.diff(np.sign(ways)))[:2]
    crossing = [np.interp(0.0, *zip(*sorted((ways[i + k], times[i + k]) for k in (0, 1)), strict=True)) for i in sign]
    assert 2.0 * (crossing[1] - crossing[0]) == pytest.approx(4.0 * length * np.sqrt(7.83e-9 / 206.9e3), rel=2e-3)
    assert abs(run.energies().error_percent) < 0.01


@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_the_bound_of_the_step_holds_for_a_distorted_hexahedron(element: str) -> None:
    """Against the eigenvalues of the mass and of the stiffness by differences."""
    points, cells = bar((1, 1, 1), (1.0, 2.0, 0.7))
    points = points + np.random.default_rng(3).uniform(-0.15, 0.15, points.shape)
    run = SpaceDynamics(points, [Solids(connectivity=cells, law=MISES, density=7.83e-9, element=element)])
    stiffness, size = np.zeros((24, 24)), 1e-7
    for node in range(8):
        for i in range(3):
            step = np.zeros((8, 6))
            step[node, i] = size
            force = [run.trial_force(sign * step)[:, :3].ravel() for sign in (1.0, -1.0)]
            stiffness[:, 3 * node + i] = (force[0] - force[1]) / (2.0 * size)
    root = 1.0 / np.sqrt(np.repeat(run.mass[:, 0], 3))
    largest = np.linalg.eigvalsh(root[:, None] * 0.5 * (stiffness + stiffness.T) * root).max()
    assert 1.0 <= run.bound_frequencies()[0] / largest < 4.0


def test_a_mixed_run_goes_on_with_the_same_bits() -> None:
    run, points = glued()
    set_going(run, points)
    run.scale_mass(1.1 * run.dt)
    run.advance(100)
    dump = run.dump()
    run.advance(100)
    again, _ = glued()
    again.restore(dump)
    again.advance(100)
    assert again.energies() == run.energies()
    for name, values in run.dump().items():
        np.testing.assert_array_equal(again.dump()[name], values, err_msg=name)
    with pytest.raises(ExplicitError, match="the dump's mesh, elements or laws are not those of this run"):
        glued("hex8_fbar", 2)[0].restore(dump)


def test_any_number_of_threads_gives_a_mixed_run_the_same_bits() -> None:
    before, found = _core.max_threads(), []
    try:
        for threads in (1, 2, 3):
            _core.set_threads(threads)
            run, points = glued(n=24)
            set_going(run, points)
            run.advance(30)
            found.append(run.dump())
    finally:
        _core.set_threads(before)
    for other in found[1:]:
        for name, values in found[0].items():
            np.testing.assert_array_equal(other[name], values, err_msg=name)


def test_a_cell_turned_inside_out_is_named_with_its_cycle() -> None:
    run, points = glued()
    run.fix(np.flatnonzero(points[:, 2] == 0.0), "uvw")
    run.fix(np.flatnonzero(points[:, 2] == 1.0), "w", -1e6)
    run.dt = 1e-6
    with pytest.raises(ExplicitError, match=r"cell (9|1\d) is turned inside out in cycle 1 \(t = 1e-06 s\): shorten"):
        run.advance(3)


def test_what_no_model_can_be_made_of_is_refused() -> None:
    points, cells = bar((1, 1, 1), (1.0, 1.0, 1.0))
    solids = solids_of(cells, "hex8")
    with pytest.raises(ExplicitError, match="give one at least, and those of Shells first"):
        SpaceDynamics(points, [solids, shells_of(cells[:, :4])])
    with pytest.raises(ExplicitError, match=r"cell 0 is turned inside out: give its nodes in the order of the element"):
        SpaceDynamics(points, [solids_of(cells[:, [4, 5, 6, 7, 0, 1, 2, 3]], "hex8")])
    with pytest.raises(ExplicitError, match="solids in space are computed in double precision"):
        SpaceDynamics(points, [solids], precision="single")
    with pytest.raises(ExplicitError, match="cell 0 names node 8"):
        SpaceDynamics(points, [solids_of(cells + 1, "hex8")])
    with pytest.raises(ExplicitError, match="block 0 has shells"):
        glued()[0].solid_state(0)
