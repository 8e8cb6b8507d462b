# SPDX-License-Identifier: Apache-2.0
"""The tools in results.vtkhdf, as blocks that VTK shows beside the body: triangles in space, lines in the plane.

A block has the tool where it starts, and at every step the `displacement` of its points since, as the body has it: one
filter warps both. Arcs are cut into chords of CHORD. /presswork keeps the tools exactly, for pictures and measures.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import h5py
import numpy as np
from numpy.typing import NDArray

from presswork.geometry.pose import ToolPose, find_pose_since, place_points
from presswork.model import FloatArray, IntArray
from presswork.results.deflate import deflate

BODY, ASSEMBLY = "body", "Assembly"
CHORD = np.radians(4.0)
"""Angle of an arc that one line stands for."""
COMPRESSION = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
_N_FILTERS = 2
"""Number of filters in COMPRESSION."""
_WORTH_IT = 32768
"""Bytes from which deflate.py is faster than HDF5."""
_LINE, _TRIANGLE = 3, 5


def make_collection(file: h5py.File) -> h5py.Group:
    """Make the file a collection of blocks, all on the time steps of the body; return the body's group."""
    root = file.create_group("VTKHDF", track_order=True)  # VTK lists the blocks in the order of their making
    root.attrs["Version"] = np.array([2, 1])
    root.attrs["Type"] = np.bytes_("MultiBlockDataSet")
    root.create_group(ASSEMBLY, track_order=True)
    body = _add_block(root, BODY)
    root["Steps"] = h5py.SoftLink(f"/VTKHDF/{BODY}/Steps")  # by which VTK finds a step from its time
    return body


def append_rows(group: h5py.Group, name: str, rows: NDArray[np.generic]) -> int:
    """Append rows to a dataset that can grow; return how many it had.

    It asks HDF5 directly: h5py's own objects take several times as long, and a saved step has some sixty datasets.
    Whole chunks of large datasets are compressed by deflate.py.
    """
    stored = h5py.h5d.open(group.id, name.encode())
    rows = np.ascontiguousarray(rows, dtype=stored.dtype)
    before, *columns = stored.shape
    stored.set_extent((before + len(rows), *columns))
    settings = stored.get_create_plist()
    filtered = settings.get_nfilters() == _N_FILTERS
    if filtered and rows.nbytes >= _WORTH_IT and _fills_chunks(settings.get_chunk(), before, rows.shape):
        per_chunk = settings.get_chunk()[0]
        for first in range(0, len(rows), per_chunk):
            place = (before + first, *(0 for _ in columns))
            stored.write_direct_chunk(place, deflate(rows[first : first + per_chunk]))
        return int(before)
    place = stored.get_space()
    place.select_hyperslab((before, *(0 for _ in columns)), rows.shape)
    stored.write(h5py.h5s.create_simple(rows.shape), place, rows)
    return int(before)


def _fills_chunks(chunk: tuple[int, ...], before: int, shape: tuple[int, ...]) -> bool:
    """Return whether rows of this shape behind others are whole chunks."""
    return chunk[1:] == shape[1:] and before % chunk[0] == 0 and shape[0] % chunk[0] == 0


def find_body(file: h5py.File) -> h5py.Group:
    """Return the group of the body: a block, or all of a file from before there were blocks."""
    root: h5py.Group = file["VTKHDF"]
    return root.get(BODY, root)


def write_tool_blocks(
    file: h5py.File, profiles: Mapping[str, FloatArray], surfaces: Mapping[str, tuple[FloatArray, IntArray]]
) -> None:
    """Write the tools as they start: profiles' segments (n, 7), and points (n, 3) with triangles (n, 3)."""
    for name, segments in profiles.items():
        points = _cut_arcs(segments)
        _write_block(file, name, np.pad(points.reshape(-1, 2), ((0, 0), (0, 1))), 2, _LINE)
    for name, (points, triangles) in surfaces.items():
        _write_block(file, name, points, 3, _TRIANGLE, triangles)


def append_tool_steps(file: h5py.File) -> None:
    """Append the last position of every tool in /presswork to its block."""
    extras = file["presswork"]
    if find_body(file) == file["VTKHDF"]:
        return  # a file from before there were blocks
    for name, tool in extras.get("tools", {}).items():
        points = file[_path(file, name)]["Points"][:, :2]
        pose = ToolPose(tool["centre"][()], tool["displacement"][-1], float(tool["angle"][-1]))
        moved = np.zeros((len(points), 3))
        moved[:, :2] = place_points(points, pose) - points
        _append_step(file[_path(file, name)], moved)
    for name, tool in extras.get("surfaces", {}).items():
        moved = np.broadcast_to(tool["displacement"][-1], tool["points"].shape)
        if np.isnan(moved).any():  # a tool that is not at work shrinks to a point that no one sees
            moved = tool["points"][0] - tool["points"][()]
        elif tool["rotation"][-1].any():
            points = tool["points"][()]
            moved = find_pose_since(tool["centre"][()], moved[0], tool["rotation"][-1]).carry(points) - points
        _append_step(file[_path(file, name)], moved)


