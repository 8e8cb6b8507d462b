# SPDX-License-Identifier: Apache-2.0
"""Meshes from files: gmsh .msh, VTK .vtk/.vtu and STL through meshio, Abaqus/CalculiX .inp, I-DEAS .unv through pyuff.

Whatever the format, what is read first is a RawMesh; the steps from it to the Mesh are the same for all.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from presswork.mesh.checks import MeshError, check_connected, check_coordinates, wind_counter_clockwise
from presswork.mesh.files.abaqus import read_abaqus
from presswork.mesh.files.ideas import read_ideas
from presswork.mesh.files.raw import RawMesh
from presswork.mesh.topology import drop_unused_points, find_boundary_edges, select_edges
from presswork.model import CELLS, ELEMENTS, CellBlock, ElementName, FloatArray, IntArray, Mesh, list_names


def read_mesh(
    path: Path, *, element: ElementName, scale: float = 1.0, material: int = 0
) -> tuple[Mesh, tuple[str, ...]]:
    """Read a 2D mesh; return it and notes on what was changed.

    scale: factor of the file's coordinates to mm. material: index into Model.materials.
    Node and edge sets come from the file's groups of nodes, lines and cells; left, right, bottom, top, all and boundary
    are added where the file has none of that name. Raises MeshError.
    """
    raw = read_raw(path)
    flat = _take_plane(raw.points) * scale
    check_coordinates(flat)
    cells = take_cells(raw, element)
    cells, turned = wind_counter_clockwise(flat, cells)
    points, number = drop_unused_points(flat, [cells])
    cells = number[cells].astype(np.int32)
    check_connected(points, cells)
    boundary = find_boundary_edges([cells])
    node_sets, edge_sets = build_sets(raw, number, points, boundary)
    notes = []
    if turned:
        notes.append("all cells are clockwise: they were turned over")
    if len(points) < len(flat):
        notes.append(f"{len(flat) - len(points)} nodes belong to no cell: they were left out")
    return Mesh(points, (CellBlock(element, cells, material),), node_sets, edge_sets, boundary), tuple(notes)


def read_raw(path: Path) -> RawMesh:
    """Read a file by its ending, turning whatever a reader raises into a MeshError."""
    readers: dict[str, Callable[[Path], RawMesh]] = {
        ".msh": _read_gmsh,
        ".vtk": _read_vtk,
        ".vtu": _read_vtu,
        ".inp": read_abaqus,
        ".unv": read_ideas,
        ".stl": _read_stl,
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        remedy = f"known endings: {', '.join(readers)}; of tools and surfaces also .step, .stp, .iges, .igs"
        raise MeshError(f"unknown mesh format `{path.suffix}`", remedy)
    if not path.is_file():
        near = sorted(entry.name for entry in path.parent.glob("*") if entry.suffix.lower() in readers)[:5]
        raise MeshError(f"no such file ({path})", f"mesh files there: {', '.join(near) or 'none'}")
    if not path.stat().st_size:
        raise MeshError("the file is empty", "write it again from the mesher")
    try:
        return reader(path)
    except MeshError:
        raise
    except (Exception, SystemExit) as error:  # the readers of the libraries raise nearly anything on a bad file
        reason = " ".join(str(error).split())[:100]
        raise MeshError(
            f"the file is cut short or unreadable ({type(error).__name__}{': ' if reason else ''}{reason})",
            "write it again from the mesher",
        ) from error


def _read_gmsh(path: Path) -> RawMesh:
    import meshio

    content = path.read_bytes()
    for section in (b"Nodes", b"Elements"):
        if b"$" + section in content and b"$End" + section not in content:
            raise MeshError(
                f"the file is cut short: its {section.decode()} do not end", "write it again from the mesher"
            )
    mesh = _read_quietly(meshio.gmsh.read, path)
    raw = _from_meshio(mesh)
    kinds = {"vertex": "point"} | {cell.files.meshio: cell.name for cell in CELLS.values() if cell.dimension < 3}
    for name, (tag, dimension) in mesh.field_data.items():
        for block, tags in zip(mesh.cells, mesh.cell_data.get("gmsh:physical", []), strict=False):
            kind = kinds.get(block.type)
            if kind is not None and block.dim == dimension:
                raw.add_to_set(name, kind, np.asarray(block.data)[np.asarray(tags) == tag])
    return raw


def _read_vtk(path: Path) -> RawMesh:
    import meshio

    return _from_meshio(_read_quietly(meshio.vtk.read, path))


def _read_vtu(path: Path) -> RawMesh:
    import meshio

    return _from_meshio(_read_quietly(meshio.vtu.read, path))


def _read_stl(path: Path) -> RawMesh:
    import meshio

    content = path.read_bytes()
    is_binary = len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
    if not is_binary and b"endsolid" not in content[-200:]:
        raise MeshError("the file is cut short: it does not end as STL does", "write it again from the CAD program")
    with np.errstate(over="ignore"):  # the library takes text for a count, to see that it is none
        return _from_meshio(_read_quietly(meshio.stl.read, path))


def _read_quietly(read: Callable[[str], Any], path: Path) -> Any:
    """Call a reader without what it prints."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        return read(str(path))


