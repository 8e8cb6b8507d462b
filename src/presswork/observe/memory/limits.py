# SPDX-License-Identifier: Apache-2.0
"""Whether a converged state is still physics: a list of measures, each of which the case sets a limit on.

Observers measure a run's state after each increment or interval; what happens beyond a limit is decided here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from presswork.model import Limits
from presswork.observe.contract import History, LimitName, Measure, Observed
from presswork.observe.memory.contract import Memory, begin_sentence, describe_instant

REMEDIES: dict[LimitName, str] = {
    "penetration": "refine the mesh where tools are narrow or curved, or shorten the stroke",
    "thinning": "the sheet has torn: ease the draw by radii, friction or holder force, or shorten the stroke",
    "hydrostatic_stress": "shorten the stroke if the die is full or tools have used up the metal between them; else "
    "take an element that does not lock",
    "mean_pressure": "the metal has no way out: shorten the stroke, make the workpiece smaller, or open the die",
}
NEVER_PASSED: tuple[LimitName, ...] = ("mean_pressure",)
"""Limits that stop a run even where the case lets it go on: what follows is a force without bounds."""


class LimitsPassed(Memory):
    """How near the states came to their limits, and which they passed."""

    name = "limits"

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._nearest: dict[str, dict[str, Any]] = {}
        self._passed: dict[str, str] = {}

    def look(self, run: Observed | None, row: Mapping[str, Any]) -> str | None:
        """Measure a converged state; return why the run must stop, if it must."""
        measures = run.observers.measures(run) if run else []
        for measure in measures:
            if measure.limit not in self._nearest or measure.value > self._nearest[measure.limit]["largest"]:
                limit = getattr(self._limits, measure.limit)
                so_far = {"largest": measure.value, "limit": limit, "fact": measure.fact, **describe_instant(row)}
                self._nearest[measure.limit] = so_far
        breach = find_breach(self._limits, measures)
        if breach is None:
            return None
        if not self._limits.stop:
            final = find_breach(self._limits, [m for m in measures if m.limit in NEVER_PASSED])
            breach = breach if final is None else final
        reason = f"{begin_sentence(describe_instant(row))}{explain_breach(breach, self._limits, row)}"
        self._passed.setdefault(breach.limit, reason)
        return reason if self._limits.stop or breach.limit in NEVER_PASSED else None

    def warnings(self) -> list[str]:
        """Return the limits that were passed by a run that went on."""
        return [] if self._limits.stop else list(self._passed.values())

    def summary(self, history: History) -> dict[str, Any]:
        """Return how near limits came, and what press and tools bear where the case gives their limits."""
        bears = {"force_n": self._limits.force, "contact_pressure_mpa": self._limits.contact_pressure}
        equipment = {name: limit for name, limit in bears.items() if limit is not None}
        return {"limits": self._nearest, **({"equipment": equipment} if equipment else {})}

    def to_data(self) -> Any:
        """Return what was nearest, and what was passed."""
        return [self._nearest, self._passed]

    def load_data(self, data: Any) -> None:
        """Take up what to_data gave."""
        self._nearest, self._passed = data


def find_breach(limits: Limits, measures: Sequence[Measure]) -> Measure | None:
    """Return the measure farthest beyond its limit, if any is.

    >>> deep = Measure("penetration", 0.8, "a tool has cut 0.8 mm into an edge of 1 mm")
    >>> find_breach(Limits(), [deep]) is deep
    True
    >>> find_breach(Limits(penetration=0.9), [deep])
    """
    beyond = [(m.value / getattr(limits, m.limit), m) for m in measures]
    share, worst = max(beyond, key=lambda pair: pair[0], default=(0.0, None))
    return worst if share > 1.0 else None


def explain_breach(measure: Measure, limits: Limits, row: Mapping[str, Any]) -> str:
    """Describe the limit that is exceeded, by what, and the remedy. row: of the history; for pressures it supplies fill
    and force."""
    limit = getattr(limits, measure.limit)
    presses = describe_press(row) if measure.limit in ("hydrostatic_stress", "mean_pressure") else ""
    key = f"limits.{measure.limit}={2.0 * measure.value:.2g}" if measure.limit in NEVER_PASSED else "limits.stop=false"
    return (
        f"{measure.fact}{presses}: no longer physics (limits.{measure.limit} = {limit:g}). "
        f"{REMEDIES[measure.limit].capitalize()}. To continue anyway: --set {key}"
    )


def describe_press(row: Mapping[str, Any]) -> str:
    """Describe how far dies are filled, and the largest force among the tools that move, else among all.

    >>> describe_press({"die.fill": 0.987, "die.force": -3e6, "punch.stroke": 3.0, "punch.force": 2.5e6})
    '; the wall of die is filled to 98.7 %; punch presses with 2.5e+06 N'
    """
    filled = [
        f"; the wall of {k.removesuffix('.fill')} is filled to {100.0 * row[k]:.3g} %"
        for k in row
        if k.endswith(".fill")
    ]
    forces = {name.removesuffix(".force"): abs(float(row[name])) for name in row if name.endswith(".force")}
    moved = {name: force for name, force in forces.items() if row.get(f"{name}.stroke")}
    strongest = max(moved or forces, key=lambda name: forces[name], default=None)
    pressed = "" if strongest is None else f"; {strongest} presses with {forces[strongest]:.4g} N"
    return "".join(filled) + pressed
