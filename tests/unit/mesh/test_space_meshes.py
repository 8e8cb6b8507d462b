# SPDX-License-Identifier: Apache-2.0
"""Hexahedra of cylinders, rings, turned bodies and prisms: volume, shape of the cells, sets, symmetry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.space.schema import SpaceCase
from presswork.mesh.make.box import corner_volumes, node_volumes, read_solid_mesh
from presswork.mesh.space.drawn_up import mesh_turned
from presswork.model import Mesh
from tests.unit.mesh.test_box import two_cells

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 1000}}

PRISM = {"kind": "extruded", "height": 5, "cells": 2}


def build(mesh: dict) -> Mesh:
    case = {
        "title": "a body",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": mesh},
        "materials": {"steel": STEEL},
        "boundary": {"wall": {"set": "back", "fix": ["x", "y", "z"]}},
        "stages": [{"name": "load", "pressure": [{"set": "front", "value": 10}]}],
    }
    return build_model(SpaceCase(**case)).mesh


def volume(mesh: Mesh) -> float:
    return float(node_volumes(mesh.points, mesh.blocks[0].connectivity).sum())


def flattest(mesh: Mesh) -> float:
    """Return the least sine that the edges of a cell span at a corner, looking along z."""
    corners = mesh.points[mesh.blocks[0].connectivity][:, :4, :2]
    out, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = out[..., 0] * back[..., 1] - out[..., 1] * back[..., 0]
    return float((cross / np.linalg.norm(out, axis=2) / np.linalg.norm(back, axis=2)).min())


@pytest.mark.parametrize("angle", [5.0, 30.0, 60.0, 90.0, 120.0, 180.0, 360.0])
def test_a_sector_of_a_cylinder_has_no_degenerate_cell(angle) -> None:
    around = 2 * max(1, round(angle / 20))
    kites = int(np.ceil(angle / 90))
    around = -(-around // (2 * kites)) * 2 * kites
    mesh = build({"kind": "cylinder", "radius": 10, "height": 6, "angle": angle, "cells": [8, around, 3]})
    turn = np.radians(angle / around)
    assert volume(mesh) == pytest.approx(0.5 * around * np.sin(turn) * 100 * 6, rel=1e-12)
    assert (corner_volumes(mesh.points, mesh.blocks[0].connectivity) > 0).all()
    at_axis = np.radians(min(angle / kites, 90.0))
    assert flattest(mesh) > min(0.99 * np.sin(at_axis), 0.6)
    if angle < 360:
        last = mesh.points[mesh.node_sets["last_plane"]]
        out_of_plane = last @ [-np.sin(np.radians(angle)), np.cos(np.radians(angle)), 0.0]
        assert np.abs(out_of_plane).max() < 1e-12
        assert len(last) == len(mesh.node_sets["first_plane"])
        assert len(mesh.face_sets["last_plane"]) == len(mesh.face_sets["first_plane"])


def test_a_quarter_has_its_planes_exactly_on_the_axes_and_mirrors_itself() -> None:
    mesh = build({"kind": "cylinder", "radius": 7, "height": 2, "angle": 90, "cells": [6, 8, 2]})
    assert set(mesh.node_sets["left"]) == set(mesh.node_sets["last_plane"])
    assert (mesh.points[mesh.node_sets["left"], 0] == 0.0).all()
    assert (mesh.points[mesh.node_sets["bottom"], 1] == 0.0).all()
    swapped = mesh.points[:, [1, 0, 2]]
    for point in swapped:
        assert np.linalg.norm(mesh.points - point, axis=1).min() < 1e-12


def test_a_ring_and_a_turned_body_have_their_volume_and_sets() -> None:
    ring = {"kind": "ring", "inner_radius": 3, "outer_radius": 6, "height": 4, "cells": [3, 36, 2]}
    whole = build(ring)
    assert volume(whole) == pytest.approx(36 / 2 * np.sin(np.radians(10)) * 27 * 4, rel=1e-12)
    assert len(whole.face_sets["hole"]) == len(whole.face_sets["rim"]) == 72
    assert "first_plane" not in whole.node_sets
    cone = build({"kind": "turned", "profile": [[10, 1], [10, 3], [4, 7]], "angle": 90, "cells": [5, 8, 6]})
    assert set(np.round(np.unique(cone.points[:, 2]), 9)) == {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}
    shape = 2 * 100 + 4 / 3 * (100 + 40 + 16)
    assert volume(cone) == pytest.approx(8 / 2 * np.sin(np.radians(11.25)) * shape, rel=2e-3)
    pierced = build({"kind": "turned", "profile": [[9, 0], [8, 5]], "hole": 2, "cells": [4, 20, 5]})
    radius = np.linalg.norm(pierced.points[pierced.node_sets["hole"], :2], axis=1)
    np.testing.assert_allclose(radius, 2.0)


def test_a_prism_fills_its_outline() -> None:
    corner = [[0, 0], [10, 0], [10, 4], [4, 4], [4, 10], [0, 10]]
    mesh = build({"kind": "extruded", "outline": corner, "element_size": 1, "bottom": 2, "height": 5, "cells": 4})
    assert volume(mesh) == pytest.approx(64 * 5, rel=1e-12)
    assert flattest(mesh) > 0.5
    assert len(mesh.face_sets["rim"]) + 2 * len(mesh.face_sets["back"]) == len(mesh.boundary_faces)
    half = [[-10, -8], [10, -8], [10, 8], [-10, 8]]
    cut = {"kind": "extruded", "outline": half, "symmetry": ["x", "y"], "element_size": 1, "height": 5, "cells": 4}
    assert volume(build(cut)) == pytest.approx(80 * 5, rel=1e-12)


def test_a_plane_mesh_is_drawn_up(tmp_path) -> None:
    path = tmp_path / "plate.inp"
    path.write_text(
        "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 3, 0\n6, 3, 1\n"
        "*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n2, 2, 5, 6, 3\n"
    )
    mesh = build({"kind": "extruded", "path": str(path), "unit": "cm", "height": 5, "cells": 4})
    assert volume(mesh) == pytest.approx(30 * 10 * 5)


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        ({"kind": "cylinder", "radius": 5, "height": 5, "cells": [6, 7, 2]}, "7 cells around"),
        ({"kind": "cylinder", "radius": 5, "height": 5, "angle": 90, "cells": [4, 8, 2]}, "at most 6"),
        ({"kind": "cylinder", "radius": 5, "height": 5, "cells": [1, 8, 2]}, "two cells along the radius"),
        ({"kind": "cylinder", "radius": 5, "height": 5, "angle": 400, "cells": [4, 8, 2]}, "400"),
        ({"kind": "ring", "inner_radius": 6, "outer_radius": 5, "height": 5, "cells": [4, 8, 2]}, "outer_radius"),
        ({"kind": "turned", "profile": [[5, 0], [5, 3], [4, 3]], "cells": [4, 8, 2]}, "z = 3 follows z = 3"),
        ({"kind": "turned", "profile": [[5, 0], [2, 3]], "hole": 2, "cells": [4, 8, 2]}, "leaves no metal"),
        ({"kind": "extruded", "height": 5, "cells": 2}, "either outline or path"),
        ({"kind": "extruded", "outline": [[0, 0], [1, 0], [1, 1]], "height": 5, "cells": 2}, "missing key"),
        (
            {
                "kind": "extruded",
                "outline": [[0, 0], [9, 0], [9, 9], [5, -3]],
                "element_size": 1,
                "height": 5,
                "cells": 2,
            },
            "crosses",
        ),
        (
            {"kind": "extruded", "outline": [[0, 0], [9, 0], [9, 9]], "element_size": 1e-4, "height": 5, "cells": 99},
            "memory",
        ),
        ({"kind": "extruded", "path": "no.dxf", "element_size": 1, "height": 5, "cells": 2}, "no.dxf"),
        ({"kind": "cylinder", "radius": 5, "height": 5, "cells": [9999, 8000, 5000]}, "memory"),
    ],
)
def test_bad_meshes_are_refused_by_key(mesh, said) -> None:
    with pytest.raises(CaseError, match=said):
        build(mesh)


def test_hexahedra_come_from_ideas_with_groups(tmp_path: Path) -> None:
    points, cells = two_cells()
    lines = ["    -1", "  2411"]
    for node, (x, y, z) in enumerate(points, 1):
        lines += [f"{node:10d}{1:10d}{1:10d}{11:10d}", f"{x:25.16E}{y:25.16E}{z:25.16E}".replace("E", "D")]
    lines += ["    -1", "    -1", "  2412"]
    for label, cell in enumerate(cells, 1):
        lines += [f"{label:10d}{115:10d}{1:10d}{1:10d}{7:10d}{8:10d}", "".join(f"{n + 1:10d}" for n in cell)]
    grip = np.flatnonzero(points[:, 0] == 3.0) + 1
    entities = [f"{7:10d}{label:10d}{0:10d}{0:10d}" for label in grip]
    pairs = ["".join(entities[row : row + 2]) for row in range(0, len(entities), 2)]
    lines += ["    -1", "    -1", "  2467", f"{1:10d}" + f"{0:10d}" * 6 + f"{len(grip):10d}", "grip", *pairs, "    -1"]
    path = tmp_path / "body.unv"
    path.write_text("\n".join(lines) + "\n")
    mesh, notes = read_solid_mesh(path, element="hex8")
    assert not notes
    assert volume(mesh) == pytest.approx(6.0)
    assert len(mesh.face_sets["grip"]) == 1


def test_counts_that_do_not_fit_a_disc_are_refused() -> None:
    with pytest.raises(ValueError, match="multiple of 2"):
        mesh_turned(np.ones(2), None, np.arange(2.0), angle=90.0, cells=(4, 3), element="hex8")


def write_section(path: Path, points: np.ndarray, cells: list[list[int]]) -> Path:
    nodes = [f"{i + 1}, {x}, {y}, 0" for i, (x, y) in enumerate(points)]
    rows = [", ".join(str(n) for n in [i + 1, *(np.array(cell) + 1)]) for i, cell in enumerate(cells)]
    path.write_text("\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=CAX4", *rows]) + "\n")
    return path


def grid_section(path: Path, inner: float, m: int = 4, n: int = 3) -> Path:
    r, z = np.meshgrid(np.linspace(inner, 10.0, m + 1), np.linspace(0.0, 6.0, n + 1))
    first = (np.arange(n)[:, None] * (m + 1) + np.arange(m)).ravel()
    cells = np.column_stack([first, first + 1, first + m + 2, first + m + 1])
    return write_section(path, np.column_stack([r.ravel(), z.ravel()]), cells.tolist())


@pytest.mark.parametrize(
    ("inner", "angle", "around"), [(0.0, 6, 2), (0.0, 90, 8), (0.0, 360, 16), (4.0, 30, 3), (4.0, 360, 24)]
)
def test_a_revolved_section_has_the_volume_of_its_chords(
    inner: float, angle: float, around: int, tmp_path: Path
) -> None:
    path = grid_section(tmp_path / "section.inp", inner)
    mesh = build({"kind": "revolved", "path": str(path), "angle": angle, "around": around})
    chord = np.radians(angle / around)
    assert volume(mesh) == pytest.approx(0.5 * around * np.sin(chord) * (100 - inner**2) * 6, rel=1e-12)
    assert corner_volumes(mesh.points, mesh.blocks[0].connectivity).min() > 0
    assert ("last_plane" in mesh.node_sets) == (angle < 360)
    if angle < 360:
        turned = mesh.points[mesh.node_sets["last_plane"]]
        np.testing.assert_allclose(
            np.arctan2(turned[:, 1], turned[:, 0])[np.hypot(*turned.T[:2]) > 0], np.radians(angle)
        )


@pytest.mark.parametrize(
    ("points", "angle", "around", "told"),
    [
        ([[-1, 0], [5, 0], [5, 5], [-1, 5]], 30, 2, "nodes at x < 0"),
        ([[0, 0], [5, 0], [5, 5], [1, 5]], 30, 2, "touches the axis, and not by one edge"),
        ([[0, 0], [5, 0], [5, 5], [0, 5]], 30, 3, "3 cells around 30 degrees of a body that touches the axis"),
        ([[0, 0], [5, 0], [5, 5], [0, 5]], 360, 6, "give a multiple of 8"),
    ],
)
def test_sections_that_cannot_be_revolved_are_refused(
    points: list[list[float]], angle: float, around: int, told: str, tmp_path: Path
) -> None:
    path = write_section(tmp_path / "section.inp", np.array(points, dtype=float), [[0, 1, 2, 3]])
    with pytest.raises(CaseError, match=told):
        build({"kind": "revolved", "path": str(path), "angle": angle, "around": around})
