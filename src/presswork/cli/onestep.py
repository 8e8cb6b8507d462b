# SPDX-License-Identifier: Apache-2.0
"""`presswork onestep`: from a part's file to its blank in seconds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from presswork import api
from presswork.case import OneStepCase, build_model
from presswork.cli.case_files import reading
from presswork.cli.computing import ending, finish, showing_progress
from presswork.cli.terminal import refuse
from presswork.model import OneStepModel

_IN_CASE = {
    "material": "blank.material",
    "thickness": "blank.thickness",
    "rolling": "blank.rolling_direction",
    "bhf": "process.holder_force",
    "mu": "process.mu",
    "draw_direction": "part.draw_direction",
    "unit": "part.unit",
    "symmetry": "part.symmetry",
    "element_size": "part.element_size",
    "addendum": "part.addendum",
    "stages": "process.stages",
}
"""Options that a case file has keys for."""


def onestep(
    context: typer.Context,
    part: Annotated[Path, typer.Argument(help="The part's mid-surface (STL or mesh), or a case (TOML).")],
    material: Annotated[
        str | None, typer.Option(help="A material of the library (`presswork materials`) or a material file.")
    ] = None,
    thickness: Annotated[str | None, typer.Option(help="Thickness of the blank, e.g. 0.8 or '0.8 mm'.")] = None,
    bhf: Annotated[str, typer.Option(help="Blank-holder force, e.g. '20 kN'.")] = "0",
    mu: Annotated[float, typer.Option(help="Coefficient of friction.")] = 0.1,
    draw_direction: Annotated[str, typer.Option(help="Direction of the punch in the file's axes.")] = "-z",
    unit: Annotated[str, typer.Option(help="Unit of the file.")] = "mm",
    rolling: Annotated[str, typer.Option(help="Rolling direction from x (degrees).")] = "0",
    symmetry: Annotated[list[str] | None, typer.Option(help="x, y: planes x = 0, y = 0 that mirror the part.")] = None,
    element_size: Annotated[
        str | None,
        typer.Option(help="Halve triangles' edges longer than this (mm); default: about 10,000 triangles."),
    ] = None,
    write_case: Annotated[
        Path | None,
        typer.Option(help="Write a stamping (TOML) of the blank, with punch, die and holder made from the part (STL)."),
    ] = None,
    cells: Annotated[
        int, typer.Option(min=100, help="Shells of the written stamping's whole blank at most; radii may ask for more.")
    ] = 8000,
    stages: Annotated[
        int, typer.Option(min=1, max=9, help="Shapes that the sheet goes through; 1: one step. 3 for deep parts.")
    ] = 1,
    addendum: Annotated[str, typer.Option(help="Width of a level flange to add to the part's outline (mm).")] = "0",
    output: Annotated[Path | None, typer.Option(help="Output folder; default: the part's name beside it.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace results in the folder.")] = False,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 uses every core.")] = 0,
    plot: Annotated[bool, typer.Option(help="Draw the pictures at the end.")] = True,
    report: Annotated[bool, typer.Option(help="Write the page for the browser at the end.")] = True,
) -> None:
    """Find the flat blank of a finished part: outline, thinning, formability, punch force."""
    if part.suffix == ".toml":
        _refuse_options(context)
    folder = output or part.with_suffix("")
    model = _load(
        part, material, thickness,
        {"holder_force": _plain(bhf), "mu": mu, "stages": stages},
        {
            "draw_direction": draw_direction, "unit": unit, "symmetry": symmetry or [],
            "addendum": _plain(addendum),
            "element_size": None if element_size is None else _plain(element_size),
        },
        rolling,
        folder,
    )  # fmt: skip
    with ending(part):
        with showing_progress(model.title, quiet=False) as show:
            outcome = api.find_blank(
                model, folder, overwrite=overwrite, threads=threads, on_iteration=show, write_case=write_case,
                cells=cells,
            )  # fmt: skip
        finish(outcome, plot=plot, report=report)


def _refuse_options(context: typer.Context) -> None:
    """Stop where options of the part and its process are given beside a case file, which holds them."""
    given = [
        f"--{name.replace('_', '-')} ({_IN_CASE[name]})"
        for name in _IN_CASE
        if getattr(context.get_parameter_source(name), "name", "") == "COMMANDLINE"
    ]
    if given:
        raise refuse(f"a case file holds all of the part and its process: set these in it: {', '.join(given)}")


def _load(
    part: Path,
    material: str | None,
    thickness: str | None,
    process: dict[str, Any],
    file: dict[str, Any],
    rolling: str,
    folder: Path,
) -> OneStepModel:
    """Build the model of a case file, or of a part's file and options."""
    with reading(folder):
        if part.suffix == ".toml":
            return build_model(OneStepCase.from_toml(part))
        if material is None or thickness is None:
            given = {"--material": (material, "dc04"), "--thickness": (thickness, "'0.8 mm'")}
            missing = [f"{name} {example}" for name, (value, example) in given.items() if value is None]
            raise refuse(f"of the blank there is missing, for example, {' '.join(missing)}")
        name = Path(material).stem
        data: dict[str, Any] = {
            "title": part.stem,
            "analysis": "onestep",
            "part": {"path": str(part.resolve()), **{k: v for k, v in file.items() if v is not None}},
            "blank": {"material": name, "thickness": _plain(thickness), "rolling_direction": _plain(rolling)},
            "process": process,
            "materials": {name: {"library": str(Path(material).resolve()) if material.endswith(".toml") else material}},
        }
        return build_model(OneStepCase.from_data(data))


def _plain(text: str) -> float | str:
    """Return a number, or the text for units to be read from."""
    try:
        return float(text)
    except ValueError:
        return text
