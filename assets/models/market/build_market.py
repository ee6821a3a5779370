"""Builds the models of the pick and place scene: apple, stall, trees, meadow, hand, and what stands about.

`mimics assets build market`, or python assets/models/market/build_market.py [FOLDER [SEED]]

The work is done by mimics_app/world/builders/market, which is typed and tested with the application. It is a toy market
as large as the HapticMaster's workspace: the apple is 64 mm across and the table 160 mm high, in metres of the hand.
"""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.world.builders.market.build import build

__all__ = ["build"]

if __name__ == "__main__":
    place = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for file in build(place, int(sys.argv[2]) if len(sys.argv) > 2 else 1):
        print(file)
