# SPDX-License-Identifier: Apache-2.0
"""`presswork onestep`: from a part's file to its blank in seconds."""

from __future__ import annotations

from math import expm1
from pathlib import Path
from typing import Annotated, Any

import typer

from presswork.case import CaseError
from presswork.case.onestep.schema import OneStepCase, build_onestep_model
from presswork.cli.case_files import picture_undercut
from presswork.cli.pictures import show
from presswork.cli.terminal import GAVE_UP, console, exit_on, refuse
from presswork.mesh import MeshError
from presswork.model import OneStepModel
from presswork.onestep.part import OneStepError
from presswork.onestep.record import BLANK_DRAWING, BLANK_POINTS, run_one_step
from presswork.results import OutputError, Result

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
    thickness: Annotated[str | None, typer.Option(help="Of the blank, e.g. 0.8 or '0.8 mm'.")] = None,
    bhf: Annotated[str, typer.Option(help="Blank-holder force, e.g. '20 kN'.")] = "0",
    mu: Annotated[float, typer.Option(help="Coefficient of friction.")] = 0.1,
    draw_direction: Annotated[str, typer.Option(help="The punch's way in the file's axes.")] = "-z",
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
    try:
        if write_case is not None:
            from presswork.onestep.stamping_case import check_case_path

            check_case_path(write_case, overwrite=overwrite)
        result = compute(model, folder, overwrite=overwrite, threads=threads, write_case=write_case)
    except OneStepError as error:
        raise refuse(str(error), GAVE_UP) from error
    except (OutputError, MeshError) as error:
        raise refuse(str(error)) from error
    with exit_on(OutputError):
        show(result, plot=plot, report=report)


def _refuse_options(context: typer.Context) -> None:
    """Stop where options of the part and its process are given beside a case file, which holds them."""
    given = [
        f"--{name.replace('_', '-')} ({_IN_CASE[name]})"
        for name in _IN_CASE
        if getattr(context.get_parameter_source(name), "name", "") == "COMMANDLINE"
    ]
    if given:
        raise refuse(f"a case file says all of the part and its process: set these in it: {', '.join(given)}")


def compute(
    model: OneStepModel,
    folder: Path,
    *,
    overwrite: bool = False,
    threads: int = 0,
    quiet: bool = False,
    write_case: Path | None = None,
) -> Result:
    """Find a part's blank, say how far it is and what came out. write_case: where a stamping of that blank goes.

    Raises OneStepError, MeshError, OutputError.
    """
    with console().status("laying the part flat") as status:
        if quiet:
            status.stop()

        def show(number: int, error: float) -> None:
            status.update(f"iteration {number}: unbalanced force {error:.1e} of the flow force")

        result, outline = run_one_step(model, folder, overwrite=overwrite, threads=threads, on_iteration=show)
    if write_case is not None:
        from presswork.onestep.stamping_case import write_stamping_case

        for note in write_stamping_case(write_case, model, outline, folder / BLANK_POINTS):
            console().print(f"{write_case}: {note}", style="yellow", markup=False)
    read = Result(folder)
    for warning in read.summary["warnings"]:
        console().print(f"warning: {warning}", style="yellow", markup=False)
    if not quiet:
        width, height = outline.extent
        thinning = result.fields["thickness_strain"]
        strip = read.summary["blank"]["strip"]
        typer.echo(
            f"blank {width:.1f} x {height:.1f} mm, {outline.area:.0f} mm2; thickness {_percent(thinning.min())} to "
            f"{_percent(thinning.max())}; punch force {result.punch_force / 1e3:.1f} kN; "
            f"{strip['utilisation_percent']:.0f} % of a strip {strip['width_mm']:.1f} mm wide"
        )
        judged = read.summary["formability"]
        typer.echo(judged["verdict"] + (f"; {judged['paths']}" if judged["least_margin"] else ""))
        typer.echo(f"{read.summary['work']}, {read.summary['wall_seconds']['total']:.1f} s; {folder / BLANK_DRAWING}")
    return read


def _percent(strain: float) -> str:
    return f"{100 * expm1(strain):+.1f} %"


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
    try:
        if part.suffix == ".toml":
            return build_onestep_model(OneStepCase.from_toml(part))
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
        return build_onestep_model(OneStepCase.from_data(data))
    except CaseError as error:
        raise refuse(f"{error}{picture_undercut(error, folder)}") from error


def _plain(text: str) -> float | str:
    """Return a number, or the text for units to be read from."""
    try:
        return float(text)
    except ValueError:
        return text
