"""`python -m mimics_app`: the same as the command `mimics`."""

import sys

from mimics_app.app.cli import main

__all__: list[str] = []

if __name__ == "__main__":
    sys.exit(main())
