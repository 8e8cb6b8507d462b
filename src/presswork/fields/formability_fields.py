# SPDX-License-Identifier: Apache-2.0
"""Fields of formability, from the strains in the middle of a sheet; and the verdict on a part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from presswork.fields.surface_defects import FOLD, SIDE, Cells, count_folds
from presswork.formability import (
    CRACKS,
    PATH_MARGINS,
    POLAR,
    ZONE,
    ZONES,
    Formability,
    Info,
    Judged,
    find_margin,
    find_thinning,
    find_wrinkling,
    find_zones,
)
from presswork.model import FloatArray, Model

FORMABILITY_FIELDS = ("thinning", "wrinkling_indicator", "forming_limit_margin", "formability_zone")
"""The last two need a forming limit."""
NEEDED = ("major_strain_middle", "minor_strain_middle", "thickness_strain")


def formability_fields(fields: Mapping[str, FloatArray], judged: Judged) -> dict[str, FloatArray]:
    """Return FORMABILITY_FIELDS (n_cells,) from the fields NEEDED; without a curve the first two, of solids none.

    Where only some cells have a curve, the last two are NaN in the others.
    """
    if not set(NEEDED) <= set(fields):
        return {}
    if len(judged) == 1:
        return _judge_cells(fields, judged[0][0])
    ends = np.cumsum([n for _, n in judged])
    parts = [
        _judge_cells({name: fields[name][end - n : end] for name in NEEDED}, own)
        for end, (own, n) in zip(ends, judged, strict=True)
    ]
    names = max(parts, key=len)
    return {
        name: np.concatenate([p.get(name, np.full(n, np.nan)) for p, (_, n) in zip(parts, judged, strict=True)])
        for name in names
    }


def _judge_cells(fields: Mapping[str, FloatArray], judged: Formability) -> dict[str, FloatArray]:
    """Return the fields of cells of one material."""
    major, minor, thickness = (fields[name] for name in NEEDED)
    found = {"thinning": find_thinning(thickness), "wrinkling_indicator": find_wrinkling(major, minor, judged.r)}
    if judged.curve is not None:
        zone = find_zones(major, minor, judged.curve, r=judged.r, margin=judged.safety_margin)
        found["forming_limit_margin"] = find_margin(major, minor, judged.curve)
        found["formability_zone"] = zone.astype(np.float64)
    return found


def describe_judged(model: Model) -> Info:
    """Return what results store of what strains are judged by, of a welded blank each zone's, and names of zones."""
    info = dict(model.judged[0][0].to_info())
    if model.zones:
        info["zones"] = "\n".join(model.zones)
        for block in model.mesh.blocks:
            info |= model.materials[block.material].formability.to_info(f"{ZONE}{block.zone}_")
    return info


@dataclass(frozen=True)
class Extreme:
    """A cell that is worst in something."""

    value: float
    cell: int
    """Its number, from 0, blocks one after the other."""
    place: tuple[float, float, float]
    """Its middle, deformed [mm]."""

    def where(self) -> str:
        """Return the place in words."""
        return f"at ({', '.join(f'{x:.4g}' for x in self.place)}) mm"


