# SPDX-License-Identifier: Apache-2.0
"""Cases of two bodies in space that touch each other in explicit dynamics."""

from pathlib import Path

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
USUAL = {
    "element": "hex8_fbar", "cells": 4, "material": "hard", "duration": 4e-4, "stroke": 0.01, "damping": 3e4,
    "target_step": 1e-7,
}  # fmt: skip


def write_case(folder: Path, text: str, **changes: object) -> Path:
    """Write a case; return its path."""
    path = folder / "case.toml"
    path.write_text(text.format(**(USUAL | changes)) + MATERIALS)
    return path
