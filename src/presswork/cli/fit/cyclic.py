# SPDX-License-Identifier: Apache-2.0
"""`material fit` of tests with reversals: tension and compression in turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import tomli_w
import typer

from presswork.case.errors import CaseError, Problem
from presswork.material.cyclic import CyclicTest, read_cyclic
from presswork.material.cyclic_plot import draw_cyclic
from presswork.material.fit_laws import make_cyclic_material
from presswork.material.identify_cyclic import CyclicFit, fit_cyclic
from presswork.material.specimen_facts import Sizes
from presswork.results.whole_file import write_whole

ODD_SLOPE = 0.15
"""Part of Young's modulus from which on a first slope that differs is reported."""


def fit_reversals(
    files: Sequence[Path], law: str, elastic: tuple[float, float], sizes: Sizes, branches: float | None,
    output: Path | None,
) -> None:  # fmt: skip
    """Read a test, fit laws to its first branches, and write material file and picture. Raises CaseError.

    elastic: Young's modulus [MPa] and Poisson's ratio; branches: how many are fitted, the others predicted; None: all.
    """
    if len(files) > 1:
        raise CaseError([Problem("", "several files, one of them with reversals", "fit it alone")], files[1])
    (path,) = files
    young, poisson = elastic
    test = read_cyclic(path, sizes)
    typer.echo(f"{path.name}, {test.how}")
    _print_branches(test, young)
    fits = fit_cyclic(test, law, young, branches)
    for fit in fits:
        typer.echo(f"{fit.law}: {', '.join(f'{key} = {value:.5g}' for key, value in fit.parameters.items())}")
        if fit.loose:
            typer.echo(f"{fit.law}: the fitted part does not determine {', '.join(fit.loose)}; later branches would")
    _print_errors(fits)
    best = fits[0]
    if len(fits) > 1:
        typer.echo(f"{best.law} is taken: the least scatter for its number of parameters (Schwarz's criterion)")
    target = output or path.with_suffix(".toml")
    write_whole(target, tomli_w.dumps(make_cyclic_material(path, best, {"young": young, "poisson": poisson})).encode())
    typer.echo(f"{target}\n{draw_cyclic(test, fits, path.stem, target.with_suffix('.png'))}")


def _print_branches(test: CyclicTest, young: float) -> None:
    """Print what the branches are, and where their first slopes are not Young's modulus."""
    for i, (branch, slope) in enumerate(zip(test.branches, test.slopes, strict=True), 1):
        typer.echo(
            f"branch {i}: strain {branch.strain[0]:.4f} to {branch.strain[-1]:.4f}, "
            f"stress {branch.stress[0]:.0f} to {branch.stress[-1]:.0f} MPa, first slope {slope / 1e3:.1f} GPa"
        )
        if not math.isnan(slope) and abs(slope / young - 1.0) > ODD_SLOPE:
            typer.echo(f"note: branch {i} does not begin with Young's modulus; check --young and the strains")


def _print_errors(fits: Sequence[CyclicFit]) -> None:
    """Print the errors by law and part of the test: root mean square, over the largest stress, and the largest."""
    parts = [(error.branch, error.is_fitted) for error in fits[0].errors]
    heads = [f"{'fitted' if is_fitted else 'predicted'}, branch {i}" for i, is_fitted in parts]
    typer.echo("".join([f"{'law':16s}", *(f"{head:>30s}" for head in heads)]))
    for fit in fits:
        cells = [f"{e.scatter:.2f} MPa {100 * e.relative:.2f} %, max {e.worst:.1f}" for e in fit.errors]
        typer.echo("".join([f"{fit.law:16s}", *(f"{cell:>30s}" for cell in cells)]))
