# SPDX-License-Identifier: Apache-2.0
"""`material fit` of tensile tests."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
import typer

from presswork.case.errors import CaseError
from presswork.case.material.yld2000_fit import N_PARAMETERS, YieldData, fit_yld2000
from presswork.material.fit_laws import fit_laws, make_tensile_material, pick_rolling_direction
from presswork.material.fit_plot import draw_fit
from presswork.material.identify import (
    HardeningFit,
    compare_flow,
    find_yield_stress,
    fit_r_value,
)
from presswork.material.identify_yld2000 import BIAXIAL
from presswork.material.specimen_facts import Sizes
from presswork.material.tensile import TensileTest, read_tensile
from presswork.results.whole_file import write_whole


@dataclass(frozen=True)
class Surface:
    """The yield function that is fitted, and its parameters that tensile tests do not give."""

    law: str
    exponent: int
    biaxial_stress: float
    """Balanced biaxial yield stress over that at 0 degrees; nan: not measured."""
    biaxial_r: float
    r_weight: float


def fit_tensile(
    files: Sequence[Path], law: str, elastic: tuple[float, float], asked: Surface, sizes: Sizes, output: Path | None
) -> None:
    """Read the tests, fit law and yield function, and write material file and picture. Raises CaseError.

    elastic: Young's modulus [MPa] and Poisson's ratio; sizes: of the specimens, where the files do not hold them.
    """
    young, poisson = elastic
    read = read_tensile(files, sizes, young)
    for note in read.notes:
        typer.echo(note)
    tests = list(read.tests)
    along = pick_rolling_direction(tests, files[0])
    fits = fit_laws(along, law, young)
    _print_laws(along, fits, young)
    r_values = {test.angle: fit_r_value(test, young, poisson) for test in tests}
    stress = {test.angle: _compare(test, along, young) for test in tests}
    for angle, r in r_values.items():
        if r is not None:
            typer.echo(f"r at {angle:g} degrees = {r:.3f}")
        if angle and not math.isnan(stress[angle]):
            typer.echo(f"stress at {angle:g} degrees = {stress[angle]:.3f} of that at 0 after the same plastic work")
    surface = _find_surface(asked, r_values, stress)
    path = output or files[0].with_suffix(".toml")
    data = make_tensile_material(files, fits[0], {"young": young, "poisson": poisson}, surface)
    write_whole(path, tomli_w.dumps(data).encode())
    typer.echo(f"{path}\n{draw_fit(tests, fits, young, path.with_suffix('.png'))}")


def _compare(test: TensileTest, along: TensileTest, young: float) -> float:
    """Return a test's stress over that along the rolling direction; nan where they share no plastic work."""
    try:
        return compare_flow(test, along, young)
    except CaseError:
        return math.nan


def _find_surface(asked: Surface, r: dict[float, float | None], stress: dict[float, float]) -> dict[str, Any] | None:
    """Return the keys of the yield function that the tests give; None without r-values in three directions."""
    column = [math.nan if one is None else one for one in r.values()]
    has_biaxial = not math.isnan(asked.biaxial_stress)
    biaxial = asked.biaxial_stress if has_biaxial else 1.0
    data = YieldData(np.array(list(r)), np.array(list(stress.values())), np.array(column), biaxial, asked.biaxial_r)
    if asked.law == "yld2000" and not has_biaxial:
        typer.echo("yield in balanced biaxial tension is not given (--biaxial-stress): as along the rolling direction")
    if asked.law == "yld2000" and data.count() >= N_PARAMETERS:
        return fit_surface(data, asked.exponent, asked.r_weight)
    if any(r.get(angle) is None for angle in (0.0, 45.0, 90.0)):
        typer.echo("no r-values at 0, 45 and 90 degrees: the material is isotropic, von Mises")
        return None
    found: dict[str, Any] = {"law": asked.law, "r00": r[0.0], "r45": r[45.0], "r90": r[90.0]}
    if asked.law == "hill1948":
        return found
    known = {"stress_45": stress[45.0], "stress_90": stress[90.0], "stress_biaxial": asked.biaxial_stress}
    measured = {key: value for key, value in known.items() if not math.isnan(value)}
    return {**found, "exponent": asked.exponent, **measured}


def fit_surface(data: YieldData, exponent: int, r_weight: float) -> dict[str, Any]:
    """Fit Yld2000-2d, print it beside the data, and return the keys of a material."""
    fitted = fit_yld2000(data, exponent, r_weight=r_weight)
    typer.echo(f"alpha = [{', '.join(f'{value:.5f}' for value in fitted.alpha)}]")
    typer.echo("angle     stress measured, fitted        r measured, fitted")
    rows = list(zip(data.angle, data.stress, fitted.found.stress, data.r, fitted.found.r, strict=True))
    for angle, *values in [*rows, (BIAXIAL, data.biaxial, fitted.found.biaxial, data.r_biaxial,
                                   fitted.found.r_biaxial)]:  # fmt: skip
        texts = ["      -" if math.isnan(value) else f"{value:7.4f}" for value in values]
        name = angle if isinstance(angle, str) else f"{angle:g}"
        typer.echo(f"{name:8s} {texts[0]:>16s}  {texts[1]} {texts[2]:>17s}  {texts[3]}")
    stress, r = fitted.worst()
    typer.echo(f"largest errors: {100 * stress:.2f} % in a stress, {r:.3f} in an r-value")
    return {"law": "yld2000", "alpha": list(fitted.alpha), "exponent": exponent}


def _print_laws(along: TensileTest, fits: list[HardeningFit], young: float) -> None:
    best = fits[0]
    typer.echo(f"Rp0.2 = {find_yield_stress(along, young):.1f} MPa; fitted to a plastic strain of "
               f"{best.largest_strain:.3f}")  # fmt: skip
    for one in fits:
        parameters = ", ".join(f"{key} = {value:.5g}" for key, value in one.parameters.items())
        typer.echo(f"{one.law}: {one.scatter:.2f} MPa ({100 * one.relative:.2f} %): {parameters}")
    if len(fits) > 1:
        far = [float(one.stress(np.array([0.6]))[0]) for one in fits]
        typer.echo(f"{best.law} is taken: the least scatter for its number of parameters (Schwarz's criterion)")
        typer.echo(f"extrapolated to 0.6 they give {min(far):.0f} to {max(far):.0f} MPa")
