# SPDX-License-Identifier: Apache-2.0
"""results.vtkhdf: meshes, fields and tools of every saved step, in one file that ParaView opens.

The file is a temporal VTKHDF collection, version 2.1, of unstructured grids: the block `body`, and one for each tool
(vtkhdf_tools.py). All steps on one mesh point to the same points and cells, and each step's fields lie one after the
other, found by their offsets. A step on another mesh than the one before, of a trimmed sheet for instance, adds its own
points and cells: VTK calls these a part. Beside it the group /presswork, which VTK passes over, holds what the pictures
need: cell blocks and boundary edges of each mesh, tool profiles and positions.

Fields are compressed. Tensors at the layers of a sheet, most of its data, are kept in single precision, all else in
double; the table of fields records this and the units.

Every append writes a copy and renames it. HDF5 has no journal, so an append in place that is killed can leave a file
that nothing reads; the copy costs a sequential read and write of the file, and in return the file is whole at any
instant, for ParaView too. Reference: VTK file formats, "VTKHDF File Format" (Kitware).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import find_row, find_unit
from presswork.formability import Info
from presswork.model import FloatArray, IntArray, Mesh, cell_of
from presswork.results.dies import append_dies, truncate_dies, write_dies
from presswork.results.vtkhdf_tools import (
    COMPRESSION,
    append_rows,
    append_tool_steps,
    find_body,
    make_collection,
    truncate_tool_blocks,
    write_tool_blocks,
)
from presswork.results.whole_file import OutputError, copy_content, replace_whole, write_hdf5

_ROWS_PER_CHUNK = 16384
_OVERHEAD_BYTES = 65536
_COUNTS = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
"""Numbers that are kept for each mesh."""
_GEOMETRY_OFFSETS = ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets")
_WITH_A_COLUMN = ("CellOffsets", "ConnectivityIdOffsets")


def append_step(
    path: Path | str,
    mesh: Mesh,
    time: float,
    point_data: Mapping[str, FloatArray],
    cell_data: Mapping[str, FloatArray],
    *,
    tools: Mapping[str, FloatArray] | None = None,
    tool_centre: Mapping[str, FloatArray] | None = None,
    tool_displacement: Mapping[str, FloatArray] | None = None,
    tool_angle: Mapping[str, float] | None = None,
    tool_rotation: Mapping[str, FloatArray] | None = None,
    surfaces: Mapping[str, tuple[FloatArray, IntArray]] | None = None,
    dies: Mapping[str, tuple[FloatArray, IntArray, FloatArray]] | None = None,
    info: Info | None = None,
) -> None:
    """Append one saved step; the first one creates the file.

    `time` [s]. `point_data` and `cell_data` hold arrays of shape (n_points,) or (n_points, k), (n_cells,) or
    (n_cells, k), cells in the order of the blocks; displacement is (n_points, 3), stress (n_cells, 6) as xx, yy, zz,
    xy, yz, xz. The same fields come at every step; a mesh unlike that of the last step is stored beside it. `tools`
    holds each tool's segments, shape (n_segments, 7) as in model.Tool, `tool_centre` the point about which it turns,
    `tool_displacement` its displacement, shape (2,) [mm], and `tool_angle` its angle [rad]; a tool not named has not
    moved. `surfaces` holds the points (n, 3) and triangles (n, 3) of tools in space, whose centre and displacement have
    shape (3,), the latter NaN where a tool is not at work, and `tool_rotation` what they have turned about their
    centres: a vector along the axis with the angle as its length, shape (3,) [rad].
    `tools`, `tool_centre`, `surfaces` and `info` (title, analysis and the like, stored as attributes) are stored with
    the first step only. `dies` holds the mesh of tools that conduct heat, where they start: points (n, 2), cells (m, k)
    and, of this step, temperatures (n,).
    Raises OutputError if the file cannot be written, ValueError if an array has the wrong shape.
    """
    path = Path(path)
    n_cells = sum(len(block.connectivity) for block in mesh.blocks)
    data = {"Point": _check_fields(point_data, len(mesh.points)), "Cell": _check_fields(cell_data, n_cells)}
    is_new = not path.exists()
    added = sum(values.nbytes for fields in data.values() for values in fields.values()) + _OVERHEAD_BYTES
    added += mesh.points.nbytes * 2 + n_cells * 100
    old = 0 if is_new else path.stat().st_size
    with replace_whole(path, needed_bytes=old + added) as new:
        if not is_new:
            copy_content(path, new)
        with write_hdf5(new, "w" if is_new else "r+") as file:
            if is_new:
                _write_frame(file, info or {})
                _write_tools(file, tools or {}, tool_centre or {}, surfaces or {})
                write_dies(file, dies or {})
            body = find_body(file)
            if is_new or not _is_last_mesh(body, mesh):
                _append_mesh(file, mesh)
            for kind, fields in data.items():
                _append_fields(body, kind, fields)
            _append_time(body, time)
            _append_tool_positions(file, tool_displacement or {}, tool_angle or {}, tool_rotation or {})
            append_tool_steps(file)
            append_dies(file, dies or {})


def count_steps(path: Path | str) -> int:
    """Return how many steps the file holds; 0 if there is no file."""
    if not Path(path).exists():
        return 0
    with open_results(path) as file:
        return int(find_body(file)["Steps"].attrs["NSteps"])


def truncate_steps(path: Path | str, n: int) -> None:
    """Keep the first `n` steps, for a run that resumes after them. Raises OutputError if there are fewer."""
    path = Path(path)
    count = count_steps(path)
    if not 0 <= n <= count:
        raise OutputError(f"{path} holds {count} saved steps, {n} are needed; run with --overwrite to start anew")
    if n == count:
        return
    if n == 0:
        path.unlink()
        return
    with replace_whole(path, needed_bytes=path.stat().st_size) as new:
        copy_content(path, new)
        with write_hdf5(new, "r+") as file:
            try:
                _truncate(file, n)
            except (KeyError, ValueError, TypeError, RuntimeError) as error:
                raise OutputError(f"{path} is damaged; run with --overwrite to start anew") from error


@contextmanager
def open_results(path: Path | str) -> Iterator[h5py.File]:
    """Open the file for reading. Raises OutputError if it is not a results file, or what the block reads is damaged."""
    with report_damage(path), open_file(path) as file:
        yield file


def open_file(path: Path | str) -> h5py.File:
    """Open the file for reading, for the caller to close. Raises OutputError if it is not a results file."""
    try:
        file = h5py.File(path, "r")
    except (OSError, ValueError) as error:
        raise OutputError(f"{path} cannot be read as a results file: {error}") from error
    with report_damage(path):
        if "VTKHDF/Steps" not in file or "presswork" not in file:
            file.close()
            raise OutputError(f"{path} is not a results file of presswork")
    return file


@contextmanager
def report_damage(path: Path | str) -> Iterator[None]:
    """Turn any error that reading the file raises in the block into OutputError."""
    try:
        yield
    except OutputError:
        raise
    except Exception as error:  # HDF5 meets damage with errors of every kind
        reason = " ".join(str(error).split())[:100]
        remedy = "run the case again, or copy the folder once more from where it is whole"
        raise OutputError(f"{path} is damaged ({type(error).__name__}: {reason}); {remedy}") from error


def _check_fields(fields: Mapping[str, FloatArray], n_rows: int) -> dict[str, FloatArray]:
    """Return the fields as contiguous float64, or name the one that has the wrong shape."""
    checked = {}
    for name, values in fields.items():
        array = np.ascontiguousarray(values, dtype=np.float64)
        if array.ndim not in (1, 2) or len(array) != n_rows:
            raise ValueError(f"field {name} has shape {array.shape}, expected ({n_rows},) or ({n_rows}, k)")
        checked[name] = array
    return checked


def _write_frame(file: h5py.File, info: Info) -> None:
    """Write what a file without meshes and steps holds."""
    root = make_collection(file)
    for name in _COUNTS:
        root.create_dataset(name, (0,), np.int64, maxshape=(None,), chunks=(16,))
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = 0
    steps.create_dataset("Values", (0,), np.float64, maxshape=(None,), chunks=(256,)).attrs["units"] = "s"
    for name in (*_GEOMETRY_OFFSETS, "NumberOfParts"):
        columns = (1,) if name in _WITH_A_COLUMN else ()
        steps.create_dataset(name, (0, *columns), np.int64, maxshape=(None, *columns), chunks=(256, *columns))
    for kind in ("Point", "Cell"):
        root.create_group(f"{kind}Data")
        steps.create_group(f"{kind}DataOffsets")
    extras = file.create_group("presswork")
    extras.attrs.update(info)
    extras.create_group("meshes")


def _append_mesh(file: h5py.File, mesh: Mesh) -> None:
    """Append points and cells, and what VTK has no place for: the blocks and the boundary edges."""
    root = find_body(file)
    cells = [block.connectivity for block in mesh.blocks]
    nodes_per_cell = np.concatenate([np.full(len(c), c.shape[1]) for c in cells])
    kinds = [np.full(len(b.connectivity), cell_of(b.element).files.vtk) for b in mesh.blocks]
    space = np.zeros((len(mesh.points), 3))
    space[:, : mesh.points.shape[1]] = mesh.points
    rows: dict[str, NDArray[np.generic]] = {
        "Points": space,
        "Connectivity": np.concatenate([c.ravel() for c in cells]).astype(np.int64),
        "Offsets": np.concatenate([[0], np.cumsum(nodes_per_cell)]).astype(np.int64),
        "Types": np.concatenate(kinds).astype(np.uint8),
    }
    for name, values in rows.items():
        if name not in root:
            _create_rows(root, name, values)
        append_rows(root, name, values)
    root["Points"].attrs["units"] = "mm"
    for name, count in zip(_COUNTS, (len(space), len(nodes_per_cell), nodes_per_cell.sum()), strict=True):
        append_rows(root, name, np.array([count]))
    meshes = file["presswork/meshes"]
    own = meshes.create_group(str(len(meshes)))
    own["boundary_edges"] = mesh.boundary_edges
    own["element"] = [block.element for block in mesh.blocks]
    own["n_cells"] = [len(block.connectivity) for block in mesh.blocks]
    own["material"] = [block.material for block in mesh.blocks]


def locate_mesh(file: h5py.File, part: int) -> MeshPlace:
    """Return where a mesh lies among the points, cells and connectivity of all."""
    return _locate_mesh(find_body(file), part)


def _locate_mesh(body: h5py.Group, part: int) -> MeshPlace:
    counts = [body[name][: part + 1] for name in _COUNTS]
    points, cells, ids = (slice(int(count[:part].sum()), int(count[: part + 1].sum())) for count in counts)
    return MeshPlace(points, cells, ids, slice(cells.start + part, cells.stop + part + 1))


@dataclass(frozen=True)
class MeshPlace:
    """Rows of one mesh."""

    points: slice
    cells: slice
    ids: slice
    """Rows of the connectivity."""
    offsets: slice
    """One more than cells."""


def _is_last_mesh(body: h5py.Group, mesh: Mesh) -> bool:
    """Return whether the mesh is that of the last step."""
    place = _locate_mesh(body, len(body["NumberOfPoints"]) - 1)
    ids = np.concatenate([block.connectivity.ravel() for block in mesh.blocks])
    n_cells = sum(len(block.connectivity) for block in mesh.blocks)
    return (
        place.points.stop - place.points.start == len(mesh.points)
        and place.cells.stop - place.cells.start == n_cells
        and np.array_equal(body["Connectivity"][place.ids], ids)
        and np.array_equal(body["Points"][place.points, : mesh.points.shape[1]], mesh.points)
    )


def _write_tools(
    file: h5py.File,
    tools: Mapping[str, FloatArray],
    centres: Mapping[str, FloatArray],
    surfaces: Mapping[str, tuple[FloatArray, IntArray]],
) -> None:
    """Write the tools where they start: profiles, or triangles in space."""
    write_tool_blocks(file, tools, surfaces)
    for name, segments in tools.items():
        tool = file.create_group(f"presswork/tools/{name}")
        tool["segments"] = np.asarray(segments, dtype=np.float64)
        tool["centre"] = np.asarray(centres.get(name, (0.0, 0.0)), dtype=np.float64)
        tool.create_dataset("displacement", (0, 2), np.float64, maxshape=(None, 2), chunks=(256, 2))
        tool.create_dataset("angle", (0,), np.float64, maxshape=(None,), chunks=(256,))
    for name, (points, triangles) in surfaces.items():
        tool = file.create_group(f"presswork/surfaces/{name}")
        tool["points"], tool["triangles"] = points, triangles
        tool["centre"] = np.asarray(centres.get(name, (0.0, 0.0, 0.0)), dtype=np.float64)
        for motion in ("displacement", "rotation"):
            tool.create_dataset(motion, (0, 3), np.float64, maxshape=(None, 3), chunks=(256, 3))


def _append_fields(body: h5py.Group, kind: str, fields: Mapping[str, FloatArray]) -> None:
    """Append one step's rows of every field, and note where they begin."""
    group, offsets = body[f"{kind}Data"], body[f"Steps/{kind}DataOffsets"]
    if len(body["Steps/Values"]) == 0:
        for name, values in fields.items():
            _create_field(group, name, values)
            offsets.create_dataset(name, (0,), np.int64, maxshape=(None,), chunks=(256,))
    elif set(group) != set(fields):
        raise ValueError(f"fields {sorted(fields)} differ from those of the first step, {sorted(group)}")
    for name, values in fields.items():
        append_rows(offsets, name, np.array([append_rows(group, name, values)]))


