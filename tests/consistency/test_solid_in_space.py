# SPDX-License-Identifier: Apache-2.0
"""Solids in space: the stiffness is the derivative of the force, rigid motion does nothing, stresses turn along."""

import numpy as np
import pytest

from presswork import _core
from presswork.model import CELLS, list_names
from presswork.model import ELEMENTS as ELEMENTS_BY_NAME

ELEMENTS = list_names(_core.Family.space, in_implicit=True)
MEASURES = ["log", "stretch", "green_lagrange"]
CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)


class OneCell:
    """One distorted, prestressed cell: f freedoms a node, q points."""

    def __init__(self, element: str, *, seed: int = 1, **settings: object) -> None:
        rng = np.random.default_rng(seed)
        self.element = element
        row = ELEMENTS_BY_NAME[element]
        self.nodes, self.f, self.q = row.nodes, row.freedoms, row.points
        self.settings = _core.PointSettings(**settings)
        self.law = _core.VonMises(200e3, 0.3, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
        self.points = rng.standard_normal((self.nodes, self.f))
        corners = CUBE if self.nodes == 8 else CUBE[[0, 1, 3, 4]]
        if self.nodes == 10:
            corners = np.concatenate([corners, corners[CELLS["tet4"].edges].mean(axis=1)])
        self.points[:, :3] = corners + 0.05 * self.points[:, :3]
        self.stress = 100 * rng.standard_normal((1, self.q, 6))
        self.eqps = 0.02 * rng.random((1, self.q))
        self.shape = rng.standard_normal((self.nodes, self.f))
        self.shape[:, 3:] *= 1e-2
        self.pressure = (200e3 / (3 * 0.4), 200e3 / 2.6, 180e3) if self.f == 4 else None
        self.hourglass = np.array([[0.7, 0.0]])

    def evaluate(self, increment: np.ndarray, *, with_stiffness: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the nodal forces (nodes, f) and the stiffness (nodes f, nodes f); the stresses are kept."""
        width, n = _core.pack_width, self.nodes * self.f
        force = np.zeros((1, n, width))
        stiffness = np.zeros((1, n, n, width)) if with_stiffness else None
        self.new_stress, self.new_eqps = np.zeros((1, self.q, 6)), np.zeros((1, self.q))
        failed = _core.evaluate_block(
            self.element,
            np.arange(self.nodes, dtype=np.int32)[None],
            self.points,
            increment,
            self.law,
            self.settings,
            axisymmetric=False,
            depth=1.0,
            hourglass_fraction=0.0,
            pressure=self.pressure,
            dt=1.0,
            stress_n=self.stress,
            eqps_n=self.eqps,
            hourglass_n=self.hourglass,
            stress=self.new_stress,
            eqps=self.new_eqps,
            hourglass=np.zeros((1, 2)),
            volume=np.zeros((1, self.q)),
            force=force,
            stiffness=stiffness,
        )
        assert failed == -1
        return force[0, :, 0].reshape(self.nodes, self.f), stiffness[0, :, :, 0] if with_stiffness else np.zeros(0)

    def nothing(self) -> np.ndarray:
        return np.zeros((self.nodes, self.f))

    def error_of_stiffness(self, increment: np.ndarray) -> float:
        _, stiffness = self.evaluate(increment, with_stiffness=True)
        numerical, step = np.zeros_like(stiffness), 1e-6
        for j in range(len(stiffness)):
            move = np.zeros(len(stiffness))
            move[j] = step
            move = move.reshape(increment.shape)
            ahead, behind = (self.evaluate(increment + sign * move)[0] for sign in (1, -1))
            numerical[:, j] = (ahead - behind).ravel() / (2 * step)
        return float(np.abs(stiffness - numerical).max() / np.abs(stiffness).max())

    def move(self, R: np.ndarray, by: np.ndarray, increment: np.ndarray) -> np.ndarray:
        """Return an increment with a turn and a shift on top of it."""
        moved = increment.copy()
        moved[:, :3] = (self.points + increment)[:, :3] @ R.T + by - self.points[:, :3]
        return moved

    def turn(self, R: np.ndarray, vector: np.ndarray) -> np.ndarray:
        """Return a nodal vector turned."""
        turned = vector.copy()
        turned[:, :3] = vector[:, :3] @ R.T
        return turned


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("size", [0.0, 5e-4, 0.05])
def test_stiffness_is_the_derivative_of_the_force(element, measure, size) -> None:
    one = OneCell(element, measure=_core.StrainMeasure[measure])
    assert one.error_of_stiffness(size * one.shape) < 1e-6


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_is_the_derivative_by_dual_numbers(element, measure) -> None:
    one = OneCell(element, measure=_core.StrainMeasure[measure])
    increment, along = 0.05 * one.shape, np.random.default_rng(5).standard_normal(one.shape.shape)
    force, stiffness = one.evaluate(increment, with_stiffness=True)
    found, derivative = _core.differentiate_cell(
        element,
        one.points,
        increment,
        along,
        one.law,
        one.settings,
        axisymmetric=False,
        depth=1.0,
        hourglass_fraction=0.0,
        pressure=one.pressure,
        stress_n=one.stress[0],
        eqps_n=one.eqps[0],
        hourglass_n=one.hourglass[0],
    )
    np.testing.assert_allclose(found, force, atol=1e-12 * np.abs(force).max())
    product = stiffness @ along.ravel()
    np.testing.assert_allclose(derivative.ravel(), product, atol=1e-10 * np.abs(product).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_with_small_displacements_is_the_derivative_of_the_force(element) -> None:
    one = OneCell(element, small_displacements=True)
    assert one.error_of_stiffness(0.05 * one.shape) < 1e-6


@pytest.mark.parametrize("element", ELEMENTS)
def test_thesis_tangent_with_all_terms_is_the_consistent_one_of_no_increment(element) -> None:
    one = OneCell(element, tangent=_core.TangentKind.thesis, k_v=True)
    _, thesis = one.evaluate(one.nothing(), with_stiffness=True)
    one.settings = _core.PointSettings()
    _, consistent = one.evaluate(one.nothing(), with_stiffness=True)
    np.testing.assert_allclose(thesis, consistent, rtol=0, atol=1e-9 * np.abs(consistent).max())


@pytest.mark.parametrize("term", ["green_lagrange_matrix", "k_e", "k_u", "k_v"])
def test_each_term_of_the_thesis_tangent_counts(term) -> None:
    one = OneCell("hex8", tangent=_core.TangentKind.thesis, k_v=False)
    _, without = one.evaluate(0.05 * one.shape, with_stiffness=True)
    flipped = {"green_lagrange_matrix": True, "k_e": False, "k_u": False, "k_v": True}[term]
    one.settings = _core.PointSettings(tangent=_core.TangentKind.thesis, **{"k_v": False, term: flipped})
    _, other = one.evaluate(0.05 * one.shape, with_stiffness=True)
    assert np.abs(other - without).max() > 1e-4 * np.abs(without).max()


def rotation(vector: np.ndarray) -> np.ndarray:
    """Return the rotation by a vector [rad], by Rodrigues's formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def as_tensors(stress: np.ndarray) -> np.ndarray:
    return stress[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]


TURNS = [np.array([0.3, -0.2, 0.5]), np.array([1.4, 0.9, -1.1]), np.array([3.0, 0.0, 0.0])]


@pytest.mark.parametrize("turn", TURNS, ids=["small", "large", "half"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_rigid_motion_turns_the_stress_and_strains_nothing(element, turn) -> None:
    one = OneCell(element)
    one.stress *= 0.1  # below yield
    R = rotation(turn)
    force, _ = one.evaluate(one.nothing())
    turned, _ = one.evaluate(one.move(R, np.array([3.0, -1.0, 2.0]), one.nothing()))
    np.testing.assert_allclose(as_tensors(one.new_stress), R @ as_tensors(one.stress) @ R.T, atol=1e-8)
    np.testing.assert_allclose(turned, one.turn(R, force), atol=1e-8)
    np.testing.assert_array_equal(one.new_eqps, one.eqps)


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("element", ELEMENTS)
def test_a_rotation_on_top_of_an_increment_turns_forces_and_stresses(element, measure) -> None:
    one = OneCell(element, measure=_core.StrainMeasure[measure])
    increment, R = 0.05 * one.shape, rotation(TURNS[1])
    force, _ = one.evaluate(increment)
    stress, eqps = one.new_stress, one.new_eqps
    assert (eqps > one.eqps).any()
    turned, _ = one.evaluate(one.move(R, np.zeros(3), increment))
    np.testing.assert_allclose(turned, one.turn(R, force), atol=1e-9 * np.abs(force).max())
    np.testing.assert_allclose(as_tensors(one.new_stress), R @ as_tensors(stress) @ R.T, atol=1e-7)
    np.testing.assert_allclose(one.new_eqps, eqps, rtol=1e-10)


def test_a_cell_turned_inside_out_is_reported() -> None:
    one = OneCell("hex8")
    with pytest.raises(AssertionError):
        one.evaluate(-2.0 * one.points)


def test_a_hexahedron_in_plane_strain_is_the_quadrilateral() -> None:
    one = OneCell("hex8")
    flat, moves = one.points[:4, :2].copy(), 0.03 * one.shape[:4, :2]
    one.points = np.vstack([np.column_stack([flat, np.full(4, z)]) for z in (0.0, 1.0)])
    one.stress[:], one.eqps[:] = 0.0, 0.01
    force, _ = one.evaluate(np.tile(np.column_stack([moves, np.zeros(4)]), (2, 1)))
    plane, stress = np.zeros((1, 8, _core.pack_width)), np.zeros((1, 4, 4))
    failed = _core.evaluate_block(
        "quad4",
        np.arange(4, dtype=np.int32)[None],
        flat,
        moves,
        one.law,
        one.settings,
        axisymmetric=False,
        depth=1.0,
        hourglass_fraction=0.0,
        stress_n=np.zeros((1, 4, 4)),
        eqps_n=np.full((1, 4), 0.01),
        hourglass_n=np.zeros((1, 2)),
        stress=stress,
        eqps=np.zeros((1, 4)),
        hourglass=np.zeros((1, 2)),
        volume=np.zeros((1, 4)),
        force=plane,
        stiffness=None,
    )
    assert failed == -1
    both = force.reshape(2, 4, 3).sum(axis=0)
    np.testing.assert_allclose(both[:, :2], plane[0, :, 0].reshape(4, 2), atol=1e-9 * np.abs(both).max())
    np.testing.assert_allclose(both[:, 2], 0.0, atol=1e-9 * np.abs(both).max())
    np.testing.assert_allclose(one.new_stress[0, :4, :4], stress[0], atol=1e-8)
