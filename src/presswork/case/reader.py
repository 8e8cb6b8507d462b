# SPDX-License-Identifier: Apache-2.0
"""Reading of case files: TOML text, `key=value` overrides, and pydantic's errors turned into the engineer's words."""

from __future__ import annotations

import difflib
import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from presswork.case.errors import CaseError, Problem, explain_syntax, suggest
from presswork.case.units import ANY_LIST, ANY_NUMBER
from presswork.text_file import UnreadableError, read_text

JsonSchema = Mapping[str, Any]

DEEPEST = 32
"""Levels of tables and lists in each other that a file may have."""
MOST_TABLES = 5000
"""Tables that a file may have; each is checked, and named where it is wrong."""
LARGEST_INTEGER = 2**63
"""TOML's whole numbers have 64 bits."""
LARGEST_FILE = 16_000_000
"""Bytes of the largest case file that is read."""


@dataclass(frozen=True)
class Tables:
    """What a case file holds, before it is validated."""

    path: Path
    data: dict[str, Any]
    text: str
    """Text of the file; empty if overrides have changed the data."""


def read_tables(path: Path, overrides: Sequence[str] = ()) -> Tables:
    """Read a case file, with `key=value` overrides in its data. Raises CaseError."""
    data, text = read_toml(path)
    apply_overrides(data, overrides, path)
    return Tables(path, data, "" if overrides else text)


def read_toml(path: Path) -> tuple[dict[str, Any], str]:
    """Read a TOML file; return its data and its text."""
    try:
        text = read_text(path, most=LARGEST_FILE)
    except FileNotFoundError:
        near = difflib.get_close_matches(path.name, [entry.name for entry in path.parent.glob("*.toml")], n=1)
        remedy = f"did you mean `{path.parent / near[0]}`?" if near else "check the path"
        raise CaseError([Problem("", "no such case file", remedy)], path) from None
    except UnreadableError as error:
        raise CaseError([Problem("", error.fault, error.remedy)], path) from None
    return _parse(text, path), text


