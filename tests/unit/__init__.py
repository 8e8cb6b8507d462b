# SPDX-License-Identifier: Apache-2.0
"""One part at a time; folders and files mirror the source."""
