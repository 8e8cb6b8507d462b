# SPDX-License-Identifier: Apache-2.0
"""A sector of a body of cyclic symmetry, and what is checked of it."""

from __future__ import annotations

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.space.schema import SpaceCase
from presswork.mesh import MeshError
from presswork.mesh.space.cyclic import count_sectors, pair_faces

WHOLE = 1e-6
"""Relative difference of a whole turn over the sector's angle from a whole number."""


def find_cyclic(case: SpaceCase, mesh: model.Mesh) -> model.CyclicSector | None:
    """Return the sector of cyclic symmetry that a case without problems of it models; None: there is none."""
    for entry in case.boundary.values():
        if entry.cyclic is not None:
            sectors = round(count_sectors(mesh, entry.cyclic, entry.set))
            return model.CyclicSector(entry.cyclic, entry.set, sectors)
    return None


def check_cyclic(case: SpaceCase, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of a sector of cyclic symmetry."""
    ties = {name: entry for name, entry in case.boundary.items() if entry.cyclic is not None}
    problems = []
    for name, entry in ties.items():
        key, obstacles = f"boundary.{name}.cyclic", _find_obstacles(case)
        obstacles += ["two entries are cyclic"] if len(ties) > 1 else []
        problems += [Problem(key, fault, "model the whole", entry.cyclic) for fault in obstacles]
        assert entry.cyclic is not None
        if entry.cyclic not in mesh.node_sets:
            problems.append(
                Problem(key, "no such node set", suggest(entry.cyclic, mesh.node_sets, "sets"), entry.cyclic)
            )
            continue
        found = count_sectors(mesh, entry.cyclic, entry.set)
        if abs(found - round(found)) > WHOLE * found or found < 1.5:
            fault = f"the sector spans {360.0 / found:.6g} degrees, no n-th part of a whole turn"
            problems.append(Problem(key, fault, "give a sector of 180, 120, 90, 72, 60 ... degrees", entry.cyclic))
            continue
        try:
            pair_faces(model.CyclicSector(entry.cyclic, entry.set, round(found)), mesh)
        except MeshError as error:
            problems.append(Problem(key, error.fault, error.remedy, entry.cyclic))
    return problems


def _find_obstacles(case: SpaceCase) -> list[str]:
    """Return why a case cannot be computed as a sector of cyclic symmetry."""
    mirrors = ({"x"}, {"y"}, {"normal"})
    obstacles = {
        "contact across the two faces is not computed": bool(case.bodies),
        "heat does not pass through the two faces": case.heat is not None,
        "there are planes of symmetry along z too": any(
            other.symmetry is not False and set(other.fix) in mirrors for other in case.boundary.values()
        ),
    }
    return [fault for fault, is_so in obstacles.items() if is_so]
