# SPDX-License-Identifier: Apache-2.0
"""Every warning of the program is explained on the page of warnings, by its words.

Texts are found in the sources: what functions named after warnings return, what is added to lists named so, what is
printed after "warning:", and what functions of the package return that these call.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from presswork.case.limits import Limits

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src/presswork"
PAGES = ("warnings.md", "refused_files.md")
FEWEST_WORDS = 6
"""Of a warning that is a sentence; shorter texts are names, or parts of sentences."""
PARTS = ("; by their paths", "in the mean over … mm round")
"""Begins of parts of warnings that are on the page by their other parts."""
STOPS = {"run"}
"""Functions that do much besides warning."""


@cache
def parse(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@cache
def list_functions() -> dict[str, list[tuple[Path, ast.FunctionDef]]]:
    """Return the functions of the package by name."""
    found: dict[str, list[tuple[Path, ast.FunctionDef]]] = {}
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(parse(path)):
            if isinstance(node, ast.FunctionDef):
                found.setdefault(node.name, []).append((path, node))
    return found


def has_warnings(node: ast.expr) -> bool:
    """Say whether an expression is a list named after warnings."""
    return "warning" in getattr(node, "id", getattr(node, "attr", ""))


def yields_warnings(node: ast.AST) -> list[ast.AST]:
    """Return what of a statement or an expression is warnings."""
    match node:
        case ast.FunctionDef(name=name) if "warn" in name:
            return [node]
        case ast.Call(func=ast.Attribute(value=value, attr=attr)) if has_warnings(value) or attr == "warn":
            return [node]
        case ast.AugAssign(target=target, value=value) if has_warnings(target):
            return [value]
        case ast.Assign(targets=[target], value=value) if has_warnings(target):
            return [value]
        case ast.Dict(keys=keys, values=values):
            pairs = zip(keys, values, strict=True)
            return [value for key, value in pairs if isinstance(key, ast.Constant) and key.value == "warnings"]
        case ast.JoinedStr(values=[ast.Constant(value=str(text)), *_]) if text.startswith("warning: "):
            return [node]
    return []


def find_called(path: Path, node: ast.AST) -> Iterator[tuple[Path, ast.FunctionDef]]:
    """Yield the functions of the package that a piece of a file calls by their names, or of itself."""
    imported = {a.name for n in ast.walk(parse(path)) if isinstance(n, ast.ImportFrom) for a in n.names}
    for call in ast.walk(node):
        if not isinstance(call, ast.Call):
            continue
        is_own = isinstance(call.func, ast.Attribute) and getattr(call.func.value, "id", "") == "self"
        name = call.func.attr if is_own else getattr(call.func, "id", "")
        for place, function in list_functions().get(name, []):
            if name not in STOPS and (place == path or (name in imported and not is_own)):
                yield place, function


def read_text(node: ast.AST) -> str | None:
    """Return a string on one line, an ellipsis for each value in it, or None."""
    if isinstance(node, ast.JoinedStr):
        parts = [str(part.value) if isinstance(part, ast.Constant) else "…" for part in node.values]
        return " ".join("".join(parts).split())
    is_text = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return " ".join(re.sub(r"%(\.\d)?[sgd]", "…", node.value).split()) if is_text else None


def list_texts(node: ast.AST) -> Iterator[str]:
    """Yield the strings of a piece of a file, docstrings left out."""
    if isinstance(node, ast.Expr | ast.Raise):
        return
    if (text := read_text(node)) is not None:
        yield text
        return
    for inner in ast.iter_child_nodes(node):
        is_statement = isinstance(inner, ast.Expr) and not isinstance(inner.value, ast.Constant)
        yield from list_texts(inner.value if is_statement else inner)


def list_warnings() -> set[tuple[str, str]]:
    """Return the warnings of the program: file and text."""
    waiting = [
        (path, found)
        for path in sorted(SOURCE.rglob("*.py"))
        for n in ast.walk(parse(path))
        for found in yields_warnings(n)
    ]
    done: set[int] = set()
    warnings = set()
    while waiting:
        path, node = waiting.pop()
        if id(node) in done:
            continue
        done.add(id(node))
        waiting += find_called(path, node)
        texts = [text for text in list_texts(node) if len(re.findall(r"[A-Za-z]{2,}", text)) >= FEWEST_WORDS]
        whole = [text for text in texts if not text.removeprefix("… ").startswith(PARTS)]
        warnings |= {(str(path.relative_to(SOURCE)), text) for text in whole}
    return warnings


@cache
def list_rows() -> list[list[str]]:
    """Return the messages of the pages: what stands between their ellipses."""
    text = "\n".join((ROOT / "docs/howto" / page).read_text("utf-8") for page in PAGES)
    rows = re.findall(r"^\| (?!message)([^|]+) \|", text, re.MULTILINE)
    return [[part.strip() for part in row.split("…") if part.strip()] for row in rows]


@pytest.mark.parametrize(("file", "text"), sorted(list_warnings()))
def test_a_warning_is_on_the_page_of_warnings(file: str, text: str) -> None:
    assert any(row and all(part in text for part in row) for row in list_rows()), f"{file}: {text}"


def test_the_limits_of_the_page_on_giving_up_are_those_of_the_program() -> None:
    text = (ROOT / "docs/howto/gave_up.md").read_text("utf-8")
    written = {key: float(value) for key, value in re.findall(r"^\| `(\w+)` \| ([\d.]+) \|", text, re.MULTILINE)}
    defaults = Limits().model_dump(exclude={"stop", "end"}, exclude_none=True)
    assert written == defaults


def test_warnings_of_all_rooms_are_found() -> None:
    found = list_warnings()
    assert len(found) > 40
    assert {file.partition("/")[0] for file, _ in found} >= {"case", "explicit", "observe", "process", "study"}
