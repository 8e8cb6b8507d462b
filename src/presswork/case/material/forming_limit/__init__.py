# SPDX-License-Identifier: Apache-2.0
"""Turns the table `forming_limit` of a sheet into its curve: Keeler, points, Swift-Hill, Marciniak-Kuczynski."""
