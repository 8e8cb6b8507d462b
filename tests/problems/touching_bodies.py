# SPDX-License-Identifier: Apache-2.0
"""Cases of two bodies in space that touch each other in explicit dynamics."""

import dataclasses
from pathlib import Path

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure

MATERIALS = """
[materials.hard]
young = "200 GPa"
poisson = 0.3
density = "7850 kg/m^3"
hardening = { law = "linear", yield_stress = 2500, modulus = 100 }
[materials.soft]
young = "70 GPa"
poisson = 0.33
density = "2700 kg/m^3"
hardening = { law = "swift", K = 180, e0 = 0.01, n = 0.2 }
"""
FLYING = """
title = "a block strikes another askew"
analysis = "solid"
procedure = "explicit"
[workpiece]
material = "soft"
element = "{element}"
mesh = {{ size = [10, 10, 10], cells = [{cells}, {cells}, {cells}] }}
[bodies.upper]
material = "hard"
element = "{element}"
velocity = [30e3, 10e3, -20e3]
mesh = {{ origin = [-2, 1, 10.1], size = [8, 8, 6], cells = [4, 3, 3] }}
[contacts.joint]
between = ["workpiece", "upper"]
contact = "coulomb"
mu = 0.2
[[stages]]
name = "fly"
duration = 60e-6
[output]
steps = 1
rows = 12
"""
PRESSED = """
title = "a block is pressed onto another"
analysis = "solid"
procedure = "explicit"
[workpiece]
material = "{material}"
element = "{element}"
mesh = {{ size = [10, 10, 5], cells = [4, 4, 2] }}
[bodies.upper]
material = "{material}"
element = "{element}"
mesh = {{ origin = [0, 0, 5], size = [10, 10, 5], cells = [3, 5, 2] }}
[contacts.joint]
between = ["workpiece", "upper"]
contact = "coulomb"
mu = 0.1
[boundary]
x = {{ set = "left", fix = ["x"] }}
y = {{ set = "bottom", fix = ["y"] }}
z = {{ set = "back", fix = ["z"] }}
upper_x = {{ set = "upper.left", fix = ["x"] }}
upper_y = {{ set = "upper.bottom", fix = ["y"] }}
[[stages]]
name = "press"
duration = {duration}
displacement = [{{ set = "upper.front", component = "z", value = -{stroke} }}]
[explicit]
damping = {damping}
target_step = {target_step}
[output]
steps = 1
rows = 20
"""
STACK = """
title = "two blocks of unlike metals are upset on each other"
analysis = "solid"
procedure = "explicit"
[workpiece]
material = "soft"
element = "tet4_nodal"
mesh = {{ size = [6, 6, 5], cells = [5, 5, 4] }}
[bodies.upper]
material = "firm"
element = "tet4_nodal"
mesh = {{ origin = [0, 0, 5], size = [5, 5, 5], cells = [4, 4, 4] }}
[contacts.joint]
between = ["workpiece", "upper"]
contact = "coulomb"
mu = 0.1
[tools.die]
shape = "plane"
normal = [0, 0, -1]
position = [0, 0, 10]
contact = "shear"
m = 0.2
[tools.anvil]
shape = "plane"
normal = [0, 0, 1]
contact = "shear"
m = 0.2
[boundary]
x = {{ set = "left", fix = ["x"] }}
y = {{ set = "bottom", fix = ["y"] }}
upper_x = {{ set = "upper.left", fix = ["x"] }}
upper_y = {{ set = "upper.bottom", fix = ["y"] }}
[materials.firm]
young = "210 GPa"
poisson = 0.3
density = "7850 kg/m^3"
hardening = {{ law = "swift", K = 300, e0 = 0.01, n = 0.2 }}
[[stages]]
name = "upset"
duration = "0.9 ms"
tools.die = {{ stroke = 0.9, direction = [0, 0, -1] }}
[explicit]
target_step = "0.4 us"
[output]
steps = 3
rows = 9
"""
HEAT_OF_STACK = """
[heat]
initial_temperature = 300
[materials.soft.thermal]
conductivity = 200
specific_heat = "900 J/(kg*K)"
[materials.firm.thermal]
conductivity = 30
specific_heat = "500 J/(kg*K)"
[contacts.joint.heat]
conductance = "100 kW/(m^2*K)"
"""
CLAMP = """
title = "a clamp is pressed shut"
analysis = "solid"
procedure = "explicit"
[workpiece]
material = "soft"
element = "{element}"
[workpiece.mesh]
kind = "extruded"
outline = [[0, 0], [16, 0], [16, 4.25], [5, 4.25], [5, 5.75], [16, 5.75], [16, 10], [0, 10]]
element_size = 1.5
height = 1.5
cells = 1
[contacts.fold]
between = ["workpiece", "workpiece"]
contact = "coulomb"
mu = 0.1
[boundary]
floor = {{ set = "bottom", fix = ["x", "y", "z"] }}
back = {{ set = "back", fix = ["z"] }}  # without it the slab buckles sideways from 1.9 mm on
[[stages]]
name = "shut"
duration = 1e-3
displacement = [{{ set = "top", component = "x", value = 0 }}, {{ set = "top", component = "y", value = -2.1 }}]
[explicit]
target_step = 2e-7
[output]
steps = 1
rows = 20
"""
IN_PLANE = """
title = "a core in a ring, or a block that strikes another"
analysis = "{analysis}"
procedure = "explicit"
{depth}
[workpiece]
material = "soft"
element = "{element}"
mesh = {{ size = [6, 5], cells = [6, 5] }}
[bodies.other]
material = "{other}"
element = "{element}"
{velocity}
mesh = {{ origin = {origin}, size = [4, 5], cells = [3, 4] }}
[contacts.joint]
between = ["workpiece", "other"]
contact = "coulomb"
mu = 0.1
[[stages]]
name = "one"
duration = {duration}
{stage}
[output]
steps = 1
rows = 20
"""
USUAL = {
    "element": "hex8_fbar", "cells": 4, "material": "hard", "duration": 4e-4, "stroke": 0.01, "damping": 3e4,
    "target_step": 1e-7,
}  # fmt: skip