def _create_rows(group: h5py.Group, name: str, values: NDArray[np.generic]) -> h5py.Dataset:
    """Create an empty dataset whose rows look like those of `values`."""
    columns = values.shape[1:]
    chunks = (max(1, min(len(values), _ROWS_PER_CHUNK)), *columns)
    row = find_row(name)
    dtype = np.float32 if row and row.single else values.dtype
    return group.create_dataset(name, (0, *columns), dtype, maxshape=(None, *columns), chunks=chunks, **COMPRESSION)


def _create_field(group: h5py.Group, name: str, values: FloatArray) -> None:
    """Create an empty field whose rows look like those of `values`."""
    field = _create_rows(group, name, values)
    if unit := find_unit(name):
        field.attrs["units"] = unit


def _append_time(body: h5py.Group, time: float) -> None:
    """Append one step on the last mesh."""
    steps = body["Steps"]
    part = len(body["NumberOfPoints"]) - 1
    place = _locate_mesh(body, part)
    append_rows(steps, "Values", np.array([time]))
    begins = (part, place.points.start, place.cells.start, place.ids.start)
    for name, begin in zip(_GEOMETRY_OFFSETS, begins, strict=True):
        columns = (1,) if name in _WITH_A_COLUMN else ()
        append_rows(steps, name, np.full((1, *columns), begin, dtype=np.int64))
    append_rows(steps, "NumberOfParts", np.ones(1, dtype=np.int64))
    steps.attrs["NSteps"] = len(steps["Values"])


