# SPDX-License-Identifier: Apache-2.0
"""Outlines of blanks and of drawn sheets as files: points as CSV, closed polylines as DXF."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

from presswork.model import FloatArray
from presswork.results.whole_file import OutputError, write_whole

_COLUMNS = ("x_mm", "y_mm", "z_mm")


def write_outline(loops: Sequence[FloatArray], path: Path | str) -> None:
    """Write loops (n, 2 | 3) [mm].

    The path's ending chooses the format: .csv with loop, x, y[, z]; .dxf with closed polylines in x, y. Raises
    OutputError for another ending, for a file that cannot be written, and for DXF without ezdxf.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind == ".dxf":
        _write_dxf(loops, path)
    elif kind == ".csv":
        head = ",".join(["loop", *_COLUMNS[: loops[0].shape[1] if loops else 2]])
        rows = [",".join([str(i), *(f"{x:.7g}" for x in point)]) for i, loop in enumerate(loops) for point in loop]
        content = ("\n".join([head, *rows]) + "\n").encode()
        write_whole(path, content)
    else:
        raise OutputError(f"{path}: an outline is written as .csv or .dxf, not as {kind or 'a file without ending'}")


def _write_dxf(loops: Sequence[FloatArray], path: Path) -> None:
    import ezdxf

    drawing = ezdxf.new("R2010", units=4)  # type: ignore[attr-defined]  # millimetres
    for loop in loops:
        drawing.modelspace().add_lwpolyline([(float(point[0]), float(point[1])) for point in loop], close=True)
    text = io.StringIO()
    drawing.write(text)
    write_whole(path, text.getvalue().encode())
