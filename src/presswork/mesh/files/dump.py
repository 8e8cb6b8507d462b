# SPDX-License-Identifier: Apache-2.0
"""A mesh as arrays under names, for a checkpoint, and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import CellBlock, Mesh, Section

SETS = ("node_sets", "edge_sets", "face_sets")


def dump_mesh(mesh: Mesh) -> dict[str, NDArray[Any]]:
    """Return the arrays of a mesh, and its other data as the bytes of a text."""
    text = {
        "blocks": [
            {
                "element": b.element,
                "material": b.material,
                "section": asdict(b.section) if b.section else None,
                "zone": b.zone,
                "rolling": b.rolling,
            }
            for b in mesh.blocks
        ],
        **{kind: list(getattr(mesh, kind)) for kind in SETS},
    }
    arrays: dict[str, NDArray[Any]] = {
        "text": np.frombuffer(json.dumps(text).encode(), dtype=np.uint8),
        "points": mesh.points,
        "boundary_edges": mesh.boundary_edges,
        "boundary_faces": mesh.boundary_faces,
    }
    if mesh.normals is not None:
        arrays["normals"] = mesh.normals
    arrays |= {f"connectivity.{i}": block.connectivity for i, block in enumerate(mesh.blocks)}
    arrays |= {f"thickness.{i}": b.own_thickness for i, b in enumerate(mesh.blocks) if b.own_thickness is not None}
    for kind in SETS:
        arrays |= {f"{kind}.{i}": values for i, values in enumerate(getattr(mesh, kind).values())}
    return arrays


def load_mesh(arrays: Mapping[str, NDArray[Any]]) -> Mesh:
    """Return the mesh that dump_mesh gave."""
    text = json.loads(arrays["text"].tobytes().decode())
    sets = {kind: {name: arrays[f"{kind}.{i}"] for i, name in enumerate(text[kind])} for kind in SETS}
    blocks = tuple(
        CellBlock(
            b["element"],
            arrays[f"connectivity.{i}"],
            b["material"],
            Section(**b["section"]) if b["section"] else None,
            b.get("zone", 0),
            tuple(b["rolling"]) if b.get("rolling") else None,
            arrays.get(f"thickness.{i}"),
        )
        for i, b in enumerate(text["blocks"])
    )
    return Mesh(
        arrays["points"],
        blocks,
        boundary_edges=arrays["boundary_edges"],
        boundary_faces=arrays["boundary_faces"],
        normals=arrays.get("normals"),
        **sets,
    )
