# SPDX-License-Identifier: Apache-2.0
"""IGES files of a few surfaces: records of 80 columns, with lines (110) and surfaces of revolution (120)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

UNITS = {"mm": (2, "MM"), "inch": (1, "IN"), "m": (6, "M")}


def write_iges(profile: Sequence[tuple[float, float]], angle: float, unit: str = "mm") -> str:
    """Return the file of a profile (r, z) of straight lines in the plane y = 0, turned about z by an angle [rad]."""
    flag, name = UNITS[unit]
    start = "a surface of revolution".ljust(72) + "S" + f"{1:7d}"
    text = f"1H,,1H;,4Hpart,8Hpart.igs,8Hpressork,3H1.0,32,38,6,308,15,4Hpart,1.0,{flag},{len(name)}H{name},1,0.1,"
    text += "15H20260101.000000,1.0E-7,1000.0,2Hme,2Hme,11,0,15H20260101.000000;"
    heads = [text[i : i + 72].ljust(72) + "G" + f"{i // 72 + 1:7d}" for i in range(0, len(text), 72)]
    entities: list[tuple[int, str]] = [(110, "110,0.0,0.0,0.0,0.0,0.0,1.0;")]
    for (r, z), (r1, z1) in itertools.pairwise(profile):
        entities.append((110, f"110,{r!r},0.0,{z!r},{r1!r},0.0,{z1!r};"))
        entities.append((120, f"120,1,{2 * len(entities) - 1},0.0,{angle!r};"))
    directory, parameters = [], []
    for number, (kind, data) in enumerate(entities):
        entry = 2 * number + 1
        rows = [data[i : i + 64] for i in range(0, len(data), 64)]
        status = "00010000" if kind == 110 else "00000000"
        directory.append(f"{kind:8d}{len(parameters) + 1:8d}" + 4 * f"{0:8d}" + 2 * f"{0:8d}" + status + f"D{entry:7d}")
        directory.append(f"{kind:8d}{0:8d}{0:8d}{len(rows):8d}{0:8d}{'':24}{0:8d}D{entry + 1:7d}")
        parameters += [f"{row:64}{entry:8d}P{len(parameters) + i + 1:7d}" for i, row in enumerate(rows)]
    end = f"S{1:7d}G{len(heads):7d}D{len(directory):7d}P{len(parameters):7d}".ljust(72) + f"T{1:7d}"
    return "\n".join([start, *heads, *directory, *parameters, end]) + "\n"
