# SPDX-License-Identifier: Apache-2.0
"""Text of a case: a quarter of a square cup drawn a little by explicit dynamics, its holder pushed."""

BEAD = """
[[beads]]
points = [[-38, -38], [38, -38], [38, 38], [-38, 38]]
closed = true
radius = 15
force = 60
"""


def describe_cup(element_size: float) -> str:
    """Return the text of the case; element_size [mm]."""
    return f"""
title = "A quarter of a square cup"
analysis = "stamping"
procedure = "explicit"
[blank]
shape = "rectangle"
size = [100, 100]
thickness = 0.8
element_size = {element_size}
material = "steel"
symmetry = ["x", "y"]
[materials.steel]
young = "210 GPa"
poisson = 0.3
hardening = {{law = "swift", K = 565.32, e0 = 0.007117, n = 0.2589}}
[tools.punch]
kind = "punch"
shape = "rectangular"
size = [51, 51]
corner_radius = 10
edge_radius = 4
mu = 0.144
[tools.die]
kind = "die"
shape = "rectangular"
size = [54, 54]
corner_radius = 11.5
edge_radius = 4
mu = 0.144
[tools.holder]
kind = "holder"
shape = "rectangular"
size = [54, 54]
corner_radius = 11.5
edge_radius = 1
mu = 0.144
[[stages]]
name = "draw"
velocity = "2 m/s"
tools.punch = {{stroke = 2}}
tools.holder = {{force = "15 kN"}}
[output]
steps = 1
rows = 10
"""
