"""The first start after a change of version compiles the kernels, which takes a minute or two: people are informed."""

from __future__ import annotations

import sys
from pathlib import Path

__all__ = ["is_cold", "say_if_cold"]


def say_if_cold() -> None:
    """Say on stderr that kernels are about to be compiled, where no machine code is kept yet."""
    from mimics_app.contracts.kernel_cache import cache_folder

    if is_cold(cache_folder):
        sys.stderr.write("mimics: compiling the kernels, once for this version; a minute or two\n")


def is_cold(folder: Path | None) -> bool:
    """Whether a cache folder holds no machine code; true of none at all, where every start compiles."""
    return folder is None or next(folder.rglob("*.nbc"), None) is None
