# SPDX-License-Identifier: Apache-2.0
"""Parts of revolution and square cups for the one-step solver, and its axisymmetric problem solved another way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import solve_banded

from presswork.mesh.triangles import find_rims
from presswork.model import FloatArray, Hardening, IntArray, Material, OneStepModel, YieldFunction

SWIFT = (565.32, 0.007117, 0.2589)
"""NUMISHEET'93 mild steel."""
YOUNG = 206e3
THICKNESS = 0.78
NO_TRIANGLES = np.zeros((0, 3), dtype=np.int32)
NO_QUADS = np.zeros((0, 4), dtype=np.int32)


def steel(hill: tuple[float, ...] | None = None) -> Material:
    chosen = None if hill is None else YieldFunction("hill1948", hill)
    return Material("steel", YOUNG, 0.3, Hardening("swift", np.array(SWIFT)), chosen)


def make_model(points: FloatArray, triangles: IntArray, quads: IntArray, **changes: object) -> OneStepModel:
    """Return a frictionless model of membrane alone unless changes say otherwise."""
    cells = np.concatenate([triangles, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)])
    rims = tuple(sorted(find_rims(points, cells), key=len, reverse=True))
    given: dict[str, object] = {
        "title": "", "points": points, "triangles": triangles, "quadrilaterals": quads, "rims": rims,
        "material": steel(), "thickness": THICKNESS, "rolling_direction": 0.0, "symmetry": (False, False),
        "holder_force": 0.0, "mu": 0.0, "layers": 1,
    }  # fmt: skip
    return OneStepModel(**{**given, **changes})  # type: ignore[arg-type]


def revolve(profile: FloatArray, around: int) -> tuple[FloatArray, IntArray]:
    """Turn a profile (n, 2) of r and z, beginning on the axis, into quadrilaterals; its first ring holds a fan of them.

    around: cells in a circle, an even number.
    """
    angle = 2.0 * np.pi * np.arange(around) / around
    rings = profile[1:, 0][:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)[None]
    z = np.broadcast_to(profile[1:, 1][:, None], rings.shape[:2])
    points = np.concatenate([[[0.0, 0.0, profile[0, 1]]], np.dstack([rings, z]).reshape(-1, 3)])
    ring = 1 + np.arange(around * (len(profile) - 1)).reshape(-1, around)
    after = np.roll(ring, -1, axis=1)
    quads = np.stack([ring[:-1], ring[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    return points, quads.astype(np.int32)


def fan(around: int) -> IntArray:
    """Return the triangles about the axis that go with revolve."""
    ring = 1 + np.arange(around)
    return np.stack([np.zeros(around, dtype=int), ring, np.roll(ring, -1)], axis=1).astype(np.int32)


def cup_profile(radius: float, corner: float, height: float, flange: float, size: float) -> FloatArray:
    """Return a cup of mid-surface radii: bottom, corner, wall, shoulder of the same corner radius, flange."""

    def arc(r: float, z: float, start: float, stop: float) -> FloatArray:
        n = max(4, int(np.ceil(corner * np.pi / 2 / size)))
        a = np.linspace(start, stop, n + 1)
        return np.stack([r + corner * np.cos(a), z + corner * np.sin(a)], axis=1)

    def line(r0: float, z0: float, r1: float, z1: float) -> FloatArray:
        n = max(1, int(np.ceil(np.hypot(r1 - r0, z1 - z0) / size)))
        return np.stack([np.linspace(r0, r1, n + 1), np.linspace(z0, z1, n + 1)], axis=1)

    parts = [
        line(0.0, 0.0, radius - corner, 0.0),
        arc(radius - corner, corner, -np.pi / 2, 0.0),
        line(radius, corner, radius, height - corner),
        arc(radius + corner, height - corner, np.pi, np.pi / 2),
        line(radius + corner, height, flange, height),
    ]
    return np.concatenate([parts[0], *(p[1:] for p in parts[1:])])


def solve_of_revolution(profile: FloatArray, stress: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the radii in the blank of a profile's points, from equilibrium of rings: d(r T1) = T2 dr.

    stress: effective stress at effective strains. Deformation theory of von Mises in principal axes: sigma_1 =
    4/3 (stress/strain) (e1 + e2/2); the sheet carries with its first thickness where it has thinned. Finite volumes
    on meridian and hoop.
    """
    r, z = profile.T
    length = np.hypot(np.diff(r), np.diff(z))
    middle = 0.5 * (r[1:] + r[:-1])

    def tensions(blank: FloatArray) -> tuple[FloatArray, FloatArray]:
        full = np.concatenate([[0.0], blank])
        e1 = np.log(length / np.diff(full))
        e2 = np.log(middle / (0.5 * (full[1:] + full[:-1])))
        effective = np.sqrt(4.0 / 3.0 * (e1**2 + e1 * e2 + e2**2)) + 1e-14
        secant = 4.0 / 3.0 * stress(effective) / effective
        carrying = THICKNESS * np.exp(np.maximum(-e1 - e2, 0.0))
        return secant * (e1 + e2 / 2) * carrying, secant * (e2 + e1 / 2) * carrying

    def unbalanced(blank: FloatArray) -> FloatArray:
        if (np.diff(np.concatenate([[0.0], blank])) <= 0).any():
            return np.full(len(blank), 1e6)
        t1, t2 = tensions(blank)
        hoop = 0.5 * t2 * np.diff(r)
        inside = middle[:-1] * t1[:-1] - middle[1:] * t1[1:] + hoop[:-1] + hoop[1:]
        return np.concatenate([inside, [middle[-1] * t1[-1] + hoop[-1]]])

    blank = np.sqrt(np.cumsum(2.0 * middle * length))  # of constant area
    now = unbalanced(blank)
    for _ in range(200):
        move = solve_banded((1, 1), _three_diagonals(unbalanced, blank), -now)
        step = 1.0
        while np.linalg.norm(unbalanced(blank + step * move)) > (1 - 1e-3 * step) * np.linalg.norm(now) and step > 1e-9:
            step *= 0.5
        blank = blank + step * move
        now = unbalanced(blank)
        if np.abs(now).max() < 1e-7 * np.abs(tensions(blank)[0]).max() * r.max():
            break
    assert np.abs(now).max() < 1e-6 * np.abs(tensions(blank)[0]).max() * r.max()
    return np.concatenate([[0.0], blank])


def _three_diagonals(function: Callable[[FloatArray], FloatArray], x: FloatArray) -> FloatArray:
    """Return the banded derivative (3, n) of a function each value of which knows its neighbours alone."""
    n, h = len(x), 1e-6
    bands = np.zeros((3, n))
    for colour in range(3):
        shift = np.where(np.arange(n) % 3 == colour, h, 0.0)
        slope = (function(x + shift) - function(x - shift)) / (2.0 * h)
        for j in range(colour, n, 3):
            for i in range(max(0, j - 1), min(n, j + 2)):
                bands[1 + i - j, j] = slope[i]
    return bands


def flow_stress(effective: FloatArray) -> FloatArray:
    """Return Swift's stress at total strains, elastic below yield, by bisection."""
    k, e0, n = SWIFT
    low, high = np.zeros_like(effective), effective.copy()
    for _ in range(80):
        p = 0.5 * (low + high)
        over = YOUNG * (effective - p) > k * (e0 + p) ** n
        low, high = np.where(over, p, low), np.where(over, high, p)
    elastic = YOUNG * effective < k * e0**n
    return np.where(elastic, YOUNG * effective, k * (e0 + 0.5 * (low + high)) ** n)
