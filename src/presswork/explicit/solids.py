# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of solids in plane strain or axisymmetry, between rigid walls.

    run = ExplicitSolids(mesh, [material], axisymmetric=True)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -287e3))
    wall = run.add_wall("anvil", line)
    run.run_to(80e-6)
    run.energies().error_percent

Units are mm, s, t, N, MPa, degrees Celsius. A node has two freedoms: u along x (the radius), v along y (the axis).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.evolution.damage import make_damage
from presswork.explicit.arrays import LoopState, SolidArrays
from presswork.explicit.body_contacts import TouchingBodies, TouchingSurfaces, list_known
from presswork.explicit.divided import DividedLoop
from presswork.explicit.dynamics import Dynamics
from presswork.explicit.input_checks import ExplicitError, check_solids
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.walls import Wall as Wall
from presswork.law.at_rest import fill_history
from presswork.law.history import EQPS, RISE, STRESS, History, list_history
from presswork.model import CellBlock, Mesh
from presswork.ranks.parts import make_part
from presswork.ranks.world import World
from presswork.state import State

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity

Array = npt.NDArray[np.float64]
FREEDOMS = "uv"
COMPONENTS = 4
"""Number of components of the stress, which comes first in a point's values."""


class ExplicitSolids(TouchingBodies, Dynamics):
    """Solids of quad4_1pt or tri3 in explicit dynamics.

    mesh: points (n_nodes, 2) [mm], blocks of cells; materials: as the blocks number them. depth [mm]: of plane strain.
    hourglass_fraction: of the shear modulus, that resists hourglass modes of quad4_1pt. world: ranks that share the
    cycles; touching: surfaces of contacts that are added later, which ranks must know.
    """

    FREEDOMS = FREEDOMS
    _loop: _core.PlaneLoop

    def __init__(
        self,
        mesh: Mesh,
        materials: Sequence[SolidMaterial],
        *,
        axisymmetric: bool,
        depth: float = 1.0,
        hourglass_fraction: float = 0.05,
        world: World | None = None,
        touching: Sequence[TouchingSurfaces] = (),
    ) -> None:
        check_solids(mesh, len(materials), axisymmetric, depth, hourglass_fraction)
        self.mesh = mesh
        n = len(mesh.points)
        rim = np.zeros(n, dtype=np.uint8)
        rim[mesh.boundary_edges.ravel()] = 1
        section: dict[str, Any] = {
            "axisymmetric": axisymmetric,
            "depth": depth,
            "hourglass_fraction": hourglass_fraction,
        }
        whole = _core.PlaneLoop(np.ascontiguousarray(mesh.points, dtype=float), rim, **section)
        for block in mesh.blocks:
            _add_block(whole, block, materials, block.connectivity)
        loop: _core.PlaneLoop | DividedLoop = whole
        if world:
            loop = _divide(whole, mesh, materials, rim, section, list_known(touching), world)
        self._laws = [
            make_damage(materials[b.material].damage, materials[b.material].umat, is_solid=True) for b in mesh.blocks
        ]
        self.kept = [
            _list_kept(materials[block.material]).behind(RISE, 1).behind(EQPS, 1).behind(STRESS, COMPONENTS)
            for block in mesh.blocks
        ]
        """What the point of a cell holds in each block, by name: stress, then what its law keeps."""
        for number, laws in enumerate(self._laws):
            rise = self.kept[number][RISE].start
            start = materials[mesh.blocks[number].material].start
            for law in laws:
                loop.add_damage(number, law.name, law.kernel, temperature=start, rise=rise)
        self._prescribed_temperature = np.concatenate(
            [np.full(len(b.connectivity), materials[b.material].start) for b in mesh.blocks]
        )
        self._walls: list[Wall] = []
        fastest = max(materials[b.material].wave_speed for b in mesh.blocks)
        n_cells = len(self._prescribed_temperature)
        super().__init__(loop, np.arange(n), np.arange(n_cells), mesh.node_sets, fastest)
        if any(materials[block.material].gtn is not None for block in mesh.blocks):
            self.prescribed_temperature = self._prescribed_temperature

    @property
    def mass(self) -> Array:
        """Mass of each node (n_nodes) [t], with what was added; of its ring in axisymmetry."""
        return self._loop.mass

    @property
    def stress(self) -> Array:
        """Stress xx, yy, zz (hoop), xy (n_cells, 4) [MPa], through the blocks."""
        return self._loop.stress

    @property
    def equivalent_plastic_strain(self) -> Array:
        """Equivalent plastic strain (n_cells)."""
        return self._loop.eqps

    def recover(self, hardens: Array) -> None:
        """Let only a part of the equivalent plastic strain so far harden from now on (n_cells,)."""
        state, first = self.state(), 0
        for block in range(len(self.mesh.blocks)):
            strain = state[SolidArrays].find_kept(block, EQPS)
            strain *= hardens[first : first + len(strain), None]
            first += len(strain)
        self.take_state(state)

    def average_pores(self, pores: NonlocalPorosity, volumes: Sequence[Array]) -> None:
        """Let pores grow by what their neighbourhoods have since the last call; volumes (n_cells,) of each block."""
        state = self.state()
        pores.advance(state[SolidArrays].points, self.kept, [volume[:, None] for volume in volumes])
        self.take_state(state)

    @property
    def points(self) -> list[Array]:
        """What the point of each cell holds, as `kept` names it, of each block (n_cells, 1, n_values)."""
        return self.state()[SolidArrays].points

    @property
    def damage(self) -> dict[str, list[Array]]:
        """Damage by the name of its quantity, of each block (n_cells, 1), without rows where it has no such law."""
        names = dict.fromkeys(law.name for laws in self._laws for law in laws)
        return {
            name: [
                self._loop.damage(block, name) if name in [law.name for law in laws] else np.zeros((0, 1))
                for block, laws in enumerate(self._laws)
            ]
            for name in names
        }

    def critical_damage(self) -> dict[str, list[float | None]]:
        """Return the critical value of each in each block; None where there is none."""
        return {
            name: [next((law.critical.get(name) for law in laws if law.name == name), None) for laws in self._laws]
            for name in dict.fromkeys(law.name for laws in self._laws for law in laws)
        }

    @property
    def temperature(self) -> Array:
        """Temperature (n_cells) [degrees C]: what is given from outside, and the rise by plastic work."""
        return self._prescribed_temperature + self._loop.rise

    @property
    def rise(self) -> Array:
        """Rise of temperature by plastic work since the start (n_cells) [K]."""
        return self._loop.rise

    @property
    def prescribed_temperature(self) -> Array:
        """What is given from outside (n_cells) [degrees C]; at first that of the materials' start."""
        return self._prescribed_temperature.copy()

    @prescribed_temperature.setter
    def prescribed_temperature(self, value: npt.ArrayLike) -> None:
        degrees = np.array(np.broadcast_to(np.asarray(value, dtype=float), self._prescribed_temperature.shape))
        if not np.isfinite(degrees).all():
            raise ExplicitError("prescribed_temperature: every value must be a finite number [degrees C]")
        ends = np.cumsum([len(block.connectivity) for block in self.mesh.blocks])[:-1]
        for block, part in enumerate(np.split(degrees, ends)):
            self._loop.set_temperature(block, part)
        self._prescribed_temperature = degrees

    def set_velocity(self, nodes: str | npt.ArrayLike, velocity: Sequence[float]) -> None:
        """Give nodes a velocity (2,) [mm/s] to start from."""
        v = self.velocity
        v[self.nodes_of(nodes)] = velocity
        self.velocity = v

    def add_wall(self, name: str, segments: npt.ArrayLike, *, mu: float = 0.0, is_at_start: bool = True) -> Wall:
        """Add a rigid profile, segments (n, 7) as in model.Tool, its metal on the right.

        Every node of the boundary is held off it. mu: Coulomb friction, infinite where nothing slides. is_at_start:
        whether it is where the segments are, and no node may lie in it; else restore moves it.
        """
        profile = np.atleast_2d(np.ascontiguousarray(segments, dtype=float))
        if profile.shape[1] != 7 or not np.isfinite(profile).all():
            raise ExplicitError(f"segments of wall {name} must be finite numbers of shape (n, 7)")
        if not (0 <= mu <= 2 or mu == np.inf):
            raise ExplicitError(f"mu of wall {name} = {mu}: it must lie between 0 and 2")
        gap = _core.touch_profile(profile, self.position)[0]
        rim = np.unique(self.mesh.boundary_edges)
        size = float(np.ptp(self.mesh.points, axis=0).max())
        deepest = rim[np.argmin(gap[rim])]
        if is_at_start and gap[deepest] < -1e-6 * size:
            raise ExplicitError(
                f"wall {name}: node {deepest} lies {-gap[deepest]:g} mm inside it at the start: move the wall off, or "
                "turn its direction round (metal is on the right)"
            )
        self._loop.add_wall(profile, mu=mu)
        wall = Wall(self._loop, len(self._walls), name)
        self._walls.append(wall)
        return wall

    def _prepare(self, velocity_scale: Array) -> None:
        self._prepare_contacts(max(self.dt, self._full_step))

    def _check(self) -> None:
        self._check_contacts()

    def _dump_run(self) -> dict[str, Array]:
        return {**super()._dump_run(), "temperature": self._prescribed_temperature.copy()}

    def _restore_run(self, own: Mapping[str, Array]) -> None:
        super()._restore_run(own)
        self.prescribed_temperature = own["temperature"]

    def _name_state(self, arrays: LoopState) -> State:
        state = super()._name_state(arrays)
        state[SolidArrays].kept = self.kept
        return state


