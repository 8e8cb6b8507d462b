# SPDX-License-Identifier: Apache-2.0
"""Shells of a file with its own numbers: LS-DYNA, Abaqus, OpenRadioss, Nastran, and what meshes are read from.

Only nodes and shells of three and four nodes are read; all else of a deck is passed over. A file that a deck includes
is read for Abaqus alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.keyword_file import KeywordFileError
from presswork.mesh.checks import MeshError
from presswork.mesh.files.abaqus_blocks import DataError, read_blocks
from presswork.mesh.files.readers import read_raw
from presswork.mesh.topology import with_four_nodes
from presswork.model import CELLS, FloatArray, IntArray, take_corners
from presswork.text_file import UnreadableError, read_bytes

LARGEST = 4 << 30
"""Bytes of a file."""
_BARE_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")
_INCLUDES = ("*INCLUDE", "#INCLUDE", "INCLUDE ")
Row = tuple[int, ...]
"""Label of a shell and of its three or four nodes."""


@dataclass(frozen=True)
class ShellMesh:
    """Shells of three and four nodes."""

    points: FloatArray
    """(n_points, 3), in the file's unit."""
    cells: IntArray
    """(n, 4); a triangle has its last node twice."""
    node_labels: IntArray
    """(n_points,)."""
    cell_labels: IntArray
    """(n,)."""


def read_shell_mesh(path: Path, scale: float = 1.0) -> ShellMesh:
    """Read shells. scale: factor of the file's coordinates to mm. Raises MeshError."""
    reader = _READERS.get("dynain" if path.name.lower() == "dynain" else path.suffix.lower())
    if reader is None:
        return _of_raw(path, scale)
    nodes: dict[int, list[float]] = {}
    rows: list[Row] = []
    try:
        for row in reader(path):
            if isinstance(row[1], float):
                nodes[int(row[0])] = [float(v) for v in row[1:4]]
            else:
                rows.append(tuple(int(v) for v in row))
    except FileNotFoundError as error:
        raise MeshError(f"no such file ({path})", "check the path") from error
    except UnreadableError as error:
        raise MeshError(error.fault, error.remedy) from error
    except (KeywordFileError, DataError, ValueError, IndexError) as error:
        raise MeshError(f"nodes or shells cannot be read: {error}", "write the file again") from error
    if not rows or not nodes:
        raise MeshError("no nodes, or no shells of three or four nodes", "give the file that holds the mesh itself")
    used = sorted({node for row in rows for node in row[1:]})
    if lost := [node for node in used if node not in nodes]:
        raise MeshError(f"shells use node {lost[0]}, which is not there", "give the file that holds the nodes, too")
    index = {node: i for i, node in enumerate(used)}
    cells = [[index[node] for node in (*row[1:], row[-1])[:4]] for row in rows]
    points = scale * np.array([nodes[node] for node in used])
    labels = np.array([row[0] for row in rows], dtype=np.int32)
    return ShellMesh(points, np.array(cells, dtype=np.int32), np.array(used, dtype=np.int32), labels)


def _of_raw(path: Path, scale: float) -> ShellMesh:
    """Return shells of a file whose numbers are not kept."""
    raw = read_raw(path)
    if not raw.cells or raw.points.shape[1] != 3:
        raise MeshError("no triangles or quadrilaterals in space", "save the part's mid-surface")
    blocks = [block for kind in raw.cells.values() for block in kind]
    cells = np.concatenate([with_four_nodes(take_corners(block)) for block in blocks]).astype(np.int32)
    used, number = np.unique(cells, return_inverse=True)
    cells = number.reshape(cells.shape).astype(np.int32)
    return ShellMesh(scale * raw.points[used], cells, _from_one(used), _from_one(cells))


def _from_one(rows: IntArray) -> IntArray:
    return np.arange(1, len(rows) + 1, dtype=np.int32)


def _lines(path: Path) -> list[str]:
    lines = read_bytes(path, most=LARGEST).decode("latin-1").replace("\r", "").split("\n")
    if not any(line.upper().startswith(("*NODE", "/NODE", "GRID")) for line in lines) and any(
        line.upper().startswith(_INCLUDES) for line in lines
    ):
        raise ValueError("the mesh lies in files that it includes")
    return lines


def _node(number: str, place: list[str]) -> tuple[int, float, float, float]:
    x, y, z = (_real(word) for word in place)
    return int(number), x, y, z


