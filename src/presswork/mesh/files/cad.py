# SPDX-License-Identifier: Apache-2.0
"""CAD models in STEP and IGES, read by Open CASCADE through netgen (extra `cad`), as triangles of their faces.

Open CASCADE crashes on some damaged files, so it works in a process of its own (`call_cad`).
"""

from __future__ import annotations

import re
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.files.raw import RawMesh
from presswork.model import CELLS, FloatArray
from presswork.own_process import DiedError, call_apart

_IGES = (".iges", ".igs")
_ENDINGS = (".step", ".stp", *_IGES)
RELATIVE_TOLERANCE = 1e-4
"""Distance of triangles from the surface where none is asked for, as a part of the model's diagonal."""
_MOST_ROUNDS = 5
"""Triangulations, each finer, as Open CASCADE takes its tolerance for edges and is some times off inside of faces."""
_ANGLE = 0.2
"""Largest angle between neighbouring triangles on a curved face [rad]: eight to a quarter of a circle."""
_LONGEST = 120
"""Seconds of processor time that a model may take to be read and cut, or followed by triangles."""
_REMEDY = "export it again as STEP AP214 or AP242"
_SEWN = 1e-3
"""How far apart edges of neighbouring faces may lie in IGES, whose faces share none [mm]."""
_LAST_RECORD = re.compile(rb"^S *[0-9]+G *[0-9]+D *[0-9]+P *[0-9]+ *T", re.MULTILINE)
"""Last record of a file in IGES: how many records of each kind it has."""
_ELSEWHERE = re.compile(rb"DOCUMENT_FILE|EXTERNALLY_DEFINED_|EXTERNAL_SOURCE", re.IGNORECASE)
"""Entities of a file whose parts lie in other files."""


def is_cad(path: Path | str) -> bool:
    """Return whether a file's name is that of a model in STEP or IGES."""
    return Path(path).suffix.lower() in _ENDINGS


def read_cad(path: Path, tolerance: float | None = None) -> RawMesh:
    """Return triangles that follow the faces of a model within a tolerance, their normals out of its solids.

    tolerance: largest distance from the surface [mm], by default RELATIVE_TOLERANCE of the diagonal. Coordinates come
    in mm, whatever the unit of the file. Raises MeshError.
    """
    found: RawMesh = call_cad("presswork.mesh.files.cad:triangulate", path, tolerance)
    return found


def call_cad(place: str, path: Path, *arguments: Any) -> Any:
    """Return what a function of a model's file gives, in a process of its own. Raises MeshError, and what it raises.

    place: the function, as "module:name", which takes the file's path and the arguments, and may call `open_cad`.
    """
    _check_file(path)
    try:
        return call_apart(place, path, *arguments, seconds=_LONGEST)
    except DiedError as error:
        raise MeshError(f"the model cannot be read (Open CASCADE {error})", _REMEDY) from None


def _check_file(path: Path) -> None:
    """Raise MeshError for faults that show before a file is opened as a model."""
    if find_spec("netgen") is None:
        raise MeshError(
            "STEP and IGES files are read by netgen, which is not installed",
            'pip install "presswork[cad]" (34 MB), or export the surface as STL',
        )
    if not path.is_file():
        raise MeshError(f"no such file ({path})", "check the path, which is relative to the case file")
    content = path.read_bytes()
    if path.suffix.lower() in _IGES:
        if content[72:73] not in (b"S", b"C") or not _LAST_RECORD.search(content.replace(b"\r", b"")):
            fault = "this is not a whole IGES file with records of 80 columns"
            raise MeshError(fault, "export it again, uncompressed, or as STEP AP214 or AP242")
        return
    if not content.lstrip()[:13].upper().startswith(b"ISO-10303-21"):
        raise MeshError(
            "this is not a STEP file: it does not begin with ISO-10303-21", "export it again as STEP AP214 or AP242"
        )
    if _ELSEWHERE.search(content):
        raise MeshError("parts of this model lie in other files", "export the assembly as one file")


def triangulate(path: Path, tolerance: float | None) -> RawMesh:
    """Do what `read_cad` does, in this process."""
    geometry = open_cad(path)
    low, high = (np.array([*corner]) for corner in geometry.shape.bounding_box)
    wanted = RELATIVE_TOLERANCE * float(np.linalg.norm(high - low)) if tolerance is None else tolerance
    chord, angle = wanted, _ANGLE
    for _ in range(_MOST_ROUNDS):
        corners, normals = _triangulate(geometry, chord, angle)
        error = _estimate_error(corners, normals)
        if error <= wanted:
            break
        chord, angle = 0.7 * chord * wanted / error, angle * float(np.sqrt(0.7 * wanted / error))
        geometry = open_cad(path)
    triangles = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    a, b, c = corners.swapaxes(0, 1)
    is_turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals.sum(axis=1)) < 0.0
    triangles[is_turned] = triangles[is_turned][:, ::-1]
    raw = RawMesh(corners.reshape(-1, 3))
    raw.add_cells(CELLS["tri3"], triangles)
    return raw


def _triangulate(geometry: Any, chord: float, angle: float) -> tuple[FloatArray, FloatArray]:
    """Return corners of triangles and the surface's normals there (n, 3, 3). Raises MeshError."""
    found = geometry._visualizationData(chord, angle)
    corners = np.asarray(found["vertices"], dtype=np.float64).reshape(-1, 3, 3)
    if not len(corners):
        raise MeshError("the model has no faces", "export a solid or its surfaces, not curves alone")
    return corners, np.asarray(found["normals"], dtype=np.float64).reshape(-1, 3, 3)


def _estimate_error(corners: FloatArray, normals: FloatArray) -> float:
    """Return how far triangles lie from a surface with these normals at their corners, curved alike on each edge.

    An edge e whose ends have the normals n rises by |e n|/4 over its chord, and the middle of a triangle by 4/9 of the
    sum of its edges. The lesser of both ends counts: at the tip of a cone there is no normal.
    """
    edges = np.roll(corners, -1, axis=1) - corners
    ends = [np.abs(np.einsum("ijk,ijk->ij", edges, normal)) for normal in (normals, np.roll(normals, -1, axis=1))]
    rise = 0.25 * np.minimum(*ends)
    return float(np.maximum(rise.max(axis=1), 4.0 / 9.0 * rise.sum(axis=1)).max())


def open_cad(path: Path) -> Any:
    """Return the model of a file, in this process, which it may end. Raises MeshError."""
    from netgen import occ

    if path.suffix.lower() in _IGES:
        return _open_iges(path.read_bytes(), occ)
    try:
        geometry = occ.OCCGeometry(str(path))
    except Exception as error:  # netgen's own, and what Open CASCADE raises through it
        reason = " ".join(str(error).split())[:100]
        raise MeshError(f"the model cannot be read ({reason})", _REMEDY) from error
    return geometry


def _open_iges(content: bytes, occ: Any) -> Any:
    """Return the model of a file in IGES, its faces sewn together. Raises MeshError."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "model.iges"  # netgen knows no other ending
        copy.write_bytes(content)
        try:
            faces = list(occ.OCCGeometry(str(copy)).shape.faces)
        except Exception as error:  # netgen's own, and what Open CASCADE raises through it
            raise MeshError("the model cannot be read, or is empty", _REMEDY) from error
    if not faces:
        raise MeshError("the model has no faces", "export a solid or its surfaces, not curves alone")
    return occ.OCCGeometry(occ.Sew(faces, _SEWN))
