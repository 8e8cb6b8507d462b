# SPDX-License-Identifier: Apache-2.0
"""Zones of a welded blank, and thickness of a rolled one."""
