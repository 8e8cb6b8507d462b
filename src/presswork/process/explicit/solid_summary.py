# SPDX-License-Identifier: Apache-2.0
"""What the summary reports about an explicit run of solids."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from presswork.explicit.energy import warn_of_energies
from presswork.fields.table import compute_fields
from presswork.process.explicit.intervals import last_energies

if TYPE_CHECKING:
    from presswork.process.explicit.forming import ExplicitForming

ADVICE = {
    "kinetic": "inertia counts: make the tools slower, or add less mass",
    "hourglass": "refine the mesh, or set explicit.hourglass_stiffness higher",
    "error": "steps are too long for cells so crushed or so fast: set explicit.safety lower",
}


def summarise_solids(run: ExplicitForming, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return counts, extremes and energies of a run, with warnings where they are beyond their limits."""
    fields = {name: values for name, values in compute_fields(run.show())[1].items() if values.ndim == 1}
    mass = run.solids.added_mass()
    speed = run.solids.mass @ run.solids.velocity / run.solids.mass.sum()
    if run.model.analysis == "axisymmetric":
        speed[0] = 0.0  # of the whole ring
    flies = any(run.settings.velocity)
    advice = {name: text for name, text in ADVICE.items() if not (flies and name == "kinetic")}
    n_cells = len(fields["effective_stress"])
    return {
        "increments": run.number,
        "cycles": run.solids.cycle,
        "work": f"{run.solids.cycle} cycles of {n_cells} cells",
        "freedoms": run.model.mesh.points.size,
        "extremes": {name: [float(v.min()), float(v.max())] for name, v in fields.items()},
        "extent_mm": {name: float(history[name][-1]) for name in run.extents} if len(history["time"]) else {},
        "centre_velocity_mm_s": [float(v) for v in speed],
        "mass": {"workpiece_t": mass.mass, "added_percent": mass.percent},
        "energy": last_energies(history),
        "time_simulated": run.solids.time,
        **run.observers.summary(run, history),
        "warnings": [
            *run.observers.warnings(run, history),
            *warn_of_energies(history, advice),
        ],
    }
