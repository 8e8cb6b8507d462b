# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of solids in space between rigid tools that none of their nodes enters.

    run = ExplicitSpaceSolids(mesh, [SpaceMaterial(law, density=7.85e-9)])
    run.fix("bottom", "v")
    wall = run.add_wall("die", make_surface(shape), position=(0.0, 0.0, 15.0), mu=0.1)
    wall.velocity = (0.0, 0.0, -1000.0)
    run.run_to(1e-3)

Units are mm, s, t, N, MPa. A node has three freedoms: u, v, w along x, y, z.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.arrays import DAMAGE, LoopState, MotionArrays, SolidArrays
from presswork.explicit.blocks import Solids
from presswork.explicit.body_contacts import TouchingBodies, TouchingSurfaces, list_known
from presswork.explicit.device import Device, refuse
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.space import SpaceDynamics
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_walls import NOT_TURNED, SpaceWall, WallStart
from presswork.law.history import EQPS, RISE, STRESS, list_history
from presswork.model import Mesh
from presswork.ranks.world import World
from presswork.state import State

if TYPE_CHECKING:
    from presswork.evolution.porosity import NonlocalPorosity

Array = npt.NDArray[np.float64]
COMPONENTS = 6
"""Number of components of the stress, which comes first in a point's values."""
DEEPEST_START = 1e-6
"""How deep a node may lie in a tool at the start, over the size of the body."""
SAME_DIRECTION = 1e-6
"""Part of a normal beside what holds its nodes already that counts for nothing."""


@dataclass(frozen=True)
class TiedFaces:
    """Two faces of a sector: the nodes of the last follow those of the first, turned about z."""

    pairs: npt.NDArray[np.int32]
    """A node of the first face and the one that follows it (n, 2)."""
    angle: float
    """[rad]"""