def _list_kept(material: SolidMaterial) -> History:
    """Return what a law keeps beside stress, plastic strain and rise of temperature."""
    return list_history(material.make_law(), 4).without(EQPS, RISE)


def _add_block(
    loop: _core.PlaneLoop, block: CellBlock, materials: Sequence[SolidMaterial], cells: npt.NDArray[np.int32]
) -> None:
    """Add cells (n, nodes), numbered as the loop numbers nodes, of a block of the mesh."""
    material = materials[block.material]
    porosity = material.gtn.initial if material.gtn else 0.0
    kept = fill_history(_list_kept(material), (), rolling=material.rolling_direction, porosity=porosity)
    loop.add_solids(
        block.element,
        np.ascontiguousarray(cells, dtype=np.int32),
        material.make_law(),
        material.density,
        kept=kept.tolist(),
        young=material.young,
        poisson=material.poisson,
    )


def _divide(
    whole: _core.PlaneLoop,
    mesh: Mesh,
    materials: Sequence[SolidMaterial],
    rim: npt.NDArray[np.uint8],
    section: dict[str, Any],
    known: npt.NDArray[np.int32],
    world: World,
) -> DividedLoop:
    """Return a loop whose cycles ranks share; the arguments are those of the whole loop."""
    cells = [block.connectivity for block in mesh.blocks]
    try:
        part = make_part(mesh.points, cells, world.size, world.rank, [False] * len(cells), known=known)
    except ValueError as error:
        raise ExplicitError(f"{error}: start fewer ranks") from None
    own = _core.PlaneLoop(np.ascontiguousarray(mesh.points[part.nodes], dtype=float), rim[part.nodes], **section)
    for block, elements in zip(mesh.blocks, part.elements, strict=True):
        if len(elements):
            _add_block(own, block, materials, part.number(block.connectivity[elements]))
    return DividedLoop(whole, own, part, world, width=2)
