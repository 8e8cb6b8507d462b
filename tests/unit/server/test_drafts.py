# SPDX-License-Identifier: Apache-2.0
"""A new case of one's own does not keep the title of the example that it began with."""

from __future__ import annotations

import tomllib
from pathlib import Path

from presswork.server.drafts import Drafts
from presswork.server.opened_folder import OpenedFolder


def test_new_case_has_its_name_as_title(tmp_path: Path) -> None:
    (tmp_path / "cases").mkdir()
    (tmp_path / "scratch").mkdir()
    drafts = Drafts(OpenedFolder(tmp_path / "cases"), tmp_path / "scratch")
    for starter in ("cylindrical_cup", "upsetting_q4"):
        names = {name: drafts.create(starter, name) for name in (f"my {starter}", starter)}
        titles = {
            name: tomllib.loads((tmp_path / "cases" / file).read_text("utf-8"))["title"] for name, file in names.items()
        }
        assert titles[f"my {starter}"] == f"my {starter}"
        assert titles[starter] not in ("", starter)
    drafts.close()
