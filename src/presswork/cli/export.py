# SPDX-License-Identifier: Apache-2.0
"""The command `export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.terminal import console, exit_on
from presswork.mesh import MeshError
from presswork.results import OutputError, Result


def export(
    folder: Annotated[Path, typer.Argument(help="Output folder of a run.", show_default=False)],
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Files to write, their format by the ending: .k or .dynain LS-DYNA, .inp Abaqus, .rad OpenRadioss, "
            ".bdf Nastran.",
            show_default=False,
        ),
    ],
    step: Annotated[int, typer.Option(help="Saved step, from 0, or from the end: -1.")] = -1,
) -> None:
    """Write the formed part for other programs, with thickness, stress and plastic strain.

    A sheet as LS-DYNA, Abaqus, OpenRadioss and Nastran shells; units are mm, t, s, N, MPa.
    """
    from presswork.mesh.files.formed.layers import elastic_energy
    from presswork.mesh.files.formed.writers import find_format
    from presswork.post.formed_part import read_formed_part
    from presswork.results.whole_file import write_whole

    with exit_on(OutputError, MeshError):
        formats = [find_format(path) for path in files]
        part = read_formed_part(Result(folder), step)
        energy = elastic_energy(part.sheet, part.young, part.poisson)
        thickness = part.sheet.thickness
        console().print(
            f"{len(part.sheet.cells)} shells, {thickness.min():.4g} to {thickness.max():.4g} mm thick, "
            f"{len(part.sheet.heights)} layers, elastic energy {energy:.4g} N mm",
            markup=False,
        )
        for note in part.notes:
            console().print(f"note: {note}", markup=False)
        for path, kind in zip(files, formats, strict=True):
            text = kind.write(part.sheet, part.title)
            write_whole(path, text.encode("ascii", "replace"))
            console().print(f"{path}: {kind.name}, {path.stat().st_size / 1e6:.2g} MB", markup=False)
