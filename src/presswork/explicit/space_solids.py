# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of a solid in space between rigid tools that none of its nodes enters.

    run = ExplicitSpaceSolids(mesh, law, density=7.85e-9)
    run.fix("bottom", "v")
    wall = run.add_wall("die", make_surface(shape), position=(0.0, 0.0, 15.0), mu=0.1)
    wall.velocity = (0.0, 0.0, -1000.0)
    run.run_to(1e-3)

Units are mm, s, t, N, MPa. A node has three freedoms: u, v, w along x, y, z.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.evolution.damage import DamageLaw
from presswork.explicit.blocks import Solids
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.space import SpaceDynamics
from presswork.model import ELEMENTS, Mesh

Array = npt.NDArray[np.float64]
EQPS, HEAT_RISE = 6, 7
"""Places in a point's values behind its stress."""
DEEPEST_START = 1e-6
"""Of the size of the body: how deep a node may lie in a tool at the start."""


class SpaceWall:
    """A rigid tool that no node of the body's surface enters."""

    def __init__(self, loop: _core.SpaceLoop, number: int, name: str, nodes: npt.NDArray[np.intp]) -> None:
        self.name = name
        self._loop, self._number, self._nodes = loop, number, nodes
        self._velocity = (0.0, 0.0, 0.0)

    @property
    def velocity(self) -> tuple[float, float, float]:
        """Prescribed translation (3,) [mm/s], times `velocity_scale`."""
        return self._velocity

    @velocity.setter
    def velocity(self, value: Sequence[float]) -> None:
        x, y, z = (float(v) for v in value)
        if not np.isfinite([x, y, z]).all():
            raise ExplicitError(f"velocity of tool {self.name} = {value}: it must be three finite numbers")
        self._velocity = (x, y, z)
        self._loop.move_wall(self._number, self._velocity)

    def limit_friction(self, limit: Array) -> None:
        """Let friction be no larger on the nodes (n_nodes,) [N] from now on."""
        self._loop.limit_wall_friction(self._number, np.ascontiguousarray(limit[self._nodes]))

    @property
    def displacement(self) -> Array:
        """Displacement since the start (3,) [mm]."""
        return np.array(self._loop.wall_offset(self._number))

    @property
    def impulse(self) -> Array:
        """Impulse of the body on the tool since the start (3,) [N s]: its change over a time is the mean force."""
        return -np.array(self._loop.wall_impulse(self._number))

    @property
    def nodal_force(self) -> Array:
        """Forces of the tool on the nodes in the last cycle (n_nodes, 3) [N]."""
        inside = np.asarray(self._loop.wall_force(self._number))
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    @property
    def force(self) -> Array:
        """Force of the body on the tool in the last cycle (3,) [N]."""
        return np.asarray(-self.nodal_force.sum(axis=0))


