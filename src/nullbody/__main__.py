"""`python -m nullbody` is the command `nullbody`."""

from __future__ import annotations

import sys

from nullbody.cli import main

if __name__ == "__main__":
    sys.exit(main())
