# SPDX-License-Identifier: Apache-2.0
"""A sweep as its page shows it: the table with names and units of its columns, and the curve of each member."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from presswork.case import CaseError, json_schema
from presswork.report.history import choose_curves, describe_column
from presswork.report.parts import round_values
from presswork.results import OutputError, Result
from presswork.results.folder import CASE, RESULTS
from presswork.server.opened_folder import OpenedFolder, RefusedError, read_case_data
from presswork.text_file import UnreadableError

TABLE = "table.csv"
_MOST_BYTES = 16_000_000
_MOST_POINTS = 300
"""Points of a curve in the page."""
_UNIT = re.compile(r"\[((?:1/|degrees? ?C?|°C|mm|N|MPa|kW|kJ|kg|t/|W/|J/|s\b|K\b|rpm)[^\[\],]*)\]")
"""A unit in the description of a key."""
_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-z%°µ].*?)\s*")
_UNITS = {"seconds": "s", "percent": "%", "draw_in": "mm", "springback": "mm", "deviation": "mm", "height": "mm"}
"""Unit of columns of a table by the end of their name, beside those of the history."""


def read_sweep(opened: OpenedFolder, name: str) -> dict[str, Any]:
    """Return the table of a sweep: columns with names and units, rows of numbers and texts, the run of each row.

    `varied` counts the columns behind the first that were varied. Raises RefusedError for what is no sweep.
    """
    folder, path = opened.find(name), opened.find(f"{name}/{TABLE}")
    if not path.is_file() or path.stat().st_size > _MOST_BYTES:
        raise RefusedError(f"{name} is not a sweep", 404)
    lines = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8"))))
    columns, texts = lines[0] if lines else [], lines[1:]
    varied = columns.index("status") - 1 if "status" in columns else 0
    kind = _find_kind(opened, name, texts)
    heads: list[dict[str, Any]] = []
    table: list[list[float | str | None]] = []
    for number, column in enumerate(columns):
        is_varied = 0 < number <= varied
        cells = [row[number] if number < len(row) else "" for row in texts]
        values, unit = _read_quantities(cells) if is_varied else ([_to_value(cell) for cell in cells], "")
        head = _describe_varied(column, kind, unit) if is_varied else _describe_found(column)
        if not is_varied and any(head["label"] == other["label"] for other in heads):
            head["label"] += " reached"
        heads.append({"column": column, **head})
        table.append([value * head["factor"] if isinstance(value, float) else value for value in values])
    there = {p.name for p in folder.glob("member_*") if (p / RESULTS).is_file()}
    members = [f"{name}/{row[0]}" if row[0] in there else None for row in texts]
    rows = [list(row) for row in zip(*table, strict=True)]
    return {"name": name, "heads": heads, "varied": varied, "rows": rows, "members": members}


def read_curves(opened: OpenedFolder, name: str) -> dict[str, Any]:
    """Return force over stroke, or what a run shows first, of every member: {member, x, y, ...} by what is drawn."""
    folder = opened.find(name)
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for path in sorted(folder.glob("member_*")):
        try:
            run = opened.find_run(f"{name}/{path.name}")
            result = Result(run)
            history = result.history
            pairs = choose_curves(result, history)
        except (OutputError, RefusedError):
            continue
        for x, y in pairs:
            rows = np.unique(np.linspace(0, len(history[x]) - 1, _MOST_POINTS).round().astype(int))
            places = [np.asarray(history[key], dtype=np.float64)[rows] * describe_column(key)[2] for key in (x, y)]
            curve = {"member": path.name, "x": round_values(places[0]), "y": round_values(places[1])}
            found.setdefault((x, y), []).append(curve)
    pairs_of = [(describe_column(x), describe_column(y), curves) for (x, y), curves in found.items()]
    return {
        "charts": [
            {"x": {"label": x[0], "unit": x[1]}, "y": {"label": y[0], "unit": y[1]}, "curves": curves}
            for x, y, curves in pairs_of
        ]
    }


def _describe_found(column: str) -> dict[str, Any]:
    """Return what a column of results is called, its unit, and the factor to it."""
    label, unit, factor = describe_column(column)
    label = label.replace("wall seconds", "wall time").removesuffix(" percent")
    ending = next((own for end, own in _UNITS.items() if column.endswith(end)), None)
    return {"label": label, "unit": ending or unit, "factor": 1.0 if ending else factor}


def _describe_varied(key: str, kind: str, unit: str) -> dict[str, Any]:
    """Return what a varied key is called: the last words of its path, and its unit; unit: of values written with one.

    >>> _describe_varied("stages.0.tools.punch.stroke", "stamping", "")
    {'label': 'punch stroke', 'unit': 'mm', 'factor': 1.0}
    """
    words = [part.replace("_", " ") for part in key.split(".") if part != "tools"]
    number = words.pop() if words[-1].isdigit() and len(words) > 1 else ""
    label = " ".join([*(word for word in words[-2:] if not word.isdigit()), *([number] if number else [])])
    return {"label": label, "unit": unit or _find_unit(key, kind), "factor": 1.0}


def _find_unit(key: str, kind: str) -> str:
    """Return the unit that the schema gives a key of a case; empty if it has none."""
    if not kind:
        return ""
    schema = json_schema(kind)
    nodes = [schema]
    for part in key.split("."):
        nodes = [child for node in nodes for child in _step(node, part, schema)]
    texts = (str(inner.get("description", "")) for node in nodes for inner in (node, *_branches(node, schema)))
    return next((found[1] for text in texts if (found := _UNIT.search(text))), "")


def _branches(node: dict[str, Any], schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield what a place may hold, references followed."""
    if "$ref" in node:
        yield from _branches(schema["$defs"][node["$ref"].rpartition("/")[2]], schema)
        return
    inner = node.get("anyOf") or node.get("oneOf")
    if not inner:
        yield node
        return
    for branch in inner:
        yield from _branches(branch, schema)


def _step(node: dict[str, Any], part: str, schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield what a place holds under a key or a number."""
    for branch in _branches(node, schema):
        if part in branch.get("properties", {}):
            yield branch["properties"][part]
        elif isinstance(branch.get("additionalProperties"), dict):
            yield branch["additionalProperties"]
        elif part.isdigit() and "items" in branch:
            yield {**branch["items"], **({"description": node["description"]} if "description" in node else {})}


def _find_kind(opened: OpenedFolder, name: str, texts: Sequence[Sequence[str]]) -> str:
    """Return the kind of case of the members; empty where none can be read."""
    for row in texts:
        try:
            analysis = str(read_case_data(opened.find(f"{name}/{row[0]}/{CASE}")).get("analysis", ""))
            json_schema(analysis)
        except (CaseError, OSError, RefusedError, UnreadableError, ValueError):
            continue
        return analysis
    return ""


def _read_quantities(cells: Sequence[str]) -> tuple[list[float | str | None], str]:
    """Return the values of a varied key, and their unit where all are written with the same one: 10 kN, 15 kN."""
    matches = [None if isinstance(_to_value(cell), float) else _QUANTITY.fullmatch(cell) for cell in cells]
    units = {found[2] if found else None for found in matches}
    if len(units) == 1 and None not in units:
        return [float(found[1]) for found in matches if found], units.pop() or ""
    return [_to_value(cell) for cell in cells], ""


def _to_value(text: str) -> float | str | None:
    """Return a cell of the table as a number if it is one."""
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        return text
    return number if abs(number) < 1e300 else text
