# SPDX-License-Identifier: Apache-2.0
"""`material fit` of hot compression tests."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import tomli_w
import typer

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.units import DENSITY, HEAT_CAPACITY, Dimension, to_number
from presswork.material.compression import (
    CompressionTest,
    correct,
    find_adiabatic_part,
    find_hot_head,
    read_compression,
)
from presswork.material.fit_laws import fit_hot_laws, make_hot_material
from presswork.material.hot_plot import draw_hot_fit
from presswork.material.identify_hot import HOT_LAWS, find_untested, tabulate
from presswork.material.measured_file import read_measured_file
from presswork.results.whole_file import write_whole


def is_hot_compression(path: Path) -> bool:
    """Return whether a CSV file holds hot compression tests: columns of rate and temperature. Raises CaseError."""
    return find_hot_head(read_measured_file(path)) is not None


def fit_compression(
    path: Path, law: str, young: float, poisson: float, density: str, specific_heat: str, output: Path | None
) -> None:
    """Correct the tests, fit the laws, and write material file, table and picture. Raises CaseError."""
    if law not in (*HOT_LAWS, "all"):
        raise CaseError([Problem("--law", "unknown law of hot tests", suggest(law, (*HOT_LAWS, "all")), law)])
    if bool(density) != bool(specific_heat):
        key = "--specific-heat" if density else "--density"
        raise CaseError([Problem(key, "heating needs density and specific heat", "give both, or none")])
    capacity = None
    if density:
        capacity = _read("--density", density, DENSITY) * _read("--specific-heat", specific_heat, HEAT_CAPACITY)
    measured = read_compression(path)
    tests = correct(measured, capacity)
    _print_tests(measured, tests, capacity)
    fits, faults = fit_hot_laws(tests, law)
    for fault in faults:
        typer.echo(f"left out: {fault}")
    for fit in fits:
        parameters = ", ".join(f"{key} = {value:.5g}" for key, value in fit.parameters.items() if value)
        typer.echo(f"{fit.law}: {fit.scatter:.2f} MPa ({100 * fit.relative:.2f} %): {parameters}")
        if fit.left_out:
            names = ", ".join(fit.left_out)
            typer.echo(
                f"{fit.law}: the tests do not determine {names}, which are 0; more strains, rates or temperatures would"
            )
    target = output or path.with_suffix(".toml")
    data = make_hot_material(path, fits[0], {"young": young, "poisson": poisson}, is_heated=capacity is not None)
    write_whole(target, tomli_w.dumps(data).encode())
    typer.echo(str(target))
    rows = [",".join(f"{value:.6g}" for value in row) for row in tabulate(tests, fits[0])]
    if rows:
        table = target.with_name(f"{target.stem}_table.csv")
        write_whole(table, "\n".join(["strain,rate,temperature,stress", *rows, ""]).encode())
        untested = [f"{rate:g} 1/s at {start:g} degrees C" for rate, start in find_untested(tests)]
        typer.echo(f"{table}" + (f"; untested, so of the law: {', '.join(untested)}" if untested else ""))
    else:
        typer.echo("no table: the tests have no strains in common")
    typer.echo(str(draw_hot_fit(tests, fits, path.stem, target.with_suffix(".png"))))


def _print_tests(measured: Sequence[CompressionTest], tests: Sequence[CompressionTest], capacity: float | None) -> None:
    """Print what the corrections have changed."""
    typer.echo(f"{len(tests)} tests")
    with_friction = [test for test in measured if test.m > 0.0]
    if with_friction:
        low, high = min(test.m for test in with_friction), max(test.m for test in with_friction)
        parts = [1.0 - after.stress[-1] / before.stress[-1] for before, after in zip(measured, tests, strict=True)]
        typer.echo(f"friction: m = {low:.3g} to {high:.3g}; it took up to {100 * max(parts):.1f} % of the stress")
    else:
        typer.echo("friction: not corrected; give columns height, diameter, and m or the barrel")
    if capacity is None:
        typer.echo("heating in the test: not corrected; give --density and --specific-heat")
    else:
        most = max(tests, key=lambda test: float(test.temperature[-1]) - test.start)
        typer.echo(
            f"heating in the test: up to {most.temperature[-1] - most.start:.1f} K, at {most.start:g} degrees C and "
            f"{most.rate:g} 1/s ({100 * find_adiabatic_part(most.rate):.0f} % of the heat stay)"
        )


def _read(key: str, text: str, dimension: Dimension) -> float:
    try:
        value = to_number(text, dimension)
    except Exception as error:
        remedy = f'for instance "{dimension.example}"'
        raise CaseError([Problem(key, f"expected {dimension.name}, not `{text}`", remedy)]) from error
    if not value > 0.0:
        raise CaseError([Problem(key, "expected a value > 0", "", text)])
    return value
