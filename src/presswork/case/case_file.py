# SPDX-License-Identifier: Apache-2.0
"""What every kind of case file shares: reading from TOML with overrides, validation of the whole, a description for
errors."""

from __future__ import annotations

import copy
import functools
from collections.abc import Sequence
from pathlib import Path
from pkgutil import resolve_name
from typing import Any, Self, get_args

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, ValidationError, ValidationInfo, model_validator

from presswork.case.errors import CaseError, Problem
from presswork.case.kinds import find_kind
from presswork.case.names import FORMAT, Format
from presswork.case.part import Part
from presswork.case.reader import Tables, list_problems, read_tables
from presswork.case.unknown_tools import name_unknown_tools


class CaseFile(Part):
    """A case of any kind. Raises CaseError, with every problem found, when it is not valid."""

    format: Format = Field(
        default=FORMAT, description="format of the file, by which a later presswork knows what its keys meant"
    )
    _source: Path | None = PrivateAttr(default=None)
    _text: str = PrivateAttr(default="")

    def check_together(self) -> None:
        """Raise what no table can know alone, by `fault`; for kinds of case to override."""

    # Before the next, which wraps only what stands above it: hence a method to override, no validators of subclasses.
    @model_validator(mode="after")
    def _check_together(self) -> Self:
        self.check_together()
        return self

    @model_validator(mode="wrap")
    @classmethod
    def _raise_case_error(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        source = info.context.get("source") if isinstance(info.context, dict) else None
        try:
            return handler(data)
        except ValidationError as error:
            problems = list_problems(error, data, _json_schema(cls))
            raise CaseError(name_unknown_tools(problems, data), source) from None

    @classmethod
    def from_toml(cls, path: str | Path, overrides: Sequence[str] = ()) -> Self:
        """Read and validate a case file.

        path: the TOML file. overrides: `key=value` texts that replace or add values, for instance
        `workpiece.mesh.cells=[30,30]` or `stages.0.tools.punch.stroke=5`; a value is read as TOML, or else as a string.
        Raises CaseError with every problem found; of a file of another kind of case, which `presswork.read_case` reads,
        its kind alone.
        """
        return cls.from_tables(read_tables(Path(path), overrides))

    @classmethod
    def from_tables(cls, tables: Tables) -> Self:
        """Validate what was read from a case file. Raises CaseError as `from_toml` does."""
        path, data = tables.path, tables.data
        cls._refuse_other_kind(data.get("analysis"), path)
        case = cls.model_validate(data, context={"source": path})
        case._source = path
        case._text = tables.text if tables.text and not names_files(data) else write_as_run(data, path.parent)
        return case

    def beside(self, data: dict[str, Any]) -> Self:
        """Return a case of the same kind and file with other data. Raises CaseError with every problem found."""
        case = self.model_validate(data, context={"source": self._source})
        case._source = self._source
        return case

    @classmethod
    def analyses(cls) -> tuple[str, ...]:
        """Return the values of `analysis` that make a case of this kind."""
        return get_args(cls.model_fields["analysis"].annotation)

    @classmethod
    def _refuse_other_kind(cls, analysis: object, path: Path) -> None:
        """Raise CaseError if `analysis` is a word of another kind of case, whose keys are others."""
        kind = find_kind(analysis)
        if kind is not None and analysis not in cls.analyses():
            own = f"{cls.__name__} is for {' and '.join(cls.analyses())}"
            remedy = f"read it by presswork.read_case(path), which reads every kind, or by {kind.name}.from_toml"
            raise CaseError([Problem("analysis", own, remedy, analysis)], path)

    def _repr_html_(self) -> str:
        """Return a drawing of the case's start and the case in words, for notebooks."""
        return str(resolve_name("presswork.notebook:show_case")(self))

    @property
    def source(self) -> Path | None:
        """The file that the case was read from, if any."""
        return self._source

    @property
    def text(self) -> str:
        """The case file as read, or written anew with the overrides in it; empty for a case built in Python."""
        return self._text


def _tables_with_paths(data: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Return the tables of a case that name a file, each with the key that does."""
    bodies = [data["workpiece"], *data.get("bodies", {}).values()] if "workpiece" in data else []
    tables = [(body["mesh"], "path") for body in bodies] + [(data.get(name, {}), "path") for name in ("blank", "part")]
    operations = [data, *data.get("operations", ())]
    tools = [tool for operation in operations for tool in operation.get("tools", {}).values()]
    tables += [(tool, key) for tool in tools for key in ("profile_file", "path")]
    tables += [(tool["cut"], "path") for tool in tools if "cut" in tool]
    tables += [(line, "path") for operation in operations for line in operation.get("trim", {}).values()]
    materials = data.get("materials", {})
    pieces = [*bodies, data.get("blank", {})]
    named = [(piece, str(piece.get("material", ""))) for piece in pieces]
    tables += [(piece, "material") for piece, name in named if name.endswith(".toml") and name not in materials]
    tables += [(m, "library") for m in materials.values() if m.get("library", "").endswith(".toml")]
    tables += [(m, "umat") for m in materials.values()]
    tables += [(m["hardening"], "file") for m in materials.values() if "hardening" in m]
    return [(table, key) for table, key in tables if key in table]


def names_files(data: dict[str, Any]) -> bool:
    """Return whether a case names files, whose paths are relative to it."""
    return bool(_tables_with_paths(data))


def write_as_run(data: dict[str, Any], folder: Path) -> str:
    """Write a case so that it can be run from anywhere: overrides in it, files by their full paths."""
    data = copy.deepcopy(data)
    for table, key in _tables_with_paths(data):
        table[key] = str((folder / table[key]).resolve())
    import tomli_w

    return tomli_w.dumps(data)


@functools.cache
def _json_schema(kind: type[CaseFile]) -> dict[str, Any]:
    return kind.model_json_schema()
