# SPDX-License-Identifier: Apache-2.0
"""The tangent of contact between bodies against finite differences of its forces, and the balance of those forces."""

import numpy as np
import pytest

from presswork import _core

LAWS = {
    "frictionless": {"mu": 0.0, "m_k": np.inf},
    "sticking": {"mu": 10.0, "m_k": np.inf},
    "coulomb_slides": {"mu": 0.05, "m_k": np.inf},
    "coulomb_sticks": {"mu": 5.0, "m_k": np.inf},
    "shear_slides": {"mu": 1.0, "m_k": 1.0},
    "capped_by_push": {"mu": 0.05, "m_k": 1e4},
}


class Surfaces:
    """Four slave edges on a wavy line and three master edges above it, some in contact and some apart."""

    def __init__(self, nodes: int, law: dict[str, float], thickness: float) -> None:
        rng = np.random.default_rng(3)
        halves = nodes - 1
        self.lower = self.line(np.linspace(10.3, 14.0, 4 * halves + 1)[::-1], 1.0)
        self.upper = self.line(np.linspace(10.0, 13.7, 3 * halves + 1), 0.995)
        self.x = np.concatenate([self.lower, self.upper])
        self.x += rng.uniform(-0.01, 0.01, self.x.shape)
        self.x_n = self.x + [0.02, 0.0] * (np.arange(len(self.x)) < len(self.lower))[:, None]
        first = len(self.lower)
        self.slave, self.master = self.edges(4, nodes, 0), self.edges(3, nodes, first)
        ends, slots = np.unique(self.slave[:, :2], return_inverse=True)
        self.slots = slots.reshape(-1, 2).astype(np.int32)
        n = len(ends)
        self.pairs = _core.find_edge_pairs(self.slave, self.master, self.x, 2.0, False)
        self.arguments = {
            "slave_depth": np.full(4, 0.5), "master_depth": np.full(3, 0.5), "held": np.zeros(n, dtype=np.uint8),
            "pressure": rng.uniform(5, 9, n), "believed": np.zeros(n),
            "least_weight": np.zeros(n),
            "shear": rng.uniform(-1, 1, n), "slip": rng.uniform(-1e-3, 1e-3, n), "stiffness": np.full(n, 300.0),
            "shear_limit": np.full(n, law["m_k"]), "mu": law["mu"], "tangential_part": 0.4, "reach": 0.4,
            "touching": 1e-9, "thickness": thickness, "with_tangent": True,
        }  # fmt: skip

    @staticmethod
    def line(x: np.ndarray, height: float) -> np.ndarray:
        return np.column_stack([x, height + 0.05 * np.sin(x)])

    @staticmethod
    def edges(n: int, nodes: int, first: int) -> np.ndarray:
        halves = nodes - 1
        start = first + halves * np.arange(n)
        columns = [start, start + halves] + ([start + 1] if nodes == 3 else [])
        return np.stack(columns, axis=1).astype(np.int32)

    def evaluate(self, x: np.ndarray):
        return _core.evaluate_interface(
            self.slave, self.master, self.slots, self.pairs, np.ascontiguousarray(x), self.x_n, **self.arguments
        )


@pytest.fixture(params=LAWS)
def law(request):
    return LAWS[request.param]


