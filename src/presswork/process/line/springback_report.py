# SPDX-License-Identifier: Apache-2.0
"""The summary of a released part's shape: twist, sections, points of its gauge, share within tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.geometry.best_fit import fit_rigidly, nodal_areas
from presswork.geometry.sprung.bend_angle import measure_bends
from presswork.geometry.sprung.part_section import Places, cut_part, find_below
from presswork.geometry.sprung.sprung_shape import measure_turn, measure_twist, normals_at, place_in_gauge
from presswork.geometry.sprung.wall_shape import measure_walls
from presswork.mesh.topology import with_four_nodes
from presswork.mesh.triangles import split_quads
from presswork.model import FloatArray, Gauge, IntArray, PartSection, Springback


@dataclass(frozen=True)
class ReleasedShape:
    """A part in its tools and released."""

    formed: FloatArray
    """(n_points, 3) [mm]."""
    free: FloatArray
    """(n_points, 3) [mm]."""
    cells: Sequence[IntArray]
    """Connectivities (n, 3) and (n, 4)."""
    symmetry: tuple[bool, bool]
    """Planes x = 0 and y = 0."""


def report_shape(part: ReleasedShape, asked: Springback) -> tuple[dict[str, Any], list[str]]:
    """Return the summary of a part's shape, and warnings of places that lie off it."""
    areas = nodal_areas(part.formed, part.cells)
    weight = np.linalg.norm(areas, axis=1)
    normals = areas / np.maximum(weight, 1e-300)[:, None]
    report: dict[str, Any] = {}
    warnings: list[str] = []
    if (twist := measure_twist(part.formed, part.free, weight)) is not None:
        axis = [float(v) for v in twist.axis]
        report["twist"] = {"degrees": float(np.degrees(twist.angle)), "length_mm": twist.length, "axis": axis}
    placed = fit_rigidly(part.free, part.formed, weight, part.symmetry)
    if asked.gauge is not None:
        gauge, placed, warnings = _measure_in_gauge(part, asked.gauge, weight, placed, asked.tolerance)
        report |= {"gauge": gauge} if gauge else {}
    report["sections"] = {}
    for section in asked.sections or _middle_sections(part.formed):
        found = _measure_section(part, placed, section)
        if found is not None:
            report["sections"][section.name] = found
        elif asked.sections:
            warnings.append(f"springback.sections.{section.name} misses the part: move it over the part in its tools")
    if asked.tolerance is not None:
        report["tolerance"] = _judge(((placed - part.formed) * normals).sum(axis=1), weight, placed, asked.tolerance)
    return report, warnings


def _middle_sections(formed: FloatArray) -> tuple[PartSection, ...]:
    """Return sections along x and y through the middle of a part."""
    x, y = (0.5 * (formed[:, :2].min(axis=0) + formed[:, :2].max(axis=0))).tolist()
    return PartSection("x", (x, y), 0.0), PartSection("y", (x, y), 0.5 * np.pi)


def _measure_section(part: ReleasedShape, placed: FloatArray, section: PartSection) -> dict[str, Any] | None:
    """Return turn, walls and bends of a section; None where it misses the part."""
    cells = np.concatenate([with_four_nodes(each) for each in part.cells])
    lines = cut_part(part.formed, cells, section.start, section.angle, section.length)
    if not lines:
        return None
    frame = np.array([[np.cos(section.angle), np.sin(section.angle), 0.0], [0.0, 0.0, 1.0]])
    flat = [[(line.take(x) - (*section.start, 0.0)) @ frame.T for line in lines] for x in (part.formed, placed)]
    turn = measure_turn(np.concatenate(flat[0]), np.concatenate(flat[1]))
    walls = []
    for formed, free in zip(*flat, strict=True):
        pieces = [np.stack([line[:-1], line[1:]], axis=1) for line in (formed, free)]
        for before, after in measure_walls(pieces[0], pieces[1]):
            straight = np.isinf(after.curl_radius)
            walls.append(
                {
                    "before_degrees": [before.bottom_angle, after.bottom_angle],
                    "after_degrees": [before.flange_angle, after.flange_angle],
                    "curl_radius_mm": None if straight else after.curl_radius,
                }
            )
    bends = [each for line in lines for each in _measure_bends(part, line, placed, section)]
    return {"turn_degrees": float(np.degrees(turn)), "walls": walls, "bends": bends}


