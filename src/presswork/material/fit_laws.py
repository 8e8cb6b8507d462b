# SPDX-License-Identifier: Apache-2.0
"""Laws fitted to what a test machine wrote, and the material file of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.material.sheet import check_sheet_material
from presswork.material.compression import CompressionTest
from presswork.material.identify import LAWS, HardeningFit, fit_hardening
from presswork.material.identify_cyclic import CyclicFit
from presswork.material.identify_hot import HOT_LAWS, HotFit, fit_hot
from presswork.material.tensile import TensileTest


def fit_laws(test: TensileTest, law: str, young: float) -> list[HardeningFit]:
    """Fit one law, or all that there are points for, the best first. Raises CaseError."""
    if law != "all":
        if law not in LAWS:
            raise CaseError([Problem("--law", "unknown law", suggest(law, (*LAWS, "all")), law)])
        return [fit_hardening(test, law, young)]
    fits = []
    for name in LAWS:
        try:
            fits.append(fit_hardening(test, name, young))
        except CaseError as error:
            reason = error
    if not fits:
        raise reason
    return sorted(fits, key=lambda one: one.criterion)


def pick_rolling_direction(tests: Sequence[TensileTest], path: Path) -> TensileTest:
    """Return the test along the rolling direction. Raises CaseError."""
    for test in tests:
        if test.angle == 0.0:
            return test
    raise CaseError([Problem("angle", "no test along the rolling direction", "give points with angle 0")], path)


def make_tensile_material(
    files: Sequence[Path], best: HardeningFit, elastic: dict[str, Any], surface: dict[str, Any] | None
) -> dict[str, Any]:
    """Return a material file of the best law, and of the yield function if the tests gave one. Raises CaseError."""
    table: dict[str, Any] = dict(elastic)
    if surface is not None:
        table["yield_function"] = surface
    table["hardening"] = {"law": best.law, **best.parameters}
    source = ", ".join(file.name for file in files)
    check_sheet_material(table, source)
    assumed = {"young": "as given to the fit", "poisson": "as given to the fit"}
    if (
        surface is not None
        and surface["law"] == "yld2000"
        and "alpha" not in surface
        and "stress_biaxial" not in surface
    ):
        assumed["yield_function"] = "yields in balanced biaxial tension as along the rolling direction; not measured"
    return {
        "name": files[0].stem,
        "summary": f"fitted to {source}",
        "material": table,
        "sources": {"all": f"{source}, fitted to a plastic strain of {best.largest_strain:.3f}"},
        "assumed": assumed,
    }


def fit_hot_laws(tests: Sequence[CompressionTest], law: str) -> tuple[list[HotFit], list[CaseError]]:
    """Return the fit of one law, or of all that the tests determine, the best first, and what was left out."""
    if law != "all":
        return [fit_hot(tests, law)], []
    fits, faults = [], []
    for name in HOT_LAWS:
        try:
            fits.append(fit_hot(tests, name))
        except CaseError as error:
            faults.append(error)
    if not fits:
        raise faults[0]
    return sorted(fits, key=lambda fit: fit.relative), faults


def make_hot_material(source: Path, fit: HotFit, elastic: dict[str, Any], *, is_heated: bool) -> dict[str, Any]:
    """Return a material file of a hot law; is_heated: whether heating in the test was corrected. Raises CaseError."""
    table = {**elastic, "hardening": fit.to_table()}
    check_sheet_material(table, str(source))
    heated = "corrected for friction and heating" if is_heated else "corrected for friction"
    return {
        "name": source.stem,
        "summary": f"fitted to {source.name}",
        "material": table,
        "sources": {"all": f"{source.name}, {heated}; scatter {fit.scatter:.2f} MPa ({100 * fit.relative:.2f} %)"},
        "assumed": {"young": "as given to the fit", "poisson": "as given to the fit"},
    }


def make_cyclic_material(path: Path, best: CyclicFit, elastic: dict[str, float]) -> dict[str, Any]:
    """Return a material file of a law fitted to a test with reversals. Raises CaseError."""
    table = {**elastic, **best.to_tables()}
    check_sheet_material(table, str(path))
    parts = [
        f"{'fitted' if e.is_fitted else 'predicted'} branch {e.branch} {e.scatter:.2f} MPa ({100 * e.relative:.2f} %)"
        for e in best.errors
    ]
    return {
        "name": path.stem,
        "summary": f"fitted to {path.name}, tension and compression in turn",
        "material": table,
        "sources": {"all": f"{path.name}; {', '.join(parts)}"},
        "assumed": {"young": "as given to the fit", "poisson": "as given to the fit", "yield_function": "von Mises"},
    }
