# SPDX-License-Identifier: Apache-2.0
"""The one-step kernel: forces against the derivative of its energy, its tangent against finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from presswork import _core
from presswork.model import Hardening, Material, YieldFunction
from presswork.onestep.fields import form_layers
from presswork.onestep.law import find_metric, make_law
from presswork.onestep.newton import Friction, OneStep, OneStepProblem
from presswork.onestep.part import prepare_part

HARDENINGS = {
    "linear": [200.0, 400.0],
    "swift": [565.0, 0.007, 0.26],
    "voce": [150.0, 330.0, 12.0],
    "linear_voce": [150.0, 330.0, 12.0, 80.0],
    "table": [0.0, 180.0, 0.2, 300.0, 1.0, 420.0],
}
HILL = (0.2826, 0.3584, 0.6416, 1.5, 1.5, 1.289)


def material(law: str, hill: tuple[float, ...] | None = None) -> Material:
    chosen = None if hill is None else YieldFunction("hill1948", hill)
    return Material("m", 2e5, 0.3, Hardening(law, np.array(HARDENINGS[law])), chosen)


def bowl(n: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points of a bowl, its quadrilaterals and places in the blank that strain it to about 0.3."""
    rng = np.random.default_rng(3)
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    flat = np.stack([x.ravel(), y.ravel()], axis=1) + 0.05 * rng.normal(size=(n * n, 2))
    points = np.column_stack([10.0 * flat, 4.0 * (flat**2).sum(axis=1)])
    index = np.arange(n * n).reshape(n, n)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    blank = flat @ np.array([[11.5, 1.0], [-0.5, 9.0]]) + 0.2 * rng.normal(size=flat.shape)
    return points, quads.astype(np.int32), blank


def energy(law, metric, part, blank, thickness) -> float:
    """Return the sum of A0 t0 W over the triangles, W integrated from the flow curve."""
    cells = part.triangles
    d = np.stack([blank[cells[:, 1]] - blank[cells[:, 0]], blank[cells[:, 2]] - blank[cells[:, 0]]], axis=2)
    f = part.edges @ np.linalg.inv(d)
    value, vector = np.linalg.eigh(np.swapaxes(f, 1, 2) @ f)
    tensor = np.einsum("nia,na,nja->nij", vector, 0.5 * np.log(value), vector)
    strain = np.stack([tensor[:, 0, 0], tensor[:, 1, 1], 2 * tensor[:, 0, 1]], axis=1)
    total = np.sqrt(np.einsum("ni,ij,nj->n", strain, np.array(metric).reshape(3, 3), strain))
    first = 200.0 / 2e5  # strain at yield
    stress = law.flow_curve(total)[0]
    work = 0.5 * 200.0 * first + 0.5 * (200.0 + stress) * (total - first)  # linear hardening
    return float((part.share * 0.5 * np.linalg.det(d) * thickness * work).sum())


@pytest.mark.parametrize("hill", [None, HILL], ids=["von_mises", "hill"])
def test_forces_are_the_derivative_of_the_work(hill):
    """By the part's own places, at a fixed blank; linear hardening, whose work has a closed form."""
    points, quads, blank = bowl()
    chosen = material("linear", hill)
    metric = find_metric(chosen, 0.3)
    law = make_law(chosen, metric)
    blank = blank * 1.6  # every triangle has thickened, so that none carries with its first thickness
    problem = OneStepProblem(prepare_part(points, quads[:0, :3], quads, with_bending=False), law, 0.8, 300.0, 1)
    forces, _, is_usable = OneStep(problem)._evaluate(blank, law, with_stiffness=False)
    assert is_usable
    h = 1e-4
    for node, axis in ((7, 0), (12, 1), (12, 2), (24, 0)):
        sides = []
        for sign in (1, -1):
            moved = points.copy()
            moved[node, axis] += sign * h
            part = prepare_part(moved, quads[:0, :3], quads, with_bending=False)
            sides.append(energy(law, metric, part, blank, 0.8))
        assert forces[node, axis] == pytest.approx((sides[0] - sides[1]) / (2 * h), rel=1e-6, abs=1e-3)


