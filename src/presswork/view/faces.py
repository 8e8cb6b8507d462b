# SPDX-License-Identifier: Apache-2.0
"""Faces in space as matplotlib's axes show them: drawn by a renderer with a depth buffer where there are many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.view import off_screen
from presswork.view.whole_tools import DrawnTool

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

MANY = 10_000
"""Faces from which on the renderer is faster; it takes 1 to 2 s to start, once a program."""
_EDGE = (0.1, 0.1, 0.1)
_EDGE_OPACITY = 0.7
_PIXELS = 1600
"""Longer side of the rendered picture: about twice the pixels that it has in a PNG."""
_PIXELS_PER_POINT = 4.5
_LINE_WIDTH = 0.9
"""Width of lines [point]."""
_MARGIN = 0.01
_BEHIND, _PART = 0.5, 1.0
"""Order of drawing of tools and of the part with sections of tools."""
Lines = Sequence[tuple[FloatArray, str]]
"""Lines (n, 2, 3) [mm], each row with its colour."""


def draw_faces(
    ax: Axes3D,
    blocks: Sequence[FloatArray],
    colours: FloatArray,
    edge_width: float,
    lines: Lines = (),
    tools: Sequence[DrawnTool] = (),
) -> None:
    """Draw faces and lines in orthographic axes whose limits and direction of view are set.

    blocks: corners of faces, (n, k, 3) [mm], k its own for each block; colours: red, green, blue, opacity of each face
    (n_faces, 4), 0 to 1; edge_width: of the lines around the faces [point], 0: none; tools: drawn first, so that the
    part is in front of them. Many faces are drawn by pyvista where it is installed and can draw without a display.
    """
    if tools:
        ax.computed_zorder = False
    for tool in tools:
        _draw_layer(ax, [tool.corners], tool.colours, 0.0, (), _BEHIND)
    _draw_layer(ax, blocks, colours, edge_width, lines, _PART)


def _draw_layer(
    ax: Axes3D, blocks: Sequence[FloatArray], colours: FloatArray, edge_width: float, lines: Lines, order: float
) -> None:
    """Draw faces and lines upon what has been drawn with a smaller order."""
    if sum(len(block) for block in blocks) >= MANY and off_screen.is_installed():
        picture = _render(ax, blocks, colours, edge_width, lines)
        if picture is not None:
            from matplotlib.image import AxesImage

            pixels, extent = picture
            image = AxesImage(ax, extent=extent, origin="upper", clip_on=False)
            image.set_data(pixels)
            image.set_alpha(float(colours[0, 3]))
            image.set_zorder(order)
            ax.add_artist(image)
            return
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    faces = Poly3DCollection([face for block in blocks for face in block], facecolors=colours, linewidths=edge_width)
    faces.set_edgecolor((*_EDGE, _EDGE_OPACITY) if edge_width > 0.0 else colours)
    faces.set_zorder(order)
    ax.add_collection3d(faces)
    for row, colour in lines:
        section = Line3DCollection(row, colors=colour, linewidths=_LINE_WIDTH)
        section.set_zorder(0.5 * (_BEHIND + order))
        ax.add_collection3d(section)


def _render(
    ax: Axes3D, blocks: Sequence[FloatArray], colours: FloatArray, edge_width: float, lines: Lines
) -> tuple[NDArray[np.uint8], tuple[float, float, float, float]] | None:
    """Return a picture and its left, right, lower and upper end in the plane of the axes; None: no picture."""
    from matplotlib.colors import to_rgb

    to_plane = find_projection(ax)
    corners = np.concatenate([*(block.reshape(-1, 3) for block in blocks), *(row.reshape(-1, 3) for row, _ in lines)])
    across = corners @ to_plane[:, :3].T + to_plane[:, 3]
    low, high = across.min(axis=0), across.max(axis=0)
    margin = _MARGIN * float((high - low).max())
    low, high = low - margin, high + margin
    scale = float(np.linalg.norm(to_plane[0, :3]))
    pixels_a_unit = _PIXELS / float((high - low).max())
    columns, rows = (max(2, round(float(part) * pixels_a_unit)) for part in high - low)
    edge_pixels = edge_width * _PIXELS_PER_POINT
    right, up = to_plane[:, :3] / scale
    middle = (0.5 * (low + high) - to_plane[:, 3]) / scale
    picture = off_screen.draw(
        off_screen.Scene(
            blocks=tuple(np.asarray(block, dtype=np.float32) for block in blocks),
            colours=np.rint(255.0 * np.clip(colours[:, :3], 0.0, 1.0)).astype(np.uint8),
            edge_width=edge_pixels,
            edge_colour=_EDGE,
            edge_opacity=_EDGE_OPACITY * min(1.0, edge_pixels),  # no line is thinner than a pixel
            lines=tuple((np.asarray(row, dtype=np.float32), to_rgb(colour)) for row, colour in lines if len(row)),
            line_width=_LINE_WIDTH * _PIXELS_PER_POINT,
            middle=middle[0] * right + middle[1] * up,
            right=right,
            up=up,
            size=(float(high[0] - low[0]) / scale, float(high[1] - low[1]) / scale),
            pixels=(columns, rows),
        )
    )
    return None if picture is None else (picture, (low[0], high[0], low[1], high[1]))


def find_projection(ax: Axes3D) -> FloatArray:
    """Return the map from places (x, y, z, 1) to the plane of orthographic axes (2, 4)."""
    matrix = np.asarray(ax.get_proj(), dtype=np.float64)
    return np.asarray(matrix[:2] / matrix[3, 3])
