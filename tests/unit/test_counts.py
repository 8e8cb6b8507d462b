# SPDX-License-Identifier: Apache-2.0
"""How the package is built, counted: depth of inheritance, files of a folder, circles of imports, functions, additions.

The aims are three classes deep, 25 files a folder, no circle beyond two files, 60 lines a function; five source files
that name a new element, two an interaction, an observer or a field (its own and the list). What stands above an aim is
a ceiling that may only come down. Files that a case passes in a run are counted in test_hops.py.
"""

import ast
import importlib.util
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
PACKAGE = SOURCE / "presswork"
DEEPEST, DEEPEST_TABLE, MOST_FILES, LONGEST, LONG_FUNCTIONS = 4, 6, 28, 60, 0
"""A table of keys (case/) inherits the keys that it shares with others."""


def list_modules() -> dict[str, Path]:
    """Return the files of the package by the names of their modules."""
    names = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        names[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return names


def list_public(modules: dict[str, Path]) -> dict[tuple[str, str], str]:
    """Return the module that each name comes from which a package hands on."""
    found = {}
    for name, path in modules.items():
        stub = path.with_suffix(".pyi")
        if path.name != "__init__.py":
            continue
        for node in ast.walk(ast.parse((stub if stub.exists() else path).read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                module = (
                    importlib.util.resolve_name("." * node.level + node.module, name) if node.level else node.module
                )
                found |= {(name, alias.asname or alias.name): module for alias in node.names}
    return found


def list_imports() -> dict[str, set[str]]:
    """Return the modules that each module imports, at whatever depth of the file, types included."""
    modules = list_modules()
    public, graph = list_public(modules), {}
    for name, path in modules.items():
        found = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("presswork"):
                for alias in node.names:
                    inner = f"{node.module}.{alias.name}"
                    found.add(inner if inner in modules else public.get((str(node.module), alias.name), node.module))
            elif isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
        graph[name] = {module for module in found if module in modules and module != name}
    return graph


def list_circles(graph: dict[str, set[str]]) -> Iterator[list[str]]:
    """Yield circles of imports until the rest has none."""
    graph = {name: set(others) for name, others in graph.items()}
    while True:
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as error:
            circle = error.args[1]
            yield circle[:-1]
            graph[circle[1]].discard(circle[0])
        else:
            return


def test_circles_of_imports_hold_two_files_at_most() -> None:
    circles = list(list_circles(list_imports()))
    assert not [circle for circle in circles if len(circle) > 2]


def test_classes_are_not_derived_deeper_than_the_ceiling() -> None:
    bases: dict[str, list[str]] = {}
    tables = set()
    for module, path in list_modules().items():
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ClassDef):
                bases[node.name] = [base.id for base in node.bases if isinstance(base, ast.Name)]
                tables |= {node.name} if module.startswith("presswork.case.") else set()

    def depth(name: str) -> int:
        return 1 + max((depth(base) for base in bases[name] if base in bases and base != name), default=0)

    for names, ceiling in ((bases.keys() - tables, DEEPEST), (tables, DEEPEST_TABLE)):
        deepest = max(names, key=depth)
        assert depth(deepest) == ceiling, f"{deepest}: lower the ceiling if it came down"


def test_nothing_is_derived_from_a_procedure_at_work() -> None:
    """ModelRun has engines below it, and these the kinds of body that they form; nothing is below those."""
    leaves = {"ImplicitForming", "ImplicitStamping", "ExplicitForming", "ExplicitStamping", "ReleasedStamping"}
    for path in list_modules().values():
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ClassDef):
                assert not leaves & {base.id for base in node.bases if isinstance(base, ast.Name)}, node.name


def test_folders_have_few_files() -> None:
    counts = {path: len([f for f in path.glob("*.py") if f.name != "__init__.py"]) for path in PACKAGE.rglob("*")}
    crowded = {str(path.relative_to(PACKAGE)): count for path, count in counts.items() if count > MOST_FILES}
    assert not crowded


def test_functions_are_short() -> None:
    long = [
        f"{name}:{node.name}"
        for name, path in list_modules().items()
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.FunctionDef) and (node.end_lineno or 0) - node.lineno + 1 > LONGEST
    ]
    assert len(long) <= LONG_FUNCTIONS, long


ADDITIONS = {
    "shell3_mitc_plus": 5,
    "shell4_1pt": 7,
    "hex8_fbar": 9,
    "tet4_mini": 10,
    "Inertia": 2,
    "ShellLoads": 2,
    "Gravity": 4,
    "DrawIn": 2,
    "MarkedPoints": 2,
    "SheetDepth": 2,
    "PressedSheet": 2,
    "LimitsPassed": 2,
    "straightened_strain": 1,
    "recrystallised_fraction": 2,
}
"""Source files that name what was added: kernels of elements, interactions, observers, memories, fields."""


@pytest.mark.parametrize("name", ADDITIONS)
def test_what_is_added_is_named_in_few_files(name: str) -> None:
    """By a name that nothing else has; tests/consistency/test_added_*.py add one of each kind from outside."""
    folders = (PACKAGE, SOURCE.parent / "cpp", SOURCE.parent / "bindings")
    files = [p for folder in folders for end in ("py", "hpp", "cpp", "cu") for p in folder.rglob(f"*.{end}")]
    named = [str(p) for p in files if re.search(rf"\b{name}\b", p.read_text("utf-8"))]
    assert len(named) == ADDITIONS[name], f"lower the ceiling if it came down: {named}"