@pytest.mark.parametrize(("layers", "formed_before"), [(1, False), (3, False), (3, True)])
@pytest.mark.parametrize("law", HARDENINGS)
def test_tangent_against_finite_differences(law, layers, formed_before):
    points, quads, blank = bowl()
    chosen = material(law, HILL)
    compiled = make_law(chosen, find_metric(chosen, 0.4))
    part = prepare_part(points, quads[:0, :3], quads, with_bending=layers > 1)
    level = np.full(len(points), 3.0)
    friction = (Friction(np.linspace(5.0, 20.0, len(points)), level),)
    problem = OneStepProblem(part, compiled, 0.8, 300.0, layers, friction=friction)
    if formed_before:  # on the way to another blank: some layers flow on, others are unloaded
        near = blank * [1.02, 0.995] + 0.02 * np.random.default_rng(5).normal(size=blank.shape)
        problem = replace(problem, formed=form_layers(problem, near))
    solver = OneStep(problem)
    data, _ = solver.matrix(blank, compiled, with_friction=True)
    n = 2 * len(points)
    shape = (n + 4, n + 4)
    matrix = csr_matrix((data, solver._assembler.indices, solver._assembler.indptr), shape=shape).toarray()[:n, :n]
    numeric, h = np.zeros((n, n)), 1e-6
    for j in range(n):
        sides = []
        for sign in (1, -1):
            moved = blank.copy()
            moved[j // 2, j % 2] += sign * h
            sides.append(solver.residual(moved, np.zeros(3), compiled, with_friction=True)[0].ravel())
        numeric[:, j] = (sides[0] - sides[1]) / (2 * h)
    assert np.abs(matrix - numeric).max() < 2e-6 * np.abs(numeric).max()


@pytest.mark.parametrize("law", HARDENINGS)
def test_a_straight_path_in_parts_is_the_path_at_once(law):
    """And on the way back the layer is elastic: it keeps its plastic strain."""
    chosen = material(law, HILL)
    compiled = make_law(chosen, find_metric(chosen, 0.4))
    strain, nothing = np.array([[0.21, -0.08, 0.13]]), np.zeros((1, 4))
    once = compiled.form(strain, nothing)
    parts = nothing
    for share in (0.2, 0.5, 0.7, 1.0):
        parts = compiled.form(share * strain, parts)
    assert parts == pytest.approx(once, rel=1e-9)
    stress = compiled.flow_curve(np.sqrt(np.einsum("ni,ij,nj->n", strain, metric_of(chosen), strain)))[0]
    elastic = strain - once[:, :3]
    assert np.sqrt(np.einsum("ni,ij,nj->n", elastic, metric_of(chosen), elastic)) == pytest.approx(stress / 2e5)
    assert compiled.form(strain - 1.5 * elastic, once) == pytest.approx(once, rel=1e-12)


def metric_of(chosen: Material) -> np.ndarray:
    return np.array(find_metric(chosen, 0.4)).reshape(3, 3)


def test_flow_curve_against_its_definition():
    """Stress at the total strain p + stress / E is the hardening law at p."""
    for law in HARDENINGS:
        compiled = make_law(material(law), find_metric(material(law), 0.0))
        p = np.array([1e-6, 1e-3, 0.02, 0.3, 1.5])
        surface = _core.YieldFunction.hill1948((0.5, 0.5, 0.5, 1.5, 1.5, 1.5))
        hardened = _core.SheetLaw(2e5, 0.3, surface, _core.HardeningLaw[law], HARDENINGS[law])
        stress, slope = (np.asarray(v) for v in hardened.flow_stress(p))
        found, tangent = compiled.flow_curve(p + stress / 2e5)
        assert found == pytest.approx(stress, rel=1e-10)
        assert tangent == pytest.approx(2e5 * slope / (2e5 + slope), rel=1e-8)
        assert compiled.flow_curve(np.array([1e-4]))[0] == pytest.approx([20.0])
