"""Write docs/third_party.md: the packages that running installs, with licence and home, from their own metadata.

    .venv/bin/python .ci/third_party.py

Run it after `make pins`; a test compares the page with what is installed.
"""

from __future__ import annotations

import re
from importlib.metadata import PackageMetadata, metadata, requires
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "third_party.md"
_PIN = re.compile(r"^([A-Za-z0-9_.-]+)==([^ ;\\]+)", re.MULTILINE)
_HOMES = {"homepage", "source", "source code", "repository"}
_HEAD = """# Packages of others

What `make run` installs, from the metadata of the installed packages (`.ci/third_party.py`). Versions are pinned with
their hashes in [requirements.txt](../requirements.txt); nothing of them is copied into this repository or its wheel.

| package | licence | needed by | home |
|---|---|---|---|
"""
_TAIL = """
System libraries come from the distribution: OpenGL by Mesa (MIT), OpenAL Soft (LGPL 2 or later), the client library of
PulseAudio (LGPL 2.1 or later); `mimics doctor` lists those of this machine. The operator's page has uPlot (MIT) with
its licence beside it.
"""


def pins() -> list[str]:
    """Return the names of the pinned packages of running, in their order."""
    return [name for name, _ in _PIN.findall((ROOT / "requirements.txt").read_text(encoding="utf-8"))]


def licence_of(about: PackageMetadata) -> str:
    """Return the licence in a few words: its expression, its classifier, or the first line of its text."""
    if expression := about.get("License-Expression"):
        return str(expression)
    words = [each.split(" :: ")[-1] for each in about.get_all("Classifier") or () if each.startswith("License :: ")]
    if words and words[-1] != "OSI Approved":
        return str(words[-1])
    return str((about.get("License") or "").partition("\n")[0])


def home_of(about: PackageMetadata) -> str:
    """Return the address of the project, or the first one that the metadata names."""
    named = dict(each.split(", ", 1) for each in reversed(about.get_all("Project-URL") or ()))
    home = next((named[name] for name in named if name.lower() in _HOMES), "")
    return home or str(about.get("Home-page") or next(reversed(named.values()), ""))


def _needers(names: list[str]) -> dict[str, list[str]]:
    """Return which of the packages need each of them."""
    found: dict[str, list[str]] = {name: [] for name in names}
    for name in names:
        for line in requires(name) or ():
            needed = re.match(r"[A-Za-z0-9_.-]+", line)
            if needed and "extra ==" not in line and (key := needed[0].lower().replace("_", "-")) in found:
                found[key].append(name)
    return found


def page() -> str:
    """Return the text of the page."""
    names = pins()
    needers = _needers(names)
    rows = []
    for name in names:
        about = metadata(name)
        needed = ", ".join(needers[name]) or "mimics_app"
        rows.append(f"| {name} | {licence_of(about)} | {needed} | {home_of(about)} |")
    return _HEAD + "\n".join(rows) + "\n" + _TAIL


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
