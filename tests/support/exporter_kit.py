"""Conformance kit of exporters: what `mimics record export` takes for granted of one, built in or of a package."""

from __future__ import annotations

import shutil
from pathlib import Path

from mimics_app.contracts.system.resources import root
from mimics_app.recording.exporter_kinds import Exporter
from mimics_app.recording.run import Run

RUNS = ("run_0_1_0", "run_0_1_0_objects", "run_0_1_0_tunnel")


def check_exporter(exporter: Exporter, folder: Path) -> dict[str, list[Path]]:
    """Export recordings, whole and cut off; raises AssertionError at what an exporter must not do.

    Args:
        exporter: The exporter.
        folder: A folder of the test.

    Returns:
        The files of each recording, by its name.
    """
    assert exporter.about and "\n" not in exporter.about
    made = {}
    for name in RUNS:
        source = folder / "runs" / name
        shutil.copytree(root() / "tests" / "data" / name, source)
        made[name] = _export(exporter, source, folder / "first" / name)
        again = _export(exporter, source, folder / "second" / name)
        assert [file.read_bytes() for file in made[name]] == [file.read_bytes() for file in again], "the same bytes"
    cut = folder / "runs" / "cut"
    shutil.copytree(root() / "tests" / "data" / RUNS[0], cut)
    (cut / "manifest.json").unlink()
    haptic = (cut / "haptic.arrows").read_bytes()
    (cut / "haptic.arrows").write_bytes(haptic[: len(haptic) * 2 // 3])
    made["cut"] = _export(exporter, cut, folder / "first" / "cut")
    return made


def _export(exporter: Exporter, source: Path, into: Path) -> list[Path]:
    before = {file: file.read_bytes() for file in source.rglob("*") if file.is_file()}
    into.mkdir(parents=True)
    files = list(exporter.open(Run.open(source), into))
    assert files and len(set(files)) == len(files), "it writes files, each once"
    assert all(file.is_file() and into in file.parents for file in files), "all lie in the folder"
    assert {file for file in into.rglob("*") if file.is_file()} == set(files), "and it names all of them"
    assert {file: file.read_bytes() for file in source.rglob("*") if file.is_file()} == before, "the run is unchanged"
    return files