def _from_meshio(mesh: Any) -> RawMesh:
    raw = RawMesh(np.asarray(mesh.points, dtype=float))
    cells = {cell.files.meshio: cell for cell in CELLS.values()}
    for block in mesh.cells:
        if block.type in cells:
            raw.add_cells(cells[block.type], np.asarray(block.data))
        elif block.type != "vertex":
            raw.other_kinds.add(block.type)
    return raw


def _take_plane(points: FloatArray) -> FloatArray:
    """Return x and y of points that lie in a plane z = constant, shape (n, 2)."""
    if len(points) == 0:
        raise MeshError("the file has no nodes", "write it again from the mesher")
    if not np.isfinite(points).all():
        raise MeshError("some coordinates are not finite numbers", "write it again from the mesher")
    if points.shape[1] == 3:
        extent = np.ptp(points, axis=0)
        if extent[2] > 1e-9 * max(extent.max(), 1e-300):
            raise MeshError(
                f"the nodes do not lie in a plane z = constant: z runs from {points[:, 2].min():.6g} to "
                f"{points[:, 2].max():.6g}",
                "turn the model into the (x, y) plane before meshing",
            )
    return np.ascontiguousarray(points[:, :2])


def take_cells(raw: RawMesh, element: ElementName) -> IntArray:
    """Return the cells that fit the element, shape (n_cells, n_nodes)."""
    if not raw.cells:
        others = f" (it has {', '.join(sorted(raw.other_kinds))})" if raw.other_kinds else ""
        raise MeshError(f"the file has no 2D cells{others}", "save triangles or quadrilaterals")
    wanted = ELEMENTS[element].cell
    if set(raw.cells) != {wanted}:
        counts = ", ".join(f"{sum(map(len, blocks))} {kind}" for kind, blocks in sorted(raw.cells.items()))
        family = ELEMENTS[element].family
        kinds = "; ".join(
            ", ".join(list_names(family, in_implicit=True, cell=kind)) or "none" for kind in sorted(raw.cells)
        )
        remedy = f"choose one of: {kinds}" if len(raw.cells) == 1 else f"mesh with {wanted} cells only"
        raise MeshError(f"the cells of the file ({counts}) do not fit element = {element}", remedy)
    cells = np.concatenate(raw.cells[wanted])
    if cells.min() < 0 or cells.max() >= len(raw.points):
        raise MeshError("cells use nodes that the file does not have", "the file is cut short; write it again")
    return cells


def build_sets(
    raw: RawMesh, number: IntArray, points: FloatArray, boundary: IntArray
) -> tuple[dict[str, IntArray], dict[str, IntArray]]:
    """Return node sets and edge sets by name, in the new node numbers."""
    node_sets: dict[str, IntArray] = {}
    edge_sets: dict[str, IntArray] = {}
    for name in sorted({*raw.node_sets, *raw.line_sets}):
        nodes = np.concatenate([*raw.node_sets.get(name, []), *(line.ravel() for line in raw.line_sets.get(name, []))])
        kept = number[nodes.astype(np.int64)]
        node_sets[name] = np.unique(kept[kept >= 0]).astype(np.int32)
        if name in raw.line_sets:
            lines = {tuple(sorted(number[line])) for block in raw.line_sets[name] for line in block}
            chosen = [tuple(sorted(edge)) in lines for edge in boundary]
            edges = boundary[np.array(chosen, dtype=bool)]
        else:
            edges = select_edges(boundary, node_sets[name])
        if len(edges):
            edge_sets[name] = edges
    tolerance = 1e-9 * float(np.linalg.norm(np.ptp(points, axis=0)))
    low, high = points.min(axis=0), points.max(axis=0)
    extremes = {
        "left": points[:, 0] <= low[0] + tolerance,
        "right": points[:, 0] >= high[0] - tolerance,
        "bottom": points[:, 1] <= low[1] + tolerance,
        "top": points[:, 1] >= high[1] - tolerance,
        "all": np.ones(len(points), dtype=bool),
    }
    taken = {*node_sets}
    for name, mask in extremes.items():
        if name not in taken:
            node_sets[name] = np.flatnonzero(mask).astype(np.int32)
            edges = select_edges(boundary, node_sets[name])
            if len(edges) and name != "all":
                edge_sets[name] = edges
    edge_sets.setdefault("boundary", boundary)
    return node_sets, edge_sets
