# SPDX-License-Identifier: Apache-2.0
"""Every key of every kind of case: description, unit, default, and an example that its class accepts."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name

import pytest
from pydantic import BaseModel, ValidationError

from presswork.case import build_model
from presswork.case.kinds import KINDS, Kind

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs/site"))
import reference  # noqa: E402
from key_examples import Block, read_blocks  # noqa: E402

ROWS = {kind: reference.find_keys(kind) for kind in KINDS}
TAKES_UNIT = "text with a unit"
BLOCKS = read_blocks()
NAMES = sorted(BLOCKS)
HAS_DIMENSION = re.compile(
    r"^(temperature|speed|velocity|stiffness|thickness|radius|diameter|height|width|depth|duration|density|stroke"
    r"|force per|energy|conductance|conductivity|specific heat|displacement over|angle|turn)\b"
)
"""Begins of descriptions of quantities that have a unit, unless they are ratios: one quantity over another."""


def list_classes(base: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """Yield every class of a table in presswork.case."""
    for found in base.__subclasses__():
        yield from list_classes(found)
        if found.__module__.startswith("presswork.case"):
            yield found


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_is_described_and_is_needed_or_has_a_default(kind: str) -> None:
    for name, table in ROWS[kind].items():
        for key in table.keys.values():
            assert key.schema.get("description"), f"{name}.{key.name}"
            assert reference.write_default(key), f"{name}.{key.name}"


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_is_in_an_example(kind: str) -> None:
    keys = [(name, key) for name, table in ROWS[kind].items() for key in table.keys.values()]
    assert not [f"{name}.{key.name}" for name, key in keys if not key.examples]


@pytest.mark.parametrize("kind", KINDS)
def test_every_text_with_a_unit_says_the_unit_of_its_number(kind: str) -> None:
    defs = reference.json_schema(kind)["$defs"]
    for name, table in ROWS[kind].items():
        for key in table.keys.values():
            text, takes = key.schema["description"], reference.describe_type(key.schema, defs)
            if "table" in takes or text.startswith("direction"):
                continue
            is_ratio = " over " in text and TAKES_UNIT not in takes
            if TAKES_UNIT in takes or (HAS_DIMENSION.match(text) and not is_ratio):
                assert reference.UNIT.search(text), f"{name}.{key.name}: {text}"


@pytest.mark.parametrize("name", NAMES)
def test_a_class_accepts_its_examples(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [f"{e},{r},{t},{100 + 50 * e}" for e in (0.0, 0.5) for r in (0.1, 10.0) for t in (900, 1100)]
    (tmp_path / "flow_stress.csv").write_text("\n".join(["strain,rate,temperature,stress", *rows]) + "\n", "utf-8")
    monkeypatch.chdir(tmp_path)
    classes = [found for found in list_classes(BaseModel) if found.__name__ == name]
    for block in BLOCKS[name]:
        faults = []
        for found in classes:
            try:
                found.model_validate(block.data)
            except ValidationError as error:
                faults.append(str(error))
        assert len(faults) < len(classes), f"{block.text}\n{faults}"


CASES = [(kind, block) for kind in KINDS.values() if kind.name != "OneStepCase" for block in BLOCKS[kind.name]]
"""A case of one step names a part, which stands in a file."""


@pytest.mark.parametrize(("kind", "block"), CASES, ids=[block.data["title"] for _, block in CASES])
def test_an_example_of_a_case_is_built_without_a_warning(
    kind: Kind, block: Block, caplog: pytest.LogCaptureFixture
) -> None:
    build_model(resolve_name(kind.place).model_validate(block.data))
    assert not caplog.messages


def test_every_example_is_shown_on_a_page() -> None:
    shown = {id(block) for tables in ROWS.values() for table in tables.values() for block in table.blocks}
    assert not [b.text for blocks in BLOCKS.values() for b in blocks if id(b) not in shown]


def test_a_shown_block_stands_at_its_place() -> None:
    swift = BLOCKS["Swift"][0].write("materials.NAME.hardening")
    assert swift.startswith('```toml\n[materials.NAME.hardening]  # a mild steel sheet\nlaw = "swift"\n')
    assert BLOCKS["Bead"][0].write("process.beads[]").startswith("```toml\n[[process.beads]]\n")
    assert "\n[workpiece]\n" in BLOCKS["Case"][0].write("")
