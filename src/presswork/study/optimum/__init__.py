# SPDX-License-Identifier: Apache-2.0
"""Optimisation of a case: variables between bounds, goals and limits by the measures of its runs."""