def truncate_tool_blocks(file: h5py.File, n: int) -> None:
    """Keep the first n steps of every tool's block."""
    for name in file["VTKHDF"]:
        block = file["VTKHDF"][name]
        if name not in (BODY, ASSEMBLY, "Steps"):
            block["PointData/displacement"].resize(n * len(block["Points"]), axis=0)
            _resize_steps(block, n)


def _path(file: h5py.File, tool: str) -> str:
    return str(file["presswork"].attrs[f"block {tool}"])


def _add_block(root: h5py.Group, name: str) -> h5py.Group:
    block = root.create_group(name)
    block.attrs["Version"] = np.array([2, 1])
    block.attrs["Type"] = np.bytes_("UnstructuredGrid")
    block.attrs["Index"] = len(root[ASSEMBLY])
    root[ASSEMBLY][name] = h5py.SoftLink(f"/VTKHDF/{name}")
    return block


def _write_block(
    file: h5py.File, tool: str, points: FloatArray, nodes: int, kind: int, cells: IntArray | None = None
) -> None:
    """Write a tool's geometry; its block is named after it in letters that VTK takes."""
    root = file["VTKHDF"]
    name = re.sub(r"[^A-Za-z0-9_-]", "_", f"_{tool}" if tool[:1].isdigit() else tool) or "tool"
    while name in root:
        name += "_"
    file["presswork"].attrs[f"block {tool}"] = f"VTKHDF/{name}"
    block = _add_block(root, name)
    ids = np.arange(len(points)) if cells is None else cells.ravel()
    n_cells = len(ids) // nodes
    block.create_dataset("Points", data=np.asarray(points, dtype=np.float32), **COMPRESSION).attrs["units"] = "mm"
    block.create_dataset("Connectivity", data=ids.astype(np.int64), **COMPRESSION)
    block["Offsets"] = nodes * np.arange(n_cells + 1, dtype=np.int64)
    block["Types"] = np.full(n_cells, kind, dtype=np.uint8)
    for count, value in (("Points", len(points)), ("Cells", n_cells), ("ConnectivityIds", len(ids))):
        block[f"NumberOf{count}"] = np.array([value], dtype=np.int64)
    steps = block.create_group("Steps")
    steps.attrs["NSteps"] = 0
    steps["Values"] = h5py.SoftLink(f"/VTKHDF/{BODY}/Steps/Values")
    for offset in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "NumberOfParts"):
        columns = (1,) if offset in ("CellOffsets", "ConnectivityIdOffsets") else ()
        first = 1 if offset == "NumberOfParts" else 0
        steps.create_dataset(
            offset, (0, *columns), np.int64, maxshape=(None, *columns), chunks=(256, *columns), fillvalue=first
        )
    field = block.create_group("PointData").create_dataset(
        "displacement", (0, 3), np.float32, maxshape=(None, 3), chunks=(max(1, min(len(points), 16384)), 3),
        **COMPRESSION,
    )  # fmt: skip
    field.attrs["units"] = "mm"
    steps.create_group("PointDataOffsets").create_dataset(
        "displacement", (0,), np.int64, maxshape=(None,), chunks=(256,)
    )
    block.create_group("CellData")


def _append_step(block: h5py.Group, moved: FloatArray) -> None:
    """Append the displacement of a block's points (n, 3) [mm]; its mesh stays."""
    steps = block["Steps"]
    n = int(steps.attrs["NSteps"]) + 1
    before = append_rows(block, "PointData/displacement", moved)
    _resize_steps(block, n)
    steps["PointDataOffsets/displacement"][n - 1] = before


def _resize_steps(block: h5py.Group, n: int) -> None:
    """Have n steps, all on the one mesh."""
    steps = block["Steps"]
    offsets = ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets", "NumberOfParts")
    for name in (*offsets, "PointDataOffsets/displacement"):
        stored = h5py.h5d.open(steps.id, name.encode())
        stored.set_extent((n, *stored.shape[1:]))
    steps.attrs["NSteps"] = n


def _cut_arcs(segments: FloatArray) -> FloatArray:
    """Return the ends of the lines that stand for a profile (n, 2, 2), each with ends of its own."""
    lines = []
    for x0, y0, x1, y1, cx, cy, turn in np.asarray(segments, dtype=float):
        if turn == 0.0:
            path = np.array([[x0, y0], [x1, y1]])
        else:
            first, last = np.arctan2(y0 - cy, x0 - cx), np.arctan2(y1 - cy, x1 - cx)
            swept = turn * ((turn * (last - first)) % (2.0 * np.pi) or 2.0 * np.pi)
            angles = first + np.linspace(0.0, swept, max(1, int(np.ceil(abs(swept) / CHORD))) + 1)
            radius = np.hypot(x0 - cx, y0 - cy)
            path = np.stack([cx + radius * np.cos(angles), cy + radius * np.sin(angles)], axis=1)
        lines.append(np.stack([path[:-1], path[1:]], axis=1))
    return np.concatenate(lines) if lines else np.zeros((0, 2, 2))
