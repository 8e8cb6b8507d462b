# SPDX-License-Identifier: Apache-2.0
"""Judge a saved part by the forming limit that was saved with it, or by another: does it split or wrinkle?"""

from __future__ import annotations

import numpy as np

from presswork.fields.formability_fields import NEEDED, FormingVerdict, formability_fields, judge_fields
from presswork.fields.surface_defects import FOLD, SIDE
from presswork.formability import PATH_MARGINS, Formability, FormingLimitCurve, Judged
from presswork.model import FloatArray
from presswork.results import Result, ResultError


def judge_cells(result: Result, step: int = -1, judged: Formability | None = None) -> dict[str, FloatArray]:
    """Return thinning [%], wrinkling_indicator, forming_limit_margin and formability_zone of the cells (n_cells,).

    judged: the limit to judge by; without it that of the run. Without a curve the first two.
    Raises ResultError for a body that is no sheet.
    """
    return formability_fields(_strains(result, step), _find_judged(result, step, judged))


def _find_judged(result: Result, step: int, judged: Formability | None) -> Judged:
    return result.judged_at(step) if judged is None else [(judged, 0)]


def judge_part(result: Result, step: int = -1, judged: Formability | None = None) -> FormingVerdict:
    """Return how many cells lie in each zone, and the worst; arguments and errors as judge_cells."""
    planes = str(result.info.get("symmetry", ""))
    fields = _strains(result, step)
    fields |= {name: result.field(name, step) for name in (FOLD, SIDE) if name in result.field_names}
    if judged is None:  # paths were followed by the curve of the run
        fields |= {name: result.field(name, step) for name in PATH_MARGINS if name in result.field_names}
    verdict = judge_fields(
        fields,
        result.mesh_at(step).blocks,
        result.points(step),
        _find_judged(result, step, judged),
        ("x" in planes, "y" in planes),
    )
    assert verdict is not None
    return verdict


def _strains(result: Result, step: int) -> dict[str, FloatArray]:
    if missing := set(NEEDED) - set(result.field_names):
        raise ResultError(f"{result.folder} holds no sheet: it has no {', '.join(sorted(missing))}")
    return {name: result.field(name, step) for name in NEEDED}


def list_other_limits(result: Result) -> list[tuple[str, FormingLimitCurve]]:
    """Return the curves of zones of a welded blank that are not that of the first one, with their names."""
    first, found = result.formability.curve, list[tuple[str, FormingLimitCurve]]()
    for number, limit in result.limits.items():
        known = [first, *(curve for _, curve in found)]
        if limit.curve is not None and not any(_are_same(limit.curve, curve) for curve in known):
            found.append((result.zones[number] or "the blank", limit.curve))
    return found


def _are_same(one: FormingLimitCurve, other: FormingLimitCurve | None) -> bool:
    return other is not None and np.array_equal(one.minor, other.minor) and np.array_equal(one.major, other.major)
