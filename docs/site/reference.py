# SPDX-License-Identifier: Apache-2.0
"""Pages of the reference that are made from the program: keys of cases, fields, commands, Python names.

A key is described once, in its pydantic class; a field in the table of fields; a command in its function. These pages
repeat it, with the packaged examples that use a key.
"""

from __future__ import annotations

import inspect
import json
import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import presswork
from presswork.case import json_schema as _json_schema
from presswork.case.kinds import KINDS as CASES
from presswork.cli.commands import COMMANDS, load
from presswork.fields.field import Field
from presswork.fields.table import FIELDS

sys.path.insert(0, str(Path(__file__).parent))
from key_examples import Block, find_blocks

EXAMPLES = Path(presswork.__file__).parent / "examples"
KINDS = {
    "plane": ("Keys of a solid in the plane or in axisymmetry", '`analysis = "axisymmetric"` or `"plane_strain"`'),
    "solid": ("Keys of a solid in space", '`analysis = "solid"`'),
    "stamping": ("Keys of a stamping", '`analysis = "stamping"`'),
    "shell": ("Keys of a shell without tools", '`analysis = "shell"`'),
    "heat": ("Keys of heat alone", '`analysis = "heat"`'),
    "onestep": ("Keys of one step back", '`analysis = "onestep"`'),
}
"""Title of the page of each kind of case, and the value of `analysis` that chooses it."""
UNIT = re.compile(r"\s*\[((?:1/|degrees? ?C?|mm|N|MPa|kW|kJ|kg|t/|W/|J/|s\b|K\b|um|us|rpm)[^\[\],]*)\]")
ROW = "| {} | {} | {} | {} | {} | {} | {} |\n"
PLAIN = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false"}
MOST_EXAMPLES = 3
NO_VALUE = "–"
"""Default of a key that has no value of its own where it is left out; its meaning says what holds then."""
ABOVE = ""
"""Stands among a key's examples for the block above its table."""


@cache
def json_schema(kind: str) -> dict[str, Any]:
    """Return the schema of a kind of case."""
    return _json_schema(kind)


@dataclass
class Key:
    """A key of a table: what its class says of it, and the examples that use it."""

    name: str
    schema: dict[str, Any]
    needed: bool
    examples: set[str] = field(default_factory=set)
    """Names of packaged examples, and ABOVE."""


@dataclass
class Table:
    """A table of case files: its place in the file, its class's description, its keys by name."""

    place: str
    description: str
    keys: dict[str, Key]
    blocks: list[Block] = field(default_factory=list)
    """Examples shown above its keys."""


