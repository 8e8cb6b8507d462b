# SPDX-License-Identifier: Apache-2.0
"""Read an output folder: the one place through which pictures and users see a run's results."""

from __future__ import annotations

import difflib
import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from presswork.fields.formability_fields import FORMABILITY_FIELDS
from presswork.fields.table import find_aliases, find_row, to_scalar
from presswork.formability import PATH_MARGINS, ZONE, Formability
from presswork.geometry.pose import ToolPose, find_pose_since, place_points, place_segments
from presswork.model import FloatArray, IntArray
from presswork.results.dies import read_dies
from presswork.results.folder import HISTORY, RESULTS, SUMMARY
from presswork.results.history import read_history
from presswork.results.vtkhdf import locate_mesh, open_file, open_results, report_damage
from presswork.results.vtkhdf_tools import find_body
from presswork.results.whole_file import OutputError

if TYPE_CHECKING:
    import pandas

    from presswork.results.dataframe import Rows

T = TypeVar("T")


class ResultError(OutputError):
    """The results do not hold what was requested; the message lists what they hold."""


@dataclass(frozen=True)
class ResultBlock:
    """Cells of one kind."""

    element: str
    """Element name, as in the case."""
    vtk_type: int
    connectivity: NDArray[np.int64]
    """Node indices, shape (n_cells, n_nodes): corners, mid-sides, centre."""


@dataclass(frozen=True)
class ResultMesh:
    """The undeformed mesh."""

    points: FloatArray
    """Coordinates [mm], shape (n_points, 2); of shells and of solids in space (n_points, 3)."""
    blocks: tuple[ResultBlock, ...]
    boundary_edges: NDArray[np.int64]
    """Shape (n_edges, 2 | 3): first end, last end[, mid-side], the body on the left."""


