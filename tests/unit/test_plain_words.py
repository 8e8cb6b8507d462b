# SPDX-License-Identifier: Apache-2.0
"""Identifiers and docstrings speak the field's language: no word of this house that has a plain one is in them."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "src" / "presswork"
PLAIN = {
    "way": "stroke, travel, path, direction, distance or increment",
    "told": "reported, status, summary",
    "tell": "report, print, describe",
    "say": "report, describe",
    "settle": "end_increment, converge, store",
    "give": "supply, set, copy",
    "rub": "slide, friction",
    "dress": "apply",
}
FORMS = {
    "ways": "way", "tells": "tell", "said": "say", "says": "say", "settles": "settle", "settled": "settle",
    "unsettled": "settle", "gives": "give", "giving": "give", "rubs": "rub", "rubbed": "rub", "dressed": "dress",
}  # fmt: skip
PHRASES = {"give_up_guess": "discard_guess", "given_temperature": "prescribed_temperature", "let_go": "released"}
ALLOWED = {
    "gives": "array of checkpoints: tools whose springs move",
    "rub": "array of checkpoints: friction on a contact",
    "stage_way": "array of checkpoints: travel of the ram in a stage",
    "contact_rub": "method of the compiled loop",
    "wall_rubbed": "method of the compiled loop",
    "rub_nodes": "function of the compiled core",
    "tell": "method of Python's files",
    "_give_up": "plain English",
}
HOUSE_WORDS = re.compile(
    r"\b(told|[Tt]ells?|[Ss]ays?|said|foretell|foretold|settle[sd]?|rubs?|rubbed|dress(es|ed)?|lets? go"
    r"|hands off|rides? along|(its|their|tool's|punch's|ram's) ways?|stands? (beside|twice|without)"
    r"|as it lies|hang together|knows no)\b"
    r"|(^|[.:] )(Of|By) "
)
"""Words and phrases of STYLE.md's table in a docstring, and beginnings of sentences that avoid a subject."""


@cache
def read_words(path: Path) -> tuple[frozenset[str], frozenset[str]]:
    """Return the identifiers and the docstrings of a file."""
    nodes = list(ast.walk(ast.parse(path.read_text("utf-8"))))
    return frozenset(find_identifiers(nodes)), frozenset(find_docstrings(nodes))


def find_identifiers(nodes: list[ast.AST]) -> Iterator[str]:
    """Yield names that a source defines or uses, those in f-strings included."""
    for node in nodes:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.arg | ast.keyword) and node.arg:
            yield node.arg
        elif isinstance(node, ast.alias):
            yield from re.split(r"\.", node.asname or node.name)


def find_house_words(name: str) -> set[str]:
    """Return the words and phrases of a name that have a plain one."""
    words = {word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)}
    return {FORMS.get(word, word) for word in words} & PLAIN.keys() | {each for each in PHRASES if each in name.lower()}


def test_identifiers_hold_no_house_words() -> None:
    found = {
        f"{path.relative_to(PACKAGE)}: {name} ({word}: {(PLAIN | PHRASES)[word]})"
        for path in sorted(PACKAGE.rglob("*.py"))
        for name in read_words(path)[0]
        if name not in ALLOWED
        for word in find_house_words(name)
    }
    assert not found, "\n".join(sorted(found))


def test_allowed_names_are_used() -> None:
    used = {name for path in PACKAGE.rglob("*.py") for name in read_words(path)[0]}
    assert used >= ALLOWED.keys()


def test_house_words_are_found_in_every_kind_of_name() -> None:
    source = "from a import b as settle_c\ndef tell(way): f'{x.GIVES}'\nclass Unsettled: rubbed_at: int = f(told=1)\n"
    words = {word for name in find_identifiers(list(ast.walk(ast.parse(source)))) for word in find_house_words(name)}
    assert words == {"settle", "tell", "way", "give", "rub", "told"}
    assert find_house_words("always_gateway") == set()


def find_docstrings(nodes: list[ast.AST]) -> Iterator[str]:
    """Yield the docstrings of a source, those below attributes and constants included, each on one line."""
    for node in nodes:
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield " ".join(node.value.value.split())


def test_docstrings_hold_no_house_words() -> None:
    found = {
        f"{path.relative_to(PACKAGE)}: {text} ({match[0].strip()})"
        for path in sorted(PACKAGE.rglob("*.py"))
        for text in read_words(path)[1]
        if (match := HOUSE_WORDS.search(text))
    }
    assert not found, "\n".join(sorted(found))


def test_house_words_are_found_in_every_docstring() -> None:
    source = (
        '"""A tool is told."""\nX = 1\n"""Of the size."""\ndef f():\n    """A. By size."""\ndef g(): "Plain words"\n'
    )
    assert [bool(HOUSE_WORDS.search(text)) for text in find_docstrings(list(ast.walk(ast.parse(source))))] == [
        True,
        True,
        True,
        False,
    ]
