"""Builds city.glb, a town of 0.64 km^2: streets of houses, trees, furniture, a square with a church, a skyline.

`mimics assets build city`, or python assets/models/city/build_city.py [FOLDER [SEED]]

The work is done by mimics_app/world/builders/city, which is typed and tested with the application.
"""

from __future__ import annotations

import sys
from pathlib import Path

from mimics_app.world.builders.city.build import build

__all__ = ["build"]

if __name__ == "__main__":
    place = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for file in build(place, int(sys.argv[2]) if len(sys.argv) > 2 else 1):
        print(file)
