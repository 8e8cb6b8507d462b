# SPDX-License-Identifier: Apache-2.0
"""How near the strains of a sheet are to its forming limit, and how much it thins."""

from __future__ import annotations

from typing import Any

from presswork.fields.formability_fields import Extreme, FormingVerdict, describe_judged, judge_fields
from presswork.formability import Info
from presswork.model import Model
from presswork.observe.contract import History, Measure, Observed, Observer


class FormabilityObserver(Observer):
    """The verdict on a sheet."""

    def __init__(self, model: Model) -> None:
        self._forms_sheet = model.analysis in ("shell", "stamping")
        self._found: tuple[tuple[int, int], FormingVerdict] | None = None

    def measures(self, run: Observed) -> list[Measure]:
        """Return the thinning of the thinnest cell."""
        if (verdict := self._judge_middle(run)) is None:
            return []
        thinnest = verdict.thinning
        fact = f"the sheet is thinned by {thinnest.value:.1f} % {thinnest.where()}"
        return [Measure("thinning", thinnest.value / 100.0, fact)]

    def find_margin(self, run: Observed) -> Extreme | None:
        """Return the cell with the least margin to the forming limit; None without a curve."""
        verdict = self._judge_middle(run)
        return None if verdict is None else verdict.margin

    def judge(self, run: Observed) -> FormingVerdict | None:
        """Return the verdict on the present sheet and its surface; None of solids."""
        return self._judge(run, with_surface=True)

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the verdict."""
        verdict = self.judge(run)
        if verdict is None:
            return {}
        estimate = run.model.one_step_thinning
        compared = {} if estimate is None else {"one_step_thinning_percent": estimate}
        return {"formability": verdict.to_summary() | compared}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return what is wrong with the part."""
        verdict = self.judge(run)
        return verdict.warnings() if verdict else []

    def info(self, run: Observed) -> Info:
        """Return what the sheet is judged by."""
        return describe_judged(run.model) if self._forms_sheet else {}

    def _judge_middle(self, run: Observed) -> FormingVerdict | None:
        """Return the verdict by the strains alone; it is found once in an instant."""
        instant = run.number, run.epoch
        if self._forms_sheet and (self._found is None or self._found[0] != instant):
            verdict = self._judge(run, with_surface=False)
            self._found = None if verdict is None else (instant, verdict)
        return None if self._found is None else self._found[1]

    def _judge(self, run: Observed, *, with_surface: bool) -> FormingVerdict | None:
        if not self._forms_sheet:
            return None
        fields, symmetry = run.sheet_fields(with_surface=with_surface), run.model.symmetry
        return judge_fields(fields, run.mesh.blocks, run.positions(), run.model.judged, symmetry)
