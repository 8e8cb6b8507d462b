# SPDX-License-Identifier: Apache-2.0
"""From the table `forming_limit` of a sheet to its curve: Keeler, points, Swift-Hill, Marciniak-Kuczynski."""
