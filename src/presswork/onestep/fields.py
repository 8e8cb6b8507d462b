# SPDX-License-Identifier: Apache-2.0
"""Strain, stress and thickness that belong to a blank."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.explicit.options import layer_rule
from presswork.model import FloatArray
from presswork.onestep.newton import OneStepProblem


def deformation_gradients(problem: OneStepProblem, blank: FloatArray) -> FloatArray:
    """Return F from the blank into each triangle's plane (n, 2, 2)."""
    cells = problem.part.triangles
    d = np.stack([blank[cells[:, 1]] - blank[cells[:, 0]], blank[cells[:, 2]] - blank[cells[:, 0]]], axis=2)
    return np.asarray(problem.part.edges @ np.linalg.inv(d))


def nodal_thickness(problem: OneStepProblem, blank: FloatArray) -> FloatArray:
    """Return the mean thickness of the triangles at each node by area (n_nodes,) [mm]."""
    part = problem.part
    thickness = problem.thickness / np.linalg.det(deformation_gradients(problem, blank))
    weighted = np.repeat(part.areas * thickness / 3.0, 3)
    total = np.bincount(part.triangles.ravel(), weighted, minlength=len(part.points))
    return np.asarray(total / np.maximum(part.nodal_areas, 1e-300))


def triangle_fields(problem: OneStepProblem, metric: list[float], blank: FloatArray) -> dict[str, FloatArray]:
    """Return the fields of the mid-surface of each triangle (n,): true strains, thickness [mm], effective stress [MPa].

    metric: Q by rows, of the law.
    """
    strain, log = _find_strain(deformation_gradients(problem, blank))
    formed = problem.find_formed()
    height, _ = layer_rule(problem.layers, "gauss")
    before = formed[:, np.abs(height) < np.abs(height).min() + 1e-9].mean(axis=1)
    now = problem.law.form(strain, before)
    since = strain - before[:, :3]
    total = np.sqrt(np.einsum("ni,ij,nj->n", since, np.array(metric).reshape(3, 3), since))
    hardened = now[:, 3]
    thinning = -log.sum(axis=1)
    return {
        "thickness": problem.thickness * np.exp(thinning),
        "thickness_strain": thinning,
        "major_strain_middle": log[:, 1],
        "minor_strain_middle": log[:, 0],
        "equivalent_plastic_strain": hardened,
        "effective_stress": _young(problem.law) * (total - (hardened - before[:, 3])),
    }


def form_layers(problem: OneStepProblem, blank: FloatArray) -> FloatArray:
    """Return what each triangle's layers have gone through in the part (n, layers, 4), see DeformationLaw.form."""
    f = deformation_gradients(problem, blank)
    half = 0.5 * problem.thickness / np.linalg.det(f)
    b = problem.part.curvature
    tensor = b[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    height, _ = layer_rule(problem.layers, "gauss")
    formed = problem.find_formed()
    layers = [
        problem.law.form(_find_strain((np.eye(2) + (half * h)[:, None, None] * tensor) @ f)[0], formed[:, k].copy())
        for k, h in enumerate(height)
    ]
    return np.ascontiguousarray(np.stack(layers, axis=1))


def _find_strain(f: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return logarithmic strains in the blank's axes (n, 3: xx, yy, 2 xy), and principal ones, ascending (n, 2)."""
    value, vector = np.linalg.eigh(np.swapaxes(f, 1, 2) @ f)
    log = 0.5 * np.log(value)
    tensor = np.einsum("nia,na,nja->nij", vector, log, vector)
    return np.stack([tensor[:, 0, 0], tensor[:, 1, 1], 2.0 * tensor[:, 0, 1]], axis=1), log


def _young(law: _core.DeformationLaw) -> float:
    """Return the law's modulus, its slope where nothing has flowed."""
    return float(law.flow_curve(np.array([1e-9]))[1][0])


def cell_means(
    problem: OneStepProblem, n_triangles: int, n_quads: int, fields: dict[str, FloatArray]
) -> dict[str, FloatArray]:
    """Return the fields of the mesh's cells: its triangles, then its quadrilaterals, means of four by area."""
    area = problem.part.areas
    means = {}
    for name, values in fields.items():
        parts = (values[n_triangles:] * area[n_triangles:]).reshape(4, n_quads).sum(axis=0)
        weight = area[n_triangles:].reshape(4, n_quads).sum(axis=0)
        means[name] = np.concatenate([values[:n_triangles], parts / weight])
    return means
