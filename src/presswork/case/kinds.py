# SPDX-License-Identifier: Apache-2.0
"""The kinds of case, told apart by `analysis`: how each is read, built into a Model, and described to editors.

A new kind is an entry of KINDS: its class needs `analysis`, a Literal of words that no other kind has, and `from_toml`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pydantic.json_schema import models_json_schema

from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.onestep.schema import OneStepCase
from presswork.case.reader import apply_overrides, read_toml
from presswork.case.shell.builder import build_shell_model
from presswork.case.shell.schema import ShellCase
from presswork.case.solid import schema
from presswork.case.solid.builder import build_solid_model
from presswork.case.stamping.builder import build_stamping_model
from presswork.case.stamping.schema import StampingCase
from presswork.model_stamping import AnyModel

AnyCase = schema.Case | ShellCase | StampingCase | OneStepCase

KINDS: dict[str, tuple[type[AnyCase], Callable[[Any], AnyModel] | None]] = {
    "solid": (schema.Case, build_solid_model),
    "shell": (ShellCase, build_shell_model),
    "stamping": (StampingCase, build_stamping_model),
    "onestep": (OneStepCase, None),
}
"""Case class and builder by the name that `presswork schema` knows; a one-step case is no process in time, and has a
builder of its own, build_onestep_model."""


def read_case(path: str | Path, overrides: Sequence[str] = ()) -> AnyCase:
    """Read and validate a case file of any kind, by its `analysis`. Raises CaseError with every problem found."""
    path = Path(path)
    data, _ = read_toml(path)
    apply_overrides(data, overrides, path)
    kinds = {word: kind for kind, _ in KINDS.values() for word in kind.analyses()}
    analysis = data.get("analysis")
    if isinstance(analysis, str) and analysis not in kinds:
        raise CaseError([Problem("analysis", "unknown choice", suggest(analysis, kinds), analysis)], path)
    return kinds.get(str(analysis), schema.Case).from_toml(path, overrides)


def build_model(case: AnyCase, *, run_user_code: bool = True) -> AnyModel:
    """Build the Model of a case of any kind; raises CaseError with every problem of the first kind that is found.

    The kinds of problem are, in this order: names that do not exist and values that do not go together; the mesh; sets,
    supports and tools that do not fit the workpiece. run_user_code: try the shared libraries that a case names, in a
    process of their own; without it they are not opened, and the Model can be described, not computed.
    """
    if isinstance(case, schema.Case):
        return build_solid_model(case, run_user_code=run_user_code)
    for kind, build in KINDS.values():
        if isinstance(case, kind):
            if build is None:
                text, remedy = "this is no process in time", f"run it by `presswork {case.analysis}`"
                raise CaseError([Problem("analysis", text, remedy, case.analysis)], case.source)
            return build(case)
    raise TypeError(f"expected a case, not a {type(case).__name__}")


def json_schema(kind: str | None = None) -> dict[str, Any]:
    """Return the JSON schema of case files, by which editors complete and check them.

    Without a kind: of all, told apart by `analysis`. Raises CaseError for a kind that there is not.
    """
    if kind is not None and kind not in KINDS:
        raise CaseError([Problem("", f"`{kind}` is no kind of case", suggest(kind, KINDS, "kinds"))], "schema")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    if kind is not None:
        return {**head, **KINDS[kind][0].model_json_schema()}
    references, common = models_json_schema([(case, "validation") for case, _ in KINDS.values()])
    branches = [references[case, "validation"] for case, _ in KINDS.values()]
    mapping = {
        word: branch["$ref"]
        for (case, _), branch in zip(KINDS.values(), branches, strict=True)
        for word in case.analyses()
    }
    tag = {"propertyName": "analysis", "mapping": mapping}
    return {**head, "title": "presswork case", "oneOf": branches, "discriminator": tag, **common}
