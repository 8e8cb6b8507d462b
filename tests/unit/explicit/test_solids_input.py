# SPDX-License-Identifier: Apache-2.0
"""What a run of explicit solids refuses: every message names the value and the remedy."""

from dataclasses import replace

import numpy as np
import pytest

from presswork.explicit.shells import ExplicitError
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import CellBlock, Heating, Mesh

STEEL = {"young": 210e3, "poisson": 0.3, "density": 7.85e-9}


def mesh(element: str = "quad4_1pt", x0: float = 0.0) -> Mesh:
    return mesh_rectangle(np.linspace(x0, x0 + 2, 3), np.linspace(0, 2, 3), element=element)


def start(**changes: object) -> ExplicitSolids:
    return ExplicitSolids(
        **({"mesh": mesh(), "materials": [SolidMaterial(**STEEL)], "axisymmetric": True} | changes)  # type: ignore[arg-type]
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"density": 7850.0}, "density = 7850 t/mm3 is beyond any metal: steel has 7.85e-9"),
        ({"density": 7.85e-6}, "beyond any metal"),
        ({"density": 0.0}, "density = 0: it must be above zero"),
        ({"density": float("nan")}, "density = nan: it must be above zero"),
        ({"young": -1.0}, "young = -1.0"),
        ({"poisson": 0.5}, "poisson = 0.5: it must lie between -1 and 0.5"),
    ],
)
def test_material_out_of_bounds(changes: dict[str, float], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        SolidMaterial(**(STEEL | changes))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"melting": 10.0}, "melting = 10.0: it must be above reference"),
        ({"start": 2000.0}, "start = 2000.0"),
        ({"exponent": 0.0}, "exponent = 0.0"),
        ({"heat_capacity": 460.0}, "a million times the figure in J"),
        ({"plastic_fraction": 90.0}, "plastic_fraction = 90.0: it must lie between 0 and 1"),
    ],
)
def test_heating_out_of_bounds(changes: dict[str, float], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        SolidMaterial(
            **STEEL, heating=Heating(**({"melting": 1540.0, "exponent": 1.0, "heat_capacity": 4.6e8} | changes))
        )


def reversed_cells() -> Mesh:
    m = mesh()
    block = m.blocks[0]
    return replace(m, blocks=(CellBlock(block.element, block.connectivity[:, ::-1].copy(), 0),))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mesh": mesh("quad8")}, "element quad8: explicit solids are tri3 or quad4_1pt"),
        ({"mesh": mesh(x0=-1.0)}, "radius -1 mm: x is the radius"),
        ({"mesh": reversed_cells()}, "cell 0 of quad4_1pt .* counter-clockwise"),
        ({"mesh": replace(mesh(), points=np.full((9, 2), np.nan))}, "node 0 has a coordinate that is not a number"),
        ({"materials": []}, "a block asks for material 0: there are 0"),
        ({"depth": 0.0}, "depth = 0.0"),
        ({"hourglass_fraction": -0.1}, "hourglass_fraction = -0.1"),
    ],
)
def test_run_that_cannot_start(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        start(**changes)


def test_velocity_beyond_sound_is_a_wrong_unit() -> None:
    with pytest.raises(
        ExplicitError, match=r"2.87e\+08 mm/s is beyond the material's sound, 6e\+06 mm/s: .* 1 m/s is 1000"
    ):
        start().set_velocity("all", (0.0, -2.87e8))
    with pytest.raises(ExplicitError, match="beyond the material's sound"):
        start().fix("bottom", "v", 1e9)


def test_unknown_names_and_numbers() -> None:
    run = start()
    with pytest.raises(ExplicitError, match="there is no node set 'foot'; the mesh has: all, bottom, bottom_left"):
        run.fix("foot", "v")
    with pytest.raises(ExplicitError, match="there is no node 9: they are 0 to 8"):
        run.fix([0, 9], "v")
    with pytest.raises(ExplicitError, match="freedoms = 'w'"):
        run.fix("bottom", "w")
    with pytest.raises(ExplicitError, match=r"velocity has shape \(3,\): it must be \(n_nodes, 2\)"):
        run.velocity = np.zeros(3)
    with pytest.raises(ExplicitError, match="force of node 0 is not a finite number"):
        run.force = np.full((9, 2), np.inf)


def test_wall_that_the_solid_lies_behind() -> None:
    run = start()
    with pytest.raises(
        ExplicitError, match=r"wall anvil: node .* lies 2 mm inside it at the start: .*metal is on the right"
    ):
        run.add_wall("anvil", [[20, 0, -1, 0, 0, 0, 0]])
    with pytest.raises(ExplicitError, match=r"segments of wall anvil must be finite numbers of shape \(n, 7\)"):
        run.add_wall("anvil", [[0, 0, 1, 0]])
    with pytest.raises(ExplicitError, match="mu of wall anvil = -1"):
        run.add_wall("anvil", [[-1, 0, 20, 0, 0, 0, 0]], mu=-1)


def test_times_that_have_passed() -> None:
    run = start()
    with pytest.raises(ExplicitError, match="end = 0 s: it must lie beyond the time reached"):
        run.run_to(0.0)
    with pytest.raises(ExplicitError, match=r"target_step = -1.0: it must be above zero"):
        run.scale_mass(-1.0)
    with pytest.raises(ExplicitError, match="n = 0: advance at least one cycle"):
        run.advance(0)


def test_a_cell_turned_inside_out_is_named() -> None:
    """Nodes driven through each other in one step."""
    run = start()
    run.fix("top", "v", -1e6)
    run.dt = 1e-5
    with pytest.raises(ExplicitError, match=r"cell . is turned inside out in cycle 1 .* shorten the step"):
        run.advance(1)


def test_a_dump_of_another_set_of_walls() -> None:
    dump = start().dump()
    other = start()
    other.add_wall("anvil", [[-1, 0, 20, 0, 0, 0, 0]])
    with pytest.raises(ExplicitError, match="the dump's walls are not those of this run: add them in the same order"):
        other.restore(dump)


def test_cells_of_another_element_are_refused() -> None:
    law = SolidMaterial(**STEEL).make_law()
    with pytest.raises(ValueError, match=r"shape \(n > 0, nodes of the element\)"):
        start()._loop.add_solids("tri3", np.array([[0, 1, 4, 3]], dtype=np.int32), law, STEEL["density"], kept=[])
