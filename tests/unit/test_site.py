# SPDX-License-Identifier: Apache-2.0
"""The site of the documents: built without a warning, every example and key in it, no dead link."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from presswork.case import json_schema
from presswork.case.kinds import KINDS
from presswork.examples import list_examples

ROOT = Path(__file__).parents[2]


class _Page(HTMLParser):
    """Anchors that a page has, and what it links to."""

    def __init__(self) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.targets: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value and name == "id":
                self.anchors.add(value)
            elif value and name in ("href", "src"):
                self.targets.add(value)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    pytest.importorskip("mkdocs")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_example_is_in_the_gallery(site: Path) -> None:
    gallery = (site / "gallery/index.html").read_text("utf-8")
    for example in list_examples():
        assert f'<h2 id="{example}">' in gallery
    assert len(re.findall(r"<img", gallery)) >= 10


def test_every_key_of_every_case_is_in_the_reference(site: Path) -> None:
    for kind in KINDS:
        page = (site / f"reference/keys_{kind}/index.html").read_text("utf-8")
        schema = json_schema(kind)
        tables = {"case": schema, **{name: node for name, node in schema["$defs"].items() if "properties" in node}}
        missing = [name for name in tables if f'id="{name.lower()}"' not in page]
        keys = {key for table in tables.values() for key in table["properties"]}
        assert not missing
        assert not [key for key in keys if f"<code>{key}</code>" not in page]


def test_no_link_of_the_site_is_dead(site: Path) -> None:
    pages = {}
    for path in site.rglob("*.html"):
        pages[path] = _Page()
        pages[path].feed(path.read_text("utf-8"))
    assert len(pages) > 15
    dead = []
    for path, page in pages.items():
        if path.name == "404.html":
            continue  # its links are from the root of a host
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            goal = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            goal = goal / "index.html" if goal.is_dir() else goal
            if not goal.exists() or (parts.fragment and goal in pages and parts.fragment not in pages[goal].anchors):
                dead.append(f"{path.relative_to(site)}: {target}")
    assert not dead
