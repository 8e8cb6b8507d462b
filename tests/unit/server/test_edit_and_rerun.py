# SPDX-License-Identifier: Apache-2.0
"""A served run leads to the case file that it was computed from, where that lies beside it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from presswork.server.http import Request
from presswork.server.site import Site
from tests.unit.results.upset_output import write_upset_output


@pytest.mark.parametrize(("run", "case"), [("forge", "forge.toml"), ("forge_2", "forge.toml"), ("other", "")])
def test_run_names_the_case_beside_it(tmp_path: Path, run: str, case: str) -> None:
    (tmp_path / "forge.toml").write_text('title = "forge"\n', "utf-8")
    write_upset_output(tmp_path / run)
    site = Site(tmp_path)
    page = site.answer(Request("GET", "run", {"run": [run]})).content.decode()
    site.close()
    header = re.search(r'id="header">(.*?)</script>', page, re.DOTALL)
    assert header
    assert json.loads(header[1])["runs"][0]["edit"] == case
