"""Files that a person names are opened in one way, which never blocks; the others are listed here with a reason."""

from __future__ import annotations

import ast

from tests.architecture.sources import modules, nodes

READERS = {"read_text", "read_bytes", "read_csv", "rdrecord", "read_edf", "read_bdf", "memory_map", "read_table"}
READERS |= {"SoundFile", "loadtxt", "genfromtxt", "fromfile", "memmap", "File"}
"""Functions that open a file, of the standard library and of others."""

OWN_DATA = {
    "app/bench/console_bench.py": "/proc",
    "app/bench/ogre_particles.py": "written by the harness that starts it",
    "app/bench/process_faults.py": "tests of the checkout",
    "app/bench/record_bench.py": "/proc",
    "app/commands/completion.py": "package data",
    "app/commands/console.py": "/proc",
    "app/commands/desktop.py": "package data",
    "app/play/scene_sheet.py": "drawn by itself",
    "app/play/thumbnails.py": "drawn by itself",
    "app/scenes/shipped.py": "shipped scenes",
    "app/terminal/command_parser.py": "package data",
    "assets/builders/catalogue.py": "package sources",
    "assets/builders/sounds/build.py": "written by itself",
    "assets/builders/texts/build.py": "translations of the checkout",
    "assets/builders/texts/msgids.py": "package sources",
    "compiled/kernel_sources.py": "package sources",
    "console/own_certificate.py": "written by itself",
    "console/page_server.py": "package data",
    "contracts/system/language.py": "package data",
    "contracts/system/run_environment.py": "/proc",
    "contracts/system/table_file.py": "package data",
    "estimation/load_people.py": "package data",
    "lab/gallery.py": "charts of the documentation",
    "lab/groups/loop_scheduling.py": "/proc",
    "lab/peer_harness.py": "written by the harness that it starts",
    "lab/physio/detection.py": "written by itself",
    "lab/stability/catalogue.py": "package sources",
    "lab/sweep/store.py": "package sources, and a table of its own",
    "plotting/drawing.py": "package data",
    "recording/exporters/_spool.py": "written by itself",
    "recording/exporters/hdf5.py": "written by itself: its mode is x",
    "rendering/audio/openal_library.py": "package data",
    "rendering/visual/figures/glyphs.py": "package data",
    "rendering/visual/materials/shader_source.py": "package data, and included only from there",
    "rendering/visual/software/raster_threads.py": "/proc",
}
"""Modules that read files of the package, of the system, or of their own making."""

GUARDED = {
    "contracts/system/regular_file.py": "the one way",
    "rendering/audio/sound_file.py": "SoundFile is given an open regular file",
    "rendering/audio/spectral/sofa_store.py": "File is given an open regular file",
    "inputs/physio/recording.py": "rdrecord reads files that were opened before, as regular ones of one folder",
    "inputs/physio/csv_file.py": "read_csv is given rows that are in memory, of a regular file",
}
"""Modules that hand a person's file to a library."""


def reads(tree: ast.Module) -> list[int]:
    """Lines in which a file is opened for reading other than by `open_regular`."""
    found = []
    for node in nodes(tree):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name == "open":
            owner = getattr(node.func, "value", None)
            if isinstance(owner, ast.Name) and owner.id == "Image":
                given = node.args[0]
                found += [node.lineno] if not (isinstance(given, ast.Name) and given.id == "stream") else []
                found = found[:-1] if isinstance(given, ast.Call) else found
            elif isinstance(node.func, ast.Name) or mode_of(node):
                found += [node.lineno] if "r" in (mode_of(node) or "r") else []
        elif name in READERS and isinstance(node.func, ast.Attribute):
            found.append(node.lineno)
        elif name == "load" and isinstance(node.func, ast.Attribute) and getattr(node.func.value, "id", "") == "np":
            found += [node.lineno] if not (isinstance(node.args[0], ast.Name) and node.args[0].id == "data") else []
    return found


def mode_of(call: ast.Call) -> str:
    """The mode with which a path or a name is opened, "" for a call that is not one of files."""
    words = [a.value for a in call.args if isinstance(a, ast.Constant) and isinstance(a.value, str)]
    return next((text for text in words if 0 < len(text) <= 3 and set(text) <= set("rwabx+t")), "")


def test_a_file_is_opened_in_the_one_way() -> None:
    """Else it may be a pipe, and the command waits for ever: use contracts/system/regular_file.py."""
    others = {path: tree for path, tree in modules().items() if path not in {*OWN_DATA, *GUARDED}}
    assert len(others) > 500
    assert [f"{path}:{line}" for path, tree in others.items() for line in reads(tree)] == []


def test_the_list_holds_no_module_that_opens_nothing() -> None:
    named = {*OWN_DATA, *GUARDED} - {"contracts/system/regular_file.py"}
    assert [path for path in sorted(named) if path not in modules() or not reads(modules()[path])] == []


def test_the_test_sees_every_form() -> None:
    text = """
with open(name) as f: pass
open(name, "rb"); path.open("rb"); path.read_text(); path.read_bytes(); np.load(path); Image.open(file)
csv.read_csv(path); h5py.File(path, "r"); soundfile.SoundFile(path)
"""
    assert len(reads(ast.parse(text))) == 10
    assert reads(ast.parse('path.open("wb"); open(os.devnull, "w"); Run.open(folder); Image.open(stream)')) == []
