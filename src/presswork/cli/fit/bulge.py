# SPDX-License-Identifier: Apache-2.0
"""`material fit` of hydraulic bulge tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomli_w
import typer

from presswork.material.bulge import BulgeSizes, BulgeTest, read_bulge
from presswork.material.fit_laws import fit_laws, make_tensile_material, pick_rolling_direction
from presswork.material.fit_plot import draw_fit
from presswork.material.identify import HardeningFit, compare_flow
from presswork.material.specimen_facts import Sizes
from presswork.material.tensile import read_tensile
from presswork.results.whole_file import write_whole


def fit_bulge(
    bulge: Path, tensile: Sequence[Path], law: str, elastic: tuple[float, float], sizes: BulgeSizes, output: Path | None
) -> None:
    """Read a bulge test, fit hardening laws to its curve, and write material file and picture. Raises CaseError.

    tensile: of the same sheet, which give the biaxial yield stress over that along the rolling direction and bring the
    curve to tension; elastic: Young's modulus [MPa] and Poisson's ratio.
    """
    young, poisson = elastic
    test = read_bulge(bulge, sizes, young, poisson)
    for note in test.notes:
        typer.echo(f"{bulge.name}: {note}")
    if test.biaxial_r is not None:
        typer.echo(f"r in balanced biaxial tension = {test.biaxial_r:.3f} (--biaxial-r of a fit to tensile tests)")
    curve = test.as_tension(young)
    if tensile:
        along = pick_rolling_direction(read_tensile(tensile, Sizes(thickness=sizes.thickness), young).tests, tensile[0])
        ratio = compare_flow(curve, along, young)
        typer.echo(
            f"balanced biaxial stress = {ratio:.3f} of that in tension after the same plastic work "
            "(--biaxial-stress of a fit to tensile tests)"
        )
        curve = scale_to_tension(test, ratio).as_tension(young)
    fits = fit_laws(curve, law, young)
    for fit in fits:
        parameters = ", ".join(f"{key} = {value:.5g}" for key, value in fit.parameters.items())
        typer.echo(f"{fit.law}: {fit.scatter:.2f} MPa ({100 * fit.relative:.2f} %): {parameters}")
    typer.echo(f"fitted to a plastic strain of {fits[0].largest_strain:.3f}")
    path = output or bulge.with_suffix(".toml")
    write_whole(path, tomli_w.dumps(_make_material(bulge, tensile, fits[0], elastic, test)).encode())
    typer.echo(f"{path}\n{draw_fit([curve], fits, young, path.with_suffix('.png'))}")


def scale_to_tension(test: BulgeTest, ratio: float) -> BulgeTest:
    """Return the curve in tension that spends the same plastic work: stress over ratio, strain times ratio."""
    return replace(test, stress=test.stress / ratio, plastic_strain=ratio * test.plastic_strain)


def _make_material(
    bulge: Path, tensile: Sequence[Path], best: HardeningFit, elastic: tuple[float, float], test: BulgeTest
) -> dict[str, Any]:
    """Return the material file, with what was assumed."""
    young, poisson = elastic
    data = make_tensile_material([bulge, *tensile], best, {"young": young, "poisson": poisson}, None)
    if not tensile:
        data["assumed"]["hardening"] = "the biaxial curve is taken as that in tension (von Mises)"
    for i, note in enumerate(test.notes):
        data["assumed"][f"bulge test {i + 1}"] = note
    if test.biaxial_r is not None:
        data["summary"] += f"; r in balanced biaxial tension {test.biaxial_r:.3f}"
    return data
