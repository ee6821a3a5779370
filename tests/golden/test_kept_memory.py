"""Memory that is freed once a surface is open is used again, and not fetched from the system page by page."""

from __future__ import annotations

import ctypes
import platform
import resource

import pytest

from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.rasteriser import rasteriser_of

_BLOCK, _ROUNDS, _PAGE = 8 << 20, 20, 4096


@pytest.mark.software
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="only glibc has mallopt")
def test_what_a_draw_frees_is_there_for_the_next_one() -> None:
    libc = ctypes.CDLL(None)
    libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
    libc.free.argtypes = [ctypes.c_void_p]
    with create_surface("egl", (16, 16)) as surface:
        rasteriser_of(surface.ctx)
        before = _faults()
        for _ in range(_ROUNDS):
            block = libc.malloc(_BLOCK)
            ctypes.memset(block, 1, _BLOCK)
            libc.free(block)
        assert _faults() - before < 2 * _BLOCK // _PAGE, "as many as the first round costs, and not every round"


def _faults() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
