"""The same examples every time: a chance find belongs to `make test-long`, not to the day a change lands.

What `make test-long` finds is kept in `tests/properties/found` and tried first from then on, by everybody once it is
committed; its line `@reproduce_failure` says how to see it again. The fault mended, it becomes an `@example` of the
test, which `make test` tries every time.
"""

from __future__ import annotations

from pathlib import Path

from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase

FOUND = Path(__file__).parent / "properties" / "found"

settings.register_profile("same", derandomize=True)
settings.register_profile("random", derandomize=False, print_blob=True, database=DirectoryBasedExampleDatabase(FOUND))
settings.load_profile("same")
