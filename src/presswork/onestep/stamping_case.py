# SPDX-License-Identifier: Apache-2.0
"""The blank that one step has found as the start of an incremental case: a stamping that waits for its tools."""

from __future__ import annotations

import json
import os
import tomllib
from pathlib import Path

import numpy as np
import tomli_w

from presswork.model_onestep import OneStepModel
from presswork.onestep.outline import BlankOutline
from presswork.results import OutputError
from presswork.results.whole_file import replace_whole

_CELLS_ACROSS = 50
"""Of the blank; whoever knows the tools' radii takes more or fewer."""
_TOOLS = """
# Name the tools: take the # away and set what is theirs (the guide has all shapes). The part is {depth:.4g} mm deep.
# [tools.punch]
# kind = "punch"
# shape = "rectangular"
# size = [51, 51]
# corner_radius = 10
# edge_radius = 4
# mu = {mu:g}
#
# [tools.die]
# kind = "die"
# shape = "rectangular"
# size = [54, 54]
# corner_radius = 11.5
# edge_radius = 4
# mu = {mu:g}
#
# [tools.holder]
# kind = "holder"
# shape = "rectangular"
# size = [54, 54]
# corner_radius = 11.5
# edge_radius = 1
# mu = {mu:g}

[[stages]]
name = "draw"
tools.punch = {{stroke = {depth:.4g}}}
"""


def check_case_path(path: Path, *, overwrite: bool = False) -> None:
    """Raise OutputError if no case can be written there, before anything is computed."""
    if path.suffix.lower() != ".toml":
        raise OutputError(f"{path}: a case is written as .toml")
    if not path.absolute().parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.absolute().parent}")
    if path.exists() and not overwrite:
        raise OutputError(f"{path} is there already; choose another name, or use --overwrite")


def write_stamping_case(path: Path, model: OneStepModel, outline: BlankOutline, points: Path) -> None:
    """Write a case of a stamping that starts from a blank: outline, thickness, material, friction, depth, holder force.

    outline: of the whole blank; points: its CSV file, which the case names. `presswork check` asks for the tools, which
    stand in the file as comments. Raises OutputError.
    """
    data = tomllib.loads(model.case_text)
    width = max(outline.extent)
    blank = {
        "shape": "outline",
        "path": os.path.relpath(points.resolve(), path.resolve().parent),
        "thickness": model.thickness,
        "element_size": float(f"{width / _CELLS_ACROSS:.2g}"),
        "material": data["blank"]["material"],
        "rolling_direction": float(f"{np.degrees(model.rolling_direction):.6g}"),
        "symmetry": [axis for axis, is_cut in zip("xy", model.symmetry, strict=True) if is_cut],
    }
    head = {"title": f"{model.title}: the blank that one step has found", "analysis": "stamping", "blank": blank}
    if data.get("materials"):
        head["materials"] = data["materials"]
    depth = float(np.ptp(model.points[:, 2]))
    text = tomli_w.dumps(head) + _TOOLS.format(depth=depth, mu=model.mu)
    if model.holder_force > 0.0:
        text += f"tools.holder = {{force = {json.dumps(model.holder_force)}}}\n"
    for bead in model.beads:
        corners = ", ".join(f"({x:g}, {y:g})" for x, y in bead.points)
        text += f"# a drawbead was there: {bead.force:g} N/mm along {corners}\n"
    if len(outline.loops) > 1:
        text += f"# {len(outline.loops) - 1} holes of the blank are left out: they are cut after drawing\n"
    content = text.encode()
    with replace_whole(path, needed_bytes=len(content)) as temporary:
        temporary.write_bytes(content)
