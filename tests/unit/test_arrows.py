# SPDX-License-Identifier: Apache-2.0
"""The layout shows the architecture: an include or import that runs backwards fails here."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

CPP_ROOMS = {
    "tensor": set(),
    "reference": {"tensor"},
    "kinematics": {"tensor"},
    "material": {"tensor"},
    "element": {"tensor", "reference", "kinematics", "material"},
    "contact": {"tensor", "reference"},
    "assembly": {"tensor", "element", "contact"},
    "explicit": {"tensor", "element", "material", "assembly", "contact"},
    "device": {"tensor", "element", "material", "contact", "explicit"},
    "remesh": {"tensor"},
    "sanitize": set(),
}

PYTHON_ROOMS = {
    "simd": {"threads"},
    "threads": set(),
    "stop": set(),
    "timing": set(),
    "outcome": set(),
    "text_file": set(),
    "keyword_file": {"text_file"},
    "own_process": set(),
    "formability": set(),
    "model": {"formability"},
    "geometry": {"model"},
    "mesh": {"geometry", "keyword_file", "model", "own_process", "text_file"},
    "remesh": {"geometry", "mesh", "model"},
    "ranks": {"model"},
    "state": {"law", "model"},
    "memory": {"model"},
    "evolution": {"formability", "law", "model", "state"},
    "law": {"model"},
    "case": {
        "formability",
        "geometry",
        "law",
        "memory",
        "mesh",
        "model",
        "remesh",
        "text_file",
    },
    "deck": {"case", "keyword_file", "mesh", "model", "results", "text_file"},
    "examples": {"case", "results"},
    "fields": {"evolution", "formability", "law", "mesh", "model"},
    "results": {"fields", "formability", "geometry", "model", "text_file"},
    "body": {"evolution", "fields", "law", "mesh", "model", "outcome", "ranks", "state", "timing"},
    "interaction": {"body", "evolution", "fields", "geometry", "law", "mesh", "model", "outcome", "state"},
    "implicit": {
        "body",
        "evolution",
        "fields",
        "interaction",
        "law",
        "model",
        "outcome",
        "ranks",
        "state",
        "stop",
        "threads",
        "timing",
    },
    "explicit": {"evolution", "law", "mesh", "model", "ranks", "state", "stop"},
    "observe": {
        "body",
        "evolution",
        "fields",
        "formability",
        "geometry",
        "implicit",
        "interaction",
        "law",
        "mesh",
        "model",
        "remesh",
    },
    "process": {
        "body",
        "evolution",
        "explicit",
        "fields",
        "formability",
        "geometry",
        "implicit",
        "interaction",
        "law",
        "memory",
        "mesh",
        "model",
        "observe",
        "outcome",
        "ranks",
        "remesh",
        "results",
        "state",
        "stop",
        "threads",
        "timing",
    },
    "post": {"fields", "formability", "geometry", "mesh", "model", "results"},
    "dies": {"body", "fields", "geometry", "implicit", "mesh", "model", "post", "remesh", "results", "timing"},
    "view": {"dies", "fields", "formability", "model", "post", "results"},
    "report": {"case", "fields", "formability", "model", "post", "results", "view"},
    "step_writer": {"model", "process", "results"},
    "fingerprint": {"model"},
    "recorder": {"fingerprint", "model", "observe", "outcome", "process", "ranks", "results", "step_writer", "stop"},
    "study": {
        "api",
        "bead_forces",
        "case",
        "fields",
        "fingerprint",
        "formability",
        "geometry",
        "law",
        "mesh",
        "model",
        "outcome",
        "post",
        "recorder",
        "results",
        "text_file",
        "view",
    },
    "material": {"case", "formability", "law", "model", "text_file", "view"},
    "onestep": {"case", "explicit", "fields", "geometry", "implicit", "mesh", "model", "results"},
    "bead_forces": {"case", "fingerprint", "model", "recorder", "results"},
    "api": {
        "bead_forces",
        "case",
        "fingerprint",
        "law",
        "mesh",
        "model",
        "onestep",
        "outcome",
        "process",
        "ranks",
        "recorder",
        "results",
    },
    "notebook": {"case", "model", "outcome", "recorder", "report", "results"},
    "server": {
        "case",
        "examples",
        "geometry",
        "material",
        "mesh",
        "model",
        "outcome",
        "process",
        "recorder",
        "report",
        "results",
        "text_file",
    },
    "cli": {
        "api",
        "explicit",
        "fields",
        "case",
        "deck",
        "dies",
        "examples",
        "law",
        "material",
        "mesh",
        "model",
        "onestep",
        "outcome",
        "post",
        "process",
        "ranks",
        "results",
        "recorder",
        "report",
        "server",
        "study",
        "view",
    },
    "__main__": {"cli"},
}
"""Room: the rooms it may import from, beside itself and _core. case may name examples in errors, never import them."""


def python_files() -> list[Path]:
    package = ROOT / "src" / "presswork"
    return [p for p in sorted(package.rglob("*.py")) if p != package / "__init__.py"]


def imports_of(path: Path) -> set[str]:
    """Rooms of presswork that a file imports, at whatever depth in the file."""
    rooms = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "presswork":
            parts = node.module.split(".")
            rooms |= {parts[1]} if len(parts) > 1 else {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            rooms |= {a.name.split(".")[1] for a in node.names if a.name.startswith("presswork.")}
    return rooms


@pytest.mark.parametrize("path", sorted((ROOT / "cpp").rglob("*.[hc]pp")), ids=lambda p: p.name)
def test_includes_run_forwards(path: Path) -> None:
    room = path.relative_to(ROOT / "cpp").parts[0]
    included = {m.split("/")[0] for m in re.findall(r'#include "([^"]+)"', path.read_text("utf-8"))}
    assert included <= CPP_ROOMS[room] | {room}


@pytest.mark.parametrize("path", python_files(), ids=lambda p: str(p.relative_to(ROOT / "src" / "presswork")))
def test_imports_run_forwards(path: Path) -> None:
    room = path.relative_to(ROOT / "src" / "presswork").parts[0].removesuffix(".py")
    public = {"Case", "CaseError", "OutputError", "Result", "build_model", "__version__"}
    allowed = (
        PYTHON_ROOMS[room]
        | {room, "_core", "_cpu"}
        | (public if room in {"cli", "onestep", "recorder", "report", "results", "server", "notebook"} else set())
    )
    assert imports_of(path) <= allowed


@pytest.mark.parametrize("path", python_files(), ids=lambda p: str(p.relative_to(ROOT / "src" / "presswork")))
def test_names_of_the_model_have_one_import_path(path: Path) -> None:
    """From presswork.model, whichever of its files they stand in."""
    if "model" not in path.relative_to(ROOT / "src" / "presswork").parts:
        assert "presswork.model." not in path.read_text("utf-8")


def test_programs_and_tests_import_each_other_by_their_packages() -> None:
    """By `tests.problems.shells`, not by the bare name of a file, which is found only from its own folder."""
    files = [p for folder in ("tests", "validation", "benchmarks") for p in sorted((ROOT / folder).rglob("*.py"))]
    folders = {path.parent for path in files}
    names = {path.stem for path in files} | {folder.name for folder in folders if folder.parent != ROOT}
    for path in files:
        nodes = list(ast.walk(ast.parse(path.read_text("utf-8"))))
        imported = {(node.module or "").split(".")[0] for node in nodes if isinstance(node, ast.ImportFrom)}
        imported |= {a.name.split(".")[0] for node in nodes if isinstance(node, ast.Import) for a in node.names}
        bare = imported & names
        assert not bare, f"{path.relative_to(ROOT)} imports {', '.join(sorted(bare))} without its package"


def test_engines_name_no_observer() -> None:
    """What measures a run is listed in observe/of_model.py; a class of it is found by who asks for it by name."""
    package = ROOT / "src" / "presswork"
    observers = {
        node.name
        for path in sorted((package / "observe").rglob("*.py"))
        for node in ast.parse(path.read_text("utf-8")).body
        if isinstance(node, ast.ClassDef)
        and {base.id for base in node.bases if isinstance(base, ast.Name)} & {"Observer", "DieFill", "Memory"}
    }
    assert {"FormabilityObserver", "ToolCuts", "DieFillInPlane", "LimitsPassed", "FieldExtremes"} <= observers
    engines = [package / "recorder.py", package / "process" / "observed_run.py", package / "process" / "model_run.py"]
    for folder in ("implicit", "explicit"):
        engines += sorted((package / "process" / folder).glob("*.py"))
    for path in engines:
        names = {n.id for n in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(n, ast.Name)}
        assert not names & observers, path
