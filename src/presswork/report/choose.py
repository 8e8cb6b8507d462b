# SPDX-License-Identifier: Apache-2.0
"""Which fields and which saved steps a page shows, so that it stays small enough to send."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.fields.field import LAMINA, TENSOR
from presswork.fields.table import find_row, split_components, to_scalar
from presswork.model import FloatArray
from presswork.report.pack import Blocks
from presswork.report.surface import Surface, find_surface
from presswork.results import Result
from presswork.view.all_plots import default_fields

STEPS_WANTED = 20
"""Fields are left out, the last of the list first, before fewer steps than these are shown."""
FIELDS_KEPT = 5
"""Fields that stay, however few steps there is room for."""


@dataclass(frozen=True)
class Shown:
    """One number a node or a face."""

    name: str
    """Name as commands name it: effective_stress, stress_top_xx, displacement."""
    stored: str
    """Name in the results file."""
    kind: str
    """point or cell."""

    def pick(self, values: FloatArray) -> FloatArray:
        """Return the number out of the stored values (n,) or (n, k): themselves, a component, or a vector's length."""
        if self.name == self.stored:
            found = to_scalar(self.stored, values)
            assert found is not None, "tensors are listed by component"
            return found
        return split_components(self.stored, values)[self.name]


@dataclass(frozen=True)
class Choice:
    """What is shown, and what not."""

    fields: tuple[Shown, ...]
    steps: tuple[int, ...]
    notes: tuple[str, ...]
    """What was left out to stay below the budget, as sentences."""
    has_inside: bool
    """Whether cells and nodes inside a solid are there, so that a cut shows the field."""


def list_fields(result: Result) -> list[Shown]:
    """Return all that can be shown: the run's default fields, then other scalars and lengths, components at the end."""
    first = list(default_fields(result))
    strains = [f"{which}_strain_middle" for which in ("major", "minor")]
    scalars: list[Shown] = []
    vectors: list[Shown] = []
    tensors: list[Shown] = []
    layers: list[Shown] = []
    for stored, kind in result.field_names.items():
        row = find_row(stored)
        values = result.field(stored, -1)
        if to_scalar(stored, values[:1]) is not None:
            scalars.append(Shown(stored, stored, kind))
        if values.ndim == 2:
            parts = [Shown(name, stored, kind) for name in split_components(stored, values[:1])]
            is_layer = row is not None and row.place == "layer"
            is_tensor = row is not None and row.components in (TENSOR, LAMINA)
            (layers if is_layer else tensors if is_tensor else vectors).extend(parts)
    wanted = [*first, *strains]
    scalars.sort(key=lambda shown: wanted.index(shown.name) if shown.name in wanted else len(wanted))
    return [*scalars, *tensors, *vectors, *layers]


def choose(result: Result, budget: int) -> Choice:
    """Return what is shown of a run in so many bytes of text, by what its last step takes."""
    fields, count = list_fields(result), len(result.times)
    notes = []
    surface = find_surface(result.mesh_at(-1), has_inside=True)
    trial = _add_points(result, surface)
    has_inside = trial.count_bytes() * (1 + FIELDS_KEPT / 3) * min(count, STEPS_WANTED) <= budget
    if not has_inside and len(surface.owners):
        surface = find_surface(result.mesh_at(-1))
        trial = _add_points(result, surface)
        notes.append("What is inside the body is left out for size: a cut shows no colours.")
    cost = trial.count_bytes()
    kept: list[Shown] = []
    for shown in fields:
        values = shown.pick(result.field(shown.stored, -1))
        trial.add_values(surface.take_points(values) if shown.kind == "point" else surface.take_cells(values))
        total = trial.count_bytes()
        if len(kept) >= FIELDS_KEPT and total * min(count, STEPS_WANTED) > budget:
            break
        kept.append(shown)
        cost = total
    room = max(2, int(budget // max(cost, 1)))
    steps = np.arange(count)
    if room < count:
        steps = np.unique(np.rint(np.linspace(0, count - 1, room)).astype(int))
        notes.append(f"{len(steps)} of {count} saved steps are here; the rest would make the page too large to send.")
    if len(kept) < len(fields):
        rest = ", ".join(shown.name for shown in fields[len(kept) :])
        notes.append(f"Fields left out for size, which the results file has: {rest}.")
    return Choice(tuple(kept), tuple(int(step) for step in steps), tuple(notes), has_inside)


def _add_points(result: Result, surface: Surface) -> Blocks:
    """Return blocks that hold the last step's positions."""
    trial = Blocks()
    trial.add_values(surface.take_points(result.points(-1)))
    return trial
