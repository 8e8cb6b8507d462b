# SPDX-License-Identifier: Apache-2.0
"""Explicit runs whose cycles ranks share, beside the same runs whole on each rank: what differs.

    mpiexec -n 3 python -m tests.problems.divided_loops

Rank 0 prints a line of JSON: by run, the largest difference of an array of its state over that array's size; of runs
that fail, what each of both has said.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from presswork import build_model, read_case
from presswork.explicit.input_checks import ExplicitError
from presswork.law.umat import compile_law
from presswork.model import Model
from presswork.process.begin import choose
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.process.line.springback import ReleasedStamping
from presswork.ranks.world import World, find_world
from tests.problems.square_cup import describe_cup
from tests.problems.stacked_plates import stack_explicit
from tests.problems.touching_bodies import FLYING, IN_PLANE, STRIKES, describe_bodies
from tests.problems.upset_block import describe_block

UMATS = Path(__file__).parents[1] / "data" / "umat" / "laws.cpp"
HEX = 'element = "hex8_1pt"\nmesh = {size = [4, 4, 3], cells = [4, 4, 3]}'
TET = 'element = "tet4_nodal"\nmesh = {size = [4, 4, 3], cells = [3, 3, 2]}'
TIED = 'element = "{}"\nmesh = {{kind = "cylinder", radius = 4, height = 3, angle = 60, cells = [3, 2, 3]}}'
SECTOR = 'element = "hex8_fbar"\nmesh = {kind = "cylinder", radius = 4, height = 3, angle = 50, cells = [3, 2, 3]}'
MOVED = 'velocity = "2 m/s"\ntools.die = {stroke = 0.4, direction = [0, 0, -1]}'
TURNED = 'velocity = "2 m/s"\ntools.die = {stroke = 0.4, direction = [0, 0, -1], turn = 5}'
PUSHED = 'duration = "2e-4 s"\ntools.die = {force = "14 kN", direction = [0, 0, -1]}'
PULLED = """duration = "2e-4 s"
displacement = [{set = "front", component = "z", value = 0.4}, {set = "back", component = "z", value = 0}]
"""
OUTPUT = "[output]\nsteps = 1\nrows = 10\n[remesh]\nenabled = false\n"
STRIP = """
title = "A strip pulled through two drawbeads"
analysis = "stamping"
procedure = "explicit"
[blank]
shape = "rectangle"
size = [60, 10]
thickness = 0.8
element_size = 2.5
material = "steel"
[materials.steel]
young = "206 GPa"
poisson = 0.3
hardening = {law = "swift", K = 565.32, e0 = 0.007117, n = 0.2589}
[boundary.flat]
set = "all"
fix = ["y", "z"]
[[beads]]
points = [[-10, -5], [-5, 5]]
force = 50
[[beads]]
points = [[-27, -5], [-27, 5]]
force = 20
[[stages]]
name = "pull"
velocity = "20 m/s"
displacement = [{set = "right", component = "x", value = 8}]
[output]
steps = 1
rows = 10
"""
"""Points of the first bead go from shell to shell, and from rank to rank; the last ones leave the sheet."""
HOT = """
[materials.steel.thermal]
conductivity = 40
specific_heat = "460 J/(kg*K)"
[heat]
initial_temperature = "300 °C"
surroundings = {ambient = 20, emissivity = 0.8}
[tools.die.heat]
temperature = 20
conductance = "4000 W/(m^2*K)"
gap = 0.1
"""
IN_AIR = '[[stages]]\nname = "air"\ndwell = {duration = 2, place = "air"}\n'
SHARES = (
    "beads.work", "loop.work", "run.energy", "contact.damping", "contact.drag", "contact.external", "contact.friction",
    "contact.squeeze",
)  # fmt: skip
"""Of these each rank has a share, and the sum is rounded."""


def read(text: str) -> Model:
    """Return the model of a case's text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.toml"
        path.write_text(text)
        return build_model(read_case(path))


def describe_explicit_block(workpiece: str, stage: str) -> str:
    """Return the text of a block in space by explicit dynamics."""
    text = describe_block(workpiece, 3, 0.3, stage, tail=OUTPUT)
    text = text.replace("poisson = 0.3", 'poisson = 0.3\ndensity = "7850 kg/m^3"')
    return text.replace('analysis = "solid"', 'analysis = "solid"\nprocedure = "explicit"')


def describe_user_law(folder: Path) -> str:
    """Return the text of a block whose UMAT, compiled into a folder, keeps what it is told of each cell."""
    library = compile_law(UMATS, folder / "laws.so")
    text = describe_explicit_block(HEX, MOVED)
    start, end = text.index("young"), text.index("[tools.die]")
    law = f'umat = "{library}"\nprops = [5, 200e3, 0.3]\nstate_variables = 12\ndensity = "7850 kg/m^3"\n'
    return text[:start] + law + text[end:]


