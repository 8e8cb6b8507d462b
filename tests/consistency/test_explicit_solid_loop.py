# SPDX-License-Identifier: Apache-2.0
"""Explicit solids: the same bits on any number of threads and after a restart; rigid motion; several blocks."""

from dataclasses import replace

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import CellBlock, Hardening, Heating, Mesh, Rate

STEEL = SolidMaterial(
    young=206.9e3,
    poisson=0.3,
    density=7.83e-9,
    hardening=Hardening("ludwik", np.array([806.0, 614.0, 0.168])),
    rate=Rate("johnson_cook", {"C": 0.0089, "reference_rate": 1.0}),
    heating=Heating(melting=1540.0, exponent=1.1, heat_capacity=4.6e8),
)


def start(element: str, n: int = 8) -> ExplicitSolids:
    mesh = mesh_rectangle(np.linspace(0, 3.2, n + 1), np.linspace(0, 3.2, n + 1), element=element)
    run = ExplicitSolids(mesh, [STEEL], axisymmetric=True)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -287e3))
    run.add_wall("anvil", [[-1, 0, 20, 0, 0, 0, 0]], mu=0.1)
    return run


def same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> bool:
    return all(one[name].tobytes() == other[name].tobytes() for name in one)


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_any_number_of_threads_gives_the_same_bits(element: str) -> None:
    dumps = []
    before = _core.max_threads()
    try:
        for threads in (1, 2, 3):
            _core.set_threads(threads)
            run = start(element, 66 if element == "quad4_1pt" else 33)
            run.advance(40)
            run.energies()
            dumps.append(run.dump())
    finally:
        _core.set_threads(before)
    assert same(dumps[0], dumps[1])
    assert same(dumps[0], dumps[2])
    assert run.equivalent_plastic_strain.max() > 0.01


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_a_restored_run_goes_on_with_the_same_bits(element: str) -> None:
    run = start(element)
    run.run_to(1e-6)
    dump = run.dump()
    run.run_to(2e-6)
    other = start(element)
    other.restore(dump)
    other.run_to(2e-6)
    assert run.cycle == other.cycle
    assert run.energies() == other.energies()
    assert same(run.dump(), other.dump())


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_mass_scaling_reaches_its_step_and_reports_the_mass(element: str) -> None:
    """On cells that grow along x those at the left rule the step: only they are made heavier."""
    mesh = mesh_rectangle(np.geomspace(1.0, 5.0, 9), np.linspace(0, 2, 3), element=element)
    run = ExplicitSolids(mesh, [STEEL], axisymmetric=True)
    plain, mass, squared = run.dt, run.mass, 2.0 / run.stable_step()
    none = run.scale_mass(0.5 * plain)
    assert none.added == 0.0
    assert none.n_elements == 0
    assert squared == 2.0 / run.stable_step()
    added = run.scale_mass(1.3 * plain)
    assert run.dt == 1.3 * plain
    assert run.stable_step() == pytest.approx(1.3 * plain / 0.9, rel=1e-9)
    assert 0 < added.n_elements < sum(len(b.connectivity) for b in mesh.blocks)
    assert added.mass == pytest.approx(STEEL.density * np.pi * 24.0 * 2.0, rel=1e-12)
    assert run.mass.sum() == pytest.approx(added.mass + added.added, rel=1e-12)
    assert added.percent == pytest.approx(100 * added.added / added.mass, rel=1e-12)
    assert (run.mass >= mass).all()
    right = mesh.points[:, 0] > 4.9
    assert (run.mass[right] == mass[right]).all()


def vibrate(element: str) -> ExplicitSolids:
    """A free elastic body that moves and vibrates, its left cells smaller."""
    mesh = mesh_rectangle(np.geomspace(1.0, 5.0, 9), np.linspace(0, 2, 3), element=element)
    run = ExplicitSolids(mesh, [replace(STEEL, hardening=None, heating=None, rate=None)], axisymmetric=False)
    run.velocity = np.array([1e3, 500.0]) + np.random.default_rng(4).uniform(-2e3, 2e3, mesh.points.shape)
    run.advance(200)
    return run


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_mass_added_on_the_way_keeps_momentum_and_balance(element: str) -> None:
    """From then on the momentum of the heavier body stays, and its energy; what the mass brought is no error."""
    run = vibrate(element)
    before, step = run.energies(), run.dt
    added = run.scale_mass(1.5 * step)
    momentum, after = run.mass @ run.velocity, run.energies()
    brought = 0.5 * added.added * 1e3**2
    assert after.kinetic - before.kinetic > brought
    assert after.error_percent == pytest.approx(before.error_percent, abs=1e-3)
    run.dt = step
    run.advance(2000)
    assert run.energies().error_percent == pytest.approx(before.error_percent, abs=0.02)
    np.testing.assert_allclose(run.mass @ run.velocity, momentum, rtol=1e-9)


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_a_longer_step_all_at_once_costs_the_energy_of_central_differences(element: str) -> None:
    """From dt to dt' the sum of v- m v+/2 and the elastic energy changes by -sum m a^2 (dt'^2 - dt^2)/8."""
    run = vibrate(element)
    step = run.dt
    run.scale_mass(1.5 * step)
    before = run.energies()
    a = -run.internal_force / run.mass[:, None]
    cost = (run.mass @ a**2).sum() * ((1.5 * step) ** 2 - step**2) / 8
    total = before.kinetic + before.internal + before.hourglass
    run.advance(2000)
    after = run.energies()
    assert after.kinetic + after.internal + after.hourglass == pytest.approx(total - cost, abs=0.03 * cost)


