# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra of 10 nodes from mesh file to picture: file formats, tools that touch mid-side nodes, what is refused."""

import meshio
import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.mesh.faces import face_areas, find_boundary_faces, press_faces
from presswork.mesh.make.box import add_middles, corner_volumes, node_volumes
from presswork.model import CELLS
from presswork.report.surface import find_surface
from presswork.view.all_plots import plot_all
from tests.regression.test_tetrahedra import TEXT as LINEAR
from tests.regression.test_tetrahedra import body
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

TEXT = LINEAR.replace("tet4_mini", "tet10")


def write_mesh(path, points, cells) -> None:
    if path.suffix == ".inp":
        rows = ["*NODE", *(f"{i + 1}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(points.tolist()))]
        rows += ["*ELEMENT, TYPE=C3D10, ELSET=BODY"]
        rows += [", ".join(str(v) for v in (i + 1, *(c + 1))) for i, c in enumerate(cells)]
        path.write_text("\n".join(rows) + "\n")
    elif path.suffix == ".unv":
        rows = ["    -1", "  2411"]
        for i, p in enumerate(points):
            rows += [f"{i + 1:10d}{1:10d}{1:10d}{11:10d}", "".join(f"{v:25.16E}" for v in p)]
        rows += ["    -1", "    -1", "  2412"]
        for i, c in enumerate(cells):
            labels = [f"{v + 1:10d}" for v in c]
            rows += [f"{i + 1:10d}{118:10d}{1:10d}{1:10d}{7:10d}{10:10d}", "".join(labels[:8]), "".join(labels[8:])]
        path.write_text("\n".join([*rows, "    -1"]) + "\n")
    else:
        kwargs = {"file_format": "gmsh22", "binary": False} if path.suffix == ".msh" else {}
        meshio.write(path, meshio.Mesh(points, [("tetra10", cells)]), **kwargs)


def make(folder, text: str = TEXT, ending: str = ".msh"):
    points, cells, _ = add_middles(*body(2), {})
    write_mesh(folder / f"body{ending}", points, cells)
    (folder / "case.toml").write_text(text.replace(".msh", ending))
    return build_model(read_case(folder / "case.toml"))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return make(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def result(model, tmp_path_factory):
    return run_model(model, tmp_path_factory.mktemp("out"), threads=1).result


@pytest.mark.validation
def test_a_run_leaves_history_fields_and_pictures(result, tmp_path) -> None:
    history, summary = result.history, result.summary
    assert history["die.force_z"][-1] == pytest.approx(-history["anvil.force_z"][-1], rel=2e-3)
    assert abs(summary["volume"]["change_percent"]) < 0.3
    assert abs(summary["energy"]["error_percent"]) < 3.0
    assert history["core.equivalent_plastic_strain"][-1] > 0.2
    assert result.points().shape == (125, 3)
    assert {block.connectivity.shape for block in result.mesh.blocks} == {(48, 10)}
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"solid_equivalent_plastic_strain_002.png"} <= pictures


def test_tools_push_at_the_middles_of_the_sides(model, result) -> None:
    """An even pressure loads no corner of a 6-node face; the pressure shown is force over area all the same."""
    pressure, on_die = result.field("contact_pressure"), result.points(0)[:, 2] > 4.99
    corners = np.zeros(len(pressure), dtype=bool)
    corners[model.mesh.blocks[0].connectivity[:, :4]] = True
    assert (pressure[corners] == 0.0).all()
    assert 300.0 < pressure[on_die & ~corners].mean() < 700.0
    assert np.abs(result.points(-1)[on_die & ~corners, 2] - 3.5).max() < 1e-3
    assert np.abs(result.points(-1)[on_die, 2] - 3.5).max() < 0.05 * 2.0  # of an edge: corners follow the body


def test_the_page_gets_every_tetrahedron(result) -> None:
    surface = find_surface(result.mesh, has_inside=True)
    assert surface.hexahedra.shape == (48, 8)
    assert surface.triangles.shape == (6 * 8 * 4, 3)


@pytest.mark.parametrize("ending", [".inp", ".vtk"])
def test_every_format_gives_the_same_mesh(model, tmp_path, ending) -> None:
    other = make(tmp_path, ending=ending).mesh
    np.testing.assert_allclose(other.points, model.mesh.points, atol=1e-12)
    np.testing.assert_array_equal(other.blocks[0].connectivity, model.mesh.blocks[0].connectivity)
    cells = other.blocks[0].connectivity
    np.testing.assert_allclose(
        other.points[cells[:, 4:]], other.points[cells[:, CELLS["tet4"].edges]].mean(axis=2), atol=1e-9
    )


def test_universal_files_are_refused_with_the_formats_that_serve(tmp_path) -> None:
    with pytest.raises(CaseError, match=r"10 nodes \(tetra10\) are not read.*save it as .inp, .msh or .vtk"):
        make(tmp_path, ending=".unv")


def test_a_resumed_run_and_two_threads_give_the_same_bits(model, result, tmp_path) -> None:
    parts = run_in_two_parts(model, tmp_path / "cut", 4, threads=(2, 1))
    assert_same_bits(parts.folder, result.folder)


def test_faces_and_volumes_add_up() -> None:
    points, cells, _ = add_middles(*body(2), {})
    faces, _ = find_boundary_faces([cells])
    areas = face_areas(points, faces)
    assert areas.sum() == pytest.approx(2 * 16.0 + 4 * 20.0)
    assert (areas[:, :3] == 0.0).all()
    force, _ = press_faces(points, faces, 3.0)
    np.testing.assert_allclose(force.sum(axis=(0, 1)), 0.0, atol=1e-12)
    assert node_volumes(points, cells).sum() == pytest.approx(80.0)
    turned = cells[:, [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    np.testing.assert_allclose(corner_volumes(points, turned), -corner_volumes(points, cells))


def test_the_stiffness_of_a_pressure_is_the_derivative_of_its_force() -> None:
    rng = np.random.default_rng(2)
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    points = np.concatenate([corners, 0.5 * (corners + np.roll(corners, -1, axis=0))])
    points += 0.1 * rng.standard_normal(points.shape)
    face = np.arange(6, dtype=np.int32)[None]
    _, stiffness = press_faces(points, face, 7.0)
    for b in range(6):
        for j in range(3):
            move = np.zeros((6, 3))
            move[b, j] = 1e-6
            ahead, behind = (press_faces(points + s * move, face, 7.0)[0][0] for s in (1, -1))
            np.testing.assert_allclose(stiffness[0, :, b, :, j], -(ahead - behind) / 2e-6, atol=1e-7)


@pytest.mark.parametrize(
    ("words", "with_what", "match"),
    [
        ("[output]", "[heat]\ninitial_temperature = 20\n[output]", "tetrahedra of 10 nodes conduct no heat"),
        ("[output]", "[remesh]\nsize = 1\n[output]", "cells of tet10 keep their mesh"),
        ("title =", 'procedure = "explicit"\ntitle =', "the explicit procedure has no such element"),
        ('element = "tet10"', 'element = "tet4_mini"', r"no tetrahedra of 4 nodes.*take element = tet10"),
    ],
)
def test_what_they_cannot_do_is_refused(tmp_path, words, with_what, match) -> None:
    with pytest.raises(CaseError, match=match):
        make(tmp_path, TEXT.replace(words, with_what))