def describe_porous_block() -> str:
    """Return the text of a block with pores that is pulled; they are averaged once a row."""
    head, _, tail = describe_explicit_block(HEX, "PULLED").partition("[tools.die]")
    head += "gtn = {porosity = 0.01, length = 1.5, coalescence = 0.03, failure = 0.2}\n"
    return head + tail[tail.index("[boundary.x]") :].replace("PULLED", PULLED)


def describe_section(element: str = "quad4_1pt", analysis: str = "axisymmetric") -> str:
    """Return the text of a cylinder or a strip that is thrown at an anvil and met by a die from above."""
    return f"""
title = "A section between two tools"
analysis = "{analysis}"
procedure = "explicit"
[explicit]
damping = 1e3
[workpiece]
material = "steel"
element = "{element}"
velocity = [0, "-100 m/s"]
mesh = {{size = [4, 6], cells = [7, 9]}}
[materials.steel]
young = 200e3
poisson = 0.3
density = "7850 kg/m^3"
hardening = {{law = "swift", K = 565, e0 = 0.007, n = 0.26}}
heating = {{reference = 20, melting = 1500, exponent = 1, heat_capacity = "460 J/(kg*K)"}}
[tools.die]
profile = [[0, 6], [3, 6], [9, 9]]
contact = "coulomb"
mu = 0.1
[tools.anvil]
profile = [[9, 0], [0, 0]]
contact = "coulomb"
mu = 0.1
[boundary.axis]
set = "left"
fix = ["x"]
[[stages]]
name = "press"
duration = "4e-5 s"
tools.die = {{stroke = 1.5, direction = [0, -1]}}
{OUTPUT}"""


def describe_explicit_sector() -> str:
    """Return the text of a sector between planes that stand askew, under a die that turns."""
    text = describe_explicit_block(SECTOR, TURNED).replace(
        "normal = [0, 0, -1]", "normal = [0, 0, -1]\naxis = [0, 0, 1]"
    )
    text = text.replace('set = "left"\nfix = ["x"]', 'set = "last_plane"\nfix = ["normal"]')
    return text.replace('set = "bottom"', 'set = "first_plane"')


def describe_tied_sector(element: str) -> str:
    """Return the text of a sector whose last face follows the first, under a die that turns."""
    text = describe_explicit_block(TIED.format(element), TURNED).replace(
        "normal = [0, 0, -1]", "normal = [0, 0, -1]\naxis = [0, 0, 1]"
    )
    head, _, stage = text.partition("[[stages]]")
    head = head.partition("[boundary.x]")[0]
    return f'{head}[boundary.cut]\nset = "last_plane"\ncyclic = "first_plane"\n[[stages]]{stage}'


def heat_up(text: str, before: str = "") -> str:
    """Return a case whose body is hot and softer for it, and cools at the die; before: stages that come first."""
    head, _, rest = text.partition("[[stages]]")
    soft = "poisson = 0.3\nheating = {reference = 20, melting = 1500, exponent = 1}"
    return f"{head.replace('poisson = 0.3', soft)}{HOT}{before}[[stages]]{rest}"


def describe_hot_cup() -> str:
    """Return the text of a cup that is drawn hot, after it has cooled in air."""
    return heat_up(describe_cup(8), IN_AIR).replace("velocity =", "process_time = 1\nvelocity =")


def describe_line() -> str:
    """Return the text of a cup that is drawn, then drawn on by the same tools, which are laid onto it."""
    text = describe_cup(12).replace("rows = 10", "rows = 2")
    head, blank, rest = text.partition("[blank]")
    rest, _, output = rest.partition("[output]")
    rest, _, forming = rest.partition("[tools.punch]")
    forming = forming.replace("[tools.", "[operations.tools.").replace("[[stages]]", "[[operations.stages]]")
    operations = "".join(f'[[operations]]\nname = "{name}"\n[operations.tools.punch]{forming}' for name in "ab")
    return f"{head}{blank}{rest}{operations}[output]{output}"


def describe_formed(folder: Path) -> str:
    """Return the text of a cup that begins with a part formed by one process, whose file is written to a folder."""
    text = describe_cup(12)
    run = ReleasedStamping(read(text + "dynain = true\n"), threads=1)
    for _ in run.advance():
        pass
    (folder / "part.dynain").write_text(run.write_part())
    blank = f'shape = "file"\npath = "{folder / "part.dynain"}"\nthickness = 0.8\nmaterial = "steel"'
    old = text[text.index('shape = "rectangle"') : text.index("\nsymmetry")]
    text = text.replace(old, blank)
    for before, height in (("[tools.die]", -1.5), ("[tools.holder]", -0.5), ("[[stages]]", 0.5)):
        text = text.replace(before, f"position = [0, 0, {height}]\n{before}")
    return text