def _parse(text: str, source: Path | None) -> dict[str, Any]:
    """Read TOML text; its tables and lists may not lie deeper in each other than any case has them."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError([Problem("", f"not valid TOML: {error}", explain_syntax(text, error))], source) from None
    except ValueError as error:  # a whole number of thousands of digits
        raise CaseError([Problem("", f"not valid TOML: {error}", "shorten the number")], source) from None
    except RecursionError:
        raise CaseError([_too_deep()], source) from None
    _require_bounded(data, source)
    return data


def _too_deep() -> Problem:
    return Problem("", f"tables and lists are nested more than {DEEPEST} deep", "no case has them deeper than 10")


def _require_bounded(data: object, source: Path | None) -> None:
    """Raise CaseError for a file deeper, larger or with longer whole numbers than any case has."""
    level: list[tuple[tuple[str | int, ...], Any]] = [((), data)]
    depth = tables = 0
    while level:
        if depth > DEEPEST:
            raise CaseError([_too_deep()], source)
        tables += sum(isinstance(value, dict) for _, value in level)
        if tables > MOST_TABLES:
            text = f"more than {MOST_TABLES:,} tables"
            raise CaseError([Problem("", text, "give points as lists, [x, y], or in a file of their own")], source)
        inner: list[tuple[tuple[str | int, ...], Any]] = []
        for path, value in level:
            if isinstance(value, dict):
                inner += [((*path, key), entry) for key, entry in value.items()]
            elif isinstance(value, list):
                inner += [((*path, number), entry) for number, entry in enumerate(value)]
            elif isinstance(value, int) and not -LARGEST_INTEGER <= value < LARGEST_INTEGER:
                key = ".".join(map(str, path))
                text = f"a whole number of {value.bit_length()} bits, and TOML's have 64"
                raise CaseError([Problem(key, text, "write a smaller one, or with a point or exponent: 1e20")], source)
        level, depth = inner, depth + 1


def apply_overrides(data: dict[str, Any], overrides: Sequence[str], source: Path | None = None) -> None:
    """Write `key=value` overrides into the data of a case, in place; a value is TOML, or else a string.

    `key=` without a value removes the key.
    """
    for override in overrides:
        key, equals, text = override.partition("=")
        key = key.strip()
        if not equals or not key:
            remedy = "write --set key=value, or --set key= to remove the key"
            raise CaseError([Problem("", f"`{override}` is not of the form key=value", remedy)], source)
        if not text.strip():
            _remove(data, key, source)
            continue
        try:
            value = _parse(f"value = {text}", source)["value"]
        except CaseError:
            value = text.strip()
        try:
            _set_by_path(data, key.split("."), value)
        except LookupError as error:
            raise CaseError([Problem(key, str(error.args[0]), "mend the key given to --set", text)], source) from None


def _remove(data: dict[str, Any], key: str, source: Path | None) -> None:
    """Remove a key of a table, or an entry of a list; the entries after it move up."""
    *keys, last = key.split(".")
    here: Any = data
    for depth, name in enumerate([*keys, last]):
        choices = (
            here if isinstance(here, dict) else [str(i) for i in range(len(here))] if isinstance(here, list) else []
        )
        if name not in choices:
            remedy = suggest(name, choices, f"keys of `{'.'.join(keys[:depth])}`" if depth else "keys of the case")
            remedy += f". For an empty text write --set '{key}=\"\"'"
            raise CaseError([Problem(key, "there is no such key to remove", remedy)], source)
        if depth < len(keys):
            here = here[name] if isinstance(here, dict) else here[int(name)]
    if isinstance(here, dict):
        del here[last]
    else:
        here.pop(int(last))


def _set_by_path(data: dict[str, Any], keys: Sequence[str], value: object) -> None:
    """Set the value at a path of table keys and list indices; tables that are missing are made."""
    here: Any = data
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        name: str | int = key
        if isinstance(here, list):
            if not (key.isascii() and key.isdigit() and len(key) < 10) or int(key) >= len(here):
                where = ".".join(keys[:depth])
                raise LookupError(
                    f"`{where}` is a list of {len(here)}: `{key}` is not an index from 0 to {len(here) - 1}"
                )
            name = int(key)
        elif not isinstance(here, dict):
            raise LookupError(f"`{'.'.join(keys[:depth])}` is a value, not a table")
        if last:
            here[name] = value
        else:
            here = here.setdefault(name, {}) if isinstance(here, dict) else here[name]


def list_problems(error: ValidationError, data: object, schema: JsonSchema) -> list[Problem]:
    """Turn pydantic's errors into problems: `data` is what was validated, `schema` the JSON schema of it."""
    entries = [dict(entry) for entry in error.errors(include_url=False)]
    problems = [_translate(entry, data, schema) for entry in entries if not _follows_from_an_entry(entry)]
    return [problem for problem in problems if not _is_of_a_form_not_taken(problem, problems)]


def _is_of_a_form_not_taken(problem: Problem, problems: Sequence[Problem]) -> bool:
    """Return whether a place that may be a value or a list was meant as the other, which has its own problem."""
    others = [other for other in problems if other is not problem]
    if problem.expected == "expected a list":
        return any(other.key == problem.key for other in others)
    return isinstance(problem.value, list) and any(other.key.startswith(f"{problem.key}.") for other in others)


def _follows_from_an_entry(entry: Mapping[str, Any]) -> bool:
    """Return whether a list is only called too short because pydantic left out entries that have their own error."""
    return bool(entry["type"] == "too_short" and len(entry["input"]) >= entry["ctx"]["min_length"])


def _translate(entry: dict[str, Any], data: object, schema: JsonSchema) -> Problem:
    """Translate one pydantic error into the words of a case file."""
    kind: str = entry["type"]
    context: dict[str, Any] = entry.get("ctx", {})
    value = entry["input"]
    location = entry["loc"]
    if location and location[-1] == "[key]":  # pydantic's mark of a fault in a name, not in what bears it
        location, value = location[:-1], {}
    key, node, parent = _walk(location, data, schema)
    if kind == "case":
        sub_key = context["key"]
        key = f"{key}.{sub_key}" if key and sub_key else key or sub_key
        value, remedy = _descend(value, sub_key), context["remedy"]
        if remedy == ANY_NUMBER and isinstance(node.get("default"), int | float):
            remedy = f"write for instance {node['default']:g}"  # which is within the bounds of the key
        elif remedy.startswith(f"{ANY_LIST}["):
            remedy = _pick_list(key, node, parent, remedy)
        return _problem(key, context["expected"], remedy, value)
    name = key.rsplit(".", 1)[-1]
    if kind == "extra_forbidden":
        return _problem(key, "unknown key", _suggest_key(key, name, parent, schema), value)
    if kind == "missing":
        meaning = _meaning(node)
        return Problem(key, "missing key", f"add it: {meaning}" if meaning else "add it")
    if kind == "union_tag_not_found":
        tag = context["discriminator"].strip("'")
        choices = ", ".join(_choices(node))
        return Problem(f"{key}.{tag}", "missing key", f"add it, one of: {choices}")
    if kind == "union_tag_invalid":
        tag = context["discriminator"].strip("'")
        return Problem(f"{key}.{tag}", "unknown choice", suggest(context["tag"], _choices(node)), context["tag"])
    if kind == "literal_error":
        remedy = suggest(value, _choices(node)) if isinstance(value, str) else f"choices: {', '.join(_choices(node))}"
        return _problem(key, "unknown choice", remedy, value)
    expected = _expectation(kind, context, str(entry["msg"]))
    return _problem(key, expected, _meaning(node) or _meaning(parent) or _instance(key, expected), value)


