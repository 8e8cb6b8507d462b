# SPDX-License-Identifier: Apache-2.0
"""Lines, arcs and curves of a DXF drawing, read with ezdxf."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case.errors import suggest
from presswork.case.tools.profile import RELATIVE_TOLERANCE
from presswork.case.units import LENGTH
from presswork.geometry.biarc import Curve, CurveError, fit_biarcs
from presswork.geometry.chain import Piece, ProfileFileError
from presswork.model import FloatArray

_UNIT = "$INSUNITS"
# its codes: inch, foot, mm, cm, m, thousandth of an inch, micrometre, decimetre; a drawing without a unit is in mm
_MILLIMETRES = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 9: 0.0254, 13: 0.001, 14: 100.0}

_Spans = tuple[Curve, FloatArray]


def read_drawing(
    path: Path, layer: str | None, factor: float | None, tolerance: float | None
) -> tuple[list[Piece], float]:
    """Return the pieces in the model space of a drawing, in mm, and the tolerance [mm].

    layer: read this one only. factor: mm in a unit of the drawing; without it that of its header. tolerance: of arcs
    from splines and ellipses [mm]; without it RELATIVE_TOLERANCE of the drawing's extent. Raises ProfileFileError.
    """
    drawing = _open(path)
    if factor is None and _UNIT.encode() not in path.read_bytes():  # ezdxf takes metres where there is no header
        factor = 1.0
    try:
        with np.errstate(all="ignore"):
            pieces, tolerance = _read(drawing, layer, factor, tolerance)
    except ProfileFileError:
        raise
    except Exception as error:  # entities without their parts, which the library asks for as they are used
        reason = " ".join(str(error).split())[:100]
        fault = f"the drawing is damaged ({type(error).__name__}: {reason})"
        raise ProfileFileError(fault, "export it again as DXF R2000 or later") from error
    largest = max(float(np.abs(np.array(piece.segments)[:, 0:4]).max()) for piece in pieces)
    if not largest <= LENGTH.largest:  # nan, too
        fault = f"coordinates up to {largest:.4g} mm, beyond {LENGTH.largest:g} mm"
        raise ProfileFileError(fault, "check the drawing and its unit")
    return pieces, tolerance


def _read(drawing: Any, layer: str | None, factor: float | None, tolerance: float | None) -> tuple[list[Piece], float]:
    """Return the pieces of a drawing that has been opened, as read_drawing does."""
    found = list(_explode(drawing.modelspace(), None))
    layers = Counter(name for name, _ in found)
    if layer is not None:
        known = {name.casefold() for name in layers}
        if layer.casefold() not in known:
            remedy = suggest(layer, layers, "layers drawn on")
            raise ProfileFileError(f"nothing is drawn on the layer `{layer}`", remedy)
        found = [(name, entity) for name, entity in found if name.casefold() == layer.casefold()]
    shapes = [(entity.dxftype(), _convert(entity)) for _, entity in found if entity.dxftype() in _CONVERTERS]
    if not shapes:
        kinds = ", ".join(sorted({entity.dxftype() for _, entity in found})) or "nothing"
        raise ProfileFileError(
            f"no {', '.join(_CONVERTERS)}, LWPOLYLINE or POLYLINE in the model space, but {kinds}",
            f"draw the profile with these, or name another layer (drawn on: {', '.join(sorted(layers)) or 'none'})",
        )
    if factor is None:
        factor = _MILLIMETRES.get(int(drawing.header.get(_UNIT, 0)), 1.0)
    if tolerance is None:
        tolerance = RELATIVE_TOLERANCE * factor * _extent(shape for _, shape in shapes)
    return [_make_piece(kind, shape, factor, tolerance) for kind, shape in shapes], tolerance


def _open(path: Path) -> Any:
    from ezdxf import filemanagement, recover

    try:
        return filemanagement.readfile(path)
    except Exception:  # nearly anything on a bad file
        pass
    try:
        return recover.readfile(path)[0]
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        remedy = "export it again as DXF R2000 or later"
        raise ProfileFileError(f"no DXF drawing that can be read ({reason})", remedy) from None


def _explode(entities: Iterable[Any], parent: str | None) -> Iterator[tuple[str, Any]]:
    """Yield the entities with their layers, blocks and polylines taken apart."""
    for entity in entities:
        layer = str(entity.dxf.get("layer", "0"))
        if parent is not None and layer == "0":
            layer = parent
        if entity.dxftype() in ("INSERT", "LWPOLYLINE", "POLYLINE"):
            yield from _explode(entity.virtual_entities(), layer)
        else:
            yield layer, entity


def _convert(entity: Any) -> FloatArray | _Spans:
    """Return an entity as segments (n, 7), or as a curve with the ends of its spans, in the drawing's unit."""
    up = entity.dxf.get("extrusion", None)
    if up is not None and abs(up.z) < 1.0 - 1e-6 and entity.dxftype() not in ("LINE", "SPLINE"):
        where = f"the {entity.dxftype()} on the layer {entity.dxf.layer}"
        raise ProfileFileError(f"{where} is not drawn in the plane z = 0", "draw the profile in the xy plane")
    return _CONVERTERS[entity.dxftype()](entity)


