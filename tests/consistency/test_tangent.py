# SPDX-License-Identifier: Apache-2.0
"""The stiffness of every element, strain measure, hardening law and integrator is the derivative of its force."""

import numpy as np
import pytest

from presswork import _core
from presswork.model import list_names

ELEMENTS = list_names(_core.Family.plane)
MEASURES = ["log", "stretch", "green_lagrange", "small"]
LAWS = {
    "linear": [700.0, 300.0],
    "swift": [565.0, 0.007, 0.26],
    "ludwik": [300.0, 500.0, 0.3],
    "voce": [200.0, 400.0, 10.0],
    "linear_voce": [450.0, 715.0, 16.93, 129.24],
    "hockett_sherby": [200.0, 400.0, 5.0, 0.7],
    "table": [0.0, 200.0, 0.05, 300.0, 0.5, 400.0],
    "swift_voce": [0.4, 565.0, 0.007, 0.26, 200.0, 400.0, 10.0],
    "monotone_table": [0.0, 200.0, 3000.0, 0.05, 300.0, 500.0, 0.5, 400.0, 100.0],
}
INTEGRATORS = ["backward_euler", "radial_return", "direct", "tangent_radial_return", "secant", "substepping"]
ELASTIC_STRAIN, PLASTIC_STRAIN = 5e-4, 0.05


def make_law(hardening: str = "linear", integrator: str = "backward_euler", modulus: str = "consistent"):
    return _core.VonMises(
        200e3,
        0.3,
        _core.HardeningLaw[hardening],
        LAWS[hardening],
        integrator=_core.Integrator[integrator],
        substeps=4,
        modulus=_core.Modulus[modulus],
    )


def reference_points(element: str) -> np.ndarray:
    nodes, _ = _core.element_sizes(element)
    corners = np.array([[2.0, 0], [3, 0], [3, 1], [2, 1]] if element.startswith("quad") else [[2.0, 0], [3, 0], [2, 1]])
    points = list(corners)
    if nodes > len(corners):
        points += list(0.5 * (corners + np.roll(corners, -1, axis=0)))
    if nodes == 9:
        points.append(corners.mean(axis=0))
    return np.array(points)


class OneElement:
    """One distorted, prestressed element."""

    def __init__(self, element: str, law, *, axisymmetric: bool, measure: str = "log", seed: int = 1) -> None:
        rng = np.random.default_rng(seed)
        self.element, self.law, self.axisymmetric = element, law, axisymmetric
        self.settings = _core.PointSettings(measure=_core.StrainMeasure[measure])
        nodes, n_points = _core.element_sizes(element)
        self.points = reference_points(element) + 0.05 * rng.standard_normal((nodes, 2))
        self.stress = 100 * rng.standard_normal((1, n_points, 4))
        self.eqps = 0.02 * rng.random((1, n_points))
        self.hourglass = 50 * rng.standard_normal((1, 2))
        self.shape = rng.standard_normal((nodes, 2))

    def evaluate(self, increment: np.ndarray, *, with_stiffness: bool) -> tuple[np.ndarray, np.ndarray]:
        nodes, n_points = _core.element_sizes(self.element)
        width = _core.pack_width
        force = np.zeros((1, 2 * nodes, width))
        stiffness = np.zeros((1, 2 * nodes, 2 * nodes, width)) if with_stiffness else None
        failed = _core.evaluate_block(
            self.element,
            np.arange(nodes, dtype=np.int32)[None],
            self.points,
            increment,
            self.law,
            self.settings,
            axisymmetric=self.axisymmetric,
            depth=1.3,
            hourglass_fraction=0.05,
            stress_n=self.stress,
            eqps_n=self.eqps,
            hourglass_n=self.hourglass,
            stress=np.zeros((1, n_points, 4)),
            eqps=np.zeros((1, n_points)),
            hourglass=np.zeros((1, 2)),
            volume=np.zeros((1, n_points)),
            force=force,
            stiffness=stiffness,
        )
        assert failed == -1
        return force[0, :, 0], stiffness[0, :, :, 0] if with_stiffness else np.zeros(0)

    def error_of_stiffness(self, increment: np.ndarray) -> float:
        _, stiffness = self.evaluate(increment, with_stiffness=True)
        numerical = np.zeros_like(stiffness)
        step = 1e-6
        for j in range(increment.size):
            move = np.zeros(increment.size)
            move[j] = step
            ahead, _ = self.evaluate(increment + move.reshape(-1, 2), with_stiffness=False)
            behind, _ = self.evaluate(increment - move.reshape(-1, 2), with_stiffness=False)
            numerical[:, j] = (ahead - behind) / (2 * step)
        return float(np.abs(stiffness - numerical).max() / np.abs(stiffness).max())


