# SPDX-License-Identifier: Apache-2.0
"""Form of the documents: length of lines, pages and sentences; pages that the summary and the site's menu know.

The limits are those of a reader: 120 characters a line (160 in tables), 300 lines a page, 35 words a sentence, and a
median sentence below 18 words. PARTS lists the folders that keep them; a folder that is rewritten joins it.
"""

import ast
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from statistics import median

import pytest

from presswork import __version__

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PARTS = ("tutorials", "howto", "reference", "theory", "verification", "performance", "dev")
PAGES = sorted([*(page for part in PARTS for page in (DOCS / part).rglob("*.md")), DOCS / "adding_a_law.md"])
COMMANDS = re.compile(r"^```sh\n.*?^```\n", re.DOTALL | re.MULTILINE)
"""A command is one line, however long."""
LINE, ROW, PAGE, WORDS, MEDIAN = 120, 160, 300, 35, 18


def name(page: Path) -> str:
    return str(page.relative_to(DOCS))


def list_blocks(text: str) -> Iterator[str]:
    """Yield paragraphs and items of lists, each as one line, without code, tables, headings and pictures."""
    block: list[str] = []
    for line in [*re.sub(r"```.*?```", "", text, flags=re.DOTALL).splitlines(), ""]:
        line = "" if line.startswith("    ") and not block else line.strip()
        is_item = re.match(r"([-*] |\d+\. )", line)
        if block and (is_item or not line or line.startswith(("|", "#", "!", "$$"))):
            yield " ".join(block)
            block = []
        if line and not line.startswith(("|", "#", "!", "$$")):
            block.append(line)


def list_sentences(text: str) -> Iterator[str]:
    """Yield the sentences of a page; code counts as one word, a link as its text."""
    for block in list_blocks(text):
        plain = re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "Code", block))
        yield from re.split(r"(?<=[.!?])\s+(?=[A-Z0-9\[*(“\"])", plain)


def count_words(sentence: str) -> int:
    return len([word for word in sentence.split() if re.search(r"\w", word)])


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_lines_and_pages_are_short(page: Path) -> None:
    lines = page.read_text("utf-8").splitlines()
    assert len(lines) <= PAGE
    long = [n for n, line in enumerate(lines, 1) if len(line) > (ROW if line.lstrip().startswith("|") else LINE)]
    assert not long, f"{page.name}: lines {long}"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_sentences_are_short(page: Path) -> None:
    long = [s for s in list_sentences(page.read_text("utf-8")) if count_words(s) > WORDS]
    assert not long


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_sentences_are_plain(page: Path) -> None:
    """The house words of messages that no page may have; decisions quote their day."""
    if page.name == "decisions.md":
        return
    plain = re.compile(r"\b(told|tells?|(let|lets) go|settle[sd]?|rubs|rides along|(its|their) ways?)\b|^(Of|By) ")
    assert not [s for s in list_sentences(page.read_text("utf-8")) if plain.search(s)]


@pytest.mark.parametrize("part", PARTS)
def test_the_median_sentence_is_short(part: str) -> None:
    pages = [page for page in PAGES if page.is_relative_to(DOCS / part)]
    found = median(count_words(s) for page in pages for s in list_sentences(page.read_text("utf-8")))
    assert found < MEDIAN


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_files_that_a_page_names_exist(page: Path) -> None:
    """A path may begin anywhere within the repository; decisions name files of their day."""
    if page.name == "decisions.md":
        return
    root = DOCS.parent
    folders = ("src", "cpp", "bindings", "tests", "validation", "benchmarks", "packaging", "docs", "examples")
    there = ["/" + str(path.relative_to(root)) for folder in folders for path in (root / folder).rglob("*.*")]
    named = re.findall(r"`((?:[A-Za-z_]\w*/)+\w+\.(?:py|hpp|cpp|cu|js))`", page.read_text("utf-8"))
    assert not [path for path in named if not any(each.endswith(f"/{path}") for each in there)]


def test_the_readme_is_a_screen_and_a_half() -> None:
    text = COMMANDS.sub("", (ROOT / "README.md").read_text("utf-8"))
    assert len(text.splitlines()) < 80
    assert not [line for line in text.splitlines() if len(line) > (ROW if line.startswith(("|", "!")) else LINE)]
    assert not [s for s in list_sentences(text) if count_words(s) > WORDS]


