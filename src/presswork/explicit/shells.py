# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics of shells: central differences on arrays, `n` cycles a call in C++.

    run = ExplicitShells(points, connectivity, thickness, law, density)
    run.fix(nodes, "uvw")
    run.velocity = ...
    run.scale_mass(2e-7)
    run.advance(1000)
    run.energies().error_percent

Units are mm, s, t, N, MPa. A node has six freedoms: displacements u, v, w and rotations p, q, r about x, y, z.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from presswork import _core
from presswork.explicit.drawbeads import BeadsOfRun
from presswork.explicit.energy import EnergyBalance, MassScaling, compute_balance, sum_energies
from presswork.explicit.input_checks import ExplicitError as ExplicitError
from presswork.explicit.input_checks import check_nodal, check_shells
from presswork.explicit.layers import LayersOfRun
from presswork.explicit.options import ShellOptions as ShellOptions
from presswork.explicit.options import layer_rule
from presswork.explicit.tools import ToolsOfRun
from presswork.law.umat import TOLD, SheetLaw, SheetUmat
from presswork.mesh.topology import is_triangle, with_four_nodes

Array = npt.NDArray[np.float64]
FREEDOMS = "uvwpqr"
SAFETY = 0.9
"""Time step over the bound of the stable one."""
Precision = Literal["double", "single"]
PHASES = ("nodes", "shells", "contact", "waiting")
LOOPS: dict[str, type[_core.ShellLoop] | type[_core.ShellLoopSingle]] = {
    "double": _core.ShellLoop,
    "single": _core.ShellLoopSingle,
}


