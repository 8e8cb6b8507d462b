# SPDX-License-Identifier: Apache-2.0
"""Whether holders have done what they are there for: keep the flange flat, and let it flow.

A pushed holder is lifted by a sheet that thickens, and by one that wrinkles or curls; what the thickest element does
not explain is the height of the wrinkles. A holder that stands at a distance from the die does not move back: a sheet
that thickens to more than the distance is squeezed, and friction keeps it from being drawn in.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.law.elastic_plastic import first_flow_stress
from presswork.mesh.make.flange import find_held_area
from presswork.model import FloatArray, Model, Tool
from presswork.process.stamping_tools import is_pushed_in

WRINKLED = 0.1
"""Part of the sheet's thickness that wrinkles must have to be worth a warning."""
SQUEEZED = 0.05
"""Part of the sheet's yield stress as a holder's mean pressure: several times the usual 1 to 3 MPa on mild steel."""


def warn_of_holders(model: Model, history: Mapping[str, NDArray[Any]], thickest: float) -> list[str]:
    """Return what a user should know of holders; thickest: largest thickness of the sheet at the end [mm]."""
    warnings: list[str] = []
    for holder in (t for t in model.tools if t.kind == "holder"):
        dies = [t for t in model.tools if t.kind == "die"]
        pushed = _rows_pushed(model, history, [holder, *dies])
        warnings += _warn_of_wrinkles(model, history, pushed, holder, dies, thickest)
        warnings += _warn_of_squeezing(model, history, ~pushed, holder)
    return warnings


def _rows_pushed(model: Model, history: Mapping[str, NDArray[Any]], tools: list[Tool]) -> NDArray[np.bool_]:
    """Mark the rows of stages in which one of the tools is pushed."""
    names = [
        stage.name
        for number, stage in enumerate(model.stages)
        if any(is_pushed_in(model, tool, number) for tool in tools)
    ]
    return np.isin(history["stage"], names)


def _warn_of_wrinkles(
    model: Model,
    history: Mapping[str, NDArray[Any]],
    pushed: NDArray[np.bool_],
    holder: Tool,
    dies: list[Tool],
    thickest: float,
) -> Iterator[str]:
    """Compare how far a pushed holder has been lifted with what the sheet has thickened."""
    thickness = model.thickest
    lift = _find_lift(history, pushed, [holder, *dies])
    if not len(lift):
        return
    row = int(np.argmax(lift))
    height = float(lift[row]) - max(thickest - thickness, 0.0)
    if height > WRINKLED * thickness:
        yield (
            f"the flange has not stayed flat: it lifted {holder.name} by {lift[row]:.3g} mm (t = "
            f"{history['time'][pushed][row]:.4g} s), {height:.3g} mm more than the sheet thickened, and so high are "
            f"its wrinkles, or its curl; push {holder.name} harder"
        )


def _find_lift(history: Mapping[str, NDArray[Any]], pushed: NDArray[np.bool_], tools: Sequence[Tool]) -> FloatArray:
    """Return how far a holder has been lifted off its dies in the rows in which it is pushed (n,) [mm]."""
    closed: FloatArray = np.sum([history[f"{tool.name}.stroke"] for tool in tools], axis=0)[pushed]
    return np.asarray(np.maximum.accumulate(closed) - closed)


def summarise_holders(
    model: Model, history: Mapping[str, NDArray[Any]], thickest: float
) -> dict[str, dict[str, float]]:
    """Return the height of wrinkles [mm] under pushed holders: their lift, less what the sheet has thickened."""
    dies = [tool for tool in model.tools if tool.kind == "die"]
    heights = []
    for holder in (tool for tool in model.tools if tool.kind == "holder"):
        pushed = _rows_pushed(model, history, [holder, *dies])
        lift = _find_lift(history, pushed, [holder, *dies])
        heights += [float(lift.max()) - max(thickest - model.thickest, 0.0)] if len(lift) else []
    return {"wrinkles": {"height_mm": max(0.0, *heights)}} if heights else {}


def _warn_of_squeezing(
    model: Model, history: Mapping[str, NDArray[Any]], fixed: NDArray[np.bool_], holder: Tool
) -> Iterator[str]:
    """Compare the pressure below a holder that nothing pushes with the sheet's yield stress."""
    section, material = model.sheet
    area = find_held_area(model.mesh, holder) * model.whole
    force = float(np.max(history[f"{holder.name}.force"][fixed], initial=0.0))
    yield_stress = first_flow_stress(material)
    if area > 0 and force / area > SQUEEZED * yield_stress:
        t = section.thickness
        yield (
            f"the sheet is squeezed below {holder.name}, which stands at a distance from the die: with up to "
            f"{force / 1e3:.3g} kN, {force / area:.3g} MPa over the flange; it thickens as it is drawn in, so leave it "
            f"{1.1 * t:.3g} to {1.2 * t:.3g} mm, or push {holder.name} by a force"
        )