def test_the_summary_of_verification_names_every_benchmark() -> None:
    text = (DOCS / "verification/index.md").read_text("utf-8")
    pages = {page.name for page in (DOCS / "verification").glob("*.md")} - {"index.md"}
    assert pages == set(re.findall(r"\]\(([\w.]+\.md)\)", text))


def test_the_menu_of_the_site_names_every_page() -> None:
    menu = (ROOT / "mkdocs.yml").read_text("utf-8")
    missing = [name(page) for page in DOCS.rglob("*.md") if not re.search(rf"\b{name(page)}$", menu, re.MULTILINE)]
    assert not missing


@pytest.mark.parametrize("page", sorted((DOCS / "verification").glob("*.md")), ids=name)
def test_tests_that_verification_names_are_there(page: Path) -> None:
    tests = {path.name for folder in ("tests", "validation") for path in (ROOT / folder).rglob("test_*.py")}
    named = set(re.findall(r"\b(test_\w+\.py)\b", page.read_text("utf-8")))
    assert named <= tests, named - tests


def list_strings(path: Path) -> Iterator[str]:
    """Yield the strings of a file of Python without docstrings; a value in one of them is an ellipsis."""
    documented = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Expr):
            documented.add(id(node.value))  # ast.walk comes to it later
        elif id(node) in documented:
            continue
        elif isinstance(node, ast.JoinedStr):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "…" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


@cache
def list_texts() -> dict[Path, list[str]]:
    """Return the strings of the program by file, docstrings left out, each on one line."""
    return {path: [" ".join(s.split()) for s in list_strings(path)] for path in (ROOT / "src/presswork").rglob("*.py")}


HOUSE_WORDS = re.compile(
    r"\b(all the same|hands off|ride along|as it lies|told of|tells of|foretold|knows no|slips? of units|in no units"
    r"|stands? (beside|twice|without)|is no (kind|known|number|table|file|column|place|value|example)|are no numbers"
    r"|(let|lets|was let) go|says nothing|two ways of saying|hang together"
    r"|told|tells?|[Ss]ays?|[Ss]aid|settle[sd]?|rubs|rides|(its|their|tools'|whose) ways?|(the|of) way of)\b"
    r"|[ ,]so far$|^(Of|By) \w+ \w+.*\."
)
"""Phrases of this project that a stranger would have to read twice (the table of STYLE.md)."""


def test_messages_are_plain() -> None:
    found = {f"{path.name}: {s}" for path, texts in list_texts().items() for s in texts if HOUSE_WORDS.search(s)}
    assert not found


@pytest.mark.parametrize("page", ["howto/warnings.md", "howto/refused_files.md"])
def test_messages_that_a_page_of_warnings_explains_are_there(page: str) -> None:
    rows = re.findall(r"^\| (?!message)([^|]+) \|", (DOCS / page).read_text("utf-8"), re.MULTILINE)
    strings = "\n".join(s for texts in list_texts().values() for s in texts)
    parts = {part.strip() for row in rows for part in row.split("…")} - {""}
    assert not {part for part in parts if part not in strings}


QUESTIONS = (
    "How do I import an LS-DYNA",
    "Which element?",
    "How long will it take?",
    "Why does my run give up",
    "How do I add a material?",
    "Does it split, does it wrinkle?",
    "What does this warning or error mean?",
)
"""What a stranger asks, as the titles of pages have it."""


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_strangers_question_is_the_title_of_a_page(question: str) -> None:
    titles = [page.read_text("utf-8").partition("\n")[0] for page in PAGES]
    assert [title for title in titles if question in title]


def test_the_version_is_that_of_the_last_release() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    last = re.findall(r"^## \[([\d.]+)\] - [\d-]+$", changes, re.MULTILINE)[0]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    cited = re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert [last] == [project["version"]] == cited == [__version__]


def test_an_entry_of_the_changelog_is_one_line() -> None:
    lines = (ROOT / "CHANGELOG.md").read_text("utf-8").splitlines()
    assert all(len(line) <= LINE and not line.startswith("  ") for line in lines)
