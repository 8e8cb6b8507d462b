# SPDX-License-Identifier: Apache-2.0
"""A formed part in the input files of other programs: one module a format, each written from one FormedSheet."""
