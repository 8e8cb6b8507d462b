# SPDX-License-Identifier: Apache-2.0
"""A case file's text after values of it have changed: comments, order and the writing of what stayed are kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.container import Container, OutOfOrderTableProxy
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Array, InlineTable, Table

from presswork.server.opened_folder import RefusedError

_TABLES = (Container, Table, InlineTable, OutOfOrderTableProxy)


def rewrite(text: str, data: Mapping[str, Any]) -> str:
    """Return the text with the values of the data: keys that it lacks are removed, null is no value.

    A value that is equal to the one that stands there keeps its writing. Raises RefusedError if the text is not TOML.
    """
    try:
        document = tomlkit.parse(text)
        _write_table(document, data)
        return tomlkit.dumps(document)
    except (TOMLKitError, ValueError, TypeError, RecursionError) as error:
        raise RefusedError(f"not valid TOML: {error}") from error


def _write_table(table: Any, data: Mapping[str, Any], *, is_dotted: bool = False) -> None:
    """Write values into a table; is_dotted: it stands in a dotted key, tools.die = {...}, so new tables are inline."""
    for key in [key for key in table if data.get(key) is None]:
        table.remove(key)
    for key, value in data.items():
        if value is None:
            continue
        if key not in table or not _write_into(table[key], value, is_dotted=is_dotted or _is_dotted(table, key)):
            table[key] = _make(value, is_inline=is_dotted or isinstance(table, InlineTable))


def _is_dotted(table: Any, key: str) -> bool:
    """Return whether a key of a table is the first part of a dotted one."""
    container = table if isinstance(table, Container) else getattr(table, "value", None)
    body = container.body if isinstance(container, Container) else []
    return any(each is not None and each.key == key and each.is_dotted() for each, _ in body)


def _write_into(item: Any, value: Any, *, is_dotted: bool = False) -> bool:
    """Write a value into what stands there; return whether that could be done, or nothing was to be done."""
    if isinstance(item, _TABLES) and isinstance(value, dict):
        _write_table(item, value, is_dotted=is_dotted)
        return True
    if isinstance(item, AoT) and isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
        for i, each in enumerate(value):
            if i < len(item):
                _write_table(item[i], each)
            else:
                item.append(_make(each, is_inline=False))
        while len(item) > len(value):
            del item[-1]
        return True
    if isinstance(item, Array) and isinstance(value, list) and len(item) == len(value):
        for i, each in enumerate(value):
            if not _write_into(item[i], each):
                item[i] = _make(each, is_inline=True)
        return True
    plain = item.unwrap() if hasattr(item, "unwrap") else item
    return bool(plain == value and isinstance(plain, bool) == isinstance(value, bool))


def _make(value: Any, *, is_inline: bool) -> Any:
    """Return a value as it is written anew: tables under heads of their own, those in lines inline."""
    if isinstance(value, dict):
        table: Any = tomlkit.inline_table() if is_inline else tomlkit.table()
        for key, each in value.items():
            if each is not None:
                table[key] = _make(each, is_inline=is_inline)
        return table
    if isinstance(value, list):
        if value and not is_inline and all(isinstance(each, dict) for each in value):
            tables = tomlkit.aot()
            for each in value:
                tables.append(_make(each, is_inline=False))
            return tables
        array = tomlkit.array()
        for each in value:
            array.append(_make(each, is_inline=True))
        return array
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return int(value)
    return value
