# SPDX-License-Identifier: Apache-2.0
"""A body of tetrahedra from mesh file to picture: tools, every file format, history, resume, threads, heat, laws."""

import meshio
import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.mesh.make.box import mesh_box
from presswork.model import CellBlock
from presswork.report.surface import find_surface
from presswork.view.all_plots import plot_all
from tests.problems.upset_block import describe_block
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

TEXT = describe_block(
    'element = "tet4_mini"\nmesh = {path = "body.msh", unit = "mm"}',
    5,
    0.3,
    "duration = 1.0\ntools.die = {stroke = 1.5, direction = [0, 0, -1]}",
    tail="[points]\ncore = [0.1, 0.1, 2.5]\n[output]\nsteps = 2\ncheckpoint_every = 2\n",
)


def body(n: int = 3):
    """Points and cells of a quarter block, moved inside so that no cell is as another."""
    line = np.linspace(0.0, 4.0, n + 1)
    mesh = mesh_box(line, line, np.linspace(0.0, 5.0, n + 1), element="tet4_mini")
    points = mesh.points.copy()
    inside = ((points > 1e-9) & (points < np.array([4.0, 4.0, 5.0]) - 1e-9)).all(axis=1)
    points[inside] += np.random.default_rng(3).uniform(-0.2, 0.2, (int(inside.sum()), 3))
    return points, mesh.blocks[0].connectivity


def write_mesh(path, points, cells) -> None:
    if path.suffix == ".inp":
        rows = ["*NODE", *(f"{i + 1}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(points.tolist()))]
        rows += ["*ELEMENT, TYPE=C3D4, ELSET=BODY"]
        rows += [", ".join(str(v) for v in (i + 1, *(c + 1))) for i, c in enumerate(cells)]
        path.write_text("\n".join(rows) + "\n")
    elif path.suffix == ".unv":
        rows = ["    -1", "  2411"]
        for i, p in enumerate(points):
            rows += [f"{i + 1:10d}{1:10d}{1:10d}{11:10d}", "".join(f"{v:25.16E}" for v in p)]
        rows += ["    -1", "    -1", "  2412"]
        for i, c in enumerate(cells):
            rows += [f"{i + 1:10d}{111:10d}{1:10d}{1:10d}{7:10d}{4:10d}", "".join(f"{v + 1:10d}" for v in c)]
        path.write_text("\n".join([*rows, "    -1"]) + "\n")
    else:
        kwargs = {"file_format": "gmsh22", "binary": False} if path.suffix == ".msh" else {}
        meshio.write(path, meshio.Mesh(points, [("tetra", cells)]), **kwargs)


def make(folder, text: str = TEXT):
    write_mesh(folder / "body.msh", *body())
    (folder / "case.toml").write_text(text)
    return build_model(read_case(folder / "case.toml"))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return make(tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def result(model, tmp_path_factory):
    return run_model(model, tmp_path_factory.mktemp("out"), threads=1).result


def test_a_run_leaves_history_fields_and_pictures(result, tmp_path) -> None:
    history, summary = result.history, result.summary
    assert history["die.force_z"][-1] == pytest.approx(-history["anvil.force_z"][-1], rel=2e-3)
    assert abs(summary["volume"]["change_percent"]) < 0.3
    assert abs(summary["energy"]["error_percent"]) < 3.0
    assert history["core.equivalent_plastic_strain"][-1] > 0.2
    assert result.points().shape == (64, 3)
    pressure = result.field("contact_pressure")
    on_die = result.points(0)[:, 2] > 4.99
    assert 300.0 < pressure[on_die].mean() < 700.0
    pictures = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"solid_equivalent_plastic_strain_002.png"} <= pictures


def test_the_page_gets_every_tetrahedron(result) -> None:
    surface = find_surface(result.mesh, has_inside=True)
    assert surface.hexahedra.shape == (162, 8)
    assert surface.triangles.shape == (6 * 2 * 9, 3)


@pytest.mark.parametrize("ending", [".inp", ".vtk", ".unv"])
def test_every_format_gives_the_same_mesh(model, tmp_path, ending) -> None:
    write_mesh(tmp_path / f"body{ending}", *body())
    (tmp_path / "case.toml").write_text(TEXT.replace("body.msh", f"body{ending}"))
    other = build_model(read_case(tmp_path / "case.toml")).mesh
    np.testing.assert_allclose(other.points, model.mesh.points, atol=1e-12)
    np.testing.assert_array_equal(other.blocks[0].connectivity, model.mesh.blocks[0].connectivity)
    assert set(other.face_sets) >= {"left", "right", "top", "bottom", "front", "back", "boundary"}


def test_a_resumed_run_and_two_threads_give_the_same_bits(model, result, tmp_path) -> None:
    parts = run_in_two_parts(model, tmp_path / "cut", 4, threads=(2, 1))
    assert_same_bits(parts.folder, result.folder)


LAWS = {
    "hill": 'yield_function = {law = "hill1948", r00 = 1.8, r45 = 1.2, r90 = 2.0}',
    "rate": 'rate = {law = "cowper_symonds", D = 40.0, q = 5.0}',
}


@pytest.mark.parametrize("keys", LAWS.values(), ids=LAWS)
def test_laws_serve_on_tetrahedra(tmp_path, keys) -> None:
    text = TEXT.replace("[tools.die]", keys + "\n[tools.die]")
    found = run_model(make(tmp_path, text), tmp_path / "out", threads=1).result
    assert found.summary["status"] == "completed"
    assert abs(found.summary["volume"]["change_percent"]) < 0.3


def test_hexahedra_in_the_file_are_refused_with_the_element_that_fits(tmp_path) -> None:
    line = np.linspace(0.0, 1.0, 3)
    mesh = mesh_box(line, line, line, element="hex8")
    cells = [("hexahedron", mesh.blocks[0].connectivity)]
    meshio.write(tmp_path / "body.msh", meshio.Mesh(mesh.points, cells), file_format="gmsh22", binary=False)
    (tmp_path / "case.toml").write_text(TEXT)
    with pytest.raises(CaseError, match=r"no tetrahedra of 4 nodes.*take element = hex8 or hex8_fbar"):
        build_model(read_case(tmp_path / "case.toml"))


def test_inverted_tetrahedra_are_turned_over_or_refused(tmp_path) -> None:
    points, cells = body(2)
    write_mesh(tmp_path / "body.msh", points, cells[:, [0, 2, 1, 3]])
    (tmp_path / "case.toml").write_text(TEXT)
    block: CellBlock = build_model(read_case(tmp_path / "case.toml")).mesh.blocks[0]
    np.testing.assert_array_equal(np.sort(block.connectivity), np.sort(cells))
    cells[3] = cells[3][[0, 2, 1, 3]]
    write_mesh(tmp_path / "body.msh", points, cells)
    with pytest.raises(CaseError, match="1 of 48 cells are inverted"):
        build_model(read_case(tmp_path / "case.toml"))
