# SPDX-License-Identifier: Apache-2.0
"""A made-up run: a billet of radius 10 and height 15 (the upper half) upset by a die, with invented smooth fields."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.model import CellBlock, FloatArray, IntArray, Mesh
from presswork.results import History, append_step, history_columns, write_summary

DIE = np.array([[14.0, 15.0, -2.0, 15.0, 0.0, 0.0, 0.0]])
"""A flat die above the billet, metal above."""

# Offsets of a cell's nodes on a grid of half cells: corners, mid-sides, centre.
_QUAD = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
_TRIANGLES = [
    [(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)],
    [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)],
]


def make_mesh(elements: tuple[str, ...] = ("quad4",), n: int = 4) -> Mesh:
    """Mesh 10 x 15 with n x n squares, split into columns of equal width, one for each element."""
    grid: dict[tuple[int, int], int] = {}
    blocks = []
    for number, element in enumerate(elements):
        family, count = element[:-1].split("_")[0][:4], int(element.split("_")[0][-1:])
        shapes = [_QUAD[:count]] if family.startswith("quad") else [t[:count] for t in _TRIANGLES]
        columns = range(number * n // len(elements), (number + 1) * n // len(elements))
        cells = [
            [grid.setdefault((2 * i + a, 2 * j + b), len(grid)) for a, b in shape]
            for i in columns
            for j in range(n)
            for shape in shapes
        ]
        blocks.append(CellBlock(element, np.array(cells, dtype=np.int32), 0))  # type: ignore[arg-type]
    points = np.array(list(grid)) * np.array([10.0, 15.0]) / (2 * n)
    return Mesh(points, tuple(blocks), {}, {}, _boundary(blocks))


def _boundary(blocks: list[CellBlock]) -> IntArray:
    """Edges that belong to one cell only; of meshes that mix orders the mid-sides are dropped."""
    edges: dict[frozenset[int], list[int]] = {}
    for block in blocks:
        corners = 3 if block.element.startswith("tri") else 4
        quadratic = block.connectivity.shape[1] >= 2 * corners
        for cell in block.connectivity.tolist():
            for a in range(corners):
                edge = [cell[a], cell[(a + 1) % corners], *([cell[corners + a]] if quadratic else [])]
                key = frozenset(edge[:2])
                edges[key] = [] if key in edges else edge
    kept = [edge for edge in edges.values() if edge]
    length = min(len(edge) for edge in kept)
    return np.array([edge[:length] for edge in kept], dtype=np.int32)


def upset(points: FloatArray, stroke: float) -> FloatArray:
    """Displacement, shape (n, 3), of a billet that keeps its volume roughly and barrels."""
    x, y = points.T
    height = 15.0 - stroke
    widening = np.sqrt(15.0 / height) - 1.0
    bulge = 1.25 - 0.75 * (y / 15.0) ** 2
    return np.column_stack([x * widening * bulge, -stroke * y / 15.0, 0 * x])


def make_fields(mesh: Mesh, stroke: float) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Point and cell data of one step."""
    x, y = mesh.points.T
    top = np.isclose(y, 15.0) & (stroke > 0)
    pressure = np.where(top, 500 + 20 * stroke * (1 - x / 12), 0.0)
    shear = np.where(top, 10 * x, 0.0)
    centres = np.concatenate([mesh.points[b.connectivity].mean(axis=1) for b in mesh.blocks])
    strain = stroke / 15.0 * (1.5 - centres[:, 1] / 15.0 * (1 - centres[:, 0] / 20.0))
    effective = 300 + 400 * np.sqrt(strain)
    stress = np.outer(effective, [0.2, -1.0, 0.2, 0.1, 0.0, 0.0])
    point_data = {
        "displacement": upset(mesh.points, stroke),
        "contact_pressure": pressure,
        "contact_shear": shear,
        "contact_force": np.column_stack([shear, -pressure, 0 * x]),
    }
    cell_data = {
        "equivalent_plastic_strain": strain,
        "effective_stress": effective,
        "stress": stress,
        "hydrostatic_stress": stress[:, :3].mean(axis=1),
    }
    return point_data, cell_data


def write_upset_output(folder: Path, elements: tuple[str, ...] = ("quad4",), n: int = 4, steps: int = 4) -> Path:
    """Write an output folder with `steps` saved steps, the first one undeformed, down to 60 % reduction."""
    folder.mkdir(parents=True, exist_ok=True)
    mesh = make_mesh(elements, n)
    history = History(folder / "history.csv", history_columns(["die"]))
    for increment, stroke in enumerate(np.linspace(0.0, 9.0, steps)):
        point_data, cell_data = make_fields(mesh, stroke)
        append_step(
            folder / "results.vtkhdf",
            mesh,
            stroke / 9.0,
            point_data,
            cell_data,
            tools={"die": DIE},
            tool_displacement={"die": np.array([0.0, -stroke])},
            info={"title": "Upsetting of a billet", "analysis": "axisymmetric"},
        )
        force = 4e5 * stroke**0.4 + 3e4 * stroke
        row = {"die.stroke": stroke, "die.force": force, "die.force_x": 0.0, "die.force_y": force, "die.force_z": 0.0}
        history.append({"time": stroke / 9.0, "stage": "press", "increment": increment, "iterations": 3, **row})
    write_summary(folder / "summary.json", {"status": "completed", "increments": steps})
    return folder