@pytest.mark.parametrize("axisymmetric", [True, False], ids=["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_is_the_derivative_by_dual_numbers(element, axisymmetric) -> None:
    """The kernel on packs and on dual numbers: the same force, and the tangent's product with a move to round-off."""
    one = OneElement(element, make_law("swift"), axisymmetric=axisymmetric)
    increment, along = PLASTIC_STRAIN * one.shape, np.random.default_rng(5).standard_normal(one.shape.shape)
    force, stiffness = one.evaluate(increment, with_stiffness=True)
    found, derivative = _core.differentiate_cell(
        element,
        one.points,
        increment,
        along,
        one.law,
        one.settings,
        axisymmetric=axisymmetric,
        depth=1.3,
        hourglass_fraction=0.05,
        stress_n=one.stress[0],
        eqps_n=one.eqps[0],
        hourglass_n=one.hourglass[0],
    )
    np.testing.assert_allclose(found.ravel(), force, atol=1e-12 * np.abs(force).max())
    product = stiffness @ along.ravel()
    np.testing.assert_allclose(derivative.ravel(), product, atol=1e-11 * np.abs(product).max())


@pytest.mark.parametrize("axisymmetric", [True, False], ids=["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("size", [ELASTIC_STRAIN, PLASTIC_STRAIN], ids=["elastic", "plastic"])
def test_stiffness_is_the_derivative_of_the_force(element, measure, axisymmetric, size) -> None:
    one = OneElement(element, make_law("swift"), axisymmetric=axisymmetric, measure=measure)
    if size == ELASTIC_STRAIN:
        one.stress *= 0.1
        one.law = make_law("linear")
    assert one.error_of_stiffness(size * one.shape) < 1e-6


@pytest.mark.parametrize("hardening", LAWS)
@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_is_consistent_with_every_hardening_law(element, hardening) -> None:
    one = OneElement(element, make_law(hardening), axisymmetric=True, seed=2)
    assert one.error_of_stiffness(PLASTIC_STRAIN * one.shape) < 1e-6


@pytest.mark.parametrize("components", [4, 6])
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("hardening", LAWS)
def test_material_tangent_is_the_derivative_of_the_stress(hardening, integrator, components) -> None:
    law = make_law(hardening, integrator)
    rng = np.random.default_rng(3)
    n = 40
    stress, eqps = 100 * rng.standard_normal((n, components)), 0.02 + 0.02 * rng.random(n)
    strain = rng.standard_normal((n, components)) * np.geomspace(1e-4, 2e-2, n)[:, None]
    _, new_eqps, tangent = law.update(strain, stress, eqps)
    assert 5 < (new_eqps > eqps).sum() < n, "both sides of yield must be there"
    step = 1e-8
    for j in range(components):
        move = np.zeros(components)
        move[j] = step
        ahead, behind = (law.update(strain + s * move, stress, eqps)[0] for s in (1, -1))
        error = np.abs(tangent[:, :, j] - (ahead - behind) / (2 * step)).max(axis=1) / 200e3
        assert np.median(error) < 1e-7
        assert error.max() < 1e-5


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_continuum_modulus_is_the_tangents_limit_for_small_increments(integrator) -> None:
    rng = np.random.default_rng(4)
    stress = rng.standard_normal((20, 4))
    deviator = stress - np.pad(np.repeat(stress[:, :3].mean(axis=1, keepdims=True), 3, axis=1), ((0, 0), (0, 1)))
    q = np.sqrt(1.5 * ((deviator[:, :3] ** 2).sum(axis=1) + 2 * deviator[:, 3] ** 2))
    stress *= (700 / q)[:, None]
    strain = 1e-9 * deviator / q[:, None]
    eqps = np.full(20, 1e-15)
    consistent = make_law("linear", integrator).update(strain, stress, eqps)[2]
    continuum = make_law("linear", integrator, "continuum").update(strain, stress, eqps)[2]
    assert np.abs(consistent - continuum).max() < 1e-5 * 200e3


@pytest.mark.parametrize("integrator", INTEGRATORS[:2] + INTEGRATORS[3:])
@pytest.mark.parametrize("hardening", LAWS)
def test_stress_ends_on_the_yield_surface(hardening, integrator) -> None:
    law = make_law(hardening, integrator)
    rng = np.random.default_rng(5)
    stress, eqps = 50 * rng.standard_normal((50, 4)), 0.05 * rng.random(50)
    new_stress, new_eqps, _ = law.update(0.05 * rng.standard_normal((50, 4)), stress, eqps)
    s = new_stress.copy()
    s[:, :3] -= s[:, :3].mean(axis=1, keepdims=True)
    q = np.sqrt(1.5 * ((s[:, :3] ** 2).sum(axis=1) + 2 * s[:, 3] ** 2))
    assert (new_eqps > eqps).all()
    np.testing.assert_allclose(q, law.flow_stress(new_eqps)[0], rtol=1e-10)


def test_thesis_tangent_with_every_term_equals_the_consistent_one_for_small_increments() -> None:
    one = OneElement("tri3", make_law("linear"), axisymmetric=True)
    increment = 1e-9 * one.shape
    _, exact = one.evaluate(increment, with_stiffness=True)
    one.settings = _core.PointSettings(tangent=_core.TangentKind.thesis, k_v=True)
    _, thesis = one.evaluate(increment, with_stiffness=True)
    assert np.abs(exact - thesis).max() < 1e-7 * np.abs(exact).max()
    one.settings = _core.PointSettings(tangent=_core.TangentKind.thesis, k_v=True, green_lagrange_matrix=True)
    _, green_lagrange = one.evaluate(increment, with_stiffness=True)
    assert np.abs(exact - green_lagrange).max() < 1e-7 * np.abs(exact).max()


@pytest.mark.parametrize("term", ["k_e", "k_u", "k_v"])
def test_every_term_of_the_thesis_tangent_changes_it(term) -> None:
    one = OneElement("tri3", make_law("linear"), axisymmetric=False)
    stiffnesses = []
    for on in (True, False):
        one.settings = _core.PointSettings(tangent=_core.TangentKind.thesis, **{term: on})
        stiffnesses.append(one.evaluate(0.01 * one.shape, with_stiffness=True)[1])
    assert np.abs(stiffnesses[0] - stiffnesses[1]).max() > 1e-5 * np.abs(stiffnesses[0]).max()


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_turned_increment_gives_a_turned_force(element) -> None:
    one = OneElement(element, make_law("swift"), axisymmetric=False)
    increment = PLASTIC_STRAIN * one.shape
    force, _ = one.evaluate(increment, with_stiffness=False)
    c, s = np.cos(1.1), np.sin(1.1)
    turn = np.array([[c, -s], [s, c]])
    turned, _ = one.evaluate((one.points + increment) @ turn.T - one.points, with_stiffness=False)
    np.testing.assert_allclose(turned.reshape(-1, 2), force.reshape(-1, 2) @ turn.T, atol=1e-9 * np.abs(force).max())


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_law_in_six_components_is_that_in_four(integrator) -> None:
    law = make_law("swift", integrator)
    rng = np.random.default_rng(4)
    stress, strain = 100 * rng.standard_normal((20, 6)), 5e-3 * rng.standard_normal((20, 6))
    stress[:, 4:] = strain[:, 4:] = 0.0
    six = law.update(strain, stress, np.full(20, 0.02))
    four = law.update(strain[:, :4].copy(), stress[:, :4].copy(), np.full(20, 0.02))
    rounding = np.spacing(np.abs(four[0]).max())  # of a component that is a difference of large ones
    np.testing.assert_allclose(six[0][:, :4], four[0], rtol=1e-13, atol=rounding)
    np.testing.assert_allclose(six[2][:, :4, :4], four[2], rtol=1e-11, atol=1e-7)
    assert not six[0][:, 4:].any()


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_law_in_six_components_turns_with_its_axes(integrator) -> None:
    law = make_law("swift", integrator)
    rng = np.random.default_rng(5)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    both = rng.standard_normal((2, 20, 3, 3))
    stress, strain = np.array([80.0, 4e-3])[:, None, None, None] * (both + both.transpose(0, 1, 3, 2))
    eqps = np.full(20, 0.02)
    plain = law.update(to_voigt(strain, 2.0), to_voigt(stress, 1.0), eqps)
    turned = law.update(to_voigt(turn @ strain @ turn.T, 2.0), to_voigt(turn @ stress @ turn.T, 1.0), eqps)
    assert (plain[1] > eqps).any()
    np.testing.assert_allclose(turned[0], to_voigt(turn @ from_voigt(plain[0]) @ turn.T, 1.0), atol=1e-9)


def to_voigt(tensor: np.ndarray, shear: float) -> np.ndarray:
    """Return xx, yy, zz, xy, yz, zx of symmetric tensors (n, 3, 3), the shear components times `shear`."""
    normal, others = tensor[:, [0, 1, 2], [0, 1, 2]], tensor[:, [0, 1, 2], [1, 2, 0]]
    return np.ascontiguousarray(np.hstack([normal, shear * others]))


def from_voigt(stress: np.ndarray) -> np.ndarray:
    return stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
