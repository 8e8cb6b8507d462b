# SPDX-License-Identifier: Apache-2.0
"""Drawbeads by their geometry: the strip that is pulled through one, and the file that keeps the restraining force.

The strip is that of the example `drawbead`: in plane strain, closed in the bead and pulled through it by explicit
shells of the blank's sheet, along its rolling direction. Lengths scale with the bead.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from presswork.case.errors import CaseError, Problem
from presswork.case.stamping.bead_geometry import BeadGeometry
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage import StampingBead

CLOSE, PULL = "close", "pull"
_WIDTH = 2.0
"""Width of the strip, of which half is modelled [mm]."""
_ELEMENT = 0.15
"""Length of a shell, of the smallest radius."""


def make_strip(case: StampingCase, geometry: BeadGeometry) -> StampingCase:
    """Return the case of a strip of the blank's sheet that is pulled through a bead."""
    blank = case.blank
    width = geometry.find_groove_width(blank.mean_thickness)
    pull = 1.2 * (width + 2.0 * geometry.groove_radius + 2.0 * geometry.depth)
    die = {"shape": "strip", "width": width, "edge_radius": geometry.groove_radius, "mu": geometry.mu}
    gap = 1.15 * blank.mean_thickness if geometry.gap is None else geometry.gap
    size = _ELEMENT * min(geometry.bead_radius, geometry.groove_radius)
    return StampingCase.model_validate({
        "title": "strip pulled through a drawbead",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [3.0 * pull, _WIDTH], "thickness": blank.mean_thickness,
                  "element_size": [size, _WIDTH], "points": max(blank.points, 7), "material": blank.material,
                  "symmetry": ["y"]},
        "materials": case.materials,
        "boundary": {"side": {"set": "top", "hold": "symmetry_y"}},
        "tools": {
            "punch": {"kind": "punch", "shape": "strip", "width": 2.0 * geometry.bead_radius,
                      "edge_radius": geometry.bead_radius, "mu": geometry.mu},
            "die": {"kind": "die", **die},
            "holder": {"kind": "holder", "gap": gap, **die},
        },
        "stages": [
            {"name": CLOSE, "tools": {"punch": {"stroke": geometry.depth}}},
            {"name": PULL, "velocity": 4000.0, "displacement": [{"set": "right", "component": "x", "value": pull}]},
        ],
        "output": {"steps": 1, "rows": 100},
    })  # fmt: skip


def list_geometries(case: StampingCase) -> list[tuple[str, BeadGeometry]]:
    """Return the geometries of beads, each with its key."""
    found = [(f"beads.{i}", bead) for i, bead in enumerate(case.beads)]
    for number, operation in enumerate(case.operations):
        found += [(f"operations.{number}.beads.{i}", bead) for i, bead in enumerate(operation.beads)]
    return [(f"{key}.geometry", bead.geometry) for key, bead in found if bead.geometry is not None]


def find_file(case: StampingCase) -> Path | None:
    """Return the file beside the case that keeps the forces of its beads; None of a case that came from no file."""
    return None if case.source is None else case.source.with_name(f"{case.source.stem}.beads.json")


def read_forces(case: StampingCase) -> dict[str, dict[str, Any]]:
    """Return what the file beside a case keeps, by fingerprints of strips; a damaged file keeps nothing."""
    path = find_file(case)
    try:
        found = json.loads(path.read_text(encoding="utf-8")) if path else {}
    except (OSError, ValueError):
        return {}
    return {key: row for key, row in found.items() if isinstance(row, dict)} if isinstance(found, dict) else {}


def put_forces(case: StampingCase, forces: Mapping[str, tuple[float, float]]) -> StampingCase:
    """Return a case whose beads have the restraining and closing forces [N/mm] of their keys; others stay."""

    def set_forces(key: str, beads: tuple[StampingBead, ...]) -> tuple[StampingBead, ...]:
        return tuple(
            bead.model_copy(update=dict(zip(("force", "closing_force"), found, strict=True)) | {"geometry": None})
            if (found := forces.get(f"{key}.{i}.geometry"))
            else bead
            for i, bead in enumerate(beads)
        )

    operations = tuple(
        each.model_copy(update={"beads": set_forces(f"operations.{number}.beads", each.beads)})
        for number, each in enumerate(case.operations)
    )
    return case.model_copy(update={"beads": set_forces("beads", case.beads), "operations": operations})


def refuse_unknown(case: StampingCase) -> None:
    """Raise CaseError if forces of beads are still to be found from their geometry."""
    problems = [
        Problem(key, "its forces have not been found yet", "compute the case by `presswork run`, or presswork.run")
        for key, _ in list_geometries(case)
    ]
    if problems:
        raise CaseError(problems, case.source)