class ExplicitSpaceSolids(SpaceDynamics):
    """A body of hex8_1pt, hex8_fbar, hex8 or tet4_nodal in explicit dynamics.

    mesh: points (n_nodes, 3) [mm], one block of cells; law: in space; density [t/mm3]. hourglass_fraction: of the shear
    modulus, that resists hourglass modes of hex8_1pt and what the nodal mean of tet4_nodal does not see. damage:
    criteria whose damage grows. start: temperature at the start [degrees C]; heats: whether the law heats.
    """

    def __init__(
        self,
        mesh: Mesh,
        law: _core.VonMises | _core.SolidLaw,
        density: float,
        *,
        hourglass_fraction: float = 0.05,
        damage: Sequence[DamageLaw] = (),
        start: float = 20.0,
        heats: bool = False,
    ) -> None:
        if len(mesh.blocks) != 1:
            raise ExplicitError("an explicit solid in space has cells of one material")
        self.mesh, self._start, self._heats = mesh, start, heats
        self._n_points = ELEMENTS[mesh.blocks[0].element].points
        body = Solids(
            connectivity=mesh.blocks[0].connectivity,
            law=law,
            density=density,
            element=mesh.blocks[0].element,  # type: ignore[arg-type]
            hourglass_fraction=hourglass_fraction,
        )
        super().__init__(mesh.points, [body])
        self._node_sets = dict(mesh.node_sets)
        for of in damage:
            self._loop.add_damage(0, of.name, of.kernel, temperature=start, rise=HEAT_RISE if heats else -1)
        self._damage = tuple(damage)
        self._walls: list[SpaceWall] = []

    @property
    def velocity(self) -> Array:
        """Velocities (n_nodes, 3) [mm/s], half a step back."""
        return super().velocity[:, :3]

    @velocity.setter
    def velocity(self, value: npt.ArrayLike) -> None:
        given = np.asarray(value, dtype=float)
        SpaceDynamics.velocity.__set__(self, np.column_stack([given, np.zeros_like(given)]))  # type: ignore[attr-defined]

    @property
    def mass(self) -> Array:
        """Mass of each node (n_nodes,) [t], with what was added."""
        return super().mass[:, 0]

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms since reset_reaction (n_nodes, 3) [N s]."""
        return super().reaction_impulse[:, :3]

    def _values(self) -> Array:
        """Return the means over the points of each cell of all that they keep (n_cells, n)."""
        inside = np.asarray(self._loop.state()["block_0"]["points"])
        out = np.empty_like(inside)
        out[self._elements] = inside
        return np.asarray(out.mean(axis=1))

    @property
    def stress(self) -> Array:
        """Stress xx, yy, zz, xy, yz, zx (n_cells, 6) [MPa], mean of the cell's points."""
        return self._values()[:, :6]

    @property
    def equivalent_plastic_strain(self) -> Array:
        """Equivalent plastic strain (n_cells), mean of the cell's points."""
        return self._values()[:, EQPS]

    def recover(self, hardens: Array) -> None:
        """Let only a part of the equivalent plastic strain so far harden from now on (n_cells,)."""
        state = self._loop.state()
        state["block_0"]["points"][..., EQPS] *= hardens[self._elements][:, None]
        self._loop.restore(state)

    @property
    def temperature(self) -> Array:
        """Temperature (n_cells) [degrees C]: that of the start, and the rise by plastic work."""
        if not self._heats:
            return np.full(len(self._elements), self._start)
        return self._start + self._values()[:, HEAT_RISE]

    @property
    def damage(self) -> dict[str, list[Array]]:  # type: ignore[override]
        """Damage by the name of its quantity, of the one block (n_cells, 1)."""
        found = {}
        for law in self._damage:
            inside = np.asarray(self._loop.damage(0, law.name)).reshape(len(self._elements), -1).max(axis=1)
            found[law.name] = [self._by_element(inside)[:, None]]
        return found

    def critical_damage(self) -> dict[str, list[float | None]]:
        """Return the critical value of each; None where there is none."""
        return {law.name: [law.critical.get(law.name)] for law in self._damage}

    def set_velocity(self, nodes: str | npt.ArrayLike, velocity: Sequence[float]) -> None:
        """Give nodes a velocity (3,) [mm/s] to start from."""
        v = self.velocity.copy()
        v[self.nodes_of(nodes)] = velocity
        self.velocity = v

    def add_wall(
        self, name: str, surface: _core.ToolSurface, *, position: Sequence[float] = (0.0, 0.0, 0.0), mu: float = 0.0
    ) -> SpaceWall:
        """Let a rigid tool hold the body's surface off; mu: Coulomb friction. position: of the tool's frame [mm]."""
        if not 0 <= mu <= 2:
            raise ExplicitError(f"mu of tool {name} = {mu}: it must lie between 0 and 2")
        size = float(np.linalg.norm(np.ptp(self.start, axis=0)))
        outer = np.unique(self.mesh.boundary_faces)
        gap = surface.nearest(np.ascontiguousarray(self.start[outer] - np.asarray(position)), size)[0]
        deepest = int(np.argmin(gap))
        if gap[deepest] < -DEEPEST_START * size:
            raise ExplicitError(
                f"tool {name}: node {outer[deepest]} lies {-gap[deepest]:g} mm inside it at the start: move the tool "
                "off, or turn its surface over"
            )
        touching = np.zeros(len(self.start), dtype=np.uint8)
        touching[outer] = 1
        assert isinstance(self._loop, _core.SpaceLoop)
        self._loop.add_wall(surface, np.ascontiguousarray(touching[self._nodes]), position=position, mu=mu, reach=size)
        wall = SpaceWall(self._loop, len(self._walls), name, self._nodes)
        self._walls.append(wall)
        return wall
