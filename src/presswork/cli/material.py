# SPDX-License-Identifier: Apache-2.0
"""The commands `material ...`. Exit status: 0, or 2 for bad input."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer

from presswork.case.errors import CaseError, Problem
from presswork.case.material.forming_limit.build import build_curve, mean_r_value
from presswork.case.material.hot_hardening import HotLaw
from presswork.case.material.library import find_sheet
from presswork.case.material.plastic import LIGHT
from presswork.case.material.yld2000_fit import R_WEIGHT, YieldData
from presswork.case.units import STRESS, to_number
from presswork.cli.fit.bulge import fit_bulge
from presswork.cli.fit.cyclic import fit_reversals
from presswork.cli.fit.hot import fit_compression, is_hot_compression
from presswork.cli.fit.tensile import Surface, fit_surface, fit_tensile
from presswork.cli.terminal import exit_on
from presswork.law.allowed import allow_library
from presswork.law.umat import CompileError, compile_law
from presswork.law.wall import find_drawing_ratio, has_wall
from presswork.material.bulge import BulgeSizes, is_bulge_test
from presswork.material.cyclic import is_cyclic
from presswork.material.cyclic_laws import CYCLIC_LAWS
from presswork.material.fit_plot import draw_curves
from presswork.material.hot_plot import draw_hot_law
from presswork.material.identify import LAWS
from presswork.material.identify_hot import HOT_LAWS
from presswork.material.identify_yld2000 import read_yield_data
from presswork.material.sheet_plot import draw_sheet
from presswork.material.specimen_facts import Sizes
from presswork.results.whole_file import OutputError, write_whole

app = typer.Typer(help="Sheet materials at a point.", no_args_is_help=True, add_completion=False)

Name = Annotated[str, typer.Argument(help="A material of the library, or a material file.", show_default=False)]
Datum = Annotated[float, typer.Option(show_default=False)]
Exponent = Annotated[Literal["6", "8"], typer.Option(help="Exponent of Yld2000-2d: 6 for steel, 8 for aluminium.")]
Size = Annotated[float | None, typer.Option(help="Size of specimens [mm], if no file holds it.", show_default=False)]
Weight = Annotated[float, typer.Option(help="Weight of r-values beside stresses in the fit of Yld2000-2d.")]
Angle = Annotated[
    float | None, typer.Option(help="Angle of the specimens from the rolling direction, if no file holds it.")
]
Branches = Annotated[
    float | None,
    typer.Option(help="Tests with reversals: branches that are fitted, 1.5 one and a half; the rest is predicted."),
]
LAW_HELP = (
    f"Hardening law: {', '.join(LAWS)}; of hot tests {', '.join(HOT_LAWS)}; of tests with reversals "
    f"{', '.join(CYCLIC_LAWS)}; all compares them."
)


@app.command("compile")
def compile_(
    source: Annotated[Path, typer.Argument(help="An Abaqus UMAT, or a law in one C++ file.", show_default=False)],
    output: Annotated[Path | None, typer.Option("--output", "-o", help="The library; default: beside it.")] = None,
) -> None:
    """Compile a material law into a shared library, for [materials.NAME] umat = "LIBRARY"."""
    with exit_on(CompileError):
        typer.echo(compile_law(source, output))


@app.command()
def allow(
    library: Annotated[Path, typer.Argument(help="A shared library with a law, whose code you trust.")],
) -> None:
    """Let cases run a library that was not compiled here, as long as its content stays."""
    with exit_on(OSError):
        allow_library(library)
        typer.echo(f"{library} may run")


@app.command()
def show(name: Name) -> None:
    """Show what a material is and where its numbers come from."""
    with exit_on(CaseError, ImportError, OSError, OutputError):
        sheet = find_sheet(name)
    typer.echo(f"{sheet.name}: {sheet.summary}" + (f", {sheet.thickness:g} mm" if sheet.thickness else ""))
    for key, value in sheet.material.model_dump(exclude_none=True).items():
        typer.echo(f"  {key}: {value}")
    material = sheet.material.to_model(sheet.key)
    if has_wall(material):
        typer.echo(f"limiting drawing ratio by theory: {find_drawing_ratio(material):.2f} (round cup, mu 0.08)")
    for title, texts in (("source", sheet.sources), ("assumed", sheet.assumed)):
        for key, text in texts.items():
            typer.echo(f"{title}, {key}: {text}")


@app.command()
def plot(
    name: Name,
    output: Annotated[Path | None, typer.Option(help="The picture; default: the material's name here.")] = None,
) -> None:
    """Draw a material: yield locus, yield stress and r-value by direction, flow stress; of hot laws by temperature."""
    with exit_on(CaseError, ImportError, OSError, OutputError):
        sheet = find_sheet(name)
        draw = draw_hot_law if isinstance(sheet.material.hardening, HotLaw) else draw_sheet
        typer.echo(draw(sheet, output or Path(f"{sheet.key}.png")))


@app.command()
def flc(
    name: Name,
    output: Annotated[Path | None, typer.Option(help="The picture; a CSV of the points lies beside it.")] = None,
    thickness: Annotated[
        float | None,
        typer.Option(help="Thickness of the sheet (mm); default: that of the sheet tested."),
    ] = None,
) -> None:
    """Find a material's forming limit curve; write its points and draw it."""
    with exit_on(CaseError, ImportError, OSError, OutputError):
        sheet = find_sheet(name)
        curve = build_curve(sheet.material, sheet.thickness if thickness is None else thickness)
        path = output or Path(f"{sheet.key}_flc.png")
        rows = [f"{a:.6g},{b:.6g}" for a, b in zip(curve.minor, curve.major, strict=True)]
        write_whole(path.with_suffix(".csv"), "\n".join(["minor,major", *rows, ""]).encode())
        minor, major = curve.lowest()
        typer.echo(f"{curve.method}: lowest at minor {minor:.3f}, major {major:.3f}")
        typer.echo(draw_curves({"": curve}, sheet.name, path, r=mean_r_value(sheet.material)))


