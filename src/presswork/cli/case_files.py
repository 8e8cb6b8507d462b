# SPDX-License-Identifier: Apache-2.0
"""Messages that explain what is wrong with a case file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from presswork.case.errors import CaseError
from presswork.cli.terminal import refuse


@contextmanager
def reading(folder: Path | None = None) -> Iterator[None]:
    """End the program with a plain message if a case is wrong. folder: for a picture of what is refused, if any."""
    try:
        yield
    except CaseError as error:
        raise refuse(f"{error}{_draw_undercut(error, folder)}") from error


def _draw_undercut(error: CaseError, folder: Path | None) -> str:
    """Draw the part that is refused for its undercut; return where, as the end of the message."""
    cause = error.__cause__
    if folder is None or cause is None:
        return ""
    from presswork.mesh.files.part_file import UndercutError

    if not isinstance(cause, UndercutError):
        return ""
    from presswork.results import OutputError
    from presswork.view.plots.part_plot import draw_undercut

    path = folder / "undercut.png"
    try:
        folder.mkdir(exist_ok=True)
        draw_undercut(cause.points, cause.triangles, cause.over, path)
    except (ImportError, OSError, OutputError) as failure:
        return f"; no picture: {failure}"
    return f"; {path} shows where"
