# SPDX-License-Identifier: Apache-2.0
"""The largest damage by each criterion, and when and where a crack begins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from presswork.fields.table import describe_field
from presswork.observe.contract import History, Observed
from presswork.observe.damage import DamagePeaks, Peak
from presswork.observe.memory.contract import Memory, begin_sentence, describe_instant


class Cracks(Memory):
    """The largest damage at a point and as a mean, and where a mean has first passed its critical value."""

    name = "damage"

    def __init__(self, *, are_cut: bool = False) -> None:
        """are_cut: cracks are cut into the mesh, and no fault."""
        self._are_cut = are_cut
        self._damage: dict[str, dict[str, Any]] = {}
        self._news: list[str] = []

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Note the damage of a state; it stops no run."""
        for peak in run.observers.find(DamagePeaks).find(run) if run else ():
            self._take_peak(peak, row)
        return None

    def _take_peak(self, peak: Peak, row: Mapping[str, Any]) -> None:
        place = {"cell": peak.cell, "point": peak.point, "at_mm": list(peak.place)}
        largest = {"value": peak.value, **place, **describe_instant(row)}
        around = {"cell": peak.mean.cell, "at_mm": list(peak.mean.place)}
        mean = {"value": peak.mean.value, "length_mm": peak.mean.length, **around, **describe_instant(row)}
        known = self._damage.setdefault(
            peak.name, {"largest": largest, "largest_mean": mean, "critical": peak.critical}
        )
        for key, now in (("largest", largest), ("largest_mean", mean)):
            if now["value"] > known[key]["value"]:
                known[key] = now
        if peak.mean.is_beyond and "first_exceeded" not in known:
            known["first_exceeded"] = {**mean, "critical": peak.mean.critical}
            self._news.append(_explain_crack(peak.name, known["first_exceeded"]))

    def news(self) -> list[str]:
        """Return the cracks that the log does not have yet."""
        news, self._news = self._news, []
        return [] if self._are_cut else news

    def warnings(self) -> list[str]:
        """Return the cracks, unless they are meant."""
        return (
            []
            if self._are_cut
            else [
                _explain_crack(name, known["first_exceeded"])
                for name, known in self._damage.items()
                if "first_exceeded" in known
            ]
        )

    def summary(self, history: History) -> dict[str, Any]:
        """Return the largest damage, and the cracks."""
        return {"damage": self._damage} if self._damage else {}

    def to_data(self) -> Any:
        """Return the damage by criterion."""
        return self._damage

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""
        self._damage = data


def _explain_crack(name: str, first: Mapping[str, Any]) -> str:
    """Describe which damage's mean has passed its critical value, when and where."""
    at = ", ".join(f"{x:.4g}" for x in first["at_mm"])
    mean = f"{first['value']:.4g} in the mean over {first['length_mm']:.3g} mm round ({at}) mm"
    return (
        f"{begin_sentence(first)}the {describe_field(name)} is {mean}, beyond the critical "
        f"{first['critical']:.4g}: a crack begins there"
    )
