"""The command line of this program asked for an object, in a process of its own: the page imports no session."""

from __future__ import annotations

import asyncio
import json
import sys
from typing import Any

__all__ = ["ask_command"]

_LONGEST_S = 120.0


async def ask_command(command: str, *words: str, given: bytes = b"") -> dict[str, Any]:
    """Return the object that a command prints; {} where it prints none in time.

    Args:
        command: Its name.
        words: Its arguments. Every user of the computer may read them in the list of processes.
        given: What it reads from its standard input.
    """
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "mimics_app", command, "--json", *words,
        stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL,
    )  # fmt: skip
    try:
        out, _ = await asyncio.wait_for(process.communicate(given), _LONGEST_S)
        found = json.loads(out)
    except (TimeoutError, ValueError):
        if process.returncode is None:
            process.kill()
        return {}
    return found if isinstance(found, dict) else {}
