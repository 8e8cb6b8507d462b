# SPDX-License-Identifier: Apache-2.0
"""Strain, stress and thickness that belong to a blank."""

from __future__ import annotations

import numpy as np

from presswork import _core
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
    f = deformation_gradients(problem, blank)
    value, vector = np.linalg.eigh(np.swapaxes(f, 1, 2) @ f)
    log = 0.5 * np.log(value)
    tensor = np.einsum("nia,na,nja->nij", vector, log, vector)
    strain = np.stack([tensor[:, 0, 0], tensor[:, 1, 1], 2.0 * tensor[:, 0, 1]], axis=1)
    total = np.sqrt(np.einsum("ni,ij,nj->n", strain, np.array(metric).reshape(3, 3), strain))
    stress, _ = problem.law.flow_curve(total)
    thinning = -log.sum(axis=1)
    return {
        "thickness": problem.thickness * np.exp(thinning),
        "thickness_strain": thinning,
        "major_strain_middle": log[:, 1],
        "minor_strain_middle": log[:, 0],
        "equivalent_plastic_strain": np.maximum(total - stress / _young(problem.law), 0.0),
        "effective_stress": stress,
    }


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