STRIKES = {
    "analysis": "plane_strain", "depth": "depth = 2", "velocity": "velocity = [10e3, -20e3]", "origin": "[1, 5.1]",
    "other": "hard", "duration": 40e-6, "stage": "",
}  # fmt: skip
"""Of IN_PLANE: a block that strikes another."""


def describe_bodies(text: str, **changes: object) -> str:
    """Return the text of a case."""
    return text.format(**(USUAL | changes)) + MATERIALS


def write_case(folder: Path, text: str, **changes: object) -> Path:
    """Write a case; return its path."""
    path = folder / "case.toml"
    path.write_text(describe_bodies(text, **changes))
    return path


def compare_with_implicit(run, name: str, axis: int, joint: str = ""):
    """Return the mean way of a set over each row [mm], the force that moves it or on a joint, and the implicit one."""
    nodes = run.model.mesh.node_sets[name]
    start, way, found = run.model.mesh.points[nodes, axis].mean(), [0.0], []
    for report in run.advance():
        way.append(start - run.solids.position[nodes, axis].mean())
        found.append(abs(run.row(report)[f"{joint or name}.force_{'xyz'[axis]}"]))
    middle = 0.5 * (np.array(way[1:]) + way[:-1])  # forces are means over rows
    procedure = ImplicitProcedure(dataclasses.replace(run.model, explicit=None))
    strokes, forces = [], []
    for _ in procedure.advance():
        strokes.append(-procedure.state.nodes.displacement[nodes, axis].mean())
        on_joint = procedure.contact_forces()[joint] if joint else procedure.state.nodes.reaction[nodes].sum(axis=0)
        forces.append(abs(on_joint[axis]))
    return middle, np.array(found), np.interp(middle, strokes, forces)