def test_run_to_a_target_step_adds_mass_as_cells_flatten() -> None:
    """A billet that strikes a wall: mass is added more than once, and a restored run adds it with the same bits."""
    run, plain = start("quad4_1pt"), start("quad4_1pt")
    target = run.dt
    run.run_to(4e-6, target_step=target)
    dump, first = run.dump(), run.mass.sum()
    run.run_to(8e-6, target_step=target)
    assert plain.mass.sum() < first < run.mass.sum()
    other = start("quad4_1pt")
    other.restore(dump)
    other.run_to(8e-6, target_step=target)
    assert same(run.dump(), other.dump())
    plain.run_to(8e-6)
    assert run.cycle < plain.cycle
    assert abs(run.energies().error_percent) < 0.5


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_rigid_motion_gives_no_stress(element: str, axisymmetric: bool) -> None:
    """Translation along the axis; a stressed block in the plane, turned by a degree a step, turns its stress only."""
    mesh = mesh_rectangle(np.linspace(1, 4, 4), np.linspace(0, 3, 4), element=element)
    run = ExplicitSolids(mesh, [replace(STEEL, rate=None)], axisymmetric=axisymmetric)  # a rate would relax the stress
    if axisymmetric:
        run.set_velocity("all", (0.0, 1e5))
        run.advance(100)
        assert np.abs(run.stress).max() < 1e-6
        return
    everything = np.arange(len(mesh.points))
    stretch = np.diag([0.02, -0.01])

    def go(move: np.ndarray) -> None:
        run.fix(everything, "u", 0.0)
        for i, letter in enumerate("uv"):
            run.fix(everything, letter, move[:, i] / run.dt)
        run.advance(1)

    run.dt = 1e-3  # slow enough to be a motion in steps of any size: every freedom is given
    go(mesh.points @ stretch)
    before, p = run.stress, run.equivalent_plastic_strain
    assert (p > 0.01).all()
    turn = np.array([[np.cos(np.pi / 180), -np.sin(np.pi / 180)], [np.sin(np.pi / 180), np.cos(np.pi / 180)]])
    for _ in range(90):
        go(run.position @ turn.T - run.position)
    np.testing.assert_allclose(run.stress[:, [1, 0, 2, 3]], before, atol=1e-6 * np.abs(before).max())
    np.testing.assert_allclose(run.equivalent_plastic_strain, p, rtol=1e-9)


def test_blocks_of_two_kinds_join_in_one_loop() -> None:
    """Left half of quads, right half of triangles: a wave passes with its speed, the energies balance."""
    quads = mesh_rectangle(np.linspace(0, 50, 51), np.linspace(0, 1, 2), element="quad4_1pt")
    triangles = mesh_rectangle(np.linspace(50, 100, 51), np.linspace(0, 1, 2), element="tri3")
    points = np.concatenate([quads.points, triangles.points])
    shared = {tuple(p): i for i, p in reversed(list(enumerate(points.round(9).tolist())))}
    number = np.array([shared[tuple(p)] for p in points.round(9).tolist()])
    used, place = np.unique(number, return_inverse=True)
    blocks = (
        CellBlock("quad4_1pt", place[quads.blocks[0].connectivity].astype(np.int32), 0),
        CellBlock("tri3", place[triangles.blocks[0].connectivity + len(quads.points)].astype(np.int32), 0),
    )
    points = points[used]
    edges = np.zeros((0, 2), dtype=np.int32)
    mesh = Mesh(points, blocks, {"end": np.flatnonzero(points[:, 0] == 0)}, {}, edges)
    elastic = SolidMaterial(young=210e3, poisson=0.3, density=7.85e-9)
    run = ExplicitSolids(mesh, [elastic], axisymmetric=False)
    run.fix(np.arange(len(points)), "v")
    run.fix("end", "u", 1000.0)
    run.advance(round(80.0 / elastic.wave_speed / run.dt))
    assert abs(run.energies().error_percent) < 0.2
    speed = run.velocity[:, 0]
    assert speed[points[:, 0] < 65].mean() == pytest.approx(1000.0, rel=0.03)
    assert np.abs(speed[points[:, 0] > 90]).max() < 5.0
