# SPDX-License-Identifier: Apache-2.0
"""How far the STEP faces of corrected tools lie off the corners of their triangles, measured on the files.

STEP is read by Open CASCADE and cut into triangles, STL is read as it is. A corner of the STL counts where a face has a
foot under it, square to the face and within a millimetre: backs and edges of tools have no face.

Run: python -m validation.corrected_faces FOLDER   (a folder that `presswork compensate` has written)
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from presswork.geometry.foot_on_triangles import find_feet, split_long
from presswork.mesh.files.cad import read_cad
from presswork.mesh.files.tool_file import read_tool
from presswork.model import FloatArray

_CHORD = 0.002
"""Largest distance of the triangles from the STEP surface [mm]."""
_NEAR, _SQUARE, _LEAST = 1.0, 0.1, 1e-4
"""Distance of a corner that counts [mm], and how far aside its foot may lie, over its distance and at least [mm]."""


def measure(step: Path, stl: Path) -> FloatArray:
    """Return the distance of each counting corner of the STL from the STEP surface (n,) [mm]."""
    mesh = read_cad(step, _CHORD)
    triangles = np.concatenate([np.atleast_2d(cells) for cells in mesh.cells["tri3"]]).astype(np.int32)
    points, triangles = split_long(mesh.points, triangles, 2.0)
    corners = read_tool(stl)[0].points
    feet = find_feet(corners, points, triangles)
    away = corners - feet.interpolate(points, triangles)
    one, two, three = points[triangles[feet.triangle]].transpose(1, 0, 2)
    normal = np.cross(two - one, three - one)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = np.abs((away * normal).sum(axis=1))
    aside = np.sqrt(np.maximum((away**2).sum(axis=1) - height**2, 0.0))
    return np.asarray(height[(height < _NEAR) & (aside < _SQUARE * height + _LEAST)])


def main() -> None:
    """Print a line for each tool of a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    for step in sorted(parser.parse_args().folder.glob("*.step")):
        off = measure(step, step.with_suffix(".stl"))
        print(
            f"{step.stem}: {len(off)} corners, {off.max():.4f} mm off at most, 99 % within {np.quantile(off, 0.99):.4f}"
        )


if __name__ == "__main__":
    main()
