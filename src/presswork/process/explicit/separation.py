# SPDX-License-Identifier: Apache-2.0
"""Separation in an explicit run in the plane: cracks grow where the mean damage is critical, and are cut into the mesh.

Before every row the mean damage of the cells is found as the observer of damage finds it (observe/neighbourhood.py).
Tips of cracks grow along its ridge, then new cracks begin (remesh/crack_path.py). They are slits of the outline
(remesh/slit.py), which the next mesh has. The metal of the slits is given back along the free surface.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, FloatArray, Separation
from presswork.observe.contract import History, Observed, Row
from presswork.observe.cut_edge import measure_cut_edge
from presswork.observe.damage_length import find_lengths
from presswork.observe.neighbourhood import FormedBlock
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.moving_section import MovingSection
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.process.mesh_change.contract import MeshChange
from presswork.remesh.crack_path import CrackPath, DamagedSection
from presswork.remesh.old_section import OldSection, with_cracks
from presswork.remesh.size_field import SizeSources
from presswork.remesh.slit import Mouth, Outline, Slit, cut_outline, place_mouth
from presswork.remesh.volume import enclosed_volume

OF_LENGTH = 0.5
"""Size of cells where cracks grow over the length over which damage is averaged, where none is given."""
WIDTH = 0.1
"""Width of slits over the smallest size of cells."""
MOST_CRACKS = 8
"""Cracks that begin before one row at most."""
DAMAGED = 0.3
"""Mean damage over the critical one from which on cells have the size of cracks."""
CHIP = 1.0
"""Least area of a piece that counts, over the square of the length."""


class DamageOfRow(MeshChange):
    """What the damage of each cell has gained in the last row; it comes last among the changes of a mesh."""

    def __init__(self, run: ExplicitForming) -> None:
        self._run, self._begin = run, find_damage(run)[0].copy()
        self.gained: FloatArray | None = None
        """In each cell (n_cells,); None: not known."""

    def look(self, failure: str = "") -> bool:
        """Note what a row begins with."""
        self._begin = find_damage(self._run)[0].copy()
        return False

    def end_step(self) -> None:
        """Find what the row has added."""
        now = find_damage(self._run)[0]
        self.gained = now - self._begin if len(now) == len(self._begin) else None

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what the last row has added."""
        return {} if self.gained is None else {"damage_gained": self.gained}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self.gained = np.array(arrays["damage_gained"]) if "damage_gained" in arrays else None