def order_along_curve(points: Array) -> npt.NDArray[np.intp]:
    """Give the order of points (n, 3) along a Morton curve: neighbours in space come near each other in memory."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / max(float((high - low).max()), 1e-300) * 1023).astype(np.uint64)
    code = np.zeros(len(points), dtype=np.uint64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return np.argsort(code, kind="stable")


class ExplicitShells(LayersOfRun, ToolsOfRun, BeadsOfRun):
    """4-node and 3-node shells in explicit dynamics.

    points (n_nodes, 3) [mm]; connectivity (n, 4), nodes in turn round each shell, a triangle with its last node twice,
    or (n, 3) of triangles alone; thickness [mm], one or (n); law in plane stress: law.umat.open_sheet_law makes it of a
    material; density [t/mm3]; axis: x of the law (rolling direction), one vector or (n, 3), projected on each shell.
    hanging: nodes that follow the ends of sides (n, 7), as SplitMesh.hanging gives them.
    precision: "single" computes shells and velocities in single precision, positions and energies in double: about half
    the time and memory; docs/theory/explicit.md says where it is good enough.
    Elements and nodes are renumbered inside for the sake of the cache; every array here is in the order given.
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        connectivity: npt.ArrayLike,
        thickness: npt.ArrayLike,
        law: SheetLaw,
        density: float,
        *,
        axis: npt.ArrayLike = (1.0, 0.0, 0.0),
        options: ShellOptions | None = None,
        precision: Precision = "double",
        hanging: npt.ArrayLike = (),
    ) -> None:
        options = options or ShellOptions()
        if precision not in LOOPS:
            raise ExplicitError(f"precision = {precision!r}: give 'double' or 'single'")
        x = np.array(points, dtype=float)
        cells = with_four_nodes(np.array(connectivity, dtype=np.int32))
        sheet = np.broadcast_to(np.asarray(thickness, dtype=float), len(cells)).copy()
        axes = np.broadcast_to(np.asarray(axis, dtype=float), (len(cells), 3))
        check_shells(x, cells, sheet, density, axes)
        curve = order_along_curve(x[cells].mean(axis=1))
        triangular = is_triangle(cells)
        kinds = [(part, n) for n in (4, 3) if len(part := curve[triangular[curve] == (n == 3)])]
        self._elements = np.concatenate([part for part, _ in kinds])
        self._counts = [len(part) for part, _ in kinds]
        first = cells[curve].ravel()
        _, at = np.unique(first, return_index=True)
        used = first[np.sort(at)]
        self._nodes = np.concatenate([used, np.setdiff1d(np.arange(len(x)), used)])
        place = np.empty(len(x), dtype=np.int32)
        place[self._nodes] = np.arange(len(x))
        self._young, self._poisson = law.young, law.poisson
        self.start, self.connectivity, self.axis, self.options = x, cells, axes, options
        if isinstance(law, SheetUmat) and precision != "double":
            raise ExplicitError(f"precision = {precision!r}: a UMAT computes in double precision")
        height, weight = layer_rule(options.n_points, options.rule)
        self._loop = LOOPS[precision](x[self._nodes])
        self._loop.ironing = options.ironing
        try:
            for part, n in kinds:
                self._loop.add_shells(
                    place[cells[part, :n]],
                    sheet[part],
                    np.ascontiguousarray(axes[part]),
                    law.umat if isinstance(law, SheetUmat) else law,
                    density,
                    height,
                    weight,
                    tabulate=options.tabulate,
                    treatment=options.treatment,
                    viscous=options.hourglass == "viscous",
                    hourglass=options.coefficients,
                    elastic=(law.young, law.poisson),
                    number=part.tolist() if isinstance(law, SheetUmat) else [],
                )
        except ValueError as error:
            raise ExplicitError(str(error)) from None
        follow = np.array(hanging, dtype=np.int32).reshape(-1, 7)
        if len(follow):
            self._loop.set_hanging(place[follow])
        self._fixed = np.zeros((len(x), 6), dtype=np.uint8)
        self._prescribed = np.zeros((len(x), 6))
        self._reference: tuple[float, float] | None = None
        self.cycle = 0
        self.time = 0.0
        self.dt = SAFETY * self.stable_step()
        self._mass = self._loop.element_mass
        self._start_tools()
        self._start_beads()

    def _by_node(self, inside: Array) -> Array:
        out = np.empty_like(inside)
        out[self._nodes] = inside
        return out

    @property
    def position(self) -> Array:
        """Positions (n_nodes, 3) [mm]."""
        return self._by_node(self._loop.position)

    @property
    def velocity(self) -> Array:
        """Velocities and angular velocities (n_nodes, 6) [mm/s, 1/s], half a step back."""
        return self._by_node(self._loop.velocity)

    @velocity.setter
    def velocity(self, value: npt.ArrayLike) -> None:
        self._loop.velocity = self._shaped(value, "velocity")[self._nodes]
        self._reference = None

    @property
    def force(self) -> Array:
        """Nodal forces and moments from outside (n_nodes, 6) [N, N mm]."""
        return self._by_node(self._loop.force)

    @force.setter
    def force(self, value: npt.ArrayLike) -> None:
        self._loop.force = self._shaped(value, "force")[self._nodes]

    def _shaped(self, value: npt.ArrayLike, name: str) -> Array:
        return check_nodal(value, name, self._fixed.shape)

    @property
    def internal_force(self) -> Array:
        """Internal forces and moments (n_nodes, 6) [N, N mm], less the forces of tools."""
        return self._by_node(self._loop.internal_force)

    @property
    def reaction_impulse(self) -> Array:
        """Impulse of what holds prescribed freedoms since reset_reaction (n_nodes, 6) [N s, N mm s]."""
        return self._by_node(self._loop.reaction_impulse)

    def reset_reaction(self) -> None:
        """Begin a new sum of reaction_impulse."""
        self._loop.reaction_impulse = np.zeros((len(self.position), 6))

    def trial_force(self, increment: npt.ArrayLike) -> Array:
        """Give the internal force (n_nodes, 6) after an increment of displacement and rotation; nothing is changed."""
        return self._by_node(self._loop.trial_force(self._shaped(increment, "increment")[self._nodes]))

    @property
    def mass(self) -> Array:
        """Mass and rotary inertia of each node (n_nodes, 2) [t, t mm2]; 0 at nodes without a shell."""
        inverse = self._by_node(self._loop.inverse_mass)
        return np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0)

    def fix(self, nodes: npt.ArrayLike, freedoms: str, velocity: npt.ArrayLike = 0.0) -> None:
        """Prescribe the velocity [mm/s or 1/s], one or one for each node, of freedoms: letters of "uvwpqr"."""
        unknown = set(freedoms) - set(FREEDOMS)
        if unknown or not freedoms:
            raise ExplicitError(f"freedoms = {freedoms!r}: give letters of {FREEDOMS!r}")
        for letter in freedoms:
            self._fixed[np.asarray(nodes), FREEDOMS.index(letter)] = 1
            self._prescribed[np.asarray(nodes), FREEDOMS.index(letter)] = velocity
        self._loop.prescribe(self._fixed[self._nodes], self._prescribed[self._nodes])

    def release(self) -> None:
        """Let every freedom go that fix has prescribed."""
        self._fixed[:] = 0
        self._prescribed[:] = 0.0
        self._loop.prescribe(self._fixed, self._prescribed)

    def stable_step(self) -> float:
        """Give the bound of the stable time step [s] of the shells as they are now."""
        return float(2.0 / np.sqrt(self.bound_frequencies().max()))

    def bound_frequencies(self) -> Array:
        """Give the bound of each shell's highest frequency squared (n) [1/s2] as it is now."""
        return self._by_element(self._loop.bound_frequencies())

    def scale_mass(self, target_step: float) -> MassScaling:
        """Add mass to shells whose stable step is below the target [s], take the target as the step; report the mass.

        The safety factor is kept: the shells' bound becomes target_step/0.9. Mass once added stays. The kinetic energy
        that it brings is no error of the balance.
        """
        if not target_step > 0:
            raise ExplicitError(f"target_step = {target_step}: it must be above zero")
        before = self._loop.energies(self.dt).kinetic
        factor = self._loop.bound_frequencies() * (0.5 * target_step / SAFETY) ** 2
        now = self._loop.element_mass * np.maximum(factor, 1.0)
        self._loop.element_mass = now
        self.dt = target_step
        self._contact_step = 0.0
        if self._reference:
            start, largest = self._reference
            self._reference = (start + self._loop.energies(self.dt).kinetic - before, largest)
        return MassScaling(float(self._mass.sum()), float((now - self._mass).sum()), int((now > self._mass).sum()))

    def advance(
        self,
        n: int,
        *,
        force_scale: float | npt.ArrayLike = 1.0,
        velocity_scale: float | npt.ArrayLike = 1.0,
        damping: float = 0.0,
    ) -> None:
        """Advance n cycles of `dt`.

        force_scale, velocity_scale: factors on force and on prescribed velocities, one or one for each cycle.
        damping: mass damping [1/s]; a mode of angular frequency w loses the fraction damping/(2 w) of critical.
        Raises ExplicitError when a material law finds no stress, or the motion is no longer finite.
        """
        scales = [np.broadcast_to(np.asarray(s, dtype=float), n).copy() for s in (force_scale, velocity_scale)]
        self._prepare_tools(scales[1])
        self._prepare_beads(n)
        if self._reference is None:
            start = sum_energies(self._energies(damping, force_scale, velocity_scale))
            self._reference = (start, abs(start))
        self._loop.time = self.time
        shell, cycle, status = self._loop.advance(self.dt, *scales, damping=damping)
        if shell >= 0:
            done = self.cycle + cycle + 1
            when = f"in cycle {done} (t = {self.time + (cycle + 1) * self.dt:g} s)"
            if status != _core.LawStatus.no_stress:
                raise ExplicitError(f"{TOLD[status]} in shell {self._elements[shell]} {when}: shorten the step")
            raise ExplicitError(
                f"the material law of shell {self._elements[shell]} has failed {when}, it finds no stress for the "
                f"strain of this step: the step {self.dt:g} s is too long, the shell has collapsed, or the law's "
                "parameters are not those of a metal"
            )
        self.cycle += n
        self.time += n * self.dt
        finite = np.isfinite(self.position).all(axis=1)
        if not finite.all():
            allowed = SAFETY * self.stable_step()
            now = f" (the shells allow {allowed:g} s now)" if np.isfinite(allowed) else ""
            raise ExplicitError(
                f"node {np.argmin(finite)} has left for infinity by cycle {self.cycle} (t = {self.time:g} s): "
                f"the step {self.dt:g} s is too long{now}, its shells have collapsed, or their material law has failed"
            )
        self._check_tools()

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time of `advance` by phase [s]: of motion, of shells, of contact with tools and beads, of waiting."""
        return dict(zip(PHASES, self._loop.seconds, strict=True))

    def inherit(
        self,
        other: ExplicitShells,
        position: npt.ArrayLike,
        node_parents: npt.NDArray[np.int32],
        parent: npt.NDArray[np.int32],
    ) -> float:
        """Begin with the state of another run some shells of which are split here, at positions (n_nodes, 3).

        parent: shell of the other run that each comes from, or is (n,); node_parents: nodes of it whose mean velocity
        and traction each node gets (n_nodes, 4). Tools must be like those of the other run. Mass goes by undeformed
        area. Returns the kinetic energy that interpolation has taken [N mm], which is no error of the balance.
        """
        before = other._loop.energies(other.dt).kinetic
        area = self._by_element(self._loop.element_mass)
        share = area / np.bincount(parent, area)[parent]
        share[np.bincount(parent)[parent] == 1] = 1.0
        place, element_place = np.empty(len(other.start), np.int32), np.empty(len(other.connectivity), np.int32)
        place[other._nodes], element_place[other._elements] = np.arange(len(place)), np.arange(len(element_place))
        loop: Any = self._loop  # of the same precision as the other
        loop.inherit(
            other._loop,
            np.asarray(position, dtype=float)[self._nodes],
            np.ascontiguousarray(place[node_parents][self._nodes]),
            element_place[parent[self._elements]],
            share[self._elements],
            other.dt,
        )
        if other.given_temperature is not None:
            self.given_temperature = other.given_temperature[parent]
        self.cycle, self.time = other.cycle, other.time
        self.dt = min(other.dt, SAFETY * self.stable_step())
        self._contact_step, self._new_tools = other._contact_step, []
        lost = before - self._loop.energies(self.dt).kinetic
        if other._reference:
            start, largest = other._reference
            self._reference = (start - lost, largest)
        return lost

    def _energies(self, damping: float, force_scale: object, velocity_scale: object) -> _core.Energies:
        first = [float(np.ravel(np.asarray(s, dtype=float))[0]) for s in (force_scale, velocity_scale)]
        return self._loop.energies(self.dt, damping=damping, force_scale=first[0], velocity_scale=first[1])

    def energies(self, *, damping: float = 0.0, force_scale: float = 1.0, velocity_scale: float = 1.0) -> EnergyBalance:
        """Give the energies now; damping and the scales are those of the next cycle."""
        balance, reference = compute_balance(self._energies(damping, force_scale, velocity_scale), self._reference)
        if self._reference:
            self._reference = reference
        return balance

    def dump(self) -> dict[str, Array]:
        """Give everything that the next cycle depends on, beside what the constructor, fix and force were given."""
        position, velocity, states, forces, external, damping = self._loop.dump()
        reference = self._reference or (np.nan, np.nan)
        scalars = np.array([self.cycle, self.time, self.dt, external, damping, *reference, self._contact_step])
        return {
            "position": position,
            "velocity": velocity,
            "state": np.concatenate([state.ravel() for state in states]),
            "forces": forces,
            "element_mass": self._loop.element_mass,
            "temperature": np.zeros(0) if self.given_temperature is None else self.given_temperature,
            "contact": self._loop.dump_contact(),
            "beads": self._loop.dump_beads(),
            "scalars": scalars,
        }

    def restore(self, dump: dict[str, Array]) -> None:
        """Take over what dump gave: the run goes on with the same bits as one never stopped."""
        cycle, self.time, self.dt, external, damping, start, largest, step = (float(s) for s in dump["scalars"])
        self.cycle = int(cycle)
        self._reference = None if np.isnan(start) else (start, largest)
        self._loop.element_mass = dump["element_mass"]
        sizes = [state.shape for state in self._loop.dump()[2]]
        parts = np.split(dump["state"], np.cumsum([n * rows for n, rows in sizes])[:-1])
        states = [part.reshape(size) for part, size in zip(parts, sizes, strict=True)]
        self._loop.restore(dump["position"], dump["velocity"], states, dump["forces"], external, damping)
        if dump["temperature"].size:
            self.given_temperature = dump["temperature"]
        self._restore_tools(dump["contact"], step)
        self._restore_beads(dump["beads"])
