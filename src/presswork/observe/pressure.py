# SPDX-License-Identifier: Apache-2.0
"""How hard the metal of solids is pressed, over its flow stress."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray
from presswork.observe.contract import Measure, Metal, Observed, Observer


class Pressure(Observer):
    """Hydrostatic stress at points, and mean pressure in bodies that tools press."""

    def measures(self, run: Observed) -> list[Measure]:
        """Return the largest hydrostatic stress of each part of the metal, and the mean pressure in each body."""
        metal = run.metal()
        found = [measure_hydrostatic_stress(each.stress, each.flow_stress, each.centres) for each in metal]
        bodies: dict[str, list[Metal]] = {}
        for each in metal:
            if each.volume is not None:
                bodies.setdefault(each.body, []).append(each)
        if not bodies or not run.model.tools:
            return found
        held = run.held_part()
        for body, parts in bodies.items():
            stress, flow = (np.concatenate([getattr(p, name) for p in parts]) for name in ("stress", "flow_stress"))
            volume = np.concatenate([part.volume for part in parts if part.volume is not None])
            found.append(measure_mean_pressure(body, stress, flow, volume, held))
        return found


def measure_hydrostatic_stress(stress: FloatArray, flow_stress: FloatArray, centres: FloatArray) -> Measure:
    """Return the largest hydrostatic stress over the flow stress.

    stress, flow_stress: of points (n,) [MPa]; centres: of their cells (n, 2), in space (n, 3) [mm].
    """
    share = np.abs(stress) / np.maximum(flow_stress, 1e-300)
    worst = int(np.argmax(share))
    where = ", ".join(f"{c:.4g}" for c in centres[worst])
    fact = (
        f"the hydrostatic stress is {stress[worst]:.4g} MPa at ({where}) mm, {share[worst]:.3g} times the "
        f"flow stress of {flow_stress[worst]:.4g} MPa"
    )
    return Measure("hydrostatic_stress", float(share[worst]), fact)


def measure_mean_pressure(
    body: str, stress: FloatArray, flow_stress: FloatArray, volume: FloatArray, touched: float | None = None
) -> Measure:
    """Return the mean pressure in a body over its mean flow stress; 0 in tension.

    Where metal can yield its mean pressure is a few times its flow stress: friction hill, flash and extrusion by nine
    tenths stay below ten. Metal that cannot get out answers by its bulk modulus, 3 times its flow stress for every
    per cent of volume in cold steel. stress: mean of the three (n,) [MPa], flow_stress (n,) [MPa], volume (n,) [mm3] of
    points; touched: part of the surface that tools or supports hold, None: unknown.
    """
    pressure, flow = (float((of * volume).sum() / volume.sum()) for of in (-stress, flow_stress))
    share = max(pressure, 0.0) / max(flow, 1e-300)
    held = "" if touched is None else f"; tools and supports hold {100.0 * touched:.3g} % of the surface"
    fact = (
        f"the mean pressure in the {body} is {pressure:.4g} MPa, {share:.3g} times its mean flow stress of "
        f"{flow:.4g} MPa{held}"
    )
    return Measure("mean_pressure", share, fact)
