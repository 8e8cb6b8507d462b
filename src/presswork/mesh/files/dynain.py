# SPDX-License-Identifier: Apache-2.0
"""A formed sheet in the text format of LS-DYNA's dynain: nodes, shells with thickness, stresses and strains; mm, MPa.

A shell has one point in its plane; those of several are means. The fifth field of its thicknesses is the angle from its
first side to x of the material. Stresses and strains are those of space.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, FormedSheet, IntArray
from presswork.text_file import UnreadableError, read_bytes

LARGEST = 4 << 30
"""Bytes of a file."""
_START = 1 << 16
"""Number of bytes at the start of a file that show whether it is text."""
_BARE_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]+)$")
_WHOLE = ("KEYWORD", "TITLE", "NODE", "ELEMENT_SHELL_THICKNESS", "INITIAL_STRESS_SHELL", "INITIAL_STRAIN_SHELL")
"""Keywords that are read, or carry nothing more."""
CENTRE = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]]) / 4.0
"""Slopes of the shape functions at the middle of a cell (2, 4)."""


def is_dynain(path: str | Path) -> bool:
    """Return whether a file is a dynain file by its name: part.dynain, or dynain itself."""
    return Path(path).suffix.lower() == ".dynain" or Path(path).name.lower() == "dynain"


def first_sides(points: FloatArray, cells: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors along the first side of each cell, in its plane, and normal to it (n, 3)."""
    e = np.einsum("ja,cai->cji", CENTRE, points[cells])
    normal = np.cross(e[:, 0], e[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    side = points[cells[:, 1]] - points[cells[:, 0]]
    side -= (side * normal).sum(axis=1, keepdims=True) * normal
    return side / np.linalg.norm(side, axis=1, keepdims=True), normal


def material_angle(sheet: FormedSheet) -> FloatArray:
    """Return the angle from the first side of each shell to x of its material (n,) [degree]."""
    side, normal = first_sides(sheet.points, sheet.cells)
    across = (np.cross(side, sheet.axis) * normal).sum(axis=1)
    return np.asarray(np.degrees(np.arctan2(across, (side * sheet.axis).sum(axis=1))))


def write_dynain(sheet: FormedSheet, title: str) -> str:
    """Return the text of a dynain."""
    angle, nodes, shells = material_angle(sheet), sheet.nodes_in_files, sheet.shells_in_files
    lines = ["*KEYWORD", "$ presswork; mm, t, s, N, MPa", "*TITLE", title[:80], "*NODE"]
    lines += [f"{i:8d}" + "".join(f"{v:16.9e}" for v in x) for i, x in zip(nodes, sheet.points, strict=True)]
    lines.append("*ELEMENT_SHELL_THICKNESS")
    for i, cell in enumerate(sheet.cells):
        lines.append(f"{shells[i]:8d}{1:8d}" + "".join(f"{node:8d}" for node in nodes[cell]))
        lines.append(4 * f"{sheet.thickness[i]:16.9e}" + f"{angle[i]:16.9e}")
    lines.append("*INITIAL_STRESS_SHELL")
    for i, (stresses, plastic) in enumerate(zip(sheet.stress, sheet.plastic_strain, strict=True)):
        lines.append(f"{shells[i]:10d}{1:10d}{len(sheet.heights):10d}{0:10d}{0:10d}{1:10d}")
        for height, s, p in zip(sheet.heights, stresses, plastic, strict=True):
            lines.append("".join(f"{v:16.9e}" for v in (height, *s[:4])))
            lines.append("".join(f"{v:16.9e}" for v in (*s[4:], p)))
    if sheet.strain is not None:
        lines.append("*INITIAL_STRAIN_SHELL")
        for i, e in enumerate(sheet.strain):
            lines.append(f"{shells[i]:10d}{1:10d}{2:10d}{1:10d}")
            for height in (-1.0, 1.0):
                lines.append("".join(f"{v:16.9e}" for v in e[:5]))
                lines.append(f"{e[5]:16.9e}{height:16.9e}")
    return "\n".join([*lines, "*END", ""])


def read_dynain(path: Path) -> FormedSheet:
    """Read a formed sheet. Raises MeshError for a file that is none, or is cut short."""
    try:
        content = read_bytes(path, most=LARGEST)
    except FileNotFoundError as error:
        raise MeshError("no such file", "check the path") from error
    except UnreadableError as error:
        raise MeshError(error.fault, error.remedy) from error
    if b"\0" in content[:_START]:
        raise MeshError("a binary file", "write the dynain as text (FTYPE = 0 of *INTERFACE_SPRINGBACK_LSDYNA)")
    text = content.decode("latin-1").replace("\r", "")
    labels: list[int] = []
    points: list[list[float]] = []
    shells: list[list[int]] = []
    thickness: list[float] = []
    angle: list[float] = []
    layers: dict[int, FloatArray] = {}
    strains: dict[int, FloatArray] = {}
    name = ""
    try:
        for name, rows in _blocks(text):
            if name == "NODE":
                labels += [int(row[:8]) for row in rows]
                points += [_numbers(row[8:], 3) for row in rows]
            elif name == "ELEMENT_SHELL_THICKNESS":
                own = [[int(row[i : i + 8] or 0) for i in range(0, 48, 8)] for row in rows[::2]]
                for cell, row in zip(own, rows[1::2], strict=True):
                    side = _numbers(row, 5)  # a triangle has three corners, its last one twice
                    thickness.append(float(np.mean(side[: 3 if cell[5] in (0, cell[4]) else 4])))
                    angle.append(side[4])
                shells += own
            elif name == "INITIAL_STRESS_SHELL":
                layers |= read_layers(rows)
            elif name == "INITIAL_STRAIN_SHELL":
                strains |= read_strains(rows)
            elif name not in _WHOLE:
                fault = f"*{name} is not read as a part of a formed sheet"
                raise MeshError(fault, "take it out, or give the whole deck to presswork import")
    except (ValueError, IndexError) as error:
        raise MeshError(f"the rows below *{name} are cut short, or hold no numbers", "write it again") from error
    if not labels or not shells or len(thickness) != len(shells):
        raise MeshError("expected *NODE and *ELEMENT_SHELL_THICKNESS", "give a dynain of shells")
    sides = np.column_stack([thickness, angle])
    return _assemble(np.array(labels), np.array(points), np.array(shells), sides, layers, strains)


def _assemble(
    labels: IntArray,
    points: FloatArray,
    shells: IntArray,
    sides: FloatArray,
    layers: dict[int, FloatArray],
    strains: dict[int, FloatArray],
) -> FormedSheet:
    """Return the sheet; shells: label, part and nodes (n, 6); sides: thickness and angle of the material (n, 2)."""
    number = {int(label): i for i, label in enumerate(labels)}
    try:
        cells = np.array([[number[int(node)] for node in row[2:5]] + [number[int(row[5] or row[4])]] for row in shells])
    except KeyError as error:
        raise MeshError(f"a shell has the node {error}, which is not there", "the file is cut short") from error
    own = [layers.get(int(label)) for label in shells[:, 0]]
    if any(each is None for each in own) or len({each.shape for each in own if each is not None}) != 1:
        fault = "expected *INITIAL_STRESS_SHELL of every shell, with as many layers"
        raise MeshError(fault, "write stresses of the whole part")
    rows = np.array(own)
    side, normal = first_sides(points, cells)
    turn = np.radians(sides[:, 1])[:, None]
    axis = np.cos(turn) * side + np.sin(turn) * np.cross(normal, side)
    found = [strains.get(int(label)) for label in shells[:, 0]]
    strain = None if any(each is None for each in found) else np.array(found)
    cells, thickness = cells.astype(np.int32), sides[:, 0]
    return FormedSheet(points, cells, thickness, axis, rows[0, :, 0], rows[:, :, 1:7], rows[:, :, 7], strain)


def read_layers(rows: Sequence[str]) -> dict[int, FloatArray]:
    """Return height, six stresses and plastic strain of each layer, bottom first (k, 8), by the shell's label."""
    found, at = {}, 0
    while at < len(rows):
        label, n_plane, n_thick, n_history, n_tensor, large = (int(each) for each in _numbers(rows[at], 6, 10))
        at += 1
        values = []
        for _ in range(n_plane * n_thick):
            if large:
                values.append([*_numbers(rows[at], 5), *_numbers(rows[at + 1], 3)])
                at += 2 + -(-n_history // 5) + -(-6 * n_tensor // 5)
            else:
                values.append(_numbers(rows[at], 8, 10))
                at += 1 + -(-n_history // 8) + -(-6 * n_tensor // 8)
        table = np.array(values)
        heights = np.unique(np.round(table[:, 0], 6))
        found[label] = np.array([table[np.abs(table[:, 0] - height) < 1e-5].mean(axis=0) for height in heights])
    return found


def read_strains(rows: Sequence[str]) -> dict[int, FloatArray]:
    """Return the mean of a shell's strains (6,) by its label: that of the middle surface of both faces."""
    found, at = {}, 0
    while at < len(rows):
        label, n_plane, n_thick, large = (int(each) for each in _numbers(rows[at], 4, 10))
        at, n = at + 1, n_plane * n_thick
        if large:
            values = [[*_numbers(rows[i], 5), *_numbers(rows[i + 1], 1)] for i in range(at, at + 2 * n, 2)]
        else:
            values = [_numbers(row, 6, 10) for row in rows[at : at + n]]
        at += 2 * n if large else n
        found[label] = np.mean(values, axis=0)
    return found


def _blocks(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield keywords and the rows below each, without comments; *END ends it."""
    for part in re.split(r"^\*", text, flags=re.MULTILINE)[1:]:
        head, *rows = part.split("\n")
        name = head.strip().upper()
        if name == "END":
            return
        yield name.split()[0], [row for row in rows if row.strip() and not row.startswith("$")]


def _numbers(row: str, n: int, width: int = 16) -> list[float]:
    fields = (row[i * width : (i + 1) * width].strip() for i in range(n))
    return [float(_BARE_EXPONENT.sub(r"e\1", each)) if each and "e" not in each.lower() else float(each or 0.0)
            for each in fields]  # fmt: skip