def _measure_bends(
    part: ReleasedShape, line: Places, placed: FloatArray, section: PartSection
) -> list[dict[str, list[float]]]:
    """Return the bends of a line of a section, in its order; a bend on a symmetry plane is whole."""
    places = line.take(part.formed)
    out = np.array([np.cos(section.angle), np.sin(section.angle)])
    flat = [np.stack([x[:, :2] @ out, x[:, 2]], axis=1) for x in (places, line.take(placed))]
    first, mirrored = 0, np.flatnonzero(part.symmetry & (np.abs(out) > 1.0 - 1e-9))
    for axis in mirrored:
        at, scale = places[:, axis], float(np.ptp(places, axis=0).max())
        if min(abs(at[0]), abs(at[-1])) > 1e-6 * scale:
            continue
        if abs(at[-1]) < abs(at[0]):
            flat, places = [x[::-1] for x in flat], places[::-1]
        first = len(places) - 1
        flat = [np.concatenate([(x * (-1.0, 1.0))[:0:-1], x]) for x in flat]
    found = [bend for bend in measure_bends(*flat) if bend.middle >= first]
    return [
        {"at_mm": [float(x) for x in places[bend.middle - first]], "included_degrees": [bend.formed, bend.free]}
        for bend in found
    ]


def _measure_in_gauge(
    part: ReleasedShape,
    gauge: Gauge,
    weight: FloatArray,
    fitted: FloatArray,
    tolerance: tuple[float, float] | None,
) -> tuple[dict[str, Any], FloatArray, list[str]]:
    """Return the summary of the gauge, the place of the part in it, and warnings; fitted: by best fit."""
    triangles = np.concatenate([split_quads(part.formed, np.asarray(c, dtype=np.int32)) for c in part.cells])
    clamps = {f"clamp {i + 1}": find_below(part.formed, triangles, x, y) for i, (x, y) in enumerate(gauge.clamps)}
    points = {name: find_below(part.formed, triangles, x, y) for name, (x, y) in gauge.points}
    lost = [
        f"springback.gauge: {name} lies off the part: move it" for name, at in {**clamps, **points}.items() if not at
    ]
    held = [at for at in clamps.values() if at is not None]
    if len(held) < len(clamps):
        return {}, fitted, [*lost, "springback.gauge: the part is measured after the best fit, for want of clamps"]

    def join(places: Sequence[Places]) -> Places:
        return Places(np.concatenate([p.nodes for p in places]), np.concatenate([p.weight for p in places]))

    def off(places: Places) -> FloatArray:
        normal = normals_at(part.formed, places.nodes)
        return np.asarray(((places.take(placed) - places.take(part.formed)) * normal).sum(axis=1))

    clamped = join(held)
    placed = place_in_gauge(
        part.formed, part.free, weight, clamped, normals_at(part.formed, clamped.nodes), part.symmetry
    )
    report: dict[str, Any] = {"clamps_mm": [float(v) for v in off(clamped)], "points": {}}
    for name, at in points.items():
        if at is not None:
            value = float(off(at)[0])
            within = {} if tolerance is None else {"within": bool(tolerance[0] <= value <= tolerance[1])}
            report["points"][name] = {"deviation_mm": value, **within}
    return report, placed, lost


def _judge(
    deviation: FloatArray, weight: FloatArray, placed: FloatArray, tolerance: tuple[float, float]
) -> dict[str, Any]:
    """Return the share of a part's area within a band, and the worst place."""
    low, high = tolerance
    inside = (deviation >= low) & (deviation <= high)
    worst = int(np.argmax(np.maximum(low - deviation, deviation - high)))
    return {
        "band_mm": [low, high],
        "share_within": float(weight[inside].sum() / weight.sum()),
        "worst_mm": float(deviation[worst]),
        "at_mm": [float(x) for x in placed[worst]],
    }