@dataclass(frozen=True)
class FormingVerdict:
    """Verdict on a part: whether it splits, and where it is nearest to the limit."""

    forming_limit: str
    """Origin of the curve; empty without a curve."""
    zones: dict[str, int]
    """Number of cells by the name of the zone; empty without a curve."""
    margin: Extreme | None
    """The cell with the least margin; None without a curve."""
    thinning: Extreme
    """The thinnest cell, in per cent."""
    note: str = ""
    """Notes on the curve."""
    by_path: Mapping[str, Extreme] = field(default_factory=dict)
    """Cells with the least margins along their paths, by the name of the field; empty where paths were not followed."""
    failing_by_path: int = 0
    """Number of cells beyond the polar limit at some time."""
    fold: Extreme | None = None
    """The cell with the largest fold ratio; None where it was not looked for."""
    folds: int = 0
    """Number of folds of the whole part."""

    @property
    def failing(self) -> int:
        """Number of cells above the curve."""
        return self.zones.get(ZONES[CRACKS], 0)

    def text(self) -> str:
        """Return the verdict as a sentence."""
        thin = "nothing thins"
        if self.thinning.value >= 0.05:
            thin = f"thinning up to {self.thinning.value:.1f} % {self.thinning.where()}"
        cracks = "the material has no forming_limit, so cracks are not judged"
        if self.margin is not None:
            cracks = self._describe_strains(self.margin) + self._describe_path()
        parts = [thin, cracks] if self.margin is None else [cracks, thin]
        if self.fold and self.folds:  # first, unless the part splits
            places = "1 place" if self.folds == 1 else f"{self.folds} places"
            parts.insert(1 if self.failing else 0, f"the sheet folds in {places}, most {self.fold.where()}")
        return "; ".join(parts)

    def _describe_strains(self, margin: Extreme) -> str:
        """Describe what the strains mean for cracks, taken as if their paths were straight."""
        count, worst = sum(self.zones.values()), 100 * margin.value
        if self.failing:
            return (
                f"the part splits: {self.failing} of {count} elements lie above the forming limit, the worst by "
                f"{-worst:.1f} % {margin.where()}"
            )
        near = self.zones[ZONES[1]]
        risk = f", {near} of {count} elements at risk" if near else ""
        return f"no element lies above the forming limit{risk}; least margin {worst:.1f} % {margin.where()}"

    def _describe_path(self) -> str:
        """Describe what the paths mean for cracks, after a linking word; empty where they were not followed."""
        if POLAR not in self.by_path:
            return ""
        worst, count = self.by_path[POLAR], sum(self.zones.values())
        if self.failing_by_path:
            return (
                f"; by their paths {self.failing_by_path} of {count} elements have passed it, the worst by "
                f"{-100 * worst.value:.1f} % {worst.where()}"
            )
        return f"; along their paths {100 * worst.value:.1f} % {worst.where()}"

    def to_summary(self) -> dict[str, Any]:
        """Return what summary.json keeps."""
        margin = None if self.margin is None else asdict(self.margin)
        return {
            "verdict": self.text(),
            "forming_limit": self.forming_limit,
            "zones": self.zones,
            "failing_cells": self.failing,
            "least_margin": margin,
            **{f"least_{name.removeprefix('forming_limit_')}": asdict(worst) for name, worst in self.by_path.items()},
            **({"failing_cells_by_path": self.failing_by_path} if self.by_path else {}),
            **({"largest_fold_ratio": asdict(self.fold), "folds": self.folds} if self.fold else {}),
            "largest_thinning_percent": asdict(self.thinning),
        }

    def warnings(self) -> list[str]:
        """Return the verdict if the part splits or folds, and what to know of the curve."""
        has_failed = self.failing or self.failing_by_path or self.folds
        return [text for text in (self.text() if has_failed else "", self.note) if text]


def judge_fields(
    fields: Mapping[str, FloatArray],
    blocks: Sequence[Cells],
    points: FloatArray,
    judged: Judged,
    symmetry: tuple[bool, bool] = (False, False),
) -> FormingVerdict | None:
    """Return the verdict on a sheet.

    fields: NEEDED, and PATH_MARGINS, FOLD and SIDE if they are there; blocks: its cells; points (n_points, 3): deformed
    [mm]; symmetry: whether x = 0 and y = 0 mirror it.

    None for a body that is no sheet.
    """
    found = formability_fields(fields, judged)
    if not found:
        return None

    centres = np.concatenate([points[block.connectivity].mean(axis=1) for block in blocks])

    def extreme(values: FloatArray, cell: np.intp) -> Extreme:
        x, y, z = (float(c) for c in centres[cell])
        return Extreme(float(values[cell]), int(cell), (x, y, z))

    thinnest = extreme(found["thinning"], np.argmax(found["thinning"]))
    fold = extreme(fields[FOLD], np.argmax(fields[FOLD])) if FOLD in fields else None
    folds = count_folds(fields[SIDE], blocks, points, symmetry) if SIDE in fields else 0
    methods = dict.fromkeys(own.curve.method for own, _ in judged if own.curve is not None)
    if not methods:
        return FormingVerdict("", {}, None, thinnest, fold=fold, folds=folds)
    zone = found["formability_zone"]
    counts = np.bincount(zone[np.isfinite(zone)].astype(int), minlength=len(ZONES))
    note = "; ".join(dict.fromkeys(own.note for own, _ in judged if own.note))
    margin = found["forming_limit_margin"]
    zones = {name: int(count) for name, count in zip(ZONES, counts, strict=True)}
    by_path = {name: extreme(fields[name], np.nanargmin(fields[name])) for name in PATH_MARGINS if name in fields}
    failing = int((fields[POLAR] < 0.0).sum()) if POLAR in fields else 0
    least = extreme(margin, np.nanargmin(margin))
    return FormingVerdict("; ".join(methods), zones, least, thinnest, note, by_path, failing, fold, folds)