@app.command()
def fit(
    files: Annotated[
        list[Path],
        typer.Argument(help="Tensile and bulge tests as machines write them, or one of hot compression or reversals."),
    ],
    young: Annotated[str, typer.Option(help='Young\'s modulus, e.g. "206 GPa".', show_default=False)],
    poisson: Annotated[float, typer.Option(help="Poisson's ratio.")] = 0.3,
    law: Annotated[str, typer.Option(help=LAW_HELP)] = "all",
    yield_function: Annotated[
        Literal["hill1948", "yld2000"],
        typer.Option(help="Fitted to the tests at angles: yld2000 to stresses and r-values, hill1948 to r-values."),
    ] = "yld2000",
    exponent: Annotated[
        Literal["6", "8"] | None, typer.Option(help="Exponent of Yld2000-2d; default: 6, below 100 GPa 8.")
    ] = None,
    biaxial_stress: Annotated[float, typer.Option(help="Balanced biaxial yield stress over that at 0.")] = math.nan,
    biaxial_r: Annotated[float, typer.Option(help="Strain across over along in that test.")] = math.nan,
    r_weight: Weight = R_WEIGHT,
    thickness: Size = None, width: Size = None, gauge_length: Size = None,
    angle: Angle = None,
    fit_branches: Branches = None,
    opening: Annotated[float | None, typer.Option(help="Bulge tests: diameter of the die's opening [mm].")] = None,
    die_radius: Annotated[float | None, typer.Option(help="Bulge tests: radius of the die's edge [mm].")] = None,
    density: Annotated[str, typer.Option(help='Hot tests: "7850 kg/m^3"; with it heating in the test counts.')] = "",
    specific_heat: Annotated[str, typer.Option(help='Hot tests: "650 J/(kg*K)".')] = "",
    output: Annotated[Path | None, typer.Option(help="Material file; default: the CSV's name, .toml.")] = None,
) -> None:  # fmt: skip
    """Fit a hardening law and a yield function to tests; write a material file and a picture.

    Hot compression tests are corrected for friction and for heating; beside the law a table of their curves is written.
    A bulge test (columns pressure and height) gives the flow curve to large strains, beside tensile tests of the same
    sheet its biaxial yield stress, too. Tension and compression in turn give isotropic and kinematic hardening.
    """
    with exit_on(CaseError, ImportError, OSError, OutputError):
        modulus = _read_stress("--young", young)
        if is_hot_compression(files[0]):
            fit_compression(files[0], law, modulus, poisson, density, specific_heat, output)
            return
        if bulges := [file for file in files if is_bulge_test(file)]:
            if len(bulges) > 1:
                remedy = "fit them one after the other"
                raise CaseError([Problem("", f"{len(bulges)} bulge tests", remedy)], bulges[1])
            others = [file for file in files if file != bulges[0]]
            fit_bulge(bulges[0], others, law, (modulus, poisson), BulgeSizes(thickness, opening, die_radius), output)
            return
        sizes = Sizes(thickness=thickness, width=width, gauge_length=gauge_length, angle=angle)
        if any(is_cyclic(file) for file in files):
            fit_reversals(files, law, (modulus, poisson), sizes, fit_branches, output)
            return
        surface = Surface(
            yield_function, int(exponent or (8 if modulus < LIGHT else 6)), biaxial_stress, biaxial_r, r_weight
        )
        fit_tensile(files, law, (modulus, poisson), surface, sizes, output)


@app.command()
def yld2000(
    data: Annotated[
        Path | None, typer.Argument(help="CSV of angle, stress, r; its line `biaxial` has that test's.")
    ] = None,
    s00: Datum = math.nan, s45: Datum = math.nan, s90: Datum = math.nan, sb: Datum = math.nan,
    r00: Datum = math.nan, r45: Datum = math.nan, r90: Datum = math.nan, rb: Datum = math.nan,
    exponent: Exponent = "8",
    r_weight: Weight = R_WEIGHT,
) -> None:  # fmt: skip
    """Fit Yld2000-2d to yield stresses over one reference and r-values, by all angles of a file or the usual eight."""
    with exit_on(CaseError, ImportError, OSError, OutputError):
        usual = YieldData(np.array([0.0, 45.0, 90.0]), np.array([s00, s45, s90]), np.array([r00, r45, r90]), sb, rb)
        if data is not None and usual.count():
            raise CaseError([Problem("", "data in a file and by options", "give one of them")], "Yld2000-2d")
        fit_surface(usual if data is None else read_yield_data(data), int(exponent), r_weight)


def _read_stress(key: str, text: str) -> float:
    try:
        value = to_number(float(text) if text.replace(".", "", 1).isdigit() else text, STRESS)
    except Exception as error:
        raise CaseError([Problem(key, f"expected a stress, not `{text}`", 'for instance "206 GPa"')]) from error
    if value < 1e3:
        raise CaseError([Problem(key, f"{value:g} MPa is outside the range of metals", 'for instance "206 GPa"', text)])
    return value
