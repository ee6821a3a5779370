"""Share of the product's compiled specialisations that an edit of a kernel file compiles again.

`python -m tests.architecture.compile_share` counts what the kernel cache holds for the present sources, so it says most
after a test run. The laboratory is left out.
"""

from __future__ import annotations

import statistics
from pathlib import Path

from mimics_app.compiled.cache_folder import cache_folder
from mimics_app.compiled.kernel_sources import source_key, sources_reached
from tests.architecture.sources import PACKAGE

__all__ = ["shares", "specialisations"]


def specialisations() -> dict[Path, int]:
    """Source of a module -> number of its specialisations in the cache."""
    counts = dict[Path, int]()
    for source in PACKAGE.rglob("*.py"):
        module = ".".join(source.relative_to(PACKAGE.parent).with_suffix("").parts)
        if cache_folder is not None and not module.startswith("mimics_app.lab."):
            counts[source] = len(list((cache_folder / f"{module}-{source_key(source)}").glob("*.nbc")))
    return {source: count for source, count in counts.items() if count}


def shares() -> dict[Path, float]:
    """Source of a compiled module -> share of all specialisations in modules that reach it."""
    counts = specialisations()
    total = sum(counts.values())
    return {
        edited: sum(count for source, count in counts.items() if edited in sources_reached(source)) / total
        for edited in counts
    }


if __name__ == "__main__":
    found = shares()
    print(f"{sum(specialisations().values()):,} specialisations of {len(found)} files")
    for path, share in sorted(found.items(), key=lambda row: -row[1]):
        print(f"{share:6.1%}  {path.relative_to(PACKAGE)}")
    few = [sum(share <= most for share in found.values()) for most in (0.05, 0.2)]
    print(f"median {statistics.median(found.values()):.1%}; at most 5 %: {few[0]}, at most 20 %: {few[1]}")