def _read_dyna(path: Path) -> Iterator[Row | tuple[int, float, float, float]]:
    keyword, skipped = "", 0
    for line in _lines(path):
        if line.startswith("*"):
            keyword, skipped = line[1:].strip().upper(), 0
            continue
        if line.startswith("$") or not line.strip():
            continue
        if keyword == "NODE":
            words = line.split(",") if "," in line else [line[:8], *(line[i : i + 16] for i in (8, 24, 40))]
            yield _node(words[0], words[1:4])
        elif keyword.startswith("ELEMENT_SHELL") and "COMPOSITE" not in keyword:
            skipped -= 1
            if skipped < 0:
                words = line.split(",") if "," in line else [line[i : i + 8] for i in range(0, 48, 8)]
                yield _shell([int(word or 0) for word in (w.strip() for w in [words[0], *words[2:6]])])
                more = sum(("THICKNESS" in keyword or "BETA" in keyword or "MCID" in keyword, "OFFSET" in keyword))
                skipped = more


def _read_radioss(path: Path) -> Iterator[Row | tuple[int, float, float, float]]:
    keyword = ""
    for line in _lines(path):
        if line.startswith("/"):
            keyword = line[1:].strip().upper()
        elif line.startswith(("#", "$")) or not line.strip():
            continue
        elif keyword == "NODE" or keyword.startswith("NODE/"):
            yield _node(line[:10], [line[i : i + 20] for i in (10, 30, 50)])
        elif keyword.startswith(("SHELL/", "SH3N/")):
            end = 50 if keyword.startswith("SHELL/") else 40
            yield _shell([int(line[i : i + 10].strip() or 0) for i in range(0, end, 10)])


def _read_nastran(path: Path) -> Iterator[Row | tuple[int, float, float, float]]:
    """Read GRID, CQUAD4, CQUADR, CTRIA3 and CTRIAR in free, small and large fields."""
    lines = _lines(path)
    for i, line in enumerate(lines):
        head = line[:8].split(",")[0].strip().upper()
        name = head.rstrip("*")
        if name not in ("GRID", "CQUAD4", "CQUADR", "CTRIA3", "CTRIAR"):
            continue
        if "," in line:
            rows = lines[i : i + 2] if head.endswith("*") else [line]
            words = [word.strip() for row in rows for word in row.split(",")[1:]]
        elif head.endswith("*"):
            words = [row[c : c + 16].strip() for row in lines[i : i + 2] for c in range(8, 72, 16)]
        else:
            words = [line[c : c + 8].strip() for c in range(8, 72, 8)]
        if name == "GRID":
            if words[1] not in ("", "0"):
                raise ValueError(f"GRID {words[0]} is given in system {words[1]}: write it in the basic system")
            yield _node(words[0], words[2:5])
        else:
            yield _shell([int(words[0]), *(int(word) for word in words[2 : 6 if "QUAD" in name else 5])])


def _read_abaqus(path: Path) -> Iterator[Row | tuple[int, float, float, float]]:
    for block in read_blocks(path):
        if block.name == "NODE":
            yield from ((int(n), float(x), float(y), float(z)) for n, x, y, z in block.table(4).tolist())
        elif block.name == "ELEMENT":
            kind = block.name_of("TYPE")
            cell = next((c for c in CELLS.values() if re.match(c.files.abaqus, kind)), None)
            if cell is not None and cell.name in ("tri3", "quad4"):
                words = [int(word) for word in block.labels()]
                for start in range(0, len(words), cell.nodes + 1):
                    yield _shell(words[start : start + cell.nodes + 1])


def _shell(words: list[int]) -> Row:
    """Return label and nodes of a shell, each node once."""
    nodes = [node for node in dict.fromkeys(words[1:]) if node]
    if len(nodes) < 3:
        raise ValueError(f"shell {words[0]} has {len(nodes)} nodes")
    return (words[0], *nodes)


def _real(text: str) -> float:
    text = text.strip().upper().replace("D", "E")
    return float(_BARE_EXPONENT.sub(r"E\1", text) if "E" not in text else text) if text else 0.0


_READERS: dict[str, Callable[[Path], Iterator[Row | tuple[int, float, float, float]]]] = {
    **dict.fromkeys((".k", ".key", ".dyn", ".dynain", "dynain"), _read_dyna),
    **dict.fromkeys((".bdf", ".nas", ".dat", ".fem"), _read_nastran),
    ".rad": _read_radioss,
    ".inp": _read_abaqus,
}