def unfold(schema: dict[str, Any], defs: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the alternatives of a schema, each with the name of its class (empty for a plain value)."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        inner = list(unfold(defs[name], defs))
        yield from ((found or name, node) for found, node in inner)
    elif choices := schema.get("anyOf") or schema.get("oneOf"):
        for choice in choices:
            yield from unfold(choice, defs)
    else:
        yield "", schema


def list_tables(kind: str) -> dict[str, Table]:
    """Return the tables of a kind of case by the names of their classes, in the order in which a reader meets them."""
    root = json_schema(kind)
    defs, tables = root.get("$defs", {}), {}
    waiting = [("", "", root)]
    while waiting:
        place, name, schema = waiting.pop(0)
        if name in tables:
            continue
        needed = schema.get("required", [])
        keys = {key: Key(key, inner, key in needed) for key, inner in schema["properties"].items()}
        tables[name] = Table(place, schema.get("description", ""), keys)
        for key, inner in schema["properties"].items():
            waiting += [
                (f"{place}.{key}{step}".lstrip("."), found or f"{name}.{key}", node)
                for step, found, node in list_inner(inner, defs)
            ]
    return tables


def list_inner(schema: dict[str, Any], defs: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield the tables within a key: what follows its name in the place of the table, class and schema."""
    for name, node in unfold(schema, defs):
        if "properties" in node:
            yield "", name, node
        elif isinstance(rows := node.get("items"), dict):
            yield from ((f"[]{step}", found, inner) for step, found, inner in list_inner(rows, defs))
        elif isinstance(named := node.get("additionalProperties"), dict):
            yield from ((f".NAME{step}", found, inner) for step, found, inner in list_inner(named, defs))


def use(data: Any, schema: dict[str, Any], defs: dict[str, Any], tables: dict[str, Table], example: str) -> None:
    """Note at every key that an example gives that this example uses it."""
    for name, node in unfold(schema, defs):
        keys = node.get("properties")
        if isinstance(data, dict) and keys is not None:
            chosen = [
                key
                for key, inner in keys.items()
                if "const" in inner and data.get(key, inner["const"]) != inner["const"]
            ]
            if name not in tables or chosen or not set(data) <= set(keys):
                continue
            for key, value in data.items():
                tables[name].keys[key].examples.add(example)
                use(value, keys[key], defs, tables, example)
        elif isinstance(data, dict) and isinstance(named := node.get("additionalProperties"), dict):
            for value in data.values():
                use(value, named, defs, tables, example)
        elif isinstance(data, list) and isinstance(rows := node.get("items"), dict):
            for value in data:
                use(value, rows, defs, tables, example)


def describe_type(schema: dict[str, Any], defs: dict[str, Any]) -> str:
    """Return in words what a key takes."""
    words: list[str] = []
    for name, node in unfold(schema, defs):
        if "properties" in node:
            word = f"table [{name}](#{name.lower()})" if name else "table"
        elif "enum" in node or "const" in node:
            word = ", ".join(f"`{value}`" for value in node.get("enum", [node.get("const")]))
        elif isinstance(rows := node.get("items"), dict):
            word = f"list of {describe_type(rows, defs)}"
        elif "prefixItems" in node:
            word = f"list of {len(node['prefixItems'])} values"
        elif isinstance(named := node.get("additionalProperties"), dict):
            word = f"tables by name: {describe_type(named, defs).replace('table ', '')}"
        else:
            types = node.get("type", [])
            found = [PLAIN[kind] for kind in ([types] if isinstance(types, str) else types) if kind in PLAIN]
            word = " or ".join("text with a unit" if text == "text" and "examples" in node else text for text in found)
        words += [word] if word and word not in words else []
    return " or ".join(words)


def find_bounds(schema: dict[str, Any]) -> str:
    """Return the range of a number, as `> 0, <= 1`."""
    signs = {"exclusiveMinimum": ">", "gt": ">", "minimum": ">=", "ge": ">="}
    signs |= {"exclusiveMaximum": "<", "lt": "<", "maximum": "<=", "le": "<="}
    nodes = [schema, *schema.get("anyOf", [])]
    return ", ".join(dict.fromkeys(f"{signs[key]} {node[key]:g}" for node in nodes for key in signs if key in node))


def write_default(key: Key) -> str:
    """Return what holds where a key is left out; empty where its description must say it and does not."""
    if key.needed:
        return "needed"
    if "default" not in key.schema:
        return NO_VALUE if "needed without" in key.schema["description"] else ""
    given = key.schema["default"]
    if given is None:
        return NO_VALUE
    if isinstance(given, dict) and given:
        table = ", ".join(f"{name} = {json.dumps(value)}" for name, value in given.items())
        return f"`{{ {table} }}`" if len(given) == 1 else "its defaults"
    return f"`{json.dumps(given)}`"


def write_key(key: Key, defs: dict[str, Any]) -> str:
    """Return the row of a key."""
    text = " ".join(key.schema["description"].split())
    unit = UNIT.search(text)
    meaning = (UNIT.sub("", text) if unit else text).replace("|", "\\|").replace("<", "&lt;")
    shown = sorted(key.examples - {ABOVE})[:MOST_EXAMPLES]
    used = ", ".join(f"[{name}](../gallery.md#{name})" for name in shown) or "above"
    return ROW.format(
        f"`{key.name}`",
        describe_type(key.schema, defs).replace("|", "\\|"),
        unit[1] if unit else "",
        write_default(key),
        find_bounds(key.schema).replace("<", "&lt;").replace(">", "&gt;"),
        meaning,
        used,
    )


def find_keys(kind: str) -> dict[str, Table]:
    """Return the tables of a kind of case, each key with the examples that use it."""
    tables, schema = list_tables(kind), json_schema(kind)
    words = next(
        (inner.get("enum") or [inner.get("const")] for key, inner in schema["properties"].items() if key == "analysis")
    )
    defs = schema.get("$defs", {})
    for path in sorted(EXAMPLES.glob("*.toml")):
        data = tomllib.loads(path.read_text("utf-8"))
        if data.get("analysis") in words:
            use(data, schema, defs, tables, path.stem)
    for name, table in tables.items():
        table.blocks = find_blocks(name or CASES[kind].name, set(table.keys))
        for block in table.blocks:
            use(block.data, {"$ref": f"#/$defs/{name}"} if name else schema, defs, tables, ABOVE)
    return tables


def describe(table: Table) -> str:
    """Return a table's description, without what it raises in Python."""
    text = table.description.split(" Raises ")[0].rstrip(".")
    return f"{text}." if text else ""


def make_keys(kind: str) -> str:
    """Return the page of a kind of case: a section for every table."""
    title, choice = KINDS[kind]
    tables, defs = find_keys(kind), json_schema(kind).get("$defs", {})
    page = [
        f"# {title}\n\nCase files with {choice}. A number has the unit given; a text with another unit is converted. "
        "A place with `NAME` takes names of your own, one with `[]` is a list of tables. Numbers of the examples are "
        "plausible; measured ones of materials are in the [library](../howto/sheet_materials.md).\n"
    ]
    for name, table in tables.items():
        head = f"## {name or 'The case'} {{ #{name.lower() or 'case'} }}\n\n{describe(table)}"
        place = f" Place: `{table.place}`.\n" if table.place else "\n"
        rows = "".join(write_key(key, defs) for key in table.keys.values())
        shown = "\n".join(block.write(table.place) for block in table.blocks)
        page.append(
            f"{head}{place}\n{shown}\n{ROW.format('key', 'type', 'unit', 'default', 'range', 'meaning', 'examples')}"
        )
        page[-1] += ROW.format(*["---"] * 7) + rows
    return "\n".join(page)


def make_fields() -> str:
    """Return the page of fields: name, unit, components, words."""
    places = {"point": "At nodes", "cell": "In cells", "layer": "In layers of a sheet: bottom, middle, top"}
    page = ["# Fields of the results\n\nA name in braces stands for a layer, a tool or a number.\n"]

    def write(row: Field) -> str:
        name = row.name.replace("{}", f"{{{row.each}}}")
        words = (row.label or row.name.replace("_", " ")).replace("{}", row.each)
        short = f"`{row.alias}`" if row.alias else ""
        return f"| `{name}` | {row.unit} | {' '.join(row.components)} | {words} | {short} |"

    for place, title in places.items():
        rows = [write(row) for row in FIELDS.values() if row.place == place]
        page.append(f"## {title}\n\n| field | unit | components | words | short name |\n|---|---|---|---|---|")
        page[-1] += "\n" + "\n".join(rows) + "\n"
    return "\n".join(page)


def write_command(name: str, command: Any) -> Iterator[str]:
    """Yield the section of a command, or of each command of a group."""
    if group := getattr(command, "commands", None):
        for inner, found in group.items():
            yield from write_command(f"{name} {inner}", found)
        return
    text = inspect.cleandoc(command.help or COMMANDS.get(name, "")).replace("<", "&lt;")
    yield f"## presswork {name}\n\n{text}\n"
    rows = []
    for option in command.params:
        flags = ", ".join(f"`{flag}`" for flag in [*option.opts, *option.secondary_opts] if flag.startswith("-"))
        shown = "" if option.default in (None, False, (), [], ...) else f"`{option.default}`"
        meaning = (getattr(option, "help", "") or "").replace("|", "\\|").replace("<", "&lt;")
        name_of = flags or f"`{(option.name or '').upper()}`"
        rows.append(f"| {name_of} | {'needed' if option.required else shown} | {meaning} |")
    yield "| option | default | meaning |\n|---|---|---|\n" + "\n".join(rows) + "\n"


def make_commands() -> str:
    """Return the page of the command line."""
    page = ["# Command line\n\n`presswork COMMAND --help` prints the same.\n"]
    for name in COMMANDS:
        page += write_command(name, load(name))
    return "\n".join(page)


def make_python() -> str:
    """Return the page of the names that `import presswork` offers."""
    page = [
        "# Python names\n\nNames of `presswork`; each has its arguments in its docstring (`help(presswork.run)`).\n"
    ]
    for name in sorted(presswork.__all__):
        thing = getattr(presswork, name)
        if name.startswith("_") or inspect.ismodule(thing):
            continue
        head = name + (str(inspect.signature(thing)) if inspect.isfunction(thing) else "")
        first = (inspect.getdoc(thing) or "").partition("\n")[0]
        page.append(f"## {name} {{ #{name.lower()} }}\n\n```python\n{head}\n```\n\n{first}\n")
    return "\n".join(page)


def make_pages() -> dict[str, str]:
    """Return the pages of the reference by their place in docs/."""
    pages = {f"reference/keys_{kind}.md": make_keys(kind) for kind in KINDS}
    pages |= {"reference/fields.md": make_fields(), "reference/commands.md": make_commands()}
    return pages | {"reference/python.md": make_python()}
