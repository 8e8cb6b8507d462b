# SPDX-License-Identifier: Apache-2.0
"""An imported case on disk: the case file, its meshes, and the list of what became of every line."""

from __future__ import annotations

import tempfile
from pathlib import Path

import meshio
import numpy as np
import tomli_w

from presswork.deck.blank_and_tools import Surface
from presswork.deck.notes import Notes
from presswork.deck.stamping import ImportedStamping
from presswork.mesh.files.dynain import write_dynain
from presswork.mesh.files.stl_file import pack_stl
from presswork.mesh.triangles import double_areas
from presswork.model import IndexArray, Triangulation
from presswork.results.whole_file import write_whole


def write_case(imported: ImportedStamping, notes: Notes, folder: Path) -> Path:
    """Write case.toml, the meshes that it names, and import.txt into a folder; return the case."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, surface in imported.meshes.items():
        _write_mesh(surface, folder / name)
    if imported.formed is not None:
        text = write_dynain(imported.formed, str(imported.case["title"]))
        write_whole(folder / "blank.dynain", text.encode("ascii"))
    lines = [f"What became of {notes.source.name}, by file and line", "", *(str(note) for note in notes.in_order())]
    write_whole(folder / "import.txt", ("\n".join(lines) + "\n").encode())
    lost = [note for note in notes.in_order() if note.fate == "changed"]
    head = [f"# From {notes.source.name}; import.txt lists what was kept, changed and dropped.", ""]
    head[1:1] = [f"# {note.keyword} {note.place}: {note.text}" for note in lost]
    case = folder / "case.toml"
    write_whole(case, ("\n".join(head) + tomli_w.dumps(imported.case)).encode())
    return case


def _write_mesh(surface: Surface, path: Path) -> None:
    quads, triangles = _split_kinds(surface.cells)
    if path.suffix == ".stl":
        corners = np.concatenate([triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        corners = corners[np.linalg.norm(double_areas(surface.points, corners), axis=1) > 0.0]
        used, number = np.unique(corners, return_inverse=True)
        face = Triangulation(surface.points[used], number.reshape(corners.shape).astype(np.int32), False)
        write_whole(path, pack_stl(path.stem, face))
        return
    cells = [(kind, own) for kind, own in (("quad", quads), ("triangle", triangles)) if len(own)]
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / path.name
        meshio.write(file, meshio.Mesh(surface.points, cells), binary=True)
        write_whole(path, file.read_bytes())


def _split_kinds(cells: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Return quadrilaterals (n, 4) and triangles (n, 3)."""
    is_triangle = cells[:, 2] == cells[:, 3]
    return cells[~is_triangle], cells[is_triangle][:, :3]
