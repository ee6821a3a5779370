"""`mimics` with its words on a screen of 20 pictures a second: what software draws of 60 is most of a window's cost.

The loop, the mouse and what is recorded of both are as ever; tests of windows wait for what happens, not for pictures.
"""

from __future__ import annotations

import sys

from mimics_app.app.cli import main
from mimics_app.app.play import pace
from mimics_app.contracts.clock import SECOND_NS

PERIOD_NS = SECOND_NS // 20

if __name__ == "__main__":
    pace._period_ns = lambda session: PERIOD_NS
    sys.exit(main(sys.argv[1:]))
