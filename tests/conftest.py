"""The same examples every time: a chance find belongs to `make test-long`, not to the day a change lands."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("same", derandomize=True)
settings.register_profile("random", derandomize=False)
settings.load_profile("same")
