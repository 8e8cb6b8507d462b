# SPDX-License-Identifier: Apache-2.0
"""Pages of the site that are made when it is built: overview, contributing, changes, the gallery, the reference."""

from __future__ import annotations

import html
import re
import sys
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

sys.path.insert(0, str(Path(__file__).parent))
import reference
from gallery import make_gallery

ROOT = Path(__file__).parents[2]
PAGES = {"index.md": "README.md", "contributing.md": "CONTRIBUTING.md", "changelog.md": "CHANGELOG.md"}
FORMULA = re.compile(r'(<(?:span|div) class="arithmatex">)\\([(\[])(.*?)\\[)\]](?=</)', re.DOTALL)
"""A formula as arithmatex writes it: between \\( and \\) in a line, between \\[ and \\] on lines of its own."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that stand in no file of docs/."""
    for page, source in PAGES.items():
        text = (
            (ROOT / source)
            .read_text("utf-8")
            .replace("](docs/", "](")
            .replace("](CONTRIBUTING.md", "](contributing.md")
        )
        files.append(File.generated(config, page, content=text))
    files.append(File.generated(config, "gallery.md", content=make_gallery()))
    for page, text in reference.make_pages().items():
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Point links to files of the root at the pages made from them."""
    return markdown.replace("](../CONTRIBUTING.md", "](contributing.md")


def on_page_content(page_html: str, **_: object) -> str:
    """Write formulas as MathML, which browsers show without a script or a network."""

    def write(found: re.Match[str]) -> str:
        return found[1] + convert(html.unescape(found[3]), display="block" if found[2] == "[" else "inline")

    return FORMULA.sub(write, page_html)