class ExplicitSpaceSolids(TouchingBodies, SpaceDynamics):
    """Bodies of hex8_1pt, hex8_fbar, hex8 or tet4_nodal in explicit dynamics.

    mesh: points (n_nodes, 3) [mm], blocks of cells; materials: one for each block. hourglass_fraction: of the shear
    modulus, that resists hourglass modes of hex8_1pt and what the nodal mean of tet4_nodal does not see. tied: faces of
    a sector. device, world: as of SpaceDynamics. touching: surfaces of contacts that are added later, which ranks must
    know.
    """

    def __init__(
        self,
        mesh: Mesh,
        materials: Sequence[SpaceMaterial],
        *,
        hourglass_fraction: float = 0.05,
        tied: TiedFaces | None = None,
        device: Device = "cpu",
        world: World | None = None,
        touching: Sequence[TouchingSurfaces] = (),
    ) -> None:
        if len(mesh.blocks) != len(materials):
            raise ExplicitError(f"materials: give one for each of the {len(mesh.blocks)} blocks of the mesh")
        has_pores = any(material.porosity is not None for material in materials)
        if has_pores:
            refuse(device, "porous metals (GTN)")
        self.mesh, self._materials = mesh, tuple(materials)
        blocks = [
            Solids(
                connectivity=block.connectivity,
                law=material.law,
                density=material.density,
                element=block.element,  # type: ignore[arg-type]
                hourglass_fraction=hourglass_fraction,
                elastic=material.elastic,
                rolling=material.rolling,
                porosity=material.porosity or 0.0,
            )
            for block, material in zip(mesh.blocks, materials, strict=True)
        ]
        super().__init__(
            mesh.points,
            blocks,
            device=device,
            tied=tied.pairs if tied else None,
            world=world,
            known=list_known(touching),
        )
        if tied:
            place = np.argsort(self._nodes).astype(np.int32)
            self._loop.tie(np.ascontiguousarray(place[tied.pairs]), tied.angle)
        self._node_sets = dict(mesh.node_sets)
        self.kept = [list_history(material.law, COMPONENTS).behind(STRESS, COMPONENTS) for material in materials]
        """What the points of each block hold, by name: stress, then what their law keeps."""
        for number, material in enumerate(materials):
            for of in material.damage:
                rise = self.kept[number][RISE].start if RISE in self.kept[number] else -1
                self._loop.add_damage(number, of.name, of.kernel, temperature=material.start, rise=rise)
        self._walls: list[SpaceWall] = []
        self._degrees: list[Array] | None = None
        self._normals: list[tuple[npt.NDArray[np.intp], Array]] = []
        self._holds_normals = True
        if has_pores:
            self.degrees = [material.start for material in materials]

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

    def _order(self, block: int) -> npt.NDArray[np.intp]:
        """Return the cells of a block, as the mesh has them there, in the order of the loop."""
        first = sum(len(each.connectivity) for each in self.mesh.blocks[:block])
        count = len(self.mesh.blocks[block].connectivity)
        return self._elements[first : first + count] - first

    def _points(self) -> list[Array]:
        """Return stress, equivalent plastic strain and rise at the points of each block's cells (n_cells, p, 7 | 8)."""
        found = []
        for block in range(len(self.mesh.blocks)):
            inside = np.asarray(self._loop.point_measures(block))
            out = np.empty_like(inside)
            out[self._order(block)] = inside
            found.append(out)
        return found

    def _mean(self, values: slice) -> Array:
        """Return means of values over the points of each cell (n_cells, n), through the blocks."""
        return np.concatenate([points[..., values].mean(axis=1) for points in self._points()])

    @property
    def stress(self) -> Array:
        """Stress xx, yy, zz, xy, yz, zx (n_cells, 6) [MPa], mean of the cell's points, through the blocks."""
        return self._mean(slice(COMPONENTS))

    @property
    def equivalent_plastic_strain(self) -> Array:
        """Equivalent plastic strain (n_cells), mean of the cell's points."""
        return self._mean(slice(COMPONENTS, COMPONENTS + 1))[:, 0]

    def recover(self, hardens: Array) -> None:
        """Let only a part of the equivalent plastic strain so far harden from now on (n_cells,)."""
        state, first = self.state(), 0
        for block, of in enumerate(self.mesh.blocks):
            own = hardens[first : first + len(of.connectivity)]
            strain = state[SolidArrays].find_kept(block, EQPS)
            strain *= own[self._order(block)][:, None]
            first += len(own)
        self.take_state(state)

    def average_pores(self, pores: NonlocalPorosity, volumes: Sequence[Array]) -> None:
        """Let pores grow by what their neighbourhoods have since the last call; volumes (n_cells,) of each block.

        Points of a cell stand for equal parts of it.
        """
        state = self.state_as_given()
        points = state[SolidArrays].points
        shares = [np.repeat(of[:, None], own.shape[1], axis=1) for of, own in zip(volumes, points, strict=True)]
        pores.advance(points, self.kept, shares)
        self.take_state_as_given(state)

    @property
    def points(self) -> list[Array]:
        """What the points of each block hold, as `kept` names it, mean of the cell's points (n_cells, 1, n_values)."""
        return [points.mean(axis=1, keepdims=True) for points in self.state_as_given()[SolidArrays].points]

    @property
    def rise_at_points(self) -> list[Array]:
        """Rise of temperature by plastic work since the start at the points of each block's cells (n_cells, p) [K]."""
        return [
            kept.of(RISE, points) if RISE in kept else np.zeros(points.shape[:2])
            for points, kept in zip(self._points(), self.kept, strict=True)
        ]

    @property
    def temperature(self) -> Array:
        """Temperature (n_cells) [degrees C], mean of the points: what is given from outside and the own rise."""
        rise = self.rise_at_points
        given = self._degrees or [np.full(1, material.start) for material in self._materials]
        return np.concatenate([(own + of).mean(axis=1) for own, of in zip(given, rise, strict=True)])

    @property
    def degrees(self) -> list[Array] | None:
        """What is given to the points of each block from outside (n_cells, p) [degrees C]; None: the laws' start."""
        return self._degrees

    @degrees.setter
    def degrees(self, given: Sequence[npt.ArrayLike]) -> None:
        shapes = [points.shape[:2] for points in self._points()]
        taken = [
            np.array(np.broadcast_to(np.asarray(value, dtype=float), shape))
            for value, shape in zip(given, shapes, strict=True)
        ]
        if not all(np.isfinite(values).all() for values in taken):
            raise ExplicitError("degrees: every value must be a finite number [degrees C]")
        for block, values in enumerate(taken):
            self._loop.set_temperature(block, np.ascontiguousarray(values[self._order(block)]))
        self._degrees = taken

    @property
    def damage(self) -> dict[str, list[Array]]:  # type: ignore[override]
        """Damage by the name of its quantity, of each block (n_cells, 1), without rows where it has no such law."""
        names = dict.fromkeys(law.name for material in self._materials for law in material.damage)
        return {name: [self._damage_of(block, name) for block in range(len(self._materials))] for name in names}

    def _damage_of(self, block: int, name: str) -> Array:
        if name not in [law.name for law in self._materials[block].damage]:
            return np.zeros((0, 1))
        order = self._order(block)
        out = np.empty((len(order), 1))
        out[order, 0] = np.asarray(self._loop.damage(block, name)).reshape(len(order), -1).max(axis=1)
        return out

    def critical_damage(self) -> dict[str, list[float | None]]:
        """Return the critical value of each in each block; None where there is none."""
        laws = [material.damage for material in self._materials]
        return {
            name: [next((law.critical.get(name) for law in of if law.name == name), None) for of in laws]
            for name in dict.fromkeys(law.name for of in laws for law in of)
        }

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

    def _prepare(self, velocity_scale: Array) -> None:
        super()._prepare(velocity_scale)
        if not self._holds_normals:
            self._loop.hold_along(*self._find_directions())
            self._holds_normals = True
        middle = self.time + 0.5 * len(velocity_scale) * self.dt
        for wall in self._walls:
            wall.drive(middle)
        self._prepare_contacts(max(self.dt, self._full_step))

    def _check(self) -> None:
        super()._check()
        self._check_contacts()

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

    def _name_state(self, arrays: LoopState) -> State:
        state = super()._name_state(arrays)
        state[SolidArrays].kept = self.kept
        return state

    def state_as_given(self) -> State:
        """Give what state does, with nodes and cells in the order given: what another mesh takes over."""

        def order(values: Array, numbers: npt.NDArray[np.intp]) -> Array:
            ordered = np.empty_like(values)
            ordered[numbers] = values
            return ordered

        return self._order_state(self.state(), order)

    def take_state_as_given(self, state: State) -> None:
        """Take over what state_as_given gave. Raises ExplicitError as restore does."""
        self.take_state(self._order_state(state.duplicate(), lambda values, numbers: values[numbers]))

    def _order_state(self, state: State, order: Callable[[Array, npt.NDArray[np.intp]], Array]) -> State:
        """Order the rows of nodes and of cells of a State by their numbers in the order of the loop, in place."""
        nodes, solids = state[MotionArrays], state[SolidArrays]
        for name in nodes.names():
            setattr(nodes, name, order(getattr(nodes, name), self._nodes))
        lists = [getattr(solids, name) for name in solids.names() if name != DAMAGE]
        for values in (*lists, *solids.damage.values()):
            values[:] = [order(of, self._order(block)) if len(of) else of for block, of in enumerate(values)]
        return state

    def _dump_run(self) -> dict[str, Array]:
        flat = [values.ravel() for values in self._degrees or []]
        return {**super()._dump_run(), "temperature": np.concatenate([np.zeros(0), *flat])}

    def _restore_run(self, own: Mapping[str, Array]) -> None:
        super()._restore_run({name: values for name, values in own.items() if name != "temperature"})
        if "temperature" in own:
            flat = own["temperature"]
            shapes = [points.shape[:2] for points in self._points()]
            parts = np.split(flat, np.cumsum([n * p for n, p in shapes])[:-1])
            self.degrees = [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]

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
