# SPDX-License-Identifier: Apache-2.0
"""Cases of any kind: read from a file, built into a Model, described to editors."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeAlias, overload

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.kinds import KINDS, Kind, find_kind
from presswork.case.names import FORMAT
from presswork.model import Model, OneStepModel

if TYPE_CHECKING:
    from presswork.case.heat.schema import HeatCase
    from presswork.case.onestep.schema import OneStepCase
    from presswork.case.plane.schema import Case
    from presswork.case.shell.schema import ShellCase
    from presswork.case.space.schema import SpaceCase
    from presswork.case.stamping.schema import StampingCase

    ProcessCase: TypeAlias = Case | SpaceCase | ShellCase | StampingCase | HeatCase
    """A case of a process in time."""
    AnyCase: TypeAlias = ProcessCase | OneStepCase


def read_case(path: str | Path, overrides: Sequence[str] = ()) -> AnyCase:
    """Read and validate a case file of any kind, by its `analysis`. Raises CaseError with every problem found."""
    from presswork.case.reader import read_tables

    tables = read_tables(Path(path), overrides)
    analysis = tables.data.get("analysis")
    kind = find_kind(analysis)
    number = tables.data.get("format")
    is_later = isinstance(number, int) and number > FORMAT  # it may know other kinds: its format is what to report
    if isinstance(analysis, str) and kind is None and not is_later:
        words = [word for kind in KINDS.values() for word in kind.analyses]
        raise CaseError([Problem("analysis", "unknown choice", suggest(analysis, words), analysis)], tables.path)
    return _load(kind or KINDS["plane"]).from_tables(tables)


def _load(kind: Kind) -> type[AnyCase]:
    """Import and return the class of a kind."""
    found: type[AnyCase] = resolve_name(kind.place)
    return found


@overload
def build_model(case: ProcessCase, *, run_user_code: bool = True) -> Model: ...
@overload
def build_model(case: OneStepCase, *, run_user_code: bool = True) -> OneStepModel: ...
@overload
def build_model(case: AnyCase, *, run_user_code: bool = True) -> Model | OneStepModel: ...
def build_model(case: AnyCase, *, run_user_code: bool = True) -> Model | OneStepModel:
    """Build the Model of a case of any kind; raises CaseError with every problem of the first kind that is found.

    The kinds of problem are, in this order: names that do not exist and values that do not go together; the mesh; sets,
    supports and tools that do not fit the workpiece. run_user_code: try the shared libraries that a case names, in a
    process of their own; without it they are not opened, and the Model can be described, not computed.
    """
    kind = find_kind(getattr(case, "analysis", None))
    if kind is None:
        raise TypeError(f"expected a case, not a {type(case).__name__}")
    options = {"run_user_code": run_user_code} if kind.has_laws else {}
    build = partial(resolve_name(kind.builder), **options)
    built: Model | OneStepModel = build(case)
    if isinstance(built, OneStepModel):
        return built
    from presswork.case.whole_model import check_whole_model

    check_whole_model(case, built)
    if (wanted := getattr(case, "gradients", None)) is not None:
        from presswork.case.gradients import add_gradients

        return add_gradients(case, wanted, built, build)
    return built


def list_libraries(case: AnyCase) -> list[Path]:
    """Return the libraries that the materials of a case name."""
    from presswork.case.material.umat import UmatMaterial

    folder = case.source.parent if case.source else Path()
    tables = case.materials.values()
    return [folder / table.umat for table in tables if isinstance(table, UmatMaterial)]


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """Return the JSON schema of case files, by which editors complete and check them.

    kind: an `analysis`, or plane for both in the plane; without it the schema covers all kinds, and `analysis`
    distinguishes them. Raises CaseError for an unknown kind.
    """
    names = {word: name for name, entry in KINDS.items() for word in (name, *entry.analyses)}
    if kind is not None and kind not in names:
        raise CaseError([Problem("", f"unknown kind of case `{kind}`", suggest(kind, names, "kinds"))], "schema")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    if kind is not None:
        return {**head, **_load(KINDS[names[kind]]).model_json_schema()}
    from pydantic.json_schema import models_json_schema

    cases = {_load(kind): kind.analyses for kind in KINDS.values()}
    references, common = models_json_schema([(case, "validation") for case in cases])
    branches = {case: references[case, "validation"] for case in cases}
    mapping = {word: branches[case]["$ref"] for case, words in cases.items() for word in words}
    tag = {"propertyName": "analysis", "mapping": mapping}
    return {**head, "title": "presswork case", "oneOf": [*branches.values()], "discriminator": tag, **common}
