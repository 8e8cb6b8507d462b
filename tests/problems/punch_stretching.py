# SPDX-License-Identifier: Apache-2.0
"""Stretching of a clamped sheet over a hemispherical punch (Wagoner's benchmark), three ways.

The packaged example by the explicit and by the implicit procedure on the same mesh, and axisymmetric solids, which
share neither element nor contact with the shells.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from time import perf_counter

import numpy as np
import numpy.typing as npt

from presswork import model as data
from presswork.case import StampingCase, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh import mesh_rectangle
from presswork.model import (
    Friction,
    Hardening,
    Material,
    Model,
    OutputSettings,
    SolverSettings,
    Stage,
    Support,
    Tool,
    ToolMotion,
)
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.process.implicit.stamping import ImplicitStamping

Array = npt.NDArray[np.float64]
EXAMPLE = files("presswork.examples") / "hemispherical_punch.toml"
PUNCH, SHOULDER, RIM = 50.8, 6.35, 59.18
DEPTH = 25.0


@dataclass(frozen=True)
class Profile:
    """Strains against the undeformed radius, and the punch's force."""

    radius: Array
    """[mm]"""
    thickness_strain: Array
    radial_strain: Array
    """Logarithmic, of the middle layer."""
    force: float
    """On the whole punch [N]."""
    kinetic: float
    """Kinetic over internal energy at the end."""
    seconds: float


@cache
def stretch(procedure: str, mu: float, size: float = 5.0, *more: str, thickness: float = 1.0) -> Profile:
    """Stretch the quarter sheet to DEPTH; more: further overrides of the case."""
    started = perf_counter()
    keys = [f'procedure="{procedure}"', f"tools.punch.mu={mu}", f"tools.die.mu={mu}", f"blank.element_size={size}",
            f"stages.0.tools.punch.stroke={DEPTH}", f"blank.thickness={thickness}", "output.rows=20", "output.steps=1",
            *more]  # fmt: skip
    model = build_model(StampingCase.from_toml(EXAMPLE, keys))  # type: ignore[arg-type]
    run = ImplicitStamping(model, threads=1) if procedure == "implicit" else ExplicitStamping(model, threads=1)
    row = {}
    for report in run.advance():
        row = run.row(report)  # type: ignore[arg-type]
    points, cells = model.mesh.points, model.mesh.blocks[0].connectivity
    snapshot = run.snapshot()
    kinetic = row.get("kinetic_energy", 0.0) / row.get("internal_energy", 1.0)
    return Profile(
        radius=np.hypot(*points[cells].mean(axis=1)[:, :2].T),
        thickness_strain=snapshot.cell_data["thickness_strain"],
        radial_strain=_radial(points[cells], (points + snapshot.point_data["displacement"])[cells]),
        force=float(row["punch.force"]),
        kinetic=float(kinetic),
        seconds=perf_counter() - started,
    )


def _radial(before: Array, after: Array) -> Array:
    """Return the logarithmic strain of the cells' material lines along the radius (n,), from corners (n, 4, 3)."""
    slopes = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) / 4.0
    start = np.einsum("aj,nai->nij", slopes, before[:, :, :2])
    now = np.einsum("aj,nai->nij", slopes, after)
    middle = before[:, :, :2].mean(axis=1)
    direction = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    line = np.einsum("nij,nj->ni", now, np.linalg.solve(start, direction[:, :, None])[:, :, 0])
    return np.asarray(np.log(np.linalg.norm(line, axis=1)))


@cache
def stretch_solids(mu: float, thickness: float = 1.0, columns: int = 120) -> Profile:
    """The same with four layers of axisymmetric quad4_fbar, exact contact of both faces with the tools' profiles."""
    started = perf_counter()
    half = 0.5 * thickness
    mesh = mesh_rectangle(np.linspace(0, RIM, columns + 1), np.linspace(-half, half, 5), element="quad4_fbar")
    sheet = Material("sheet", 69004.0, 0.3, Hardening("swift", np.array([589.0, 1e-4, 0.216])))
    wall, high, low = RIM - SHOULDER, half + PUNCH, -half - SHOULDER
    profiles = {
        "punch": [[PUNCH, high + 20, PUNCH, high, 0, 0, 0], [PUNCH, high, 0, half, 0, high, -1]],
        "die": [[wall, low - 30, wall, low, 0, 0, 0], [wall, low, RIM, -half, RIM, low, -1]],
    }
    law = "coulomb" if mu else "frictionless"
    model = Model(
        title="stretching over a hemispherical punch",
        analysis="axisymmetric",
        depth=1.0,
        mesh=mesh,
        materials=(sheet,),
        tools=tuple(
            Tool(n, data.Profile(np.array(p, float)), friction=Friction(law, mu=mu)) for n, p in profiles.items()
        ),
        supports=(Support("left", (True, False)), Support("right", (True, True))),
        stages=(Stage("stretch", tool_motion={"punch": ToolMotion(move=(0.0, -DEPTH))}),),
        solver=SolverSettings(symmetric=mu == 0, initial_increment=0.001, max_increment=0.01, max_iterations=30),
        output=OutputSettings(steps=1),
    )
    run = ImplicitProcedure(model, threads=1)
    for _ in run.advance():
        pass
    now = mesh.points + run.state.nodes.displacement[:, :2]
    rows = [np.flatnonzero(np.isclose(mesh.points[:, 1], y)) for y in (-half, 0.0, half)]
    bottom, mid, top = (now[row[np.argsort(mesh.points[row, 0])]] for row in rows)
    across = np.log(np.linalg.norm(top - bottom, axis=1) / thickness)
    along = np.log(np.linalg.norm(np.diff(mid, axis=0), axis=1) * columns / RIM)
    centre = (np.arange(columns) + 0.5) * RIM / columns
    force = run.interactions.tools.contact.tool_forces(run.state, run.interactions.supports.fixed(0))[0]
    return Profile(centre, 0.5 * (across[1:] + across[:-1]), along, float(force[0, 1]), 0.0, perf_counter() - started)