def _pick_list(key: str, node: JsonSchema, table: JsonSchema, remedy: str) -> str:
    """Return a remedy whose list is within the bounds of its key; of a place, what a tool can do without one."""
    default = node.get("default")
    if isinstance(default, list | tuple) and all(isinstance(each, int | float) for each in default):
        return f"{ANY_LIST}[{', '.join(f'{each:g}' for each in default)}]"
    if key.rsplit(".", 1)[-1] == "position":
        instead = 'write "touch"' if "position" in table.get("required", ()) else "leave it out"
        return f"{instead}, or give every value"
    return remedy


def _suggest_key(key: str, name: str, table: JsonSchema, schema: JsonSchema) -> str:
    """Explain where an unknown key belongs: in another table, or which key of this one is meant."""
    keys = table.get("properties", {})
    here = key.split(".")[:-1]
    places = [place or "the case itself" for place in _find_tables(name, schema) if not _is_at(here, place)]
    if places:
        return f"it is a key of {' and of '.join(places[:3])} (keys here: {', '.join(sorted(keys))})"
    return suggest(name, keys, "keys here")


def _is_at(path: Sequence[str], place: str) -> bool:
    """Return whether a place of the schema, where NAME and N stand for any entry, is that of a path."""
    steps = place.split(".") if place else []
    pairs = zip(path, steps, strict=False)
    return len(steps) == len(path) and all(step in ("NAME", "N", own) for own, step in pairs)


def _find_tables(name: str, schema: JsonSchema) -> list[str]:
    """Return the dotted paths of tables that have a key, the shortest first; NAME and N stand for any entry."""
    found: dict[str, None] = {}
    tables: list[tuple[str, Any]] = [("", schema)]
    seen: set[str] = set()
    while tables:
        path, node = tables.pop(0)
        if reference := node.get("$ref", ""):
            if reference in seen:
                continue
            seen.add(reference)
            node = schema["$defs"][reference.rsplit("/", 1)[-1]]
        if name in node.get("properties", {}):
            found[path] = None
        inner = [(f"{path}.{key}".strip("."), value) for key, value in node.get("properties", {}).items()]
        inner += [(path, option) for key in ("anyOf", "oneOf") for option in node.get(key, ())]
        for key, entry in (("items", "N"), ("additionalProperties", "NAME")):
            if isinstance(node.get(key), dict):
                inner.append((f"{path}.{entry}", node[key]))
        tables += inner
    return list(found)


def _instance(key: str, expected: str) -> str:
    """Return a remedy for a place whose schema has none: what may stand there, for instance."""
    texts = {
        "a table": f"write [{key}], and its keys below",
        "a list": "write [1, 2], for instance",
        "a whole number": "write 10, for instance",
        "true or false": "write true, for instance",
        "a text in quotes": 'write "steel", for instance',
    }
    return texts.get(expected.removeprefix("expected "), "write a value within these bounds")


def _descend(value: object, key: str) -> object:
    """Return what stands at a dotted key under a value; the value itself where nothing does."""
    here = value
    for name in key.split(".") if key else ():
        if isinstance(here, dict) and name in here:
            here = here[name]
        elif isinstance(here, list | tuple) and name.isdigit() and int(name) < len(here):
            here = here[int(name)]
        else:
            return value
    return here