def _append_tool_positions(
    file: h5py.File,
    displacement: Mapping[str, FloatArray],
    angle: Mapping[str, float],
    rotation: Mapping[str, FloatArray],
) -> None:
    """Append where every tool is."""
    tools, surfaces = (file["presswork"].get(group, {}) for group in ("tools", "surfaces"))
    unknown = (set(displacement) | set(angle) | set(rotation)) - set(tools) - set(surfaces)
    if unknown:
        raise ValueError(f"position of {sorted(unknown)}, but the file's tools are {sorted([*tools, *surfaces])}")
    for name, tool in [*tools.items(), *surfaces.items()]:
        size = tool["displacement"].shape[1]
        append_rows(tool, "displacement", np.asarray(displacement.get(name, (0.0,) * size), float).reshape(1, size))
    for name, tool in tools.items():
        append_rows(tool, "angle", np.array([angle.get(name, 0.0)]))
    for name, tool in surfaces.items():
        append_rows(tool, "rotation", np.asarray(rotation.get(name, (0.0, 0.0, 0.0)), float).reshape(1, 3))


def _truncate(file: h5py.File, n: int) -> None:
    """Cut every growing dataset after `n` steps, and drop the meshes that only later ones have."""
    root = find_body(file)
    steps = root["Steps"]
    last = int(steps["PartOffsets"][n - 1])
    place = locate_mesh(file, last)
    for kind, count in (("Point", root["NumberOfPoints"][last]), ("Cell", root["NumberOfCells"][last])):
        for name, field in root[f"{kind}Data"].items():
            offsets = steps[f"{kind}DataOffsets"][name]
            field.resize(int(offsets[n - 1]) + int(count), axis=0)
            offsets.resize(n, axis=0)
    rows = {"Points": place.points, "Connectivity": place.ids, "Offsets": place.offsets, "Types": place.cells}
    for name, own in rows.items():
        root[name].resize(own.stop, axis=0)
    for name in _COUNTS:
        root[name].resize(last + 1, axis=0)
    for number in range(last + 1, len(file["presswork/meshes"])):
        del file[f"presswork/meshes/{number}"]
    for name in (*_GEOMETRY_OFFSETS, "NumberOfParts", "Values"):
        steps[name].resize(n, axis=0)
    for tool in file["presswork"].get("tools", {}).values():
        tool["displacement"].resize(n, axis=0)
        tool["angle"].resize(n, axis=0)
    for tool in file["presswork"].get("surfaces", {}).values():
        tool["displacement"].resize(n, axis=0)
        tool["rotation"].resize(n, axis=0)
    steps.attrs["NSteps"] = n
    truncate_tool_blocks(file, n)
    truncate_dies(file, n)
