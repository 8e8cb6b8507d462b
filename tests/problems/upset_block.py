# SPDX-License-Identifier: Apache-2.0
"""Text of a case: a quarter of a block that is upset between rigid planes, in space."""

ON_THE_ANVIL = 'contact = "shear"\nm = {m}'


def describe_block(
    workpiece: str, height: float, m: float, stage: str, *, anvil: str = ON_THE_ANVIL, tail: str = ""
) -> str:
    """Return the text of the case.

    workpiece: element and mesh; height: of the block, where the die stands [mm]; m: shear friction; stage: keys of the
    only one; anvil: its friction, as the die's if not given; tail: further tables.
    """
    return f"""
title = "a block is upset"
analysis = "solid"
[workpiece]
material = "steel"
{workpiece}
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {{law = "swift", K = 565, e0 = 0.007, n = 0.26}}
[tools.die]
shape = "plane"
normal = [0, 0, -1]
position = [0, 0, {height}]
contact = "shear"
m = {m}
[tools.anvil]
shape = "plane"
normal = [0, 0, 1]
{anvil.format(m=m)}
[boundary.x]
set = "left"
fix = ["x"]
[boundary.y]
set = "bottom"
fix = ["y"]
[[stages]]
name = "press"
{stage}
{tail}"""
