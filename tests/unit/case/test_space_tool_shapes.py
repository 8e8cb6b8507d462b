# SPDX-License-Identifier: Apache-2.0
"""Shapes of tools in space and what is checked of them: exact distances, facets, symmetry, cells against radii."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, build_model, read_case
from presswork.case.space.schema import SpaceCase
from presswork.examples import copy_example
from presswork.geometry.crossing_facets import find_crossing_facets
from presswork.geometry.pose import find_space_pose, turn_about
from presswork.geometry.swept_tool import draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.geometry.touch_in_space import find_touch_in_space
from presswork.model import Model, SweptProfile, Tool

DOWN = [0, 0, -1]
SYMMETRIC = {"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}}


def build(die: dict[str, Any], folder: Path | None = None) -> Model:
    """A quarter of a block 20 x 20 x 8 mm under a die."""
    data: dict[str, Any] = {
        "title": "pressed",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 10, 8], "cells": [5, 5, 4]}},
        "materials": {"steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 500}}},
        "tools": {"die": {"contact": "frictionless", **die}},
        "boundary": SYMMETRIC | {"back": {"set": "back", "fix": ["z"]}},
        "stages": [{"name": "press", "tools": {"die": {"stroke": 2, "direction": DOWN}}}],
    }
    if folder is not None:
        data["tools"]["die"]["path"] = str(folder / "die.stl")
    return build_model(SpaceCase.model_validate(data))


def distance(shape: str, at: np.ndarray) -> np.ndarray:
    """The exact distance from a sphere, a cylinder and a box [mm]."""
    if shape == "sphere":
        return np.linalg.norm(at, axis=1) - 5.0
    if shape == "cylinder":
        beyond = np.column_stack([np.hypot(at[:, 0], at[:, 1]) - 4.0, np.abs(at[:, 2]) - 5.0])
    else:
        beyond = np.abs(at) - [4.0, 6.0, 5.0]
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0) - 1.0


SHAPES = {
    "sphere": {"shape": "sphere", "radius": 5},
    "cylinder": {"shape": "cylinder", "radius": 5, "length": 12, "edge_radius": 1},
    "box": {"shape": "box", "size": [10, 14, 12], "edge_radius": 1},
}


@pytest.mark.parametrize("shape", SHAPES)
def test_gap_and_normal_of_a_shape_are_exact(shape: str) -> None:
    tool = build({**SHAPES[shape], "position": "touch"}).tools[0]
    surface = make_surface(tool.surface)
    points = np.random.default_rng(1).uniform(-12.0, 12.0, (2000, 3))
    points = points[distance(shape, points) > -0.9]
    gap, normal, _, _ = surface.nearest(points)
    np.testing.assert_allclose(gap, distance(shape, points), atol=1e-12)
    h = 1e-6
    slope = [(distance(shape, points + h * e) - distance(shape, points - h * e)) / (2 * h) for e in np.eye(3)]
    assert (np.abs(np.stack(slope, axis=-1) - normal).max(axis=1) < 1e-6).mean() > 0.99, "but for medial places"
    assert isinstance(tool.surface, SweptProfile)
    drawn, _ = triangulate(tool.surface, 0.01)
    np.testing.assert_allclose(distance(shape, drawn), 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("die", "height"),
    [
        ({"shape": "sphere", "radius": 5}, 13.0),
        ({"shape": "cylinder", "radius": 3, "length": 40, "rotation": {"axis": [1, 0, 0], "angle": 90}}, 11.0),
        ({"shape": "box", "size": [10, 10, 6], "edge_radius": 1}, 11.0),
        ({"shape": "box", "size": [10, 10, 10], "edge_radius": 0}, 13.0),
        ({"shape": "round", "profile": [[0, 2], [4, 2], [4, 9]]}, 6.0),
        ({"shape": "plane", "normal": DOWN}, 8.0),
    ],
)
def test_a_tool_comes_from_afar_until_it_touches(die: dict[str, Any], height: float) -> None:
    assert build({**die, "position": "touch"}).tools[0].position == pytest.approx((0.0, 0.0, height), abs=1e-6)


def test_a_tool_that_comes_between_the_nodes_of_a_face_touches_it(tmp_path: Path) -> None:
    """Its tip is over the middle of a face of 2 mm, far from nodes."""
    tip, rim = np.array([3.0, 3.0, 0.0]), np.array([[0.5, 0.5, 4], [6, 0.5, 4], [6, 6, 4], [0.5, 6, 4]])
    write_stl(tmp_path / "die.stl", np.array([[tip, rim[k], rim[k - 1]] for k in range(4)]))
    model = build({"shape": "file", "path": "die.stl", "position": "touch"}, tmp_path)
    assert model.tools[0].position == pytest.approx((0.0, 0.0, 8.0), abs=1e-6)


def test_a_tool_that_glides_past_nodes_does_not_touch_them() -> None:
    """A cylinder along the side of a block meets what stands out below, not the side."""
    tool = Tool("die", build({**SHAPES["cylinder"], "position": "touch"}).tools[0].surface)
    surface, pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))

    def nearest(points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(pose.to_frame(points)), reach)
        return gap, normal

    side = np.column_stack([np.full(9, 5.0), np.zeros(9), np.linspace(-10.0, 0.0, 9)])
    assert find_touch_in_space(nearest, side, np.array(DOWN, dtype=float)) is None
    below = np.concatenate([side, [[2.0, 0.0, -9.0]]])
    assert find_touch_in_space(nearest, below, np.array(DOWN, dtype=float)) == pytest.approx(3.0, abs=1e-6)


def test_a_node_that_touches_just_before_another_is_not_passed_over() -> None:
    """The second one meets a slope, to which its last, least step is longer than what is left to the first."""

    def nearest(points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        slope = points[:, 0] > 5.0
        gap = np.where(slope, 0.95 * (9.998 - points[:, 2]), 10.0 - points[:, 2])
        return gap, np.where(slope[:, None], [np.sqrt(0.0975), 0.0, -0.95], [0.0, 0.0, -1.0])

    nodes = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    assert find_touch_in_space(nearest, nodes, np.array(DOWN, dtype=float)) == pytest.approx(9.998, abs=1e-6)


def write_stl(path: Path, corners: np.ndarray) -> None:
    """Write facets (n, 3, 3) as text."""
    rows = ["solid die"]
    for facet in corners:
        rows += ["facet normal 0 0 0", "outer loop", *(f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in facet)]
        rows += ["endloop", "endfacet"]
    path.write_text("\n".join([*rows, "endsolid die"]))


def box_facets(low: tuple[float, float, float], high: tuple[float, float, float], n: int = 6) -> np.ndarray:
    """The facets of a box, n x n squares to a face."""
    facets = []
    u = np.linspace(0.0, 1.0, n + 1)
    for axis in range(3):
        for side in (0.0, 1.0):
            for i in range(n):
                for j in range(n):
                    square = np.zeros((4, 3))
                    square[:, axis] = side
                    square[:, (axis + 1) % 3] = u[[i, i + 1, i + 1, i]]
                    square[:, (axis + 2) % 3] = u[[j, j, j + 1, j + 1]]
                    square = square if side else square[::-1]
                    facets += [square[[0, 1, 2]], square[[0, 2, 3]]]
    return np.array(low) + np.array(facets) * np.subtract(high, low)


WHOLE = box_facets((-12.0, -12.0, 8.0), (12.0, 12.0, 14.0))
FINE = box_facets((-12.0, -12.0, 8.0), (12.0, 12.0, 14.0), 16)
BESIDE, ABOVE = np.array([0.7, 0.9, 0.0]), np.array([0.0, 0.0, 30.0])
FILE = {"shape": "file", "path": "die.stl"}


def test_flipped_facets_of_a_file_are_turned_over(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    facets = WHOLE.copy()
    facets[::7] = facets[::7, ::-1]
    write_stl(tmp_path / "die.stl", facets)
    with caplog.at_level(logging.WARNING):
        shape = build(FILE, tmp_path).tools[0].surface
    assert "wound against their neighbours" in caplog.text
    gap, *_ = make_surface(shape).nearest(np.array([[0.0, 0.0, 7.0], [0.0, 0.0, 9.0]]))
    np.testing.assert_allclose(gap, [1.0, -1.0], atol=1e-9)


def turned_box() -> np.ndarray:
    facets = box_facets((-3.0, -3.0, 7.0), (3.0, 3.0, 16.0)) - [0.0, 0.0, 11.0]
    return facets @ turn_about(np.array([0.3, 0.2, 0.1])).T + [0.1, 0.2, 14.0]


@pytest.mark.parametrize(
    ("facets", "said"),
    [
        (np.delete(FINE, [1500], axis=0), "facets are missing"),
        (np.concatenate([WHOLE, turned_box()]), "facets pass through each other"),
        (np.concatenate([WHOLE, WHOLE[288:308] + BESIDE]), "facets pass through each other or lie on each other"),
        (box_facets((-12.0, -12.0, 8.0), (7.0, 12.0, 14.0)), r"x = 0 cuts this tool, but its halves differ"),
        (box_facets((-12.0, -12.0, 7.0), (12.0, 12.0, 14.0)), "starts inside the workpiece"),
        (box_facets((0.9, 0.9, 4.0), (1.1, 1.1, 14.0), 1), "starts inside the workpiece|halves differ"),
        (WHOLE + ABOVE, "never reaches the workpiece"),
    ],
    ids=["hole", "crossing", "overlapping", "unlike halves", "in the billet", "through a face", "beside the billet"],
)
def test_a_file_that_is_no_tool_is_refused(facets: np.ndarray, said: str, tmp_path: Path) -> None:
    write_stl(tmp_path / "die.stl", facets)
    with pytest.raises(CaseError, match=said):
        build(FILE, tmp_path)


def test_a_clean_surface_has_no_crossing_facets() -> None:
    tool = build({**SHAPES["box"], "position": "touch"}).tools[0]
    assert isinstance(tool.surface, SweptProfile)
    assert find_crossing_facets(*triangulate(tool.surface, 1e-3)) is None


@pytest.mark.parametrize(
    ("die", "said"),
    [
        ({"shape": "straight", "profile": [[0, 8], [12, 8], [12, 14], [6, 14], [6, 4]]}, "crosses or touches itself"),
        ({"shape": "cylinder", "radius": 3, "length": 4, "edge_radius": 2.5, "position": [0, 0, 20]}, "no room"),
        ({"shape": "box", "size": [4, 0, 4]}, "three values > 0"),
        ({"shape": "sphere", "radius": -1}, "greater than 0|> 0"),
        ({"shape": "file", "path": "die.stl", "tolerance": 0.1}, "CAD file only"),
        ({"shape": "file", "path": "die.step", "unit": "mm"}, "no meaning with a CAD file"),
        ({"shape": "box", "size": [8, 8, 4], "position": [2, 0, 10]}, "halves differ"),
    ],
)
def test_bad_shapes_are_refused(die: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError, match=said):
        build(die)


def test_cells_too_coarse_for_a_radius_are_told_with_the_size_that_would_do(caplog: pytest.LogCaptureFixture) -> None:
    rounded = {"shape": "straight", "profile": [[0, 8], {"to": [6, 8], "radius": 1}, [8, 12], [30, 12]]}
    with caplog.at_level(logging.WARNING):
        build(rounded)
    assert "smallest radius is 1 mm" in caplog.text
    assert "cells of 0.5 mm would do" in caplog.text
    caplog.clear()
    rounded["profile"][1]["radius"] = 3  # type: ignore[index]
    build(rounded)
    assert "would do" not in caplog.text


def test_new_meshes_have_smaller_cells_at_radii(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """The packaged cross rib: edges of 1.9 mm at the start, 0.8 mm at the die's radii of 1.5 mm once it is remeshed."""
    path = copy_example("cross_rib_forging", tmp_path)
    for size, said in ((0.8, False), (1.3, True)):
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            build_model(read_case(path, [f"remesh.smallest_size={size}"]))
        assert ("radius is 1.5 mm, and remesh.smallest_size of 1.3 mm, too coarse" in caplog.text) == said, caplog.text


