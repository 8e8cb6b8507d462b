# SPDX-License-Identifier: Apache-2.0
"""B-spline faces of tools: within 0.02 mm of the corners of triangles drawn in closed form, also after STEP."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from presswork.geometry.foot_on_triangles import find_feet
from presswork.geometry.spline_face import SplineFace, fit_face
from presswork.mesh.files.cad import read_cad
from presswork.mesh.files.step_faces import pack_faces
from presswork.model import FloatArray, IntArray, Triangulation
from presswork.study.compensated_tools import PressedTool
from presswork.study.tool_faces import WITHIN, SheetInTools, fit_tool

THICKNESS = 1.0


def draw_hat(offset: float, spacing: float, beyond: float = 0.0) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return half of a hat off its middle line: points, their places in the flat blank, triangles.

    A bottom of 20 mm, radii of 5 mm, a wall of 80 degrees, a flange of 15 mm; it is bent a little along y.
    """
    steep, s = np.radians(80.0), np.arange(0.0, 60.0 + beyond, spacing)
    ends = np.cumsum([20.0, 5.0 * steep, 12.0, 5.0 * steep])
    fine = np.linspace(0.0, s[-1], 20_001)
    slope = np.interp(fine, ends, [0.0, steep, steep, 0.0])
    step = fine[1]
    line = np.stack(
        [(np.cumsum(np.cos(slope)) - 1.0) * step, np.cumsum(np.sin(slope)) * step, -np.sin(slope), np.cos(slope)]
    )
    x, z, n_x, n_z = (np.interp(s, fine, each) for each in line)
    y = np.arange(-10.0, 10.0 + 0.5 * spacing, spacing)
    grid = np.stack([*np.broadcast_arrays((x + offset * n_x)[:, None], y, (z + offset * n_z)[:, None])], axis=2)
    grid[..., 2] += 0.002 * grid[..., 1] ** 2
    flat = np.stack(np.broadcast_arrays(s[:, None], y), axis=2)
    n = len(y)
    i = (np.arange(len(s) - 1)[:, None] * n + np.arange(n - 1)).ravel()
    cells = np.concatenate([np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])])
    return grid.reshape(-1, 3), flat.reshape(-1, 2), cells.astype(np.int32)


def as_tool(points: FloatArray, triangles: IntArray) -> PressedTool:
    shape = Triangulation(points, triangles, is_closed=False)
    return PressedTool("die", "die", shape, np.zeros(3), np.zeros(3))


def test_a_face_follows_a_half_circle_within_a_tolerance() -> None:
    rng = np.random.default_rng(3)
    angle, y = rng.uniform(0.0, np.pi, 4000), rng.uniform(0.0, 10.0, 4000)
    points = np.stack([8.0 * np.cos(angle), y, 8.0 * np.sin(angle)], axis=1)
    face = fit_face(points, np.stack([8.0 * angle, y], axis=1), 4.0, 0.01)
    assert face.off <= 0.01
    u, v = np.meshgrid(np.linspace(0.5, 8.0 * np.pi - 0.5, 60), np.linspace(0.5, 9.5, 20))
    place = face.evaluate(u.ravel(), v.ravel())
    assert np.abs(np.hypot(place[:, 0], place[:, 2]) - 8.0).max() < 0.02


def fit_die(beyond: float = 0.0) -> tuple[PressedTool, list[SplineFace]]:
    formed, flat, cells = draw_hat(0.0, 1.5)
    points, _, triangles = draw_hat(-0.5 * THICKNESS, 0.8, beyond)
    die = as_tool(points, triangles)
    sheet = SheetInTools(formed, flat, cells, (False, False), THICKNESS)
    return die, list(fit_tool(die, die, sheet, 1.5))


def test_a_die_becomes_one_face_that_ends_with_the_blank() -> None:
    die, (face,) = fit_die(beyond=10.0)
    assert face.off <= WITHIN
    assert len(die.shape.points) > 1000
    reach = face.controls[..., 0].max()
    assert reach < draw_hat(0.0, 1.5)[0][:, 0].max() + 1.0  # the die goes on 10 mm beyond


def test_a_half_sheet_gives_the_face_of_the_whole_tool() -> None:
    formed, flat, cells = draw_hat(0.0, 1.5)
    points, _, triangles = draw_hat(-0.5 * THICKNESS, 0.8)
    both = np.concatenate([points, points * (-1.0, 1.0, 1.0)])
    both, index = np.unique(np.round(both, 9), axis=0, return_inverse=True)
    other = triangles[:, ::-1] + len(points)
    whole = as_tool(both, index.reshape(-1)[np.concatenate([triangles, other])].astype(np.int32))
    sheet = SheetInTools(formed, flat, cells, (True, False), THICKNESS)
    (face,) = fit_tool(whole, whole, sheet, 1.5)
    assert face.off <= WITHIN
    assert np.ptp(face.controls[..., 0]) > 1.9 * points[:, 0].max()


@pytest.mark.skipif(find_spec("netgen") is None, reason="needs the extra cad")
def test_open_cascade_reads_the_faces(tmp_path: Path) -> None:
    die, faces = fit_die()
    path = tmp_path / "die.step"
    path.write_bytes(pack_faces("die (corrected)", faces))
    mesh = read_cad(path, 0.02)
    triangles = np.concatenate(mesh.cells["tri3"]).astype(np.int32)
    feet = find_feet(die.shape.points, mesh.points, triangles)
    away = np.linalg.norm(feet.interpolate(mesh.points, triangles) - die.shape.points, axis=1)
    s, y = draw_hat(0.0, 0.8)[1].T
    assert away[(s < 58.0) & (np.abs(y) < 9.0)].max() < 0.04
