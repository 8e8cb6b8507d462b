# SPDX-License-Identifier: Apache-2.0
"""The site of the documents: built without a warning, every example and key in it, no dead link."""

from __future__ import annotations

import html
import posixpath
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from presswork.case import json_schema
from presswork.case.kinds import KINDS
from presswork.examples import list_examples

ROOT = Path(__file__).parents[2]


ANCHOR = re.compile(r"""[\s"']id=["']?([^"'\s>]+)""")
TARGET = re.compile(r"""[\s"'](?:href|src)=["']?([^"'\s>]+)""")
TAG = re.compile(r"<[a-zA-Z][^>]*>")
LOADED = re.compile(r"<(?:script|img|iframe)\b[^>]*\bsrc=[^>]*>|<link\b[^>]*\brel=[\"']?(?:stylesheet|preload)[^>]*>")
"""Tags whose files a browser fetches to show a page."""


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    pytest.importorskip("mkdocs")
    pytest.importorskip("latex2mathml")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[str, str]:
    """Text of every page by its place in the site."""
    return {path.relative_to(site).as_posix(): path.read_text("utf-8") for path in site.rglob("*.html")}


def test_every_example_is_in_the_gallery_once_under_a_process(site: Path, pages: dict[str, str]) -> None:
    heads = re.findall(r'<h([23]) id="([^"]+)">', pages["gallery/index.html"])
    examples = [name for level, name in heads if level == "3"]
    assert sorted(examples) == sorted(list_examples())
    assert heads[0][0] == "2"


def test_every_example_of_the_gallery_has_a_picture(pages: dict[str, str]) -> None:
    sections = pages["gallery/index.html"].split("<h3 ")[1:]
    assert not [section[:60] for section in sections if "<img" not in section]


def test_every_key_of_every_case_is_in_the_reference(site: Path) -> None:
    for kind in KINDS:
        page = (site / f"reference/keys_{kind}/index.html").read_text("utf-8")
        schema = json_schema(kind)
        tables = {"case": schema, **{name: node for name, node in schema["$defs"].items() if "properties" in node}}
        missing = [name for name in tables if f'id="{name.lower()}"' not in page]
        keys = {key for table in tables.values() for key in table["properties"]}
        assert not missing
        assert not [key for key in keys if f"<code>{key}</code>" not in page]


def find_dead_links(pages: dict[str, str], files: set[str]) -> list[str]:
    """Return links to files or anchors that are not there. pages: text by place in the site; files: all places."""
    tags = {place: "".join(TAG.findall(text)) for place, text in pages.items()}
    anchors = {place: {html.unescape(name) for name in ANCHOR.findall(text)} for place, text in tags.items()}
    dead = []
    for place, text in tags.items():
        for target in set(TARGET.findall(text)):
            parts = urlsplit(html.unescape(target))
            if parts.scheme or parts.netloc:
                continue
            goal = posixpath.normpath(posixpath.join(posixpath.dirname(place), unquote(parts.path)))
            goal = place if not parts.path else goal
            page = next((name for name in (goal, posixpath.normpath(f"{goal}/index.html")) if name in files), None)
            if page is None or (parts.fragment and page in anchors and unquote(parts.fragment) not in anchors[page]):
                dead.append(f"{place}: {target}")
    return dead


def test_no_link_of_the_site_is_dead(site: Path, pages: dict[str, str]) -> None:
    files = {path.relative_to(site).as_posix() for path in site.rglob("*") if path.is_file()}
    assert len(pages) > 200
    own = {place: text for place, text in pages.items() if place != "404.html"}  # its links are from a host's root
    assert not find_dead_links(own, files)


def test_a_dead_link_is_found() -> None:
    page = '<h2 id="a">A</h2><p>src=no.png</p><a href="b/">B</a><a href=#a>A</a><a href="b/#c">C</a><img src="d.png">'
    files = {"index.html", "b/index.html"}
    found = find_dead_links({"index.html": page, "b/index.html": '<a href="../#a">A</a>'}, files)
    assert sorted(found) == ["index.html: b/#c", "index.html: d.png"]


def test_a_page_is_shown_without_a_network(pages: dict[str, str]) -> None:
    fetched = {tag for text in pages.values() for tag in LOADED.findall(text) if re.search(r"=[\"']?(https?:)?//", tag)}
    assert not fetched


def test_formulas_are_written_when_the_site_is_built(pages: dict[str, str]) -> None:
    formulas = [text for page in pages.values() for text in re.findall(r'class="arithmatex">(.{12})', page, re.DOTALL)]
    assert len(formulas) > 50
    assert all(text.startswith("<math ") for text in formulas)
