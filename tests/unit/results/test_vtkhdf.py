# SPDX-License-Identifier: Apache-2.0
"""results.vtkhdf reads in VTK as it was written, and is whole after any crash."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time as clock
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from presswork.results import OutputError, Result, ResultError, append_step, count_steps, truncate_steps, vtkhdf
from tests.unit.results.upset_output import DIE, make_fields, make_mesh, write_upset_output

ELEMENTS = {"tri3": 5, "tri6_7pt": 22, "tri6_6pt": 22, "quad4_fbar": 9, "quad8_2x2": 23, "quad9": 28}
MIXED = [("tri3", "quad4", "quad4_fbar"), ("tri6_6pt", "quad8", "quad9")]

_APPEND_FOR_EVER = """
import sys
from presswork.results import append_step, count_steps
from tests.unit.results.upset_output import make_fields, make_mesh
mesh = make_mesh(("quad4",), 40)
for k in range(10**6):
    append_step(sys.argv[1], mesh, float(k), *make_fields(mesh, 1.0))
    print(k, flush=True)
"""


def read_with_vtk(path: Path, step: int) -> tuple[Any, Any]:
    """Return VTK's reader and the wrapped grid of the body at a step."""
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    reader.SetStep(step)
    reader.Update()
    return reader, pyvista.wrap(reader.GetOutputDataObject(0))["body"]


def show_at(path: Path, time: float) -> Any:
    """Return the blocks that VTK's pipeline shows at a time, as ParaView asks for it."""
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateTimeStep(time)
    return pyvista.wrap(reader.GetOutputDataObject(0))


@pytest.mark.parametrize("elements", [*[(e,) for e in ELEMENTS], *MIXED], ids="-".join)
def test_vtk_reads_every_step_as_written(tmp_path: Path, elements: tuple[str, ...]) -> None:
    write_upset_output(tmp_path, elements, n=6, steps=4)
    mesh = make_mesh(elements, 6)
    for step, stroke in enumerate(np.linspace(0.0, 9.0, 4)):
        reader, grid = read_with_vtk(tmp_path / "results.vtkhdf", step)
        assert reader.GetNumberOfSteps() == 4
        types = np.concatenate([np.full(len(b.connectivity), VTK_TYPE(b.element)) for b in mesh.blocks])
        np.testing.assert_array_equal(grid.celltypes, types)
        np.testing.assert_array_equal(grid.points[:, :2], mesh.points)
        connectivity = np.concatenate([b.connectivity.ravel() for b in mesh.blocks])
        np.testing.assert_array_equal(grid.cell_connectivity, connectivity)
        point_data, cell_data = make_fields(mesh, stroke)
        for name, values in point_data.items():
            np.testing.assert_array_equal(grid.point_data[name], values)
        for name, values in cell_data.items():
            np.testing.assert_array_equal(grid.cell_data[name], values)


def VTK_TYPE(element: str) -> int:  # noqa: N802
    """The type that VTK's documentation gives."""
    return {"tri3": 5, "tri6": 22, "quad4": 9, "quad8": 23, "quad9": 28}[element.split("_")[0]]


@pytest.mark.parametrize("element", ELEMENTS)
def test_vtk_finds_the_mesh_area(tmp_path: Path, element: str) -> None:
    write_upset_output(tmp_path, (element,), n=4, steps=1)
    _, grid = read_with_vtk(tmp_path / "results.vtkhdf", 0)
    assert grid.compute_cell_sizes()["Area"].sum() == pytest.approx(150.0)


def test_fields_carry_their_units(tmp_path: Path) -> None:
    with h5py.File(write_upset_output(tmp_path) / "results.vtkhdf") as file:
        assert file["VTKHDF/body/PointData/displacement"].attrs["units"] == "mm"
        assert file["VTKHDF/body/CellData/stress"].attrs["units"] == "MPa"


def test_truncated_file_reads_in_vtk_and_grows_again_to_the_same(tmp_path: Path) -> None:
    path = write_upset_output(tmp_path, steps=4) / "results.vtkhdf"
    whole = Result(tmp_path).field("stress", 3), Result(tmp_path).tool_displacement("die", 3)
    truncate_steps(path, 2)
    assert count_steps(path) == 2
    assert read_with_vtk(path, 1)[0].GetNumberOfSteps() == 2
    mesh = make_mesh()
    for stroke in (6.0, 9.0):
        append_step(path, mesh, 1.0, *make_fields(mesh, stroke), tool_displacement={"die": np.array([0.0, -stroke])})
    np.testing.assert_array_equal(Result(tmp_path).field("stress", 3), whole[0])
    np.testing.assert_array_equal(Result(tmp_path).tool_displacement("die", 3), whole[1])
    np.testing.assert_array_equal(read_with_vtk(path, 3)[1].cell_data["stress"], whole[0])