def compare(text: str, world: World, rows: int = 2) -> dict[str, float]:
    """Compute rows of a case whole and shared; return by array how far the states are apart."""
    found = []
    for each in (None, world):
        run = choose(read(text), 1, each)
        on = run.advance()
        for _ in range(rows):
            next(on)
        found.append(run.to_arrays())
    return measure(*found)


def strike_plates(world: World, cycles: int = 65) -> dict[str, float]:
    """Let a plate strike another of the same sheet whole and shared; return by array how far the states are apart.

    So many cycles and as many again; the overlap after the first, in which they have met, stands among them.
    """
    found = []
    for each in (None, world):
        sheet, n = stack_explicit(tilt=0.002, world=each)
        sheet.touch_itself(mu=0.2)
        v = np.zeros((len(sheet.position), 6))
        v[n:, :3] = [800.0, 0.0, -3000.0]
        sheet.velocity = v
        sheet.advance(cycles)
        overlap = np.array(sheet.find_overlap())
        assert overlap[0] > 0.0
        sheet.advance(cycles)
        found.append({**sheet.dump(), "overlap": overlap, "force": sheet.shell_contact_force})
    return measure(*found)


def measure(whole: Mapping[str, Any], shared: Mapping[str, Any]) -> dict[str, float]:
    """Return by array how far two states are apart, over the array's size."""
    assert set(whole) == set(shared)
    apart = {}
    for name, values in whole.items():
        one, two = (np.nan_to_num(np.asarray(v, dtype=float), posinf=0.0) for v in (values, shared[name]))
        scale = max(float(np.abs(one).max(initial=0.0)), 1e-300)
        apart[name] = float(np.abs(one - two).max(initial=0.0)) / scale
    return apart


def fail(text: str, world: World, speed: float, longer: float) -> list[str]:
    """Return what a run says, whole and shared, with random speeds [mm/s] and a step longer by a factor."""
    said = []
    for each in (None, world):
        run: Any = choose(read(text), 1, each)
        loop = run.shells if isinstance(run, ExplicitStamping) else run.solids
        loop.velocity = np.random.default_rng(3).normal(0.0, speed, loop.velocity.shape)
        loop.dt *= longer
        try:
            loop.advance(200)
            said.append("no error")
        except ExplicitError as error:
            said.append(str(error))
    return said


def main() -> None:
    """Compute all runs."""
    world = find_world()
    assert world is not None
    with tempfile.TemporaryDirectory() as folder:
        formed = describe_formed(Path(folder))
        runs = {"formed": compare(formed, world), "user_law": compare(describe_user_law(Path(folder)), world)}
    runs |= {
        "plates": strike_plates(world),
        "struck": compare(describe_bodies(FLYING, element="hex8_1pt"), world, rows=3),
        "struck_tetrahedra": compare(describe_bodies(FLYING, element="tet4_nodal", cells=2), world, rows=2),
        "struck_in_plane": compare(describe_bodies(IN_PLANE, element="quad4_1pt", **STRIKES), world, rows=8),
        "pores": compare(describe_porous_block(), world),
        "section": compare(describe_section(), world),
        "strip": compare(describe_section("tri3", "plane_strain"), world),
        "new_sections": compare(describe_section().replace("enabled = false", "every = 0.2"), world, rows=5),
        "new_bodies": compare(
            describe_explicit_block(TET, MOVED).replace("enabled = false", "every = 0.2"), world, rows=3
        ),
        "hexahedra": compare(describe_explicit_block(HEX, MOVED), world),
        "pushed": compare(describe_explicit_block(HEX, PUSHED), world),
        "eight_points": compare(describe_explicit_block(HEX.replace("hex8_1pt", "hex8"), MOVED), world),
        "sector_turned": compare(describe_explicit_sector(), world, rows=1),
        "sector_tied": compare(describe_tied_sector("hex8_1pt"), world),
        "tetrahedra_tied": compare(describe_tied_sector("tet4_nodal"), world),
        "hot_block": compare(heat_up(describe_explicit_block(HEX, MOVED)), world),
        "hot_cup": compare(describe_hot_cup(), world, rows=12),
        "refined": compare(describe_cup(12).replace("[blank]", "[blank]\nrefine = {levels = 1}"), world, rows=6),
        "tetrahedra": compare(describe_explicit_block(TET, MOVED), world),
        "mitc": compare(describe_cup(8) + '[explicit]\nelement = "shell4_mitc_plus"\n', world),
        "single": compare(describe_cup(8) + '[explicit]\nprecision = "single"\n', world),
        "beads": compare(STRIP, world, rows=10),
        "line": compare(describe_line(), world, rows=5),
        "scaled": compare(describe_cup(8) + "[explicit]\ntarget_step = 2e-6\n", world),
    }
    failed = [
        fail(describe_cup(8), world, 5e3, 4.0),
        fail(describe_explicit_block(HEX, MOVED), world, 1e5, 2.0),
    ]
    if world.rank == 0:
        print(json.dumps({"apart": runs, "failed": failed}))


if __name__ == "__main__":
    main()
