# SPDX-License-Identifier: Apache-2.0
"""Tubes and spheres under pressure from inside, as cases, and the mesh of a sphere."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
RADIUS, THICKNESS, K, N = 29.0, 2.0, 500.0, 0.2
"""Of the vessels [mm], their thickness [mm], and their flow stress K strain^N [MPa]."""


def write_sphere(path: Path, n: int) -> None:
    """Write the quarter x, y >= 0 of a sphere, n cells along half an edge of the cube that it is drawn from."""
    half, whole = np.linspace(0.0, 1.0, n + 1), np.linspace(-1.0, 1.0, 2 * n + 1)
    faces: list[tuple[Callable[[float, float], tuple[float, float, float]], Array, Array]] = [
        (lambda a, b: (1.0, a, b), half, whole),
        (lambda a, b: (b, 1.0, a), whole, half),
        (lambda a, b: (a, b, 1.0), half, half),
        (lambda a, b: (b, a, -1.0), half, half),
    ]
    points, cells = [], []
    for place, u, v in faces:
        first, m = len(points), len(v)
        for a in np.tan(np.pi / 4 * u):
            for b in np.tan(np.pi / 4 * v):
                corner = np.array(place(float(a), float(b)))
                points.append(RADIUS * corner / np.linalg.norm(corner))
        cells += [
            [first + i * m + j, first + (i + 1) * m + j, first + (i + 1) * m + j + 1, first + i * m + j + 1]
            for i in range(len(u) - 1)
            for j in range(m - 1)
        ]
    kept, number = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    _write(path, kept, number.reshape(-1)[np.array(cells)].tolist())


def _write(path: Path, points: Array, cells: list[list[int]]) -> None:
    points[np.abs(points) < 1e-9] = 0.0
    meshio.Mesh(points, [("quad", np.array(cells))]).write(path)


TUBE = {"shape": "tube", "diameter": 2 * RADIUS + THICKNESS, "length": 20.0, "element_size": 4.0}
"""Of the middle radius RADIUS."""


def make_case(blank: dict[str, Any], inflow: float, boundary: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Return the case of a vessel that a fluid blows up by a volume [mm3]."""
    hardening = {"law": "swift", "K": K, "e0": 1e-4, "n": N}
    return {
        "title": "vessel",
        "analysis": "stamping",
        "procedure": "implicit",
        "blank": {**blank, "thickness": THICKNESS, "material": "sheet", "symmetry": ["x", "y"]},
        "materials": {"sheet": {"young": "200 GPa", "poisson": 0.3, "density": "7850 kg/m^3", "hardening": hardening}},
        "pressure": {"oil": {"face": "inside", "fluid": {"stiffness": "2 GPa", "room": "50 cm^3"}}},
        "boundary": boundary,
        "stages": [{"name": "burst", "duration": 0.02, "pressure": {"oil": {"inflow": inflow}}}],
        "output": {"steps": 1, "rows": 100},
        **changes,
    }
