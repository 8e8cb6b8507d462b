# SPDX-License-Identifier: Apache-2.0
"""The packaged hub on sharper corners of its foot and of the flash land: force on the way, fill, volume, energy.

Run: python -m validation.sharp_corners [FOOT,LAND[,SIZE] ...]: radii [mm], 0 for a sharp corner, and the size of cells.
Without any: all of them. A row has the forces at 80, 90, 95, 97, 98, 99, 100 %.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path

import numpy as np

from presswork import Case, build_model, run_model
from presswork.examples import copy_example
from presswork.post import measure_die_fill

PAIRS = ("3,1.5", "3,1.5,0.375", "2,1.5", "1,1.5", "1,1.5,0.375", "0,1.5", "3,0", "3,0,0.375", "1,0", "0,0")
FRACTIONS = (0.8, 0.9, 0.95, 0.97, 0.98, 0.99, 1.0)
FOOT, LAND, WALL = 2, 4, 20.4
"""Points of the die's profile, and radius up to which its wall must be filled [mm]."""
FLASH_CORNERS = (1, 2, 3)
"""Of the forging with flash: roof of the hub, its foot, roof of the flange."""


def make_hub(foot: float, land: float, size: float | None, folder: Path) -> Case:
    """Return the packaged case with other radii [mm] and size of cells [mm]."""
    case = Case.from_toml(str(copy_example("forging_hub", folder))).model_dump(exclude_unset=True)
    profile = list(case["tools"]["die"]["profile"])
    for number, radius in ((FOOT, foot), (LAND, land)):
        point = profile[number]["to"] if isinstance(profile[number], dict) else profile[number]
        profile[number] = {"to": list(point), "radius": radius} if radius else list(point)
    case["tools"]["die"]["profile"] = profile
    if size is not None:
        case["remesh"] = {"size": size}
    return Case.model_validate(case)


def make_flash(corner: float, size: float, folder: Path) -> Case:
    """Return the packaged forging with flash with other radii of its foot and roofs, and a size of cells [mm]."""
    case = Case.from_toml(str(copy_example("forging_flash", folder))).model_dump(exclude_unset=True)
    profile = list(case["tools"]["die"]["profile"])
    for number in FLASH_CORNERS:
        profile[number] = {"to": list(profile[number]["to"]), "radius": corner}
    case["tools"]["die"]["profile"] = profile
    case["remesh"] = {"size": size}
    return Case.model_validate(case)


def main() -> None:
    """Forge the hubs and print a row each."""
    for pair in sys.argv[1:] or PAIRS:
        foot, land, *size = (float(part) for part in pair.split(","))
        with tempfile.TemporaryDirectory() as name:
            case = make_hub(foot, land, size[0] if size else None, Path(name))
            outcome = run_model(build_model(case), Path(name) / "run", threads=1)
            result, log = outcome.result, (Path(name) / "run" / "run.log").read_text()
            stroke, force = result.history["die.stroke"], result.history["die.force"] / 1e3
            jumps = [float(jump) for jump in re.findall(r"changes by ([\d.]+)%", log)]
            volume, energy = result.summary["volume"], result.summary["energy"]["error_percent"]
            print(
                f"foot {foot:g} land {land:g} size {size[0] if size else 0.75:g}: {outcome.status}, filled "
                f"{measure_die_fill(result, 'die', x_range=(0.0, WALL)).filled:.3f},",
                " ".join(f"{np.interp(part * 5.6, stroke, force):.0f}" for part in FRACTIONS),
                f"kN, {len(jumps)} new meshes, largest change {max(jumps):.2f} %, volume "
                f"{volume['change_percent'] - volume['elastic_part_percent']:+.5f} %, energy {energy:+.2f} %",
                flush=True,
            )


if __name__ == "__main__":
    main()
