# SPDX-License-Identifier: Apache-2.0
"""The page as one file: frame, style, modules and data together.

Modules are stored deflated as text; a few lines of script in the frame inflate them and make each a module by an
address of its own (`page/start.js`). The page's own policy allows that script, by its digest, and the modules, and
neither a network nor any other script: text out of a case stays text even if it reads as a tag.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from collections.abc import Iterator
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

from presswork.report.pack import Blocks

_PAGE = files("presswork.report") / "page"
_IMPORT = re.compile(r'\bfrom\s*"\./([^"]+)"')
_MAIN = "main.js"


def make_policy(*, is_served: bool = False) -> str:
    """Return the page's policy; a page that is served may ask its own server, and no other, for numbers."""
    digest = base64.b64encode(hashlib.sha256(_read("start.js").encode()).digest()).decode()
    policy = f"default-src 'none'; script-src 'sha256-{digest}' blob:; style-src 'unsafe-inline'; img-src data: blob:; "
    return policy + "base-uri 'none'; form-action 'none'" + ("; connect-src 'self'" if is_served else "")


def assemble_page(header: dict[str, Any], blocks: Blocks, *, is_served: bool = False) -> str:
    """Return the page's text; header: plain values, blocks: its numbers; is_served: by a server of ours."""
    titles = [str(run["title"]) for run in header["runs"]]
    data = "\n".join(f'<script type="text/plain" id="block-{i}">{text}</script>' for i, text in enumerate(blocks.texts))
    parts = {
        "{{policy}}": make_policy(is_served=is_served),
        "{{icon}}": '<link rel="icon" href="data:,">\n' if is_served else "",
        "{{title}}": escape(" | ".join(titles)),
        "{{style}}": _read("theme.css") + _read("style.css"),
        "{{header}}": _to_json(header),
        "{{blocks}}": data,
        "{{modules}}": _pack_modules(),
        "{{start}}": _read("start.js"),
    }
    return re.sub("|".join(re.escape(mark) for mark in parts), lambda mark: parts[mark[0]], _read("frame.html"))


def _to_json(header: dict[str, Any]) -> str:
    """Return strict JSON that no HTML parser takes for the end of its element."""
    text = json.dumps(header, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


@cache
def _pack_modules() -> str:
    """Return the modules as elements, each after those that it imports."""
    texts = []
    for name, source in _order_modules():
        packed = base64.b64encode(zlib.compress(source.encode(), 4)).decode()
        texts.append(f'<script type="text/plain" class="module" data-name="{name}">{packed}</script>')
    return "\n".join(texts)


def _order_modules() -> Iterator[tuple[str, str]]:
    """Yield name and source of every module that main.js needs, imports first."""
    done: set[str] = set()

    def visit(name: str) -> Iterator[tuple[str, str]]:
        if name in done:
            return
        done.add(name)
        source = _read(name)
        for needed in _IMPORT.findall(source):
            yield from visit(needed)
        yield name, source

    yield from visit(_MAIN)


def _read(name: str) -> str:
    return _PAGE.joinpath(*name.split("/")).read_text(encoding="utf-8")
