# SPDX-License-Identifier: Apache-2.0
"""A workpiece meshed elsewhere: found beside the case file, scaled, and refused with key, value and remedy."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.mesh import mesh_rectangle
from presswork.mesh.checks import reverse_cells
from presswork.model import FloatArray, IntArray

meshio = pytest.importorskip("meshio")

RECTANGLE = 'kind = "rectangle"\nsize = [10, 15]\ncells = [2, 3]\npattern = "crossed"'
MESH_FILE = 'kind = "file"\npath = "meshes/billet.vtu"\nunit = "cm"'
BILLET = mesh_rectangle(np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.5, 1.0, 1.5]), element="tri3")


@pytest.fixture
def write_mesh(tmp_path: Path) -> Callable[[FloatArray, IntArray], Path]:
    """Return a function that writes triangles to the file that MESH_FILE names."""

    def write(points: FloatArray, cells: IntArray) -> Path:
        path = tmp_path / "meshes" / "billet.vtu"
        path.parent.mkdir()
        flat = np.column_stack([points, np.zeros(len(points))])
        meshio.write(path, meshio.Mesh(flat, [("triangle", cells)]))
        return path

    return write


def test_mesh_file_is_found_beside_the_case_and_scaled(write_case: Callable[..., Path], write_mesh: Any) -> None:
    write_mesh(BILLET.points, BILLET.blocks[0].connectivity)
    built = build_model(Case.from_toml(write_case((RECTANGLE, MESH_FILE))))
    np.testing.assert_allclose(built.mesh.points, 10.0 * BILLET.points)
    assert built.mesh.blocks[0].element == "tri3"


def test_what_was_changed_is_logged(
    write_case: Callable[..., Path], write_mesh: Any, caplog: pytest.LogCaptureFixture
) -> None:
    write_mesh(BILLET.points, reverse_cells(BILLET.blocks[0].connectivity))
    with caplog.at_level(logging.WARNING):
        build_model(Case.from_toml(write_case((RECTANGLE, MESH_FILE))))
    assert "all cells are clockwise: they were turned over" in caplog.text


def test_inverted_cells_are_refused(fail_case: Callable[..., str], write_mesh: Any) -> None:
    cells = BILLET.blocks[0].connectivity.copy()
    cells[3] = cells[3, ::-1]
    write_mesh(BILLET.points, cells)
    message = fail_case((RECTANGLE, MESH_FILE))
    for fragment in ('workpiece.mesh.path = "meshes/billet.vtu"', "1 of 24 cells are inverted", "cell 4", "mesher"):
        assert fragment in message


def test_unconnected_cells_are_refused(fail_case: Callable[..., str], write_mesh: Any) -> None:
    points = np.concatenate([BILLET.points, BILLET.points + np.array([5.0, 0.0])])
    cells = np.concatenate([BILLET.blocks[0].connectivity, BILLET.blocks[0].connectivity + len(BILLET.points)])
    write_mesh(points, cells)
    message = fail_case((RECTANGLE, MESH_FILE))
    for fragment in ("workpiece.mesh.path", "2 parts that share no node", "x 50 to 60", "keep one part"):
        assert fragment in message


def test_file_cut_short_is_refused(fail_case: Callable[..., str], write_mesh: Any) -> None:
    path = write_mesh(BILLET.points, BILLET.blocks[0].connectivity)
    path.write_bytes(path.read_bytes()[:500])
    message = fail_case((RECTANGLE, MESH_FILE))
    for fragment in ("workpiece.mesh.path", "cut short or unreadable", "write it again"):
        assert fragment in message


def test_element_of_other_cells_is_refused(fail_case: Callable[..., str], write_mesh: Any) -> None:
    write_mesh(BILLET.points, BILLET.blocks[0].connectivity)
    message = fail_case((RECTANGLE, MESH_FILE), ('element = "tri3"', 'element = "quad4"'))
    assert "(24 tri3) do not fit element = quad4; choose one of: tri3" in message
