# SPDX-License-Identifier: Apache-2.0
"""Contact stress of the upsetting with sticking, four elements and a fine mesh: bounds, integrals, and a picture.

The thesis's case (Cheng 1995, chapter 2, section 12-1, figures 2.9 to 2.11) to 60 % from the shipped examples.
Run: python -m validation.contact_stress [--fine 60] [--picture docs/img/contact_stress.png]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from presswork.case import Case, build_model
from presswork.fields.contact_stress import ContactSurface
from presswork.fields.tool_stress import recover_tool_stress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, Model

SHOWN = {"upsetting_4cst": "4CST", "upsetting_q4": "Q4", "upsetting_q8_2x2": "Q8 2x2", "upsetting_t6_6pt": "T6"}
FORGINGS = (
    "curved_die", "forging_flash", "heading", "heading_friction", "ring_compression", "strip_rolling", "two_bodies",
    "upsetting_4cst", "upsetting_q4", "upsetting_q8_2x2", "upsetting_t6_6pt", "upsetting_t6_7pt",
)  # fmt: skip
"""The examples of bulk forming by the implicit procedure, but for extrusions."""


@dataclass(frozen=True)
class Face:
    """Contact stress at the end of a run."""

    place: FloatArray
    """x of the nodes in contact (n,) [mm], along the first tool."""
    pressure: FloatArray
    shear: FloatArray
    strength: FloatArray
    """k of the material at the node (n,)."""
    nodal_pressure: FloatArray
    """Nodal force over the node's area (n,) [MPa]."""
    nodal_shear: FloatArray
    traction_error: float
    """Integral of the traction less the sum of nodal forces, over that; the largest of the tools."""
    pressure_error: float
    """The same of the pressure and the pushes."""
    shear_left: float
    """Tangential force that finds no room on the surface, over all of it."""


@cache
def compute(example: str, changes: tuple[str, ...] = ()) -> Face:
    """Run an example to its end and recover the contact stress."""
    model = build_model(Case.from_toml(str(files("presswork.examples") / f"{example}.toml"), list(changes)))
    procedure = ImplicitProcedure(model, threads=1)
    for _ in procedure.advance():
        pass
    return measure(model, procedure)


def measure(model: Model, procedure: ImplicitProcedure) -> Face:
    """Recover the contact stress of the present state."""
    state = procedure.state
    contact = procedure.interactions.tools.contact.forces(
        state, procedure.interactions.supports.fixed(len(model.stages) - 1)
    )
    flow = procedure.mechanics.nodal_flow_stress(state)
    points = model.mesh.points + state.nodes.displacement
    found = recover_tool_stress(model, points, contact, flow)
    depth = None if model.analysis == "axisymmetric" else model.depth
    surface = ContactSurface(model.mesh.boundary_edges, points, contact.status > 0, contact.gap, depth=depth)
    area = surface.nodal_area
    errors = []
    for t in range(len(model.tools)):
        force = contact.force[contact.tool == t].sum(axis=0)
        errors.append(np.abs(area @ found.traction[t, :, :2] - force).max() / max(np.abs(force).max(), 1e-300))
    own = contact.tool == 0
    nodes = contact.nodes[own][np.argsort(points[contact.nodes[own], 0])]
    push, drag = np.zeros(len(points)), np.zeros(len(points))
    np.add.at(push, contact.nodes, contact.push)
    np.add.at(drag, contact.nodes, contact.drag)
    return Face(
        place=points[nodes, 0],
        pressure=found.pressure[nodes],
        shear=found.shear[nodes],
        strength=flow[nodes] / np.sqrt(3),
        nodal_pressure=push[nodes] / area[nodes],
        nodal_shear=drag[nodes] / area[nodes],
        traction_error=max(errors),
        pressure_error=float(abs(area @ found.pressure - push.sum()) / push.sum()),
        shear_left=float(abs(area @ found.shear - drag.sum()) / max(np.abs(drag).sum(), 1e-300)),
    )


def draw(path: str, fine: Face, blocks: int) -> None:
    """Draw pressure and shear along the face, the nodal forces over their areas thin."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 1, figsize=(8.2, 7.4), sharex=True, layout="constrained")
    axes[0].plot(fine.place, fine.pressure, "k-", lw=2.2, label=f"Q4, {blocks} x {blocks}")
    axes[1].plot(fine.place, -fine.shear, "k-", lw=2.2)
    axes[1].plot(fine.place, fine.strength, "k:", lw=1.0, label="k of the metal at the face")
    for number, (example, name) in enumerate(SHOWN.items()):
        face = compute(example)
        axes[0].plot(face.place, face.pressure, f"C{number}.-", lw=1.4, label=name)
        axes[1].plot(face.place, -face.shear, f"C{number}.-", lw=1.4)
    raw = compute("upsetting_4cst")
    axes[0].plot(raw.place, raw.nodal_pressure, "C0--", lw=0.7, label="4CST, nodal force over area")
    axes[1].plot(raw.place, -raw.nodal_shear, "C0--", lw=0.7)
    axes[0].set(ylabel="contact pressure [MPa]", ylim=(0, 4000))
    axes[1].set(ylabel="contact shear towards the axis [MPa]", xlabel="radius [mm]", ylim=(-400, 1200), xlim=(0, None))
    for ax in axes:
        ax.grid(True, color="0.92", lw=0.8)
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(frameon=False, fontsize=8, loc="upper left")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Print the table; draw if asked to."""
    parser = argparse.ArgumentParser(description="Contact stress of sticking upsettings")
    parser.add_argument("--fine", type=int, default=60, help="Blocks along each side of the fine mesh")
    parser.add_argument("--picture", help="PNG file to draw")
    arguments = parser.parse_args()
    fine = compute("upsetting_q4", (f"workpiece.mesh.cells=[{arguments.fine},{arguments.fine}]",))
    print("| mesh | pressure, r < 8 mm, off the fine mesh | largest | nodal force over area | shear left out |")
    print("|---|---|---|---|---|")
    for example, name in {**SHOWN, "fine": f"Q4, {arguments.fine} x {arguments.fine}"}.items():
        face = fine if example == "fine" else compute(example)
        inner = face.place < 8.0
        off = face.pressure[inner] / np.interp(face.place[inner], fine.place, fine.pressure) - 1
        print(
            f"| {name} | {off.min():+.1%} to {off.max():+.1%} | {face.pressure.max():.0f} MPa | "
            f"{face.nodal_pressure.max():.0f} MPa | {face.shear_left:.1%} |"
        )
    if arguments.picture:
        draw(arguments.picture, fine, arguments.fine)


if __name__ == "__main__":
    main()