@pytest.mark.parametrize("thickness", [0.0, 1.7], ids=["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("nodes", [2, 3])
def test_interface_tangent_is_the_derivative_of_the_forces(nodes, thickness, law) -> None:
    surfaces = Surfaces(nodes, law, thickness)
    x = surfaces.x
    found = surfaces.evaluate(x)
    wanted = 2 if 0.0 < law["mu"] < 1.0 or np.isfinite(law["m_k"]) else 1
    assert (found.status == wanted).any() or law["mu"] == 0.0
    assert (np.asarray(found.pressure) > 0).sum() >= 3
    n = 2 * len(x)
    tangent = np.zeros((n, n))
    for (i, j), block in zip(found.pairs, found.blocks, strict=True):
        tangent[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] += block
    step = 1e-6
    slopes = np.zeros((n, n))
    for j in range(n):
        moved = [x.ravel() + sign * step * np.eye(n)[j] for sign in (1, -1)]
        ahead, behind = (np.array(surfaces.evaluate(m.reshape(-1, 2)).force).ravel() for m in moved)
        slopes[:, j] = -(ahead - behind) / (2 * step)
    assert np.abs(slopes).max() > 10.0
    np.testing.assert_allclose(tangent, slopes, atol=2e-6 * np.abs(slopes).max())


@pytest.mark.parametrize("thickness", [0.0, 1.7], ids=["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("nodes", [2, 3])
def test_pressure_slopes_are_the_derivatives_of_the_pressures(nodes, thickness) -> None:
    """By which the iteration says what pressure a correction leads to."""
    surfaces = Surfaces(nodes, LAWS["frictionless"], thickness)
    surfaces.arguments["held"] = np.ones(len(surfaces.arguments["held"]), dtype=np.uint8)
    found = surfaces.evaluate(surfaces.x)
    change = np.random.default_rng(5).uniform(-1.0, 1.0, surfaces.x.shape)
    slot, node = np.asarray(found.slope_places).T
    slopes = np.zeros(len(found.pressure))
    np.add.at(slopes, slot, (np.asarray(found.pressure_slopes) * change[node]).sum(axis=1))
    ahead, behind = (np.asarray(surfaces.evaluate(surfaces.x + s * 1e-6 * change).pressure) for s in (1, -1))
    assert np.abs(slopes).max() > 10.0
    np.testing.assert_allclose(slopes, (ahead - behind) / 2e-6, atol=1e-5 * np.abs(slopes).max())


def test_tangent_and_friction_follow_the_believed_pressure() -> None:
    """A slot that is held keeps sliding with the pressure believed in, whatever the guess's gap makes of it."""
    surfaces = Surfaces(2, LAWS["coulomb_slides"], 1.0)
    n = len(surfaces.arguments["held"])
    surfaces.arguments |= {"held": np.ones(n, dtype=np.uint8), "believed": np.full(n, 7.0)}
    lifted = surfaces.x + [0.0, -0.05] * (np.arange(len(surfaces.x)) < len(surfaces.lower))[:, None]
    found = surfaces.evaluate(lifted)
    pulls = np.asarray(found.pressure) < 0
    assert pulls.any()
    assert (np.asarray(found.status)[pulls] == 2).all()
    np.testing.assert_allclose(np.abs(found.shear)[pulls], 0.05 * np.abs(found.pressure)[pulls])
    surfaces.arguments["believed"] = np.full(n, -7.0)
    assert (np.asarray(surfaces.evaluate(lifted).shear)[pulls] == 0.0).all()


BY_GAP, KEEPS_HOLD, LET_GO = 0, 1, 2


def tangent_of(surfaces: Surfaces, x: np.ndarray, hold: int, **other: object):
    """Return pressure, shear and the sum of the tangent's squares, all slots alike."""
    n = len(surfaces.arguments["held"])
    surfaces.arguments |= {"held": np.full(n, hold, dtype=np.uint8), **other}
    found = surfaces.evaluate(x)
    return np.asarray(found.pressure), np.asarray(found.shear), float((np.asarray(found.blocks) ** 2).sum())


def test_a_slot_let_go_has_no_tangent_where_it_just_touches() -> None:
    """It has pulled: a stiff gap that is closed but for a nanometre would hold it against its own release."""
    surfaces = Surfaces(2, LAWS["frictionless"], 1.0)
    apart = surfaces.x - [0.0, 0.1] * (np.arange(len(surfaces.x)) < len(surfaces.lower))[:, None]
    found = {hold: tangent_of(surfaces, apart, hold, pressure=np.zeros(5), touching=1.0) for hold in (BY_GAP, LET_GO)}
    assert (found[BY_GAP][0] == 0.0).all()
    assert found[BY_GAP][2] > 1.0
    assert found[LET_GO][2] == 0.0
    closed = tangent_of(surfaces, surfaces.x, LET_GO, pressure=np.full(5, 5.0))
    assert (closed[0] > 0.0).any()
    assert closed[2] > 1.0, "it pushes again where the gap is closed"


def test_a_sticking_slot_that_pulls_has_no_shear_and_no_tangent_against_slip() -> None:
    """Its tangent is the frictionless one; with a stiffness that no force follows, Newton's method would crawl."""
    pulling = {"pressure": np.full(5, -50.0), "believed": np.full(5, -50.0)}
    sticking = tangent_of(surfaces := Surfaces(2, LAWS["sticking"], 1.0), surfaces.x, KEEPS_HOLD, **pulling)
    smooth = tangent_of(surfaces := Surfaces(2, LAWS["frictionless"], 1.0), surfaces.x, KEEPS_HOLD, **pulling)
    assert (sticking[0] < 0.0).any()
    assert (sticking[1] == 0.0).all()
    assert sticking[2] == pytest.approx(smooth[2], rel=1e-12)


@pytest.mark.parametrize("nodes", [2, 3])
def test_interface_forces_balance(nodes, law) -> None:
    surfaces = Surfaces(nodes, law, 1.0)
    found = surfaces.evaluate(surfaces.x)
    force = np.asarray(found.force)
    assert np.abs(force).sum() > 1.0
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12 * np.abs(force).sum())
    np.testing.assert_allclose(found.master_force, force[len(surfaces.lower) :].sum(axis=0), rtol=1e-12)


def test_surfaces_that_pass_through_each_other_are_told() -> None:
    surfaces = Surfaces(2, LAWS["frictionless"], 1.0)
    lifted = surfaces.x.copy()
    lifted[: len(surfaces.lower), 1] += 0.6
    assert surfaces.evaluate(lifted).too_deep > 0
    assert surfaces.evaluate(surfaces.x).too_deep == 0