def test_truncating_to_nothing_removes_the_file_and_to_more_is_refused(tmp_path: Path) -> None:
    path = write_upset_output(tmp_path, steps=2) / "results.vtkhdf"
    with pytest.raises(OutputError, match="holds 2 saved steps, 3 are needed"):
        truncate_steps(path, 3)
    truncate_steps(path, 0)
    assert count_steps(path) == 0


def write_steps(path: Path, steps: list[tuple[tuple[str, ...], int]]) -> None:
    """Write a step for each pair of elements and cells along x; its stroke is its number."""
    for stroke, (elements, n) in enumerate(steps):
        mesh = make_mesh(elements, n)
        append_step(path, mesh, float(stroke), *make_fields(mesh, float(stroke)))


CHANGING = [(("quad4",), 6), (("quad4",), 6), (("tri3", "quad4"), 4), (("tri3", "quad4"), 4), (("quad4",), 6)]


def test_a_mesh_may_change_between_steps(tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    write_steps(path, CHANGING)
    result = Result(tmp_path)
    for step, (elements, n) in enumerate(CHANGING):
        mesh = make_mesh(elements, n)
        _, grid = read_with_vtk(path, step)
        connectivity = np.concatenate([b.connectivity.ravel() for b in mesh.blocks])
        np.testing.assert_array_equal(grid.points[:, :2], mesh.points)
        np.testing.assert_array_equal(grid.cell_connectivity, connectivity)
        own = result.mesh_at(step)
        assert [b.element for b in own.blocks] == list(elements)
        np.testing.assert_array_equal(own.points, mesh.points)
        np.testing.assert_array_equal(np.concatenate([b.connectivity.ravel() for b in own.blocks]), connectivity)
        np.testing.assert_array_equal(own.boundary_edges, mesh.boundary_edges)
        point_data, cell_data = make_fields(mesh, float(step))
        for name, values in (point_data | cell_data).items():
            np.testing.assert_array_equal(result.field(name, step), values)
            np.testing.assert_array_equal({**grid.point_data, **grid.cell_data}[name], values)
    assert result.mesh_at(1) is result.mesh
    assert result.mesh_at(3) is result.mesh_at(2)


@pytest.mark.parametrize("kept", [1, 2, 3, 4])
def test_steps_on_other_meshes_are_cut_off_with_them(tmp_path: Path, kept: int) -> None:
    """As if they had never been written, when the run goes on."""
    path, other = tmp_path / "results.vtkhdf", tmp_path / "other" / "results.vtkhdf"
    other.parent.mkdir()
    write_steps(path, CHANGING)
    truncate_steps(path, kept)
    for stroke, (elements, n) in enumerate(CHANGING[kept:], kept):
        append_step(path, make_mesh(elements, n), float(stroke), *make_fields(make_mesh(elements, n), float(stroke)))
    write_steps(other, CHANGING)
    with h5py.File(path) as one, h5py.File(other) as two:
        names: dict[str, list[str]] = {"one": [], "two": []}
        one.visit(names["one"].append)
        two.visit(names["two"].append)
        assert names["one"] == names["two"]
        for name in names["one"]:
            if isinstance(one[name], h5py.Dataset):
                np.testing.assert_array_equal(one[name][()], two[name][()], err_msg=name)


def test_non_finite_values_are_kept(tmp_path: Path) -> None:
    mesh = make_mesh()
    point_data, cell_data = make_fields(mesh, 1.0)
    cell_data["effective_stress"][:2] = np.nan, np.inf
    append_step(tmp_path / "results.vtkhdf", mesh, 0.0, point_data, cell_data)
    np.testing.assert_array_equal(Result(tmp_path).field("effective_stress"), cell_data["effective_stress"])


def test_wrong_arrays_are_refused_and_nothing_is_lost(tmp_path: Path) -> None:
    path = write_upset_output(tmp_path, steps=2) / "results.vtkhdf"
    former = path.read_bytes()
    mesh = make_mesh()
    point_data, cell_data = make_fields(mesh, 1.0)
    with pytest.raises(ValueError, match="field stress has shape"):
        append_step(path, mesh, 1.0, point_data, {**cell_data, "stress": np.zeros((3, 6))})
    with pytest.raises(ValueError, match="differ from those of the first step"):
        append_step(path, mesh, 1.0, point_data, {"stress": cell_data["stress"]})
    with pytest.raises(ValueError, match="punch"):
        append_step(path, mesh, 1.0, point_data, cell_data, tool_displacement={"punch": np.zeros(2)})
    assert path.read_bytes() == former
    assert not list(tmp_path.glob("*.tmp"))


def test_crash_in_the_middle_of_an_append_leaves_the_former_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_upset_output(tmp_path, steps=2) / "results.vtkhdf"
    former = path.read_bytes()

    def crash(*_: object) -> None:
        raise RuntimeError("crash")

    monkeypatch.setattr(vtkhdf, "_append_time", crash)
    mesh = make_mesh()
    with pytest.raises(RuntimeError, match="crash"):
        append_step(path, mesh, 1.0, *make_fields(mesh, 1.0))
    assert path.read_bytes() == former
    assert count_steps(path) == 2


@pytest.mark.parametrize("delay", [0.0, 0.01, 0.023])
def test_kill_at_any_instant_leaves_a_readable_file(tmp_path: Path, delay: float) -> None:
    path = tmp_path / "results.vtkhdf"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    command = [sys.executable, "-c", _APPEND_FOR_EVER, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) == 3:
                break
        clock.sleep(delay)
        process.send_signal(signal.SIGKILL)
    steps = count_steps(path)
    assert steps >= 4
    assert Result(tmp_path).field("stress").shape == (1600, 6)
    assert read_with_vtk(path, steps - 1)[0].GetNumberOfSteps() == steps


def test_file_that_is_something_else_is_named(tmp_path: Path) -> None:
    (tmp_path / "results.vtkhdf").write_text("not HDF5")
    with pytest.raises(OutputError, match="cannot be read as a results file"):
        count_steps(tmp_path / "results.vtkhdf")


def test_tools_keep_their_exact_profiles(tmp_path: Path) -> None:
    result = Result(write_upset_output(tmp_path))
    np.testing.assert_array_equal(result.tools["die"], DIE)
    np.testing.assert_array_equal(result.tool_displacement("die", 1), [0.0, -3.0])


ROLL = np.array([[2.0, 0.0, -2.0, 0.0, 0.0, 0.0, 1.0], [-2.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0]])
"""A circle of radius 2 about the origin, in two arcs."""
BLANK_HOLDER = (np.array([[0.0, 0.0, 5.0], [4.0, 0.0, 5.0], [0.0, 3.0, 5.0]]), np.array([[0, 1, 2]], dtype=np.int32))


def write_tools(path: Path, steps: int) -> None:
    mesh = make_mesh()
    for k in range(steps):
        append_step(
            path, mesh, 0.1 * k, *make_fields(mesh, float(k)),
            tools={"roll": ROLL, "body": DIE}, tool_centre={"roll": np.array([0.0, 0.0])},
            surfaces={"Blechhalter 1 ü": BLANK_HOLDER},
            tool_displacement={"roll": np.array([0.5 * k, 0.0]), "Blechhalter 1 ü": np.array([0.0, 0.0, -1.0 * k])},
            tool_angle={"roll": 0.25 * np.pi * k},
        )  # fmt: skip


def test_tools_move_beside_the_body_in_vtk(tmp_path: Path) -> None:
    """At a time as ParaView asks for it; warped by `displacement` like the body; in letters that VTK takes."""
    path = tmp_path / "results.vtkhdf"
    write_tools(path, 3)
    for k in (2, 0, 1):
        blocks = show_at(path, 0.1 * k)
        assert blocks.keys() == ["body", "roll", "body_", "Blechhalter_1__"]
        np.testing.assert_array_equal(
            blocks["body"].point_data["displacement"], make_fields(make_mesh(), float(k))[0]["displacement"]
        )
        roll = blocks["roll"]
        moved = roll.points + roll.point_data["displacement"]
        np.testing.assert_allclose(np.linalg.norm(roll.points, axis=1), 2.0, rtol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(moved - [0.5 * k, 0.0, 0.0], axis=1), 2.0, rtol=1e-6)
        turned = np.array([2.0 * np.cos(0.25 * np.pi * k) + 0.5 * k, 2.0 * np.sin(0.25 * np.pi * k), 0.0])
        np.testing.assert_allclose(moved[0], turned, atol=1e-6)
        assert roll.compute_cell_sizes()["Length"].sum() == pytest.approx(4.0 * np.pi, rel=1e-3)
        holder = blocks["Blechhalter_1__"]
        np.testing.assert_array_equal(holder.point_data["displacement"], np.tile([0.0, 0.0, -k], (3, 1)))
        assert holder.compute_cell_sizes()["Area"].sum() == pytest.approx(6.0)


def test_tools_are_cut_off_with_their_steps(tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    write_tools(path, 3)
    truncate_steps(path, 1)
    blocks = show_at(path, 0.0)
    assert blocks["roll"].n_points == blocks["roll"].point_data["displacement"].shape[0]
    mesh = make_mesh()
    append_step(path, mesh, 0.7, *make_fields(mesh, 1.0), tool_displacement={"roll": np.array([7.0, 0.0])})
    np.testing.assert_allclose(
        show_at(path, 0.7)["roll"].point_data["displacement"], [[7.0, 0.0, 0.0]] * blocks["roll"].n_points
    )


def test_layers_of_a_sheet_are_kept_in_single_precision_and_all_fields_compressed(tmp_path: Path) -> None:
    mesh = make_mesh()
    point_data, cell_data = make_fields(mesh, 1.0)
    cell_data["stress_top"] = cell_data["stress"] + 1.0 / 3.0
    append_step(tmp_path / "results.vtkhdf", mesh, 0.0, point_data, cell_data)
    result = Result(tmp_path)
    np.testing.assert_array_equal(result.field("stress_top"), cell_data["stress_top"].astype(np.float32))
    np.testing.assert_array_equal(result.field("stress"), cell_data["stress"])
    with h5py.File(tmp_path / "results.vtkhdf") as file:
        fields = [f for kind in ("PointData", "CellData") for f in file[f"VTKHDF/body/{kind}"].values()]
        assert {field.compression for field in fields} == {"gzip"}
        assert {field.name.rsplit("/", 1)[1] for field in fields if field.dtype == np.float32} == {"stress_top"}


def test_pyvista_reads_the_blocks_and_steps_as_the_guide_says(tmp_path: Path) -> None:
    path = tmp_path / "results.vtkhdf"
    write_tools(path, 3)
    guide = (Path(__file__).parents[3] / "docs/howto/python.md").read_text("utf-8")
    shown = re.search(r"```python\n(import pyvista.*?)```", guide, re.DOTALL)
    assert shown is not None
    pytest.importorskip("pyvista").OFF_SCREEN = True
    code = shown[1].replace("out/results.vtkhdf", str(path)).replace("square_cup.png", str(tmp_path / "cup.png"))
    names: dict[str, Any] = {}
    exec(code, names)
    assert list(names["times"]) == pytest.approx([0.0, 0.1, 0.2])
    assert names["blocks"].keys()[0] == "body"
    assert np.ptp(names["blocks"]["body"].point_data["displacement"]) > 0


def test_dataframes_hold_history_points_and_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = Result(write_upset_output(tmp_path))
    history = result.to_dataframe()
    assert list(history.columns) == list(result.history)
    np.testing.assert_array_equal(history["die.force"], result.history["die.force"])
    cells = result.to_dataframe("cell", step=1)
    np.testing.assert_array_equal(cells["stress_xy"], result.field("stress_xy", 1))
    np.testing.assert_array_equal(cells["effective_stress"], result.field("effective_stress", 1))
    assert cells.attrs["units"]["stress_xy"] == "MPa"
    points = result.to_dataframe("point", step=1)
    np.testing.assert_array_equal(points[["x", "y"]].to_numpy(), result.points(1))
    np.testing.assert_array_equal(points["displacement_y"], result.field("displacement", 1)[:, 1])
    with pytest.raises(ResultError, match="choices are history, point and cell"):
        result.to_dataframe("cells")  # type: ignore[arg-type]
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ResultError, match=r'pip install "presswork\[dataframe\]"'):
        result.to_dataframe()