def test_cells_too_coarse_for_a_radius_of_facets_are_told_with_the_size_that_would_do(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    for radius, said in ((1.0, True), (3.0, False)):
        points, triangles = triangulate(draw_punch((8.0, 8.0), 4.0, radius, 6.0), 0.02)
        write_stl(tmp_path / "die.stl", (points + np.array([0.0, 0.0, 8.0]))[triangles])
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            build(FILE, tmp_path)
        assert ("tools.die: its smallest radius is" in caplog.text) == said, caplog.text
        if said:
            found = float(caplog.text.split("its smallest radius is ")[1].split(" mm")[0])
            assert found == pytest.approx(radius, rel=0.25)


def test_a_ridge_that_a_symmetry_plane_halves_is_as_wide_as_it_is(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    for half, said in ((0.6, True), (1.2, False)):
        write_stl(tmp_path / "die.stl", box_facets((0.0, 0.0, 8.0), (half, 12.0, 14.0)))
        caplog.clear()
        with caplog.at_level(logging.WARNING):
            build(FILE, tmp_path)
        assert (f"a ridge about {2 * half:.2g} mm wide near (" in caplog.text) == said, caplog.text


def test_cells_too_coarse_for_a_ridge_are_told_with_the_size_that_would_do(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    write_stl(tmp_path / "die.stl", box_facets((-0.6, -12.0, 8.0), (0.6, 12.0, 14.0)))
    with caplog.at_level(logging.WARNING):
        build(FILE, tmp_path)
    assert "tools.die: a ridge about 1.2 mm wide near (" in caplog.text
    assert "cells of the workpiece of 2 mm" in caplog.text
    assert "0.6 mm would do" in caplog.text
    caplog.clear()
    write_stl(tmp_path / "die.stl", box_facets((-1.5, -12.0, 8.0), (1.5, 12.0, 14.0)))
    build(FILE, tmp_path)
    assert "would do" not in caplog.text


def test_a_tool_of_a_step_model_has_the_shape_of_its_faces(tmp_path: Path) -> None:
    occ = pytest.importorskip("netgen.occ", reason='no netgen: pip install "presswork[cad]"')
    occ.Cylinder(occ.Pnt(0, 0, 8), occ.Z, r=6, h=10).WriteStep(str(tmp_path / "die.step"))
    die = {"shape": "file", "path": str(tmp_path / "die.step"), "tolerance": 1e-3}
    surface = make_surface(build(die).tools[0].surface, smooth=True)
    gap, normal, _, _ = surface.nearest(np.array([[0.0, 0.0, 7.0], [8.0, 0.0, 13.0], [0.0, 9.0, 14.0]]))
    np.testing.assert_allclose(gap, [1.0, 2.0, 3.0], atol=2e-3)
    np.testing.assert_allclose(normal, [[0, 0, -1], [1, 0, 0], [0, 1, 0]], atol=0.02)
