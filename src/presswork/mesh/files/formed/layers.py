# SPDX-License-Identifier: Apache-2.0
"""Layers of a formed sheet: their rule, the frame of their stress, forces and moments, and layers of other rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from presswork.mesh.files.dynain import first_sides
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import FloatArray, FormedSheet, Section

Rule = Literal["gauss", "lobatto", "simpson"]
RULES: tuple[Rule, ...] = ("gauss", "simpson", "lobatto")
_ALIKE = 1e-3
"""How far a layer may lie off its place in a rule, over half the thickness."""
MATRIX = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Where a tensor has xx, yy, zz, xy, yz, zx."""


def find_rule(heights: FloatArray) -> Rule | None:
    """Return the rule whose points the layers are; None: of no rule."""
    for rule in RULES:
        if len(heights) >= 2 and (rule != "simpson" or len(heights) % 2 == 1):
            own = thickness_rule(Section(1.0, len(heights), rule))[0]
            if np.abs(own - heights).max() < _ALIKE:
                return rule
    return None


def layer_weights(heights: FloatArray) -> FloatArray:
    """Return weights (k,) that sum to 2: of the layers' rule, or exact for polynomials through all of them."""
    rule = find_rule(heights)
    if rule is not None:
        return thickness_rule(Section(1.0, len(heights), rule))[1]
    powers = np.polynomial.legendre.legvander(heights, len(heights) - 1)
    return np.linalg.solve(powers.T, 2.0 * np.eye(len(heights))[0])


def lamina_frames(sheet: FormedSheet) -> FloatArray:
    """Return x of the material, y and the normal of each shell as rows (n, 3, 3)."""
    _, normal = first_sides(sheet.points, sheet.cells)
    x = sheet.axis - (sheet.axis * normal).sum(axis=1, keepdims=True) * normal
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(normal, x), normal], axis=1)


def lamina_stress(sheet: FormedSheet, frames: FloatArray) -> FloatArray:
    """Return xx, yy and xy of the stress in the frames of lamina_frames (n, k, 3) [MPa]."""
    tensor = np.einsum("cip,ckpq,cjq->ckij", frames, sheet.stress[..., MATRIX], frames)
    return np.stack([tensor[..., 0, 0], tensor[..., 1, 1], tensor[..., 0, 1]], axis=-1)


def resultants(heights: FloatArray, stress: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and bending part of stresses (n, k, m) [MPa]: N = mean t and M = bending t^2/6."""
    weights = layer_weights(heights)
    return 0.5 * np.einsum("k,nkm->nm", weights, stress), 1.5 * np.einsum("k,nkm->nm", weights * heights, stress)


def in_layers(sheet: FormedSheet, rules: Sequence[Rule]) -> tuple[FormedSheet, Rule]:
    """Return the sheet in layers of one of the rules, and which.

    Its own layers stay where they are of such a rule. Else values are interpolated between the layers onto as many of
    the first rule, and stresses get a constant and a linear part so that every force and moment stays.
    """
    own = find_rule(sheet.heights)
    if own is not None and own in rules:
        return sheet, own
    rule = rules[0]
    points = len(sheet.heights) + (rule == "simpson" and len(sheet.heights) % 2 == 0)
    heights = thickness_rule(Section(1.0, max(points, 3), rule))[0]
    stress = _interpolate(sheet.heights, sheet.stress, heights)
    mean, bending = (resultants(sheet.heights, sheet.stress)[i] - resultants(heights, stress)[i] for i in (0, 1))
    unit = resultants(heights, np.broadcast_to(heights[None, :, None], (1, len(heights), 1)))[1].item()
    stress = stress + mean[:, None] + bending[:, None] * heights[:, None] / unit
    plastic = np.maximum(_interpolate(sheet.heights, sheet.plastic_strain[..., None], heights)[..., 0], 0.0)
    return replace(sheet, heights=heights, stress=stress, plastic_strain=plastic), rule


def _interpolate(heights: FloatArray, values: FloatArray, at: FloatArray) -> FloatArray:
    """Return values of layers (n, k, m) at other heights; beyond the outer layers they go on in a straight line."""
    lower = np.clip(np.searchsorted(heights, at) - 1, 0, len(heights) - 2)
    part = (at - heights[lower]) / (heights[lower + 1] - heights[lower])
    return values[:, lower] + part[:, None] * (values[:, lower + 1] - values[:, lower])


def elastic_energy(sheet: FormedSheet, young: float, poisson: float) -> float:
    """Return the elastic energy that the stresses of the sheet store [N mm] (plane stress, isotropic)."""
    stress = lamina_stress(sheet, lamina_frames(sheet))
    xx, yy, xy = np.moveaxis(stress, -1, 0)
    density = (xx**2 + yy**2 - 2.0 * poisson * xx * yy + 2.0 * (1.0 + poisson) * xy**2) / (2.0 * young)
    per_area = 0.5 * sheet.thickness * (density @ layer_weights(sheet.heights))
    return float((per_area * shell_areas(sheet.points, sheet.cells)).sum())


def shell_areas(points: FloatArray, cells: np.ndarray) -> FloatArray:
    """Return the area of each shell (n,) [mm2], half the product of its diagonals."""
    a, b, c, d = points[cells].swapaxes(0, 1)
    return np.asarray(0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1))