def _convert_line(line: Any) -> FloatArray:
    start, end = line.dxf.start, line.dxf.end
    return np.array([[start.x, start.y, end.x, end.y, 0.0, 0.0, 0.0]])


def _convert_arc(arc: Any) -> FloatArray:
    centre = arc.ocs().to_wcs(arc.dxf.center)
    start, end = arc.start_point, arc.end_point
    turn = 1.0 if arc.dxf.extrusion.z > 0.0 else -1.0
    if (arc.dxf.end_angle - arc.dxf.start_angle) % 360.0 == 0.0:
        return _convert_circle(arc)
    return np.array([[start.x, start.y, end.x, end.y, centre.x, centre.y, turn]])


def _convert_circle(circle: Any) -> FloatArray:
    centre, radius = circle.ocs().to_wcs(circle.dxf.center), circle.dxf.radius
    right, left = [centre.x + radius, centre.y], [centre.x - radius, centre.y]
    return np.array([[*right, *left, centre.x, centre.y, 1.0], [*left, *right, centre.x, centre.y, 1.0]])


def _convert_ellipse(ellipse: Any) -> _Spans:
    centre, major, minor = (
        np.array([vector.x, vector.y]) for vector in (ellipse.dxf.center, ellipse.dxf.major_axis, ellipse.minor_axis)
    )
    start, end = float(ellipse.dxf.start_param), float(ellipse.dxf.end_param)
    sweep = (end - start) % (2.0 * np.pi)
    sweep = sweep if sweep > 1e-9 else 2.0 * np.pi
    spans = np.linspace(start, start + sweep, int(np.ceil(sweep / (0.5 * np.pi) - 1e-9)) + 1)

    def point(at: FloatArray) -> FloatArray:
        return np.asarray(centre + np.outer(np.cos(at), major) + np.outer(np.sin(at), minor))

    def tangent(at: float, _: float) -> FloatArray:
        slope = -np.sin(at) * major + np.cos(at) * minor
        return np.asarray(slope / np.linalg.norm(slope))

    return Curve(point, tangent), spans


def _convert_spline(spline: Any) -> _Spans:
    curve = spline.construction_tool()
    knots = np.unique(np.array(curve.knots(), dtype=np.float64))
    first, last = curve.knots()[curve.order - 1], curve.knots()[-curve.order]
    spans = knots[(knots >= first) & (knots <= last)]

    def point(at: FloatArray) -> FloatArray:
        return np.array([[p.x, p.y] for p in curve.points(at)])

    def tangent(at: float, towards: float) -> FloatArray:
        inside = at + 1e-9 * (towards - at)  # of the side asked for, where the spline has a corner
        slope = curve.derivative(inside, 1)[1]
        direction = np.array([slope.x, slope.y])
        if np.linalg.norm(direction) <= 1e-6 * np.linalg.norm(np.ptp(point(spans), axis=0)) / (last - first):
            ends = point(np.array([at, at + 1e-4 * (towards - at)]))  # control points that coincide: the speed is zero
            direction = (ends[1] - ends[0]) * np.sign(towards - at)
        return np.asarray(direction / np.linalg.norm(direction))

    return Curve(point, tangent), spans


_CONVERTERS: dict[str, Callable[[Any], FloatArray | _Spans]] = {
    "LINE": _convert_line,
    "ARC": _convert_arc,
    "CIRCLE": _convert_circle,
    "ELLIPSE": _convert_ellipse,
    "SPLINE": _convert_spline,
}


def _extent(shapes: Iterable[FloatArray | _Spans]) -> float:
    """Return the diagonal of the box round the ends of all shapes and spans."""
    points = []
    for shape in shapes:
        if isinstance(shape, tuple):
            points.append(shape[0].point(shape[1]))
        else:
            points += [shape[:, 0:2], shape[:, 2:4]]
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0)))


def _make_piece(kind: str, shape: FloatArray | _Spans, factor: float, tolerance: float) -> Piece:
    """Scale a shape to mm, and turn a curve into arcs."""
    if isinstance(shape, tuple):
        curve, spans = shape
        rows: list[FloatArray] = []
        try:
            for start, end in pairwise(spans.tolist()):
                rows += fit_biarcs(curve, start, end, tolerance / factor)
        except CurveError as error:
            raise ProfileFileError(f"the {kind}: {error}", "mend the drawing, or set a larger tolerance") from error
        segments = np.array(rows)
    else:
        segments = shape.copy()
    segments[:, 0:6] *= factor
    return Piece(kind, tuple(segments))
