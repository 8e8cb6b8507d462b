# SPDX-License-Identifier: Apache-2.0
"""Where nodes of Abaqus lie: *SYSTEM, *NODE in cylindrical or spherical coordinates, and poses of instances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.mesh.files.abaqus_blocks import Block, DataError
from presswork.model import FloatArray

GENERATED = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SUBSTRUCTURE GENERATE")
"""Keywords by which Abaqus makes nodes and elements of others."""


@dataclass(frozen=True)
class Frame:
    """A rectangular system: point = origin + coordinates along its axes."""

    origin: FloatArray
    """(3,)."""
    axes: FloatArray
    """One in each row (3, 3)."""

    def place(self, points: FloatArray) -> FloatArray:
        """Return points of the system (n, 3) in global coordinates."""
        return np.asarray(points @ self.axes + self.origin)


GLOBAL = Frame(np.zeros(3), np.eye(3))


def read_system(block: Block) -> Frame:
    """Return the system of a *SYSTEM, the global one for an empty block. Raises DataError.

    The data are points a (origin), b (on its x axis) and c (in its x-y plane); without c its z axis is Z, without b
    its axes are the global ones.
    """
    values = [to_float(word) for row in block.rows() for word in _whole_points(row)]
    points = np.array(values + [0.0] * (-len(values) % 3)).reshape(-1, 3)
    if len(points) > 3:
        raise DataError("more than three points")
    if not len(points):
        return GLOBAL
    origin = points[0]
    if len(points) == 1:
        return Frame(origin, np.eye(3))
    x = points[1] - origin
    z = np.cross(x, points[2] - origin) if len(points) == 3 else np.array([0.0, 0.0, 1.0])
    if not np.linalg.norm(x) or not np.linalg.norm(np.cross(z, x)):
        raise DataError("the points lie on one line")
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    y = np.cross(z, x)
    y /= np.linalg.norm(y)
    return Frame(origin, np.array([x, y, np.cross(x, y)]))


def read_nodes(block: Block, frame: Frame) -> FloatArray:
    """Return rows of label, x, y, z of a *NODE (n, 4). Raises DataError."""
    table = block.table(4)
    system = block.name_of("SYSTEM")
    if system not in ("", "R", "C", "S"):
        raise DataError(f"SYSTEM={system}: expected R, C or S")
    points = table[:, 1:]
    if system in ("C", "S"):
        r, turn = points[:, 0], np.radians(points[:, 1])
        rise = np.radians(points[:, 2]) if system == "S" else np.zeros(len(points))
        height = r * np.sin(rise) if system == "S" else points[:, 2]
        points = np.column_stack([r * np.cos(rise) * np.cos(turn), r * np.cos(rise) * np.sin(turn), height])
    return np.column_stack([table[:, 0], frame.place(points)])


def make_pose(rows: list[list[str]]) -> tuple[FloatArray, FloatArray]:
    """Return rotation (3, 3) and shift (3,) of an instance by its rows of data: x -> turn x + shift. Raises DataError.

    The first row is a translation, the second two points of an axis and an angle [degree], which turns what was moved.
    """
    values = [[to_float(word) for word in row] for row in rows]
    shift = np.array((values[0] + [0.0] * 3)[:3]) if values else np.zeros(3)
    if len(values) < 2:
        return np.eye(3), shift
    if len(values[1]) < 7:
        raise DataError("a rotation has two points of its axis and an angle")
    a, b, angle = np.array(values[1][:3]), np.array(values[1][3:6]), np.radians(values[1][6])
    if not np.linalg.norm(b - a):
        raise DataError("the two points of the axis of rotation are one")
    x, y, z = (b - a) / np.linalg.norm(b - a)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return turn, turn @ (shift - a) + a


def to_float(word: str) -> float:
    """Return a finite number, 0 for an empty field. Raises DataError."""
    try:
        number = float(word or 0.0)
    except ValueError as error:
        raise DataError(str(error)) from None
    if not np.isfinite(number):
        raise DataError(f"`{word}` is no finite number")
    return number


def _whole_points(row: list[str]) -> list[str]:
    """Return the fields of a row without blanks at its end, filled up to whole points."""
    n = max((i for i, word in enumerate(row, 1) if word), default=0)
    return [*row, "", ""][: 3 * -(-n // 3)]
