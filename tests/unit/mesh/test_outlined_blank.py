# SPDX-License-Identifier: Apache-2.0
"""Meshes within outlines: the outline is met, cells are well shaped and as large as asked, bad outlines are refused."""

import numpy as np
import pytest

from presswork.geometry.polygon import polygon_area
from presswork.mesh.checks import MeshError, corner_jacobians
from presswork.mesh.make.outlined_blank import mesh_outlined_blank

ANGLE = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
COS, SIN = np.cos(ANGLE), np.sin(ANGLE)
OUTLINES = {
    "circle": 50.0 * np.stack([COS, SIN], axis=1),
    "rounded": 50.0 * np.stack([np.sign(COS) * np.abs(COS) ** 0.5, np.sign(SIN) * np.abs(SIN) ** 0.5], axis=1),
    "rectangle": np.array([[-50.0, -30.0], [50.0, -30.0], [50.0, 30.0], [-50.0, 30.0]]),
    "octagon": np.array([[-50.0, -30], [-30, -50], [30, -50], [50, -30], [50, 30], [30, 50], [-30, 50], [-50, 30]]),
    "flower": (45.0 + 6.0 * np.cos(4 * ANGLE))[:, None] * np.stack([COS, SIN], axis=1),
}


@pytest.mark.parametrize("symmetry", [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("name", OUTLINES)
def test_cells_fill_the_outline_and_are_well_shaped(name, symmetry):
    outline, size = OUTLINES[name], 3.0
    mesh = mesh_outlined_blank(outline, size, symmetry)
    cells, points = mesh.blocks[0].connectivity, mesh.points[:, :2]
    twice = corner_jacobians(points, cells)
    area = 0.25 * twice.sum() * 2 ** sum(symmetry)
    assert area == pytest.approx(polygon_area(outline), rel=3e-3)
    sides = np.linalg.norm(np.roll(points[cells], -1, axis=1) - points[cells], axis=2)
    assert (twice / (sides * np.roll(sides, 1, axis=1))).min() > 0.55
    assert sides.min() > 0.5 * size
    assert sides.max() < 1.4 * size
    for axis, is_cut in enumerate(symmetry):
        if is_cut:
            assert points[:, axis].min() == 0.0
            assert (points[mesh.node_sets["symmetry_" + "xy"[axis]], axis] == 0.0).all()


CROSS = [[-20, -50], [20, -50], [20, -20], [50, -20], [50, 20], [20, 20], [20, 50], [-20, 50], [-20, 20], [-50, 20],
         [-50, -20], [-20, -20]]  # fmt: skip
TEE = [[-50, 50], [-50, 20], [-15, 20], [-15, -60], [15, -60], [15, 20], [50, 20], [50, 50]]
YOKE = [[-50, -50], [50, -50], [50, 50], [20, 50], [20, -20], [-20, -20], [-20, 50], [-50, 50]]
NOTCH = [[-50, -50], [50, -50], [50, 50], [20, 50], [0, 20], [-20, 50], [-50, 50]]


@pytest.mark.parametrize(
    ("corners", "turn", "sine"),
    [(CROSS, 0, 0.4), (TEE, 0, 0.4), (YOKE, 0, 0.4), (YOKE, 20, 0.4), (NOTCH, 0, 0.2), (NOTCH, 20, 0.2)],
)
def test_hollow_corners_are_met_wherever_the_grid_lies(corners, turn, sine):
    """Right angles, and the tip of a notch of 67 degrees, whose cells are sharper."""
    turn = np.radians(turn)
    turned = np.array(corners) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    for size in np.linspace(2.0, 6.0, 9):
        mesh = mesh_outlined_blank(turned, size, (False, False))
        points, cells = mesh.points[:, :2], mesh.blocks[0].connectivity
        twice = corner_jacobians(points, cells)
        sides = np.linalg.norm(np.roll(points[cells], -1, axis=1) - points[cells], axis=2)
        assert 0.25 * twice.sum() == pytest.approx(polygon_area(turned), rel=1e-9)
        assert (twice / (sides * np.roll(sides, 1, axis=1))).min() > sine
        assert sides.min() > 0.35 * size


def test_triangles_are_quarters_of_the_cells():
    quads, triangles = (mesh_outlined_blank(OUTLINES["flower"], 4.0, (True, True), triangles=t) for t in (False, True))
    assert [b.connectivity.shape for b in triangles.blocks] == [(4 * len(quads.blocks[0].connectivity), 3)]
    assert triangles.node_sets["edge"].tolist() == quads.node_sets["edge"].tolist()


def test_nodes_of_the_edge_lie_on_the_outline_and_meet_its_corners():
    outline = OUTLINES["rectangle"]
    mesh = mesh_outlined_blank(outline, 4.0, (False, False))
    edge = mesh.points[mesh.node_sets["edge"], :2]
    assert (np.isclose(np.abs(edge[:, 0]), 50.0) | np.isclose(np.abs(edge[:, 1]), 30.0)).all()
    for corner in outline:
        assert np.linalg.norm(edge - corner, axis=1).min() < 1e-9


def test_the_sense_of_the_outline_does_not_matter():
    outline = OUTLINES["flower"]
    one, other = (mesh_outlined_blank(o, 4.0, (True, True)).points for o in (outline, outline[::-1]))
    assert one.shape == other.shape
    assert np.abs(one - other).max() < 0.4


@pytest.mark.parametrize(
    ("outline", "symmetry", "said"),
    [
        (OUTLINES["circle"][:2], (False, False), "an outline of 2 points"),
        (OUTLINES["circle"] * [1.0, 0.06], (False, False), "too narrow"),
        (OUTLINES["circle"] + [60.0, 0.0], (True, False), "does not reach the symmetry plane x = 0"),
        ([[-9.0, 0], [30, 0], [30, 30], [-9, 30], [-9, 20], [9, 15], [-9, 10]], (True, False), "more than twice"),
    ],
)  # fmt: skip
def test_bad_outlines_are_refused(outline, symmetry, said):
    with pytest.raises(MeshError, match=said):
        mesh_outlined_blank(np.asarray(outline, dtype=float), 4.0, symmetry)
