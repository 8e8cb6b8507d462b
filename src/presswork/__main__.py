# SPDX-License-Identifier: Apache-2.0
"""`python -m presswork`: the command line of the Python that runs it."""

from presswork.cli import main

if __name__ == "__main__":
    main()
