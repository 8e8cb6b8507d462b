# SPDX-License-Identifier: Apache-2.0
"""The kinds of case, told apart by `analysis`: how each is read, built into a Model, and described to editors.

A new kind is an entry of KINDS. Its class needs `analysis`, a Literal of words that no other kind has, and `from_toml`.
Class and builder are imported when a case of that kind is read, so a run does not wait for the schemas of all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeAlias

from presswork.case.errors import CaseError, Problem, suggest

if TYPE_CHECKING:
    from presswork.case.heat.schema import HeatCase
    from presswork.case.onestep.schema import OneStepCase
    from presswork.case.shell.schema import ShellCase
    from presswork.case.solid.schema import Case
    from presswork.case.space.schema import SpaceCase
    from presswork.case.stamping.schema import StampingCase
    from presswork.model import Model

    AnyCase: TypeAlias = Case | SpaceCase | ShellCase | StampingCase | HeatCase | OneStepCase


@dataclass(frozen=True)
class Kind:
    """A kind of case, by names alone."""

    analyses: tuple[str, ...]
    """Values of `analysis` that make a case of this kind: those of the Literal in its class."""
    place: str
    """Module and name of its class, as "module:name"."""
    builder: str = ""
    """Module and name of what makes a Model of it; of a one-step case, no process in time, build_onestep_model does."""

    has_laws: bool = True
    """Whether its materials have laws of deformation, which may be in shared libraries."""

    @property
    def name(self) -> str:
        """Name of its class."""
        return self.place.partition(":")[2]

    def load(self) -> type[AnyCase]:
        """Import and return its class."""
        found: type[AnyCase] = resolve_name(self.place)
        return found


KINDS = {
    "plane": Kind(
        ("axisymmetric", "plane_strain"),
        "presswork.case.solid.schema:Case",
        "presswork.case.solid.builder:build_solid_model",
    ),
    "solid": Kind(
        ("solid",), "presswork.case.space.schema:SpaceCase", "presswork.case.space.builder:build_space_model"
    ),
    "shell": Kind(
        ("shell",), "presswork.case.shell.schema:ShellCase", "presswork.case.shell.builder:build_shell_model"
    ),
    "stamping": Kind(
        ("stamping",),
        "presswork.case.stamping.schema:StampingCase",
        "presswork.case.stamping.builder:build_stamping_model",
    ),
    "heat": Kind(
        ("heat",),
        "presswork.case.heat.schema:HeatCase",
        "presswork.case.heat.builder:build_heat_model",
        has_laws=False,
    ),
    "onestep": Kind(("onestep",), "presswork.case.onestep.schema:OneStepCase"),
}
"""By the names that `presswork schema` knows."""


def read_case(path: str | Path, overrides: Sequence[str] = ()) -> AnyCase:
    """Read and validate a case file of any kind, by its `analysis`. Raises CaseError with every problem found."""
    from presswork.case.reader import apply_overrides, read_toml

    path = Path(path)
    data, _ = read_toml(path)
    apply_overrides(data, overrides, path)
    kinds = {word: kind for kind in KINDS.values() for word in kind.analyses}
    analysis = data.get("analysis")
    if isinstance(analysis, str) and analysis not in kinds:
        raise CaseError([Problem("analysis", "unknown choice", suggest(analysis, kinds), analysis)], path)
    return kinds.get(str(analysis), KINDS["plane"]).load().from_toml(path, overrides)


def build_model(case: AnyCase, *, run_user_code: bool = True) -> Model:
    """Build the Model of a case of any kind; raises CaseError with every problem of the first kind that is found.

    The kinds of problem are, in this order: names that do not exist and values that do not go together; the mesh; sets,
    supports and tools that do not fit the workpiece. run_user_code: try the shared libraries that a case names, in a
    process of their own; without it they are not opened, and the Model can be described, not computed.
    """
    from presswork.case.whole_model import check_whole_model

    kind = next((kind for kind in KINDS.values() if getattr(case, "analysis", None) in kind.analyses), None)
    if kind is None:
        raise TypeError(f"expected a case, not a {type(case).__name__}")
    if not kind.builder:
        text, remedy = "this is no process in time", f"run it by `presswork {case.analysis}`"
        raise CaseError([Problem("analysis", text, remedy, case.analysis)], case.source)
    options = {"run_user_code": run_user_code} if kind.has_laws else {}
    model: Model = resolve_name(kind.builder)(case, **options)
    check_whole_model(case, model)
    if (wanted := getattr(case, "gradients", None)) is not None:
        from presswork.case.gradients import add_gradients

        return add_gradients(case, wanted, model, lambda beside: resolve_name(kind.builder)(beside, **options))
    return model


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """Return the JSON schema of case files, by which editors complete and check them.

    kind: an `analysis`, or plane for both of the plane; without it: of all, told apart by `analysis`. Raises CaseError
    for an unknown kind.
    """
    names = {word: name for name, entry in KINDS.items() for word in (name, *entry.analyses)}
    if kind is not None and kind not in names:
        raise CaseError([Problem("", f"`{kind}` is no kind of case", suggest(kind, names, "kinds"))], "schema")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    if kind is not None:
        return {**head, **KINDS[names[kind]].load().model_json_schema()}
    from pydantic.json_schema import models_json_schema

    cases = {kind.load(): kind.analyses for kind in KINDS.values()}
    references, common = models_json_schema([(case, "validation") for case in cases])
    branches = {case: references[case, "validation"] for case in cases}
    mapping = {word: branches[case]["$ref"] for case, words in cases.items() for word in words}
    tag = {"propertyName": "analysis", "mapping": mapping}
    return {**head, "title": "presswork case", "oneOf": [*branches.values()], "discriminator": tag, **common}