class CrackGrowth(MeshChange):
    """Cuts cracks into the mesh of the one body of a run in the plane."""

    def __init__(
        self,
        run: ExplicitForming,
        settings: Separation,
        meshes: IntervalMeshes[OldSection],
        bodies: MovingSection,
        row: DamageOfRow,
    ) -> None:
        """meshes: makes new meshes of the run with the cracks that bodies are given; row: what a row has added."""
        self._run, self._meshes, self._bodies, self._row = run, meshes, bodies, row
        damage, (found,) = run.model.materials[run.model.mesh.blocks[0].material].damage, find_lengths(run.model)
        length = found if damage is None or damage.length is None else damage.length
        assert length is not None
        self._length = length
        self._size = OF_LENGTH * length if settings.size is None else settings.size
        self._pieces, self._begun = 1, 0
        self._most_gained = 0.0
        """Largest growth of a mean in a row."""
        self._instants = np.full((2, 2), np.nan)
        """Time [s] and stroke [mm] at which the first crack begins, and at which the body parts."""
        self._edges = np.zeros((0, 6))
        """For each piece, as the body parts: zones of the edge as CutEdge has them, and how far it has moved [mm]."""

    # --- its reports -------------------------------------------------------------------------------------------------

    def columns(self, run: Observed) -> list[str]:
        """Return the numbers of cracks begun and of pieces."""
        return ["cracks", "pieces"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the values of its columns."""
        return {"cracks": self._begun, "pieces": self._pieces}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return when cracks begin, when the body parts, what that takes, and the zones of the edges."""
        found: dict[str, Any] = {"cracks": self._begun, "pieces": self._pieces}
        for name, (time, stroke) in zip(("first_crack", "parted"), self._instants, strict=True):
            if np.isfinite(time):
                found[name] = {"time_s": float(time), "stroke_mm": float(stroke)}
        found |= self._measure_work(history)
        if len(self._edges):
            order = np.argsort(self._edges[:, 5])
            names = ["sheet", *("slug" for _ in order[1:])]
            found["edges"] = [
                {"piece": name, **_describe_edge(self._edges[i])} for name, i in zip(names, order, strict=True)
            ]
        return {"separation": found}

    def _measure_work(self, history: History) -> dict[str, float]:
        """Return the largest force of the tool that has moved farthest, and its work until the body has parted."""
        if not len(history.get("time", ())) or not any(np.any(wall.displacement) for wall in self._run.walls):
            return {}
        tool = max(self._run.walls, key=lambda wall: float(np.linalg.norm(wall.displacement)))
        direction = np.asarray(tool.displacement) / np.linalg.norm(tool.displacement)
        force = -sum(history[f"{tool.name}.force_{axis}"] * share for axis, share in zip("xy", direction, strict=True))
        stroke, parted = history[f"{tool.name}.stroke"], self._instants[1, 0]
        own = history["time"] <= parted if np.isfinite(parted) else np.ones(len(stroke), dtype=bool)
        steps = np.diff(stroke, prepend=0.0)  # forces are means over their rows
        return {"largest_force_N": float(force.max()), "work_J": 1e-3 * float((force * steps)[own].sum())}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return counts, instants and edges."""
        counts = np.array([self._pieces, self._begun, self._most_gained])
        return {"separation.counts": counts, "separation.instants": self._instants, "separation.edges": self._edges}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._pieces, self._begun = (int(number) for number in arrays["separation.counts"][:2])
        self._most_gained = float(arrays["separation.counts"][2])
        self._instants = np.array(arrays["separation.instants"], dtype=float)
        self._edges = np.array(arrays["separation.edges"], dtype=float)

    # --- how cracks grow ---------------------------------------------------------------------------------------------

    def look(self, failure: str = "") -> bool:
        """Let cracks grow, and go on with a mesh that has them; return whether there is one."""
        if failure:
            return False
        (old,) = self._bodies.find(np.zeros_like(self._run.positions()))
        section = self._measure(old)
        for grows, begins in ((True, True), (True, False), (False, True)):
            cuts = _Cuts(old, section, WIDTH * self._bodies.smallest_size)
            try:
                if grows:
                    cuts.grow(self._bodies.tips)
                if begins:
                    cuts.begin(self._bodies.cracked)
            except MeshError as error:
                self._run.notes.append(f"no crack is cut: {error}")
                continue
            if not cuts.words:
                return False
            self._bodies.cut(cuts.outline, cuts.tips + ([] if grows else [old.position[i] for i in self._bodies.tips]))
            if self._meshes.remesh("; ".join(cuts.words)):
                self._note(cuts.n_begun)
                return True
            self._bodies.cut(None, [])
        return False

    def _measure(self, old: OldSection) -> DamagedSection:
        """Return the mean damage of the cells, and let cells be small where it is large."""
        run, length = self._run, self._length
        damage, critical = find_damage(run)
        block = FormedBlock(run.model, run.mesh, run.positions(), 0)
        gained = damage if self._row.gained is None else self._row.gained
        chosen = np.flatnonzero(damage > DAMAGED * critical)
        means, gains = np.zeros(len(damage)), np.zeros(len(damage))
        if len(chosen):
            layer, radii = np.zeros(len(chosen), dtype=np.intp), np.full(len(chosen), length)
            means[chosen] = block.average(damage[:, None], chosen, layer, radii)
            gains[chosen] = block.average(gained[:, None], chosen, layer, radii)
        middles = old.position[old.corners()].mean(axis=1)
        near = middles[means > DAMAGED * critical]
        self._bodies.crack_sizes = SizeSources(near, np.full(len(near), self._size)) if len(near) else None
        self._most_gained = max(self._most_gained, float(gains.max(initial=0.0)))
        return DamagedSection(middles, means / critical, gains, length, self._most_gained)

    def _note(self, n_begun: int) -> None:
        """Note what new cracks have done to the body."""
        run = self._run
        now = np.array([run.solids.time, self._find_stroke()])
        if self._begun == 0:
            self._instants[0] = now
        self._begun += n_begun
        (new,) = self._bodies.find(np.zeros_like(run.positions()))
        chip = CHIP * self._length**2
        pieces = [chain for chain in new.chains if enclosed_volume(new.position[chain], ring=False) > chip]
        if len(pieces) > self._pieces:
            self._pieces = len(pieces)
            if np.isnan(self._instants[1, 0]):
                self._instants[1] = now
                self._measure_edges(new, pieces)

    def _find_stroke(self) -> float:
        """Return how far the tool has moved that has moved farthest [mm]."""
        return max((float(np.linalg.norm(wall.displacement)) for wall in self._run.walls), default=0.0)

    def _measure_edges(self, new: OldSection, pieces: list[NDArray[np.intp]]) -> None:
        """Measure the edges of the pieces."""
        walls = self._run.walls
        moved = max(
            (wall.displacement for wall in walls), key=lambda travel: float(np.linalg.norm(travel)), default=None
        )
        if moved is None or not np.any(moved):
            return
        direction = moved / np.linalg.norm(moved)
        travelled, found = self._run.moved(new.position - self._run.model.mesh.points) @ direction, []
        for piece in pieces:
            edge = measure_cut_edge(new.position[piece], self._bodies.cracked[piece], direction)
            if edge is not None:
                zones = (edge.rollover, edge.sheared, edge.fracture, edge.burr, edge.thickness)
                found.append([*zones, float(travelled[piece].mean())])
        self._edges = np.array(found, dtype=float).reshape(-1, 6)


class _Cuts:
    """The cracks that are cut into a section before one row."""

    def __init__(self, old: OldSection, section: DamagedSection, width: float) -> None:
        self._old, self._section, self._width = old, section, width
        self.outline = Outline(old.position, tuple(old.chains), tuple(old.firm))
        self.tips: list[FloatArray] = []
        """Where tips are then (2,) [mm]."""
        self.words: list[str] = []
        self.n_begun = 0
        self._grown: list[FloatArray] = []

    def grow(self, nodes: list[int]) -> None:
        """Let cracks grow from their tips, by their nodes. Raises MeshError."""
        waiting = {tip: self._old.position[tip] for tip in nodes}
        rests: dict[int, FloatArray] = {}
        """Tips that have grown, or that do not grow, by their numbers in the outline."""
        for tip in nodes:
            place = waiting.pop(tip, None)
            if place is None:  # another crack has met it
                continue
            self._see(waiting | rests)
            path = self._section.grow(place, find_heading(self._old, tip))
            if path is None:
                rests[tip] = place
                continue
            self._cut(path, Mouth(tip, is_tip=True), "grows")
            if path.met is not None:
                waiting.pop(path.met, None)
                rests.pop(path.met, None)
            elif not path.ends_outside:
                away = np.linalg.norm(self.outline.points - path.points[-1], axis=1)
                rests[int(np.argmin(away))] = path.points[-1]
        self.tips = [*rests.values()]

    def begin(self, cracked: BoolArray) -> None:
        """Let cracks begin; cracked: nodes on faces of cracks (n_points,). Raises MeshError."""
        faces = self._old.position[cracked] if len(cracked) else np.zeros((0, 2))
        for _ in range(MOST_CRACKS):
            self._see({})
            path = self._section.find_new(np.concatenate([faces, *self._grown]))
            if path is None:
                break
            begin = None if path.begins_inside else place_mouth(self.outline, path.points[0], self._may_open())
            self._cut(path, begin, "begins")
            self.tips += [path.points[0]] if path.begins_inside else []
            self.n_begun += 1

    def _see(self, tips: Mapping[int, FloatArray]) -> None:
        """Show the section the outline as it is now, and the tips that may be met."""
        now = with_cracks(self._old, self.outline)
        self._section.see(now.sides, ~now.held_sides, tips)

    def _cut(self, path: CrackPath, begin: Mouth | None, verb: str) -> None:
        end = None
        if path.met is not None:
            end = Mouth(path.met, is_tip=True)
        elif path.ends_outside:
            end = place_mouth(self.outline, path.points[-1], self._may_open())
        else:
            self.tips.append(path.points[-1])
        self.outline = cut_outline(self.outline, Slit(path.points, self._width, begin, end))
        self._grown.append(path.points)
        (x0, y0), (x1, y1) = path.points[0], path.points[-1]
        through = " through the metal" if path.ends_outside else ""
        self.words.append(f"a crack {verb} from ({x0:.4g}, {y0:.4g}) to ({x1:.4g}, {y1:.4g}){through}")

    def _may_open(self) -> BoolArray:
        """Mark the points of the outline at which a crack may begin or end (n,)."""
        allowed = np.ones(len(self.outline.points), dtype=bool)
        allowed[: len(self._old.position)] = ~self._old.fixed.any(axis=1)
        allowed[list(self.outline.firm)] = False
        return allowed


def find_heading(old: OldSection, tip: int) -> FloatArray:
    """Return the direction in which the tip of a crack points (2,)."""
    loop = next(chain for chain in old.chains if tip in chain)
    at = int(np.flatnonzero(loop == tip)[0])
    beside = 0.5 * (old.position[loop[at - 1]] + old.position[loop[(at + 1) % len(loop)]])
    heading = old.position[tip] - beside
    return np.asarray(heading / np.linalg.norm(heading))


def find_damage(run: ExplicitForming) -> tuple[FloatArray, float]:
    """Return the damage of the cells (n_cells,) and its critical value."""
    evolved = run.evolved()
    name = next(name for name, of_blocks in evolved.critical.items() if of_blocks[0] is not None)
    critical = evolved.critical[name][0]
    assert critical is not None
    return evolved.values[name][0][:, 0], critical


def _describe_edge(edge: FloatArray) -> dict[str, float]:
    """Return the heights of an edge [mm] by name."""
    names = ("rollover_mm", "sheared_mm", "fracture_mm", "burr_mm", "thickness_mm")
    return {name: float(value) for name, value in zip(names, edge, strict=False)}
