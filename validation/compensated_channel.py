# SPDX-License-Identifier: Apache-2.0
"""A channel of DP780, crash-formed or drawn under a holder and trimmed, whose dies are corrected for springback.

    python -m validation.compensated_channel OUT [formed | implicit | trimmed | bent]

A slice of 1 mm sheet, 16 mm deep, walls of 75 degrees, radii of 5 mm. formed: between punch and die alone; implicit: by
the implicit procedure with the sheet's mass. trimmed: drawn under a holder of 5 kN and cut off below the
shoulder, where the addendum begins; the binder stays as it is. bent: so, but the binder is bent with the rest.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from presswork.mesh.files.stl_file import pack_stl
from presswork.study import Compensation, compensate_springback
from tests.problems.compensation import channel_face, write_channel

Way = Literal["formed", "implicit", "trimmed", "bent"]
_TRIM, _SHOULDER, _FLANGE = 18.5, 19.5, 23.0
"""Where the part is cut off, where the punch ends, and where the flange begins beyond the shoulder [mm]."""


def compensate_channel(folder: Path, way: Way = "formed", *, most: int = 4, tolerance: float = 0.01) -> Compensation:
    """Correct the tools of a channel."""
    folder.mkdir(parents=True, exist_ok=True)
    fine = {"shape": "rectangle", "size": [76, 4], "thickness": 1, "element_size": [1, 4], "points": 7,
            "material": "dp780", "symmetry": ["x"]}  # fmt: skip
    stage: dict[str, Any] = {"name": "form", "velocity": "3 m/s", "tools": {"punch": {"stroke": 15.9}}}
    changes: dict[str, Any] = {"blank": fine, "stages": [stage]}
    if way == "implicit":
        changes |= {"procedure": "implicit", "implicit": {"inertia": 1}}
    is_drawn = way in {"trimmed", "bent"}
    if is_drawn:
        fine["size"] = [90, 4]
        upper = channel_face(0.5, reach=60.0)
        far = (np.abs(upper.points[upper.triangles][:, :, 0]) > _FLANGE).all(axis=1)
        (folder / "holder.stl").write_bytes(pack_stl("holder", replace(upper, triangles=upper.triangles[far])))
        stage["tools"]["holder"] = {"force": 5e3}
        kinds = ("punch", "die", "holder")
        changes["tools"] = {kind: {"kind": kind, "shape": "file", "path": f"{kind}.stl"} for kind in kinds}
        line = {"shape": "rectangle", "size": [2 * _TRIM, 20]}
        changes["trim"] = {"edge": line}
    case = write_channel(folder, **changes)
    if is_drawn:
        (folder / "die.stl").write_bytes(pack_stl("die", channel_face(-0.5, reach=60.0)))
        punch = channel_face(0.6)
        near = (np.abs(punch.points[punch.triangles][:, :, 0]) < _SHOULDER).all(axis=1)
        (folder / "punch.stl").write_bytes(pack_stl("punch", replace(punch, triangles=punch.triangles[near])))
    return compensate_springback(
        case, folder / "out", tolerance=tolerance, most=most, fix_binder=way == "trimmed", threads=1, overwrite=True
    )


if __name__ == "__main__":
    chosen = sys.argv[2] if len(sys.argv) > 2 else "formed"
    found = compensate_channel(Path(sys.argv[1]), chosen)  # type: ignore[arg-type]
    print(found.status, found.reason)
    print((found.folder / "table.csv").read_text())
