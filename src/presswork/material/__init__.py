# SPDX-License-Identifier: Apache-2.0
"""Sheet materials at a point: the library of named sheets, identification, and forming limits."""

from presswork.case.material.library import NamedSheet, find_sheet, list_sheets, read_sheet

__all__ = ["NamedSheet", "find_sheet", "list_sheets", "read_sheet"]