def _problem(key: str, expected: str, remedy: str, value: object) -> Problem:
    """Make a problem that shows the value unless it is a whole table, which would only drown the message."""
    if isinstance(value, dict | BaseModel):
        return Problem(key, expected, remedy)
    return Problem(key, expected, remedy, value)


def _expectation(kind: str, context: Mapping[str, Any], message: str) -> str:
    """Describe what pydantic's commonest checks expect."""
    if kind in ("model_type", "model_attributes_type", "dict_type", "mapping_type"):
        return "expected a table"
    if kind in ("tuple_type", "list_type"):
        return "expected a list"
    if kind.startswith("int_"):
        return "expected a whole number"
    if kind.startswith("bool_"):
        return "expected true or false"
    if kind == "string_type":
        return "expected a text in quotes"
    signs = {"greater_than": ("gt", "> "), "greater_than_equal": ("ge", ">= "), "less_than": ("lt", "< ")}
    signs["less_than_equal"] = ("le", "<= ")
    if kind in signs:
        name, sign = signs[kind]
        return f"expected a value {sign}{context[name]:g}"
    if kind == "too_short":
        least = context["min_length"]
        return f"expected at least {least} {'entry' if least == 1 else 'entries'}"
    if kind == "too_long":
        return f"expected at most {context['max_length']} entries"
    return f"expected otherwise: {message}"


def _walk(location: Sequence[str | int], data: object, schema: JsonSchema) -> tuple[str, JsonSchema, JsonSchema]:
    """Follow an error's location; return the dotted key that the user wrote, the schema there, and the one above."""
    path: list[str] = []
    node, parent = _resolve(schema, schema), schema
    raw = data
    for step in location:
        mapping = node.get("discriminator", {}).get("mapping", {})
        if step in mapping:  # pydantic names the chosen kind of a union, which is no key of the file
            node = _resolve({"$ref": mapping[step]}, schema)
            continue
        parent = node
        node = _resolve(_child(node, step), schema)
        order = parent.get("short_form", ())
        if isinstance(raw, list | tuple) and len(order) > 1 and step in order:  # of which it is one of the values
            path.append(str(order.index(step)))
            raw = _entry(raw, order.index(step))
            continue
        if isinstance(raw, list | tuple | str | float | int) and isinstance(step, str):
            continue  # the short list form of a table, e.g. [x, y] for {to = [x, y]}; a form that a value may take
        if isinstance(raw, Mapping) and "[" in str(step) and step not in raw:
            continue
        path.append(str(step) if step != "" and str(step).isprintable() else json.dumps(step))
        raw = _entry(raw, step)
    return ".".join(path), node, parent


def _entry(raw: object, step: str | int) -> object:
    if isinstance(raw, Mapping):
        return raw.get(step)
    if isinstance(raw, list | tuple) and isinstance(step, int) and step < len(raw):
        return raw[step]
    return getattr(raw, str(step), None)


def _child(node: JsonSchema, step: str | int) -> JsonSchema:
    if isinstance(step, int):
        lists = [option["items"] for option in (node, *node.get("anyOf", ())) if "items" in option]
        return dict(lists[0]) if lists else {}
    properties = node.get("properties", {})
    if step in properties:
        return dict(properties[step])
    more = node.get("additionalProperties", {})
    return dict(more) if isinstance(more, dict) else {}


def _resolve(node: JsonSchema, root: JsonSchema) -> JsonSchema:
    """Follow references; of `X or nothing` and `table or short form` take the first with keys, keeping descriptions."""
    description = node.get("description")
    while "$ref" in node:
        node = root["$defs"][node["$ref"].rsplit("/", 1)[-1]]
    if "anyOf" in node:
        options = [_resolve(option, root) for option in node["anyOf"] if option.get("type") != "null"]
        with_keys = [option for option in options if "properties" in option or "discriminator" in option]
        if with_keys or len(options) == 1:
            node = (with_keys or options)[0]
    return {**node, "description": description} if description else node


def _meaning(node: JsonSchema) -> str:
    return str(node.get("description", ""))


def _choices(node: JsonSchema) -> list[str]:
    if "discriminator" in node:
        return list(node["discriminator"]["mapping"])
    if "const" in node:
        return [str(node["const"])]
    if "items" in node and "enum" in node["items"]:
        return [str(choice) for choice in node["items"]["enum"]]
    return [str(choice) for choice in node.get("enum", [])]
