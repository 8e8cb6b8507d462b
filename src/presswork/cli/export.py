# SPDX-License-Identifier: Apache-2.0
"""The command `export`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer

from presswork.cli.terminal import console, exit_on
from presswork.mesh import MeshError
from presswork.results import OutputError, Result

if TYPE_CHECKING:
    from presswork.model import FormedSheet
    from presswork.post.formed_part import FormedPart


def export(
    folder: Annotated[Path, typer.Argument(help="Output folder of a run.", show_default=False)],
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Files to write, their format by the ending: .k or .dynain LS-DYNA, .inp Abaqus, .rad OpenRadioss, "
            ".bdf Nastran, .stl, .step.",
            show_default=False,
        ),
    ],
    step: Annotated[int, typer.Option(help="Saved step, from 0, or from the end: -1.")] = -1,
    surface: Annotated[
        Literal["middle", "bottom", "top", "skin"],
        typer.Option(help="For STL and STEP: middle, a face, or skin, which is closed round the metal."),
    ] = "middle",
    onto: Annotated[
        Path | None, typer.Option(help="Mesh of shells, whose nodes and numbers are written: the part is mapped to it.")
    ] = None,
    scale: Annotated[float, typer.Option(help="Factor of that mesh's coordinates to mm.")] = 1.0,
    within: Annotated[
        float | None,
        typer.Option(help="Distance from the part to which shells take from it (mm); default: half a shell."),
    ] = None,
    fit: Annotated[bool, typer.Option(help="Lay the part onto that mesh by the best fit from where it is.")] = False,
) -> None:
    """Write the formed part for other programs, with thickness, stress and plastic strain.

    A sheet as LS-DYNA, Abaqus, OpenRadioss and Nastran shells, or as the surface in STL and STEP; a solid as Abaqus
    cells, in space also as LS-DYNA cells and STL. Units are mm, t, s, N, MPa.
    """
    from presswork.api import read_last_sheet
    from presswork.mesh.files.formed.writers import find_format
    from presswork.post.formed_part import read_formed_part
    from presswork.results.whole_file import write_whole

    with exit_on(OutputError, MeshError):
        formats = [find_format(path) for path in files]
        result = Result(folder)
        if not result.is_shell:
            if onto is not None:
                raise MeshError("only sheets are mapped to another mesh", "leave --onto out")
            _export_solid(result, step, files)
            return
        part = read_formed_part(result, step, lambda: read_last_sheet(folder))
        _print_sheet(part.sheet, part)
        for note in part.notes:
            console().print(f"note: {note}", markup=False)
        sheet = part.sheet if onto is None else _map(part, onto, scale, within)
        for path, kind in zip(files, formats, strict=True):
            write_whole(path, kind.write(sheet, part.title, surface))
            console().print(f"{path}: {kind.name}, {path.stat().st_size / 1e6:.2g} MB", markup=False)


def _export_solid(result: Result, step: int, files: list[Path]) -> None:
    """Write a solid. Raises MeshError for a format that has none."""
    from presswork.mesh.files.formed.writers import FORMATS, find_format
    from presswork.post.formed_part import read_formed_solid
    from presswork.results.whole_file import write_whole

    solid, title = read_formed_solid(result, step), str(result.info.get("title", "")).strip()
    contents = []
    for path in files:
        kind = find_format(path)
        if kind.write_solid is None:
            known = ", ".join(each.name for each in FORMATS if each.write_solid)
            raise MeshError(f"{path}: solids are not written as {kind.name}", f"choose one of {known}")
        contents.append((path, kind.name, kind.write_solid(solid, title)))
    stress = float(np.abs(solid.stress).max())
    console().print(f"{len(solid.stress)} cells, stresses up to {stress:.4g} MPa", markup=False)
    for path, name, content in contents:
        write_whole(path, content)
        console().print(f"{path}: {name}, {len(content) / 1e6:.2g} MB", markup=False)


def _print_sheet(sheet: FormedSheet, part: FormedPart) -> float:
    """Print the number of shells and layers, the thickness and the stored energy; return the energy [N mm]."""
    from presswork.mesh.files.formed.layers import elastic_energy

    energy, thickness = elastic_energy(sheet, part.young, part.poisson), sheet.thickness
    console().print(
        f"{len(sheet.cells)} shells, {thickness.min():.4g} to {thickness.max():.4g} mm thick, {len(sheet.heights)} "
        f"layers, elastic energy {energy:.4g} N mm",
        markup=False,
    )
    return energy


def _map(part: FormedPart, onto: Path, scale: float, within: float | None) -> FormedSheet:
    """Return the part on another mesh, and print how well it lies there. Raises MeshError."""
    from presswork.mesh.files.formed.layers import elastic_energy
    from presswork.mesh.files.shell_mesh import read_shell_mesh
    from presswork.mesh.sheet_map import covered_part, map_sheet

    mesh = read_shell_mesh(onto, scale)
    mapped = map_sheet(part.sheet, mesh, within)
    covered = mapped.is_covered
    if not covered.any():
        near = mapped.distance.min()
        fault = f"{onto}: no shell lies at the part, the nearest one {near:.4g} mm off"
        raise MeshError(fault, "lay it where the part is, or give --scale for its unit, or --within")
    own = covered_part(mapped)
    energy, before = _print_sheet(own, part), elastic_energy(part.sheet, part.young, part.poisson)
    share = f", {energy / before - 1.0:+.2%} of the part's" if before > 0.0 else ""
    console().print(
        f"mapped to {covered.sum()} of {len(covered)} shells, {mapped.distance[covered].mean():.3g} mm off the part on "
        f"the mean{share} elastic energy",
        markup=False,
    )
    if not covered.all():
        thickness = float(np.mean(part.sheet.thickness))
        console().print(
            f"note: {(~covered).sum()} shells lie off the part: {thickness:.4g} mm thick, without stress", markup=False
        )
    return mapped.sheet
