# SPDX-License-Identifier: Apache-2.0
"""Small displacements, in every element and shell: linear on the undeformed body, exact and symmetric tangents."""

import numpy as np
import pytest

from presswork import _core
from tests.consistency.test_shell_tangent import ELASTIC, PLASTIC, SHELLS, Shell, random_increment
from tests.consistency.test_tangent import ELEMENTS, make_law, reference_points


def evaluate(element, law, points, increment, *, axisymmetric, stress=None, eqps=None):
    """Return force (freedoms,), stiffness (freedoms, freedoms), stress and plastic strain of one cell."""
    nodes, q = _core.element_sizes(element)
    stress = np.zeros((1, q, 4)) if stress is None else stress
    eqps = np.zeros((1, q)) if eqps is None else eqps
    after, strain, volume = np.zeros_like(stress), np.zeros((1, q)), np.zeros((1, q))
    force = np.zeros((1, 2 * nodes, _core.pack_width))
    stiffness = np.zeros((1, 2 * nodes, 2 * nodes, _core.pack_width))
    failed = _core.evaluate_block(
        element, np.arange(nodes, dtype=np.int32)[None], points, increment, law,
        _core.PointSettings(small_displacements=True), axisymmetric=axisymmetric, depth=1.0, hourglass_fraction=0.05,
        stress_n=stress, eqps_n=eqps, hourglass_n=np.zeros((1, 2)), stress=after, eqps=strain,
        hourglass=np.zeros((1, 2)), volume=volume, force=force, stiffness=stiffness, symmetric=False,
    )  # fmt: skip
    assert failed == -1
    return force[0, :, 0], stiffness[0, :, :, 0], after, strain


def distorted(element):
    rng = np.random.default_rng(1)
    return reference_points(element) + 0.05 * rng.standard_normal(reference_points(element).shape)


@pytest.mark.parametrize("axisymmetric", [False, True])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", ["linear", "linear_voce"])
def test_stiffness_is_the_symmetric_derivative_of_the_force(element, law, axisymmetric):
    rng, points = np.random.default_rng(2), distorted(element)
    increment = 4e-3 * rng.standard_normal(points.shape)
    mises = make_law(law)
    _, stiffness, _, eqps = evaluate(element, mises, points, increment, axisymmetric=axisymmetric)
    assert eqps.max() > 1e-4, "it flows"
    numeric = np.zeros_like(stiffness)
    for i in range(increment.size):
        step = np.zeros(increment.size)
        step[i] = 1e-7
        ends = [
            evaluate(
                element, mises, points, increment + sign * step.reshape(increment.shape), axisymmetric=axisymmetric
            )
            for sign in (1, -1)
        ]
        numeric[:, i] = (ends[0][0] - ends[1][0]) / 2e-7
    np.testing.assert_allclose(stiffness, numeric, atol=2e-6 * np.abs(stiffness).max())
    np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-12 * np.abs(stiffness).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_rotation_to_first_order_however_large_makes_no_force(element):
    """u = w x X has no symmetric gradient; a cell that it turns over is no fault."""
    points = distorted(element)
    turn = 3.0 * points @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    force, stiffness, _, _ = evaluate(element, make_law("linear"), points, turn, axisymmetric=False)
    assert np.abs(force).max() < 1e-12 * np.abs(stiffness).max()


@pytest.mark.parametrize("element", ELEMENTS)
def test_elastic_force_is_proportional_to_the_displacement(element):
    points = distorted(element)
    increment = 1e-4 * np.random.default_rng(3).standard_normal(points.shape)
    one, ten = (evaluate(element, make_law("linear"), points, f * increment, axisymmetric=True)[0] for f in (0.1, 1.0))
    np.testing.assert_allclose(ten, 10 * one, atol=1e-10 * np.abs(ten).max())


def test_bbar_has_the_same_mean_stress_at_every_point_of_a_cell():
    """tr strain is its mean over the cell: pressure is constant, in the plane and in axisymmetry, whatever the law."""
    points = distorted("quad4_fbar")
    increment = 4e-3 * np.random.default_rng(4).standard_normal(points.shape)
    for axisymmetric in (False, True):
        stress = evaluate("quad4_fbar", make_law("linear"), points, increment, axisymmetric=axisymmetric)[2]
        mean = stress[0, :, :3].mean(axis=1)
        np.testing.assert_allclose(mean, mean[0], rtol=1e-12)


class SmallShell(Shell):
    """A shell with small displacements: positions and directors stay."""

    def evaluate(self, increment, penalty=0.0):
        q, k = self.state[1].shape[1:3]
        n = 6 * self.nodes
        new, volume = [a.copy() for a in self.state], np.zeros((1, q, k))
        force, stiffness = np.zeros((1, n, _core.pack_width)), np.zeros((1, n, n, _core.pack_width))
        cell, fault = _core.evaluate_shells(
            self.element, self.cells, self.cells, self.points, self.points, increment, self.director, *self.rule,
            self.law, dt=1.0, penalty=penalty, state_n=self.state, state=new, volume=volume, force=force,
            stiffness=stiffness, symmetric=False, small_displacements=True,
        )  # fmt: skip
        assert cell == -1, fault
        return force[0, :, 0], stiffness[0, :, :, 0], new, volume

    def accept(self, increment):
        self.state = self.evaluate(increment)[2]


@pytest.mark.parametrize("element", SHELLS)
def test_shells_tangent_is_the_symmetric_derivative_of_the_force(element):
    shell = SmallShell(element, PLASTIC)
    shell.accept(random_increment(shell.nodes, 0.01, 0.1, 1))
    increment = random_increment(shell.nodes, 0.01, 0.1, 2)
    _, stiffness, new, _ = shell.evaluate(increment)
    assert new[2][..., 0].max() > shell.state[2][..., 0].max(), "it flows"
    step = 3e-7
    for i in range(6 * shell.nodes):
        change = np.zeros_like(increment)
        change.flat[i] = step
        slope = (shell.evaluate(increment + change)[0] - shell.evaluate(increment - change)[0]) / (2 * step)
        np.testing.assert_allclose(stiffness[:, i], slope, atol=3e-8 * np.abs(stiffness).max())
    if element != "shell4_1pt":  # its hourglass stress depends on the layers' flow, but not they on it
        np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-11 * np.abs(stiffness).max())


@pytest.mark.parametrize("element", SHELLS)
def test_shells_answer_elastically_in_proportion_whatever_the_increments(element):
    """Ten increments and one give the same stress; a hundredfold displacement a hundredfold force."""
    increment = random_increment(SmallShell(element, ELASTIC).nodes, 0.05, 0.5, 5)
    whole = SmallShell(element, ELASTIC)
    force, _, _, _ = whole.evaluate(increment)
    small = whole.evaluate(0.01 * increment)[0]
    scale = np.abs(force).max()
    np.testing.assert_allclose(100 * small, force, atol=1e-10 * scale)
    parts = SmallShell(element, ELASTIC)
    for _ in range(9):
        parts.accept(0.1 * increment)
    np.testing.assert_allclose(parts.evaluate(0.1 * increment)[0], force, atol=1e-9 * scale)


@pytest.mark.parametrize("element", SHELLS)
def test_shells_feel_nothing_of_a_rotation_to_first_order(element):
    shell = SmallShell(element, ELASTIC)
    spin = np.array([0.7, -0.4, 1.1])
    increment = np.column_stack([np.cross(spin, shell.points), np.tile(spin, (shell.nodes, 1))])
    force, stiffness, _, _ = shell.evaluate(increment)
    assert np.abs(force).max() < 1e-12 * np.abs(stiffness).max()
