# SPDX-License-Identifier: Apache-2.0
"""B-spline faces as a STEP file (ISO 10303-21, AP214): an open shell for each face."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.geometry.spline_face import DEGREE, SplineFace
from presswork.model import FloatArray

_HEAD = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('{title}'),'2;1');
FILE_NAME('{title}','',(''),(''),'presswork','presswork','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('{title}','{title}','',(#3));
#5=PRODUCT_DEFINITION_FORMATION('','',#4);
#6=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#7=PRODUCT_DEFINITION('design','',#5,#6);
#8=PRODUCT_DEFINITION_SHAPE('','',#7);
#9=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#10=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#11=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#12=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-4),#9,'distance_accuracy_value','');
#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#12))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#9,#10,#11))REPRESENTATION_CONTEXT('',''));
"""
_MULTIPLICITY = DEGREE + 1


def pack_faces(title: str, faces: Sequence[SplineFace]) -> bytes:
    """Return the text of a STEP file of faces [mm]."""
    plain = "".join(c if c.isascii() and c.isalnum() else " " for c in title)
    writer = _Writer(14)
    shells = [writer.add(f"OPEN_SHELL('',({_add_face(writer, face)}))") for face in faces]
    model = writer.add(f"SHELL_BASED_SURFACE_MODEL('',({','.join(shells)}))")
    shape = writer.add(f"MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',({model}),#13)")
    writer.add(f"SHAPE_DEFINITION_REPRESENTATION(#8,{shape})")
    text = _HEAD.format(title=plain) + "\n".join(writer.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"
    return text.encode("ascii")


class _Writer:
    """Entities in the order of their numbers."""

    def __init__(self, first: int) -> None:
        self.lines: list[str] = []
        self._next = first

    def add(self, entity: str) -> str:
        """Add an entity and return its reference."""
        name = f"#{self._next}"
        self.lines.append(f"{name}={entity};")
        self._next += 1
        return name

    def add_points(self, points: FloatArray) -> list[str]:
        """Add points (n, 3) and return their references."""
        return [self.add(f"CARTESIAN_POINT('',({','.join(_real(x) for x in p)}))") for p in points]


def _add_face(writer: _Writer, face: SplineFace) -> str:
    """Add a face bounded by its four edges; return its reference."""
    n_u, n_v = face.controls.shape[:2]
    names = np.array(writer.add_points(face.controls.reshape(-1, 3))).reshape(n_u, n_v)
    u, v = (_list_knots(knots) for knots in face.knots)
    rows = ",".join(f"({','.join(row)})" for row in names)
    surface = writer.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',{DEGREE},{DEGREE},({rows}),.UNSPECIFIED.,.F.,.F.,.F.,"
        f"{u[0]},{v[0]},{u[1]},{v[1]},.UNSPECIFIED.)"
    )
    corners = {(i, j): writer.add(f"VERTEX_POINT('',{names[i, j]})") for i in (0, -1) for j in (0, -1)}
    sides = [  # counter-clockwise in u and v: its controls, knots, first and last corner, along them
        (names[:, 0], u, (0, 0), (-1, 0), True),
        (names[-1], v, (-1, 0), (-1, -1), True),
        (names[:, -1], u, (0, -1), (-1, -1), False),
        (names[0], v, (0, 0), (0, -1), False),
    ]
    edges = []
    for controls, knots, first, last, is_along in sides:
        curve = writer.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{DEGREE},({','.join(controls)}),.UNSPECIFIED.,.F.,.F.,"
            f"{knots[0]},{knots[1]},.UNSPECIFIED.)"
        )
        edge = writer.add(f"EDGE_CURVE('',{corners[first]},{corners[last]},{curve},.T.)")
        edges.append(writer.add(f"ORIENTED_EDGE('',*,*,{edge},{'.T.' if is_along else '.F.'})"))
    loop = writer.add(f"EDGE_LOOP('',({','.join(edges)}))")
    bound = writer.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
    return writer.add(f"ADVANCED_FACE('',({bound}),{surface},.T.)")


def _list_knots(knots: FloatArray) -> tuple[str, str]:
    """Return multiplicities and values of clamped knots whose inner ones are single."""
    values = knots[DEGREE:-DEGREE]
    counts = [_MULTIPLICITY, *[1] * (len(values) - 2), _MULTIPLICITY]
    return f"({','.join(map(str, counts))})", f"({','.join(_real(x) for x in values)})"


def _real(value: float) -> str:
    """Return a real number as STEP has it, with a point."""
    text = f"{value:.9g}"
    mantissa, mark, power = text.partition("e")
    return (mantissa if "." in mantissa else mantissa + ".") + (f"E{power}" if mark else "")
