# SPDX-License-Identifier: Apache-2.0
"""The stages in which a boundary entry holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import Field

from presswork.case.errors import Problem, suggest
from presswork.case.part import Part


class StagedBoundary(Part):
    """A boundary entry that may hold in some stages alone."""

    stages: tuple[str, ...] | None = Field(
        default=None,
        min_length=1,
        description="names of the stages in which it holds, each time where the nodes are when it begins; without it: "
        "in all. What it bears goes to zero over the stage that releases it",
    )


def check_held_stages(boundary: Mapping[str, StagedBoundary], stages: Sequence[str]) -> list[Problem]:
    """Return the problems of entries that hold in stages which there are not; stages: names of those of the case."""
    return [
        Problem(f"boundary.{name}.stages", "no such stage", suggest(stage, stages, "stages"), stage)
        for name, entry in boundary.items()
        for stage in entry.stages or ()
        if stage not in stages
    ]


def releases(boundary: Mapping[str, StagedBoundary], stages: Sequence[str], number: int) -> bool:
    """Return whether a stage releases what the stage before it holds; stages: names of those of the case."""
    before = list_released(boundary, stages[max(number - 1, 0)])
    return not set(list_released(boundary, stages[number])) <= set(before)


def list_released(boundary: Mapping[str, StagedBoundary], stage: str) -> tuple[str, ...]:
    """Return the names of the entries that do not hold in a stage."""
    return tuple(name for name, entry in boundary.items() if entry.stages is not None and stage not in entry.stages)