class Result:
    """The results of one run. Opening only looks whether the files are there; each call reads what it returns."""

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        self._file: h5py.File | None = None
        self._kept: dict[str, Any] = {}
        self._meshes: dict[int, ResultMesh] = {}
        if not self.folder.is_dir():
            raise ResultError(f"there is no folder {self.folder}")
        if not (self.folder / RESULTS).is_file():
            raise ResultError(f"{self.folder} holds no {RESULTS}: it is not an output folder, or nothing was saved yet")

    def _repr_html_(self) -> str:
        """Return the page of the run in a frame, for notebooks."""
        return str(resolve_name("presswork.notebook:show_result")(self))

    @property
    def summary(self) -> dict[str, Any]:
        """Summary of the run; empty until the run ends."""
        path = self.folder / SUMMARY
        if not path.is_file():
            return {}
        try:
            content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        except (ValueError, RecursionError) as error:
            raise ResultError(f"{path} is damaged: {error}") from error
        if not isinstance(content, dict):
            raise ResultError(f"{path} is damaged: it is not a table")
        return content

    @property
    def history(self) -> dict[str, NDArray[Any]]:
        """Every column of history.csv, shape (n_increments,)."""
        return self.keep(HISTORY, lambda: read_history(self.folder / HISTORY))

    @property
    def times(self) -> FloatArray:
        """Times of the saved steps [s], shape (n_steps,)."""
        with self._open() as file:
            return np.asarray(find_body(file)["Steps/Values"][()], dtype=np.float64)

    @cached_property
    def info(self) -> dict[str, Any]:
        """Description of the run as texts, numbers and arrays: title, analysis, forming limit."""
        with self._open() as file:
            return {
                name: value.item() if np.ndim(value) == 0 and hasattr(value, "item") else value
                for name, value in _attributes(file)
            }

    @property
    def formability(self) -> Formability:
        """Forming limit of the sheet; it has no curve if the material had none."""
        return Formability.from_info(self.info)

    @property
    def zones(self) -> list[str]:
        """Names of the zones of a welded blank, the remaining blank first; empty without."""
        return str(self.info["zones"]).split("\n") if "zones" in self.info else []

    def judged_at(self, step: int = -1) -> list[tuple[Formability, int]]:
        """Return what the strains of a saved step are judged by: that of so many cells, then of so many more."""
        counts = [len(block.connectivity) for block in self.mesh_at(step).blocks]
        if not self.zones:
            return [(self.formability, sum(counts))]
        zone = self.field("zone", step)[np.cumsum([0, *counts[:-1]])]
        return [(self.limits[int(number)], n) for number, n in zip(zone, counts, strict=True)]

    @cached_property
    def limits(self) -> dict[int, Formability]:
        """Forming limits of the zones of a welded blank, by number."""
        numbers = range(len(self.zones))
        return {
            i: Formability.from_info(self.info, f"{ZONE}{i}_")
            for i in numbers
            if f"{ZONE}{i}_safety_margin" in self.info
        }

    @cached_property
    def mesh(self) -> ResultMesh:
        """The undeformed mesh; where it changes in a run, that of the first step."""
        return self.mesh_at(0)

    def mesh_at(self, step: int = -1) -> ResultMesh:
        """Return the undeformed mesh of a saved step, for example that of a trimmed sheet instead of the first."""
        with self._open() as file:
            parts = self._whole(find_body(file), "Steps/PartOffsets")
            part = int(parts[self._index(step, len(parts))])
        if part not in self._meshes:
            self._meshes[part] = self._read_mesh(part)
        return self._meshes[part]

    def _read_mesh(self, part: int) -> ResultMesh:
        with self._open() as file:
            root, extras, place = find_body(file), file[f"presswork/meshes/{part}"], locate_mesh(file, part)
            connectivity, types = root["Connectivity"][place.ids], root["Types"][place.cells]
            offsets = root["Offsets"][place.offsets]
            blocks, first = [], 0
            for element, count in zip(extras["element"].asstr()[()], extras["n_cells"][()], strict=True):
                ids = connectivity[offsets[first] : offsets[first + count]].reshape(count, -1)
                blocks.append(ResultBlock(element, int(types[first]), ids))
                first += count
            edges = extras["boundary_edges"][()].astype(np.int64)
            points = root["Points"][place.points, : self._dimension]
            for ids in [edges, *(block.connectivity for block in blocks)]:
                if ids.size and not 0 <= ids.min() <= ids.max() < len(points):
                    raise ValueError("cells use points that are not there")
            return ResultMesh(points, tuple(blocks), edges)

    @cached_property
    def tools(self) -> dict[str, FloatArray]:
        """Each tool's profile where it started, shape (n_segments, 7) as in model.Tool; empty if not saved."""
        with self._open() as file:
            return {name: tool["segments"][()] for name, tool in file["presswork"].get("tools", {}).items()}

    @cached_property
    def surfaces(self) -> dict[str, tuple[FloatArray, IntArray]]:
        """Points (n, 3) and triangles (n, 3) of the tools in space, where they started."""
        with self._open() as file:
            saved = file["presswork"].get("surfaces", {})
            return {name: (tool["points"][()], tool["triangles"][()]) for name, tool in saved.items()}

    def tools_at_work(self, step: int = -1) -> list[str]:
        """Return the tools in space of the operation that a saved step belongs to; of one operation all."""
        return [name for name in self.surfaces if np.isfinite(self.surface_displacement(name, step)).all()]

    def operation_at(self, step: int = -1) -> str:
        """Return the name of the operation of a press line that a saved step belongs to; empty without a line."""
        names = str(self.info.get("operations", "")).split("\n")
        tools = self.tools_at_work(step)
        of_tools = [name for name in names if name and any(tool.startswith(f"{name}_") for tool in tools)]
        return max(of_tools, key=len, default="")  # a name may begin with another one

    def plan_at(self, step: int = -1) -> FloatArray:
        """Return how x and y of the blank lie at a saved step, as in `place` of operations: turn and shift (2, 3)."""
        plans, name = self.info.get("plans"), self.operation_at(step)
        if plans is None or not name:
            return np.eye(2, 3)
        return np.asarray(plans[str(self.info["operations"]).split("\n").index(name)], dtype=np.float64)

    def surface_displacement(self, tool: str, step: int = -1) -> FloatArray:
        """Return how far a tool in space has moved since the start [mm], shape (3,); NaN where it is not at work."""
        return self.surface_motion(tool, step)[0]

    def surface_motion(self, tool: str, step: int = -1) -> tuple[FloatArray, FloatArray]:
        """Return how far a tool in space has moved [mm] and turned about its centre [rad] since the start.

        Both have shape (3,); what it has turned is a vector along the axis, its length the angle.
        """
        self._require(tool, self.surfaces, "tool")
        with self._open() as file:
            names = ("displacement", "rotation")
            moved, turned = (self._whole(file, f"presswork/surfaces/{tool}/{name}") for name in names)
            index = self._index(step, len(moved))
            return np.asarray(moved[index], dtype=np.float64), np.asarray(turned[index], dtype=np.float64)

    def surface_centre(self, tool: str) -> FloatArray:
        """Return the point about which a tool in space turns where it was at the start [mm], shape (3,)."""
        self._require(tool, self.surfaces, "tool")
        with self._open() as file:
            return np.asarray(file[f"presswork/surfaces/{tool}/centre"][()], dtype=np.float64)

    def placed_surface(self, tool: str, step: int = -1) -> FloatArray:
        """Return the points of a tool in space where they are at a saved step [mm], shape (n, 3)."""
        pose = find_pose_since(self.surface_centre(tool), *self.surface_motion(tool, step))
        return pose.carry(self.surfaces[tool][0])

    @cached_property
    def field_names(self) -> dict[str, str]:
        """The saved fields, each with "point" or "cell"."""
        with self._open() as file:
            kinds = (("point", "PointData"), ("cell", "CellData"))
            found = {name: kind for kind, group in kinds for name in find_body(file)[group]}
            if not all(isinstance(name, str) for name in found):  # HDF5 gives bytes where it cannot decode a name
                raise ValueError("the name of a field is not text")
        return found

    def tool_displacement(self, tool: str, step: int = -1) -> FloatArray:
        """Return a tool's displacement since the start [mm], shape (2,)."""
        return self.tool_pose(tool, step).displacement

    def tool_pose(self, tool: str, step: int = -1) -> ToolPose:
        """Return where a tool stands."""
        self._require(tool, self.tools, "tool")
        with self._open() as file:
            names = ("centre", "displacement", "angle")
            centre, displacement, angle = (self._whole(file, f"presswork/tools/{tool}/{name}") for name in names)
            index = self._index(step, len(displacement))
            return ToolPose(centre, displacement[index], float(angle[index]))

    def dies(self, step: int = -1) -> dict[str, tuple[FloatArray, IntArray, FloatArray]]:
        """Return the meshes of tools that conduct heat, where they are at a saved step.

        They are, by tool: points (n, 2) [mm], cells (m, k) and temperatures (n,) [degrees C].
        """
        with self._open() as file:
            found = read_dies(file, step)
        return {
            name: (place_points(points, self.tool_pose(name, step)), cells, values)
            for name, (points, cells, values) in found.items()
        }

    def placed_tool(self, tool: str, step: int = -1) -> FloatArray:
        """Return a tool's profile where it is at a saved step, shape (n_segments, 7) as in model.Tool."""
        pose = self.tool_pose(tool, step)
        return place_segments(self.tools[tool], pose)

    def field(self, name: str, step: int = -1) -> FloatArray:
        """Return a field at a saved step, shape (n,) or (n, k), n points or cells; negative steps count from the end.

        "eqps" stands for equivalent_plastic_strain; "stress_xx" ... "stress_xy" for one component of the stress, and
        "displacement_x", "stress_top_xx", "lamina_stress_top_xx" and the like for one of another vector or tensor.
        """
        stored, component = self._resolve(name)
        group, count = ("PointData", "Points") if self.field_names[stored] == "point" else ("CellData", "Cells")
        with self._open() as file:
            root = find_body(file)
            offsets = self._whole(root, f"Steps/{group}Offsets/{stored}")
            index = self._index(step, len(offsets))
            part = self._whole(root, "Steps/PartOffsets")[index]
            n, start = int(self._whole(root, f"NumberOf{count}")[part]), int(offsets[index])
            values = np.asarray(root[f"{group}/{stored}"][start : start + n], dtype=np.float64)
            if len(values) != n:
                raise ValueError(f"{stored} has {len(values)} rows, not {n}")
        return values if component is None else values[:, component]

    def to_dataframe(self, rows: Rows = "history", step: int = -1) -> pandas.DataFrame:
        """Return a pandas table: history.csv, or the fields of all points or cells at a saved step.

        rows: "history" has a row an increment; "point" and "cell" have a column for every component of every field,
        and x, y (z) of the deformed point, or of the cell's middle [mm]; `.attrs["units"]` has the units of columns.
        Raises ResultError, without pandas too.
        """
        from presswork.results.dataframe import make_dataframe

        return make_dataframe(self, rows, step)

    def scalar(self, name: str, step: int = -1) -> FloatArray:
        """Return a field as one number per node or cell (n,), a vector's length. Raises ResultError for a tensor."""
        values = self.field(name, step)
        stored, component = self._resolve(name)
        found = values if component is not None else to_scalar(stored, values)
        if found is None:
            row = find_row(stored)
            first = row.components[0] if row else "xx"
            raise ResultError(f"{name} has {values.shape[1]} components; name one, for instance {name}_{first}")
        return found

    def unit(self, name: str) -> str:
        """Return a field's unit; "" if it is not known, "1" for a pure number."""
        stored, _ = self._resolve(name)
        with self._open() as file:
            group = "PointData" if self.field_names[stored] == "point" else "CellData"
            return str(find_body(file)[f"{group}/{stored}"].attrs.get("units", ""))

    def kind(self, name: str) -> str:
        """Return whether a field lives on the "point"s or the "cell"s."""
        return self.field_names[self._resolve(name)[0]]

    def points(self, step: int = -1) -> FloatArray:
        """Return the coordinates of the deformed mesh [mm], shape (n_points, 2); in space (n_points, 3)."""
        moved = self.field("displacement", step)[:, : self._dimension]
        return np.asarray(self.mesh_at(step).points + moved, dtype=np.float64)

    @property
    def is_shell(self) -> bool:
        """Whether the body is a sheet in space."""
        return self.is_stamping or self.info.get("analysis") in ("shell", "onestep")

    @property
    def is_space_solid(self) -> bool:
        """Whether the body is a solid in space."""
        return self.info.get("analysis") == "solid"

    @property
    def is_onestep(self) -> bool:
        """Whether this is a one-step run: the first step is the blank, the second the part."""
        return self.info.get("analysis") == "onestep"

    @property
    def is_line(self) -> bool:
        """Whether the part goes through several operations with tools of their own."""
        return bool(self.info.get("operations"))

    @property
    def is_stamping(self) -> bool:
        """Whether the body is a blank between tools in space."""
        return self.info.get("analysis") == "stamping"

    @property
    def _dimension(self) -> int:
        return 3 if self.is_shell or self.is_space_solid else 2

    def _resolve(self, name: str) -> tuple[str, int | None]:
        """Return the stored field and the component that a name stands for."""
        stored = find_aliases().get(name, name)
        base, _, component = stored.rpartition("_")
        row = find_row(base) if stored not in self.field_names and base in self.field_names else None
        if row and component in row.components:
            return base, row.components.index(component)
        self._require(stored, self.field_names, "field")
        return stored, None

    def _require(self, name: str, known: Iterable[str], what: str) -> None:
        """Raise ResultError with the nearest choice if a name is not known."""
        names = list(known)
        if name not in names:
            near = difflib.get_close_matches(name, [*names, *(find_aliases() if what == "field" else ())], n=1)
            hint = f" (did you mean {near[0]}?)" if near else ""
            if name in (*FORMABILITY_FIELDS, *PATH_MARGINS) and self.is_shell:
                hint = " (the material has no forming_limit, or the results are older than this field)"
            there_are = ", ".join(sorted(names)) or "none"
            raise ResultError(f"{self.folder} has no {what} {name}{hint}; there are: {there_are}")

    def _index(self, step: int, count: int) -> int:
        """Return a step counted from the start."""
        if not -count <= step < count:
            raise ResultError(f"{self.folder} has {count} saved steps, 0 to {count - 1}; there is no step {step}")
        return step % count

    @contextmanager
    def kept_open(self) -> Iterator[None]:
        """Open the results file once for all that the block reads, rather than at every call."""
        with open_file(self.folder / RESULTS) as self._file:
            try:
                yield
            finally:
                self._file = None
                self._kept.clear()

    def keep(self, name: str, find: Callable[[], T]) -> T:
        """Return what a function finds; while the file is kept open, it is called once for each name."""
        if self._file is None:
            return find()
        if name not in self._kept:
            self._kept[name] = find()
        found: T = self._kept[name]
        return found

    def _whole(self, group: h5py.Group, path: str) -> NDArray[Any]:
        """Return all of a small dataset."""
        return self.keep(path, lambda: np.asarray(group[path][()]))

    @contextmanager
    def _open(self) -> Iterator[h5py.File]:
        """Open the results file for reading; a run that appends meanwhile replaces it, which does no harm."""
        if self._file is None:
            with open_results(self.folder / RESULTS) as file:
                yield file
        else:
            with report_damage(self.folder / RESULTS):
                yield self._file


def _attributes(file: h5py.File) -> list[tuple[str, Any]]:
    """Return the attributes of the run; where tools have their blocks is for the writer alone."""
    return [(name, value) for name, value in file["presswork"].attrs.items() if not name.startswith("block ")]
