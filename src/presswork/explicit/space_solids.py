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
from presswork.explicit.space_walls import NOT_TURNED, SpaceWall, WallStart
from presswork.model import ELEMENTS, Mesh

Array = npt.NDArray[np.float64]
EQPS, HEAT_RISE = 6, 7
"""Places in a point's values behind its stress."""
DEEPEST_START = 1e-6
"""Of the size of the body: how deep a node may lie in a tool at the start."""
SAME_DIRECTION = 1e-6
"""Part of a normal beside what holds its nodes already that counts for nothing."""


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
        self._normals: list[tuple[npt.NDArray[np.intp], Array]] = []
        self._holds_normals = True

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
    def rise_at_points(self) -> Array:
        """Rise of temperature by plastic work since the start at the cells' points (n_cells, p) [K]."""
        inside = np.asarray(self._loop.state()["block_0"]["points"])
        return self._by_element(inside[..., HEAT_RISE]) if self._heats else np.zeros(inside.shape[:2])

    @property
    def temperature(self) -> Array:
        """Temperature (n_cells) [degrees C], mean of the points: what is given from outside and the own rise."""
        given = self._start if self._given_temperature is None else self._given_temperature
        return np.asarray((given + self.rise_at_points).mean(axis=1))

    @property
    def given_temperature(self) -> Array | None:
        """What is given to the points from outside (n_cells, p) [degrees C]; None: that of the law's start."""
        return self._given_temperature

    @given_temperature.setter
    def given_temperature(self, value: npt.ArrayLike) -> None:
        degrees = np.array(np.broadcast_to(np.asarray(value, dtype=float), self.rise_at_points.shape))
        if not np.isfinite(degrees).all():
            raise ExplicitError("given_temperature: every value must be a finite number [degrees C]")
        self._loop.set_temperature(0, np.ascontiguousarray(degrees[self._elements]))
        self._given_temperature = degrees

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

    def fix_normal(self, nodes: str | npt.ArrayLike, normal: Sequence[float]) -> None:
        """Hold nodes along a unit vector (3,) that is no axis, besides what fix prescribes, before or after."""
        self._normals.append((self.nodes_of(nodes), np.asarray(normal, dtype=float)))
        self._holds_normals = False

    def fix(self, nodes: str | npt.ArrayLike, freedoms: str, velocity: npt.ArrayLike = 0.0) -> None:
        """Prescribe the velocity [mm/s], one or one for each node, of freedoms: letters of "uvw"."""
        super().fix(nodes, freedoms, velocity)
        self._holds_normals = False

    def release(self) -> None:
        """Let every freedom go that fix and fix_normal have prescribed."""
        super().release()
        self._normals = []

    def tie_sector(self, first: npt.ArrayLike, last: npt.ArrayLike, angle: float) -> None:
        """Let the nodes of the last face of a sector follow those of the first (n,), turned about z by an angle [rad].

        Nodes on the axis are on both.
        """
        place = np.empty(len(self._nodes), dtype=np.int32)
        place[self._nodes] = np.arange(len(self._nodes))
        pairs = place[np.column_stack([first, last])]
        assert isinstance(self._loop, _core.SpaceLoop)
        self._loop.tie(np.ascontiguousarray(pairs[pairs[:, 0] != pairs[:, 1]]), angle)

    def _prepare(self, velocity_scale: Array) -> None:
        super()._prepare(velocity_scale)
        if not self._holds_normals:
            assert isinstance(self._loop, _core.SpaceLoop)
            self._loop.hold_along(*self._find_directions())
            self._holds_normals = True
        middle = self.time + 0.5 * len(velocity_scale) * self.dt
        for wall in self._walls:
            wall.drive(middle)

    def _find_directions(self) -> tuple[npt.NDArray[np.int32], Array, Array]:
        """Return nodes (k,) of the loop, rising, unit vectors (k, 3) that hold them, and velocities along these (k,).

        What fix prescribes comes first: of a normal that part counts which is normal to all that holds the node.
        """
        held: dict[int, list[tuple[Array, float]]] = {}
        place = np.argsort(self._nodes)
        for nodes, normal in self._normals:
            for node in nodes.tolist():
                own = held.setdefault(node, [])
                fixed = self._fixed[node, :3] > 0
                rest, speed = np.where(fixed, 0.0, normal), -float(normal[fixed] @ self._prescribed[node, :3][fixed])
                for along, given in own:
                    part = float(rest @ along)
                    rest, speed = rest - part * along, speed - part * given
                if (length := float(np.linalg.norm(rest))) > SAME_DIRECTION:
                    own.append((rest / length, speed / length))
        rows = sorted((int(place[node]), along, speed) for node, own in held.items() for along, speed in own)
        return (
            np.array([row[0] for row in rows], dtype=np.int32),
            np.array([row[1] for row in rows]).reshape(-1, 3),
            np.array([row[2] for row in rows]),
        )

    def add_wall(
        self,
        name: str,
        surface: _core.ToolSurface,
        *,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        mu: float = 0.0,
        start: WallStart = NOT_TURNED,
        is_at_start: bool = True,
    ) -> SpaceWall:
        """Let a rigid tool hold the body's surface off.

        position: of the tool's frame [mm]; start: how it is turned there. mu: Coulomb friction, infinite where nothing
        slides. is_at_start: whether it is there now, and no node may lie in it; else restore moves it. Raises
        ExplicitError.
        """
        if not (0 <= mu <= 2 or mu == np.inf):
            raise ExplicitError(f"mu of tool {name} = {mu}: it must lie between 0 and 2")
        size = float(np.linalg.norm(np.ptp(self.start, axis=0)))
        outer = np.unique(self.mesh.boundary_faces)
        rotation = np.asarray(start.rotation)
        gap = surface.nearest(np.ascontiguousarray((self.start[outer] - np.asarray(position)) @ rotation), size)[0]
        deepest = int(np.argmin(gap))
        if is_at_start and gap[deepest] < -DEEPEST_START * size:
            raise ExplicitError(
                f"tool {name}: node {outer[deepest]} lies {-gap[deepest]:g} mm inside it at the start: move the tool "
                "off, or turn its surface over"
            )
        touching = np.zeros(len(self.start), dtype=np.uint8)
        touching[outer] = 1
        assert isinstance(self._loop, _core.SpaceLoop)
        self._loop.add_wall(
            surface,
            np.ascontiguousarray(touching[self._nodes]),
            position=position,
            rotation=rotation.tolist(),
            centre=start.centre,
            axis=start.axis,
            turns=start.turns,
            mu=mu,
            reach=size,
        )
        wall = SpaceWall(self._loop, len(self._walls), name, self._nodes)
        self._walls.append(wall)
        return wall
