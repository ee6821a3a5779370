"""Names of files mean one thing wherever they appear, small modules have several users, functions few arguments."""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from pathlib import PurePosixPath

import pytest

from tests.architecture.sources import imports, modules, texts

SHARED = {
    "assets": "files of models, sounds and pictures",
    "attempts": "attempts at a trial",
    "bench": "a part of `mimics bench`",
    "board": "the board over the picture",
    "build": "the composition of one builder's files",
    "catalogue": "modules of a package by name, imported on request",
    "check": "checks of what a person wrote or connected",
    "cord": "a hanging cord",
    "ecg": "the electrocardiogram",
    "effects": "visual effects",
    "emg": "the electromyogram",
    "engine": "the running part of a rendering",
    "explain": "`mimics explain`",
    "file": "a reader of a file format",
    "gait": "synthesis of a gait",
    "goals": "goals of a task or of its adaptation",
    "hand": "an anatomical hand",
    "hapticmaster": "the HapticMaster",
    "hud": "the heads-up display",
    "json_text": "a strict reader of JSON",
    "kind": "the protocol of a kind of task, and each built-in one",
    "levels": "levels of detail",
    "lsl": "the lab streaming layer",
    "materials": "materials of surfaces",
    "methods": "methods with alternatives",
    "objects": "haptic objects",
    "occlusion": "occlusion culling",
    "page": "one HTML page, or one page of the viewer",
    "person": "one person: described, or simulated",
    "plugins": "plug-ins of installed packages",
    "pointer": "mouse, keyboard and gamepad as a pointing device",
    "probe": "shared parts of measurements",
    "registry": "members of a kind by name, built in and installed",
    "reload": "live reload of a scene file",
    "replay": "replay of a recording",
    "report": "`mimics report`",
    "rhythm": "the rhythm of the heart",
    "robot": "the robot of a scene",
    "robot_checks": "checks of a scene's robot",
    "run": "one run of a session",
    "schema": "`mimics schema`",
    "serial_robot": "a robot on a serial line",
    "settings": "settings of a package",
    "shapes": "primitive shapes",
    "signals": "body signals",
    "solids": "closed solids",
    "spec": "structs of a file format",
    "sprites": "billboards and particles",
    "stage": "a stage of Figure 1",
    "state_machine": "states and transitions",
    "stills": "single frames as files",
    "tables": "tables for analysis: of a run, of a study",
    "textures": "images of surfaces",
    "trackers": "trackers of head and hands",
    "upper_body": "a body from trackers of head and hands",
    "worker": "the main function of a process of its own",
}
"""Names that several files have, and the one meaning of each."""

TWO_MEANINGS = {
    "bounds": "number types of components, and bounding spheres of draw items",
    "calibration": "of a tracker, and the scenario that measures a person",
    "desktop": "the command `mimics desktop`, and the display that is a window",
    "fusion": "the estimator that fuses features, and its member",
    "head": "the movement of the head as a signal, and a measured head of sound",
    "motion": "features of movement, and a motion of a skeleton",
    "view": "the command `mimics view`, and one camera of the picture",
    "watch": "the live processing of body signals, and the stability monitor of the loop",
}
"""Names that mean two things, in packages that no reader opens together."""

NAMED_BY_MEMBERS = (
    "lab/groups/",
    "recording/exporters/",
    "rendering/haptic/controllers/built_in/",
    "rendering/haptic/devices/built_in/",
)
"""Packages whose files are named like the member of each: a group of methods, a format, a controller, a device."""

_SMALL = 40

ON_THEIR_OWN = {
    "__main__": "the interpreter starts it",
    "app/bench/record_load": "a process of its own",
    "app/commands/": "the command line finds a command by its name",
    "assets/builders/": "the catalogue finds a builder by its name",
    "dsp/channels/": "a channel is found by the name of its signal",
    "estimation/estimators/": "an estimator is found by its name",
    "lab/groups/": "the catalogue finds a group of methods by its name",
    "lab/sweep/wall_stability": "one experiment of a sweep a file",
    "maths/triples": "arithmetic, which is of no room that needs it",
    "rendering/audio/mixers/": "a mixer is found by its name",
    "rendering/audio/recipes/": "the tables of recipes are found by their modules",
    "rendering/haptic/controllers/built_in/": "a controller is found by its name",
    "rendering/haptic/controllers/no_controller": "compiled; its user knows more than arrays",
    "rendering/haptic/devices/built_in/": "a device is found by its name",
    "rendering/haptic/devices/inverse_by_steps": "compiles on import, and is imported on demand",
    "world/components/": "the reader of scenes finds component types by their modules",
}
"""Small modules with one user, or none that imports them, and why they stay: a whole path, or a package's with "/"."""


def _names() -> dict[str, list[str]]:
    found = defaultdict(list)
    for path in texts():
        if (name := PurePosixPath(path).stem) != "__init__" and not path.startswith(NAMED_BY_MEMBERS):
            found[name].append(path)
    return {name: paths for name, paths in found.items() if len(paths) > 1}


def test_a_file_name_that_is_used_again_means_the_same() -> None:
    """Give a new file a name that says which; or it means what the others mean, and the table says what that is."""
    listed = {*SHARED, *TWO_MEANINGS}
    assert not {name: paths for name, paths in _names().items() if name not in listed}
    assert not listed - set(_names()), "no longer shared: remove the line"


def _importers() -> dict[str, set[str]]:
    """Product modules that import each module, by path without suffix."""
    users: dict[str, set[str]] = defaultdict(set)
    known = {path.removesuffix(".py") for path in texts()}
    for path, tree in modules().items():
        for _, name in imports(tree):
            if not name.startswith(("mimics_app.", "assets.builders.")):
                continue
            target = name.removeprefix("mimics_app.").replace(".", "/")
            target = target if target in known else target.rpartition("/")[0]
            users[target].add(path.removesuffix(".py"))
    return users


def _foldable(lines: dict[str, int], users: dict[str, set[str]]) -> list[str]:
    """Return small modules with one user."""
    found = []
    for path, count in lines.items():
        stays = any(path == own or (own.endswith("/") and path.startswith(own)) for own in ON_THEIR_OWN)
        if count > _SMALL or stays or path.endswith("__init__") or len(users.get(path, ())) > 1:
            continue
        found.append(path)
    return found


def test_a_small_module_with_one_user_is_part_of_it() -> None:
    lines = {path.removesuffix(".py"): text.count("\n") for path, text in texts().items()}
    users = _importers()
    assert not _foldable(lines, users), "fold each into its user, or say in ON_THEIR_OWN why it stays"
    needed = Counter(own for own in ON_THEIR_OWN for path in lines if path == own or path.startswith(own))
    assert not [own for own in ON_THEIR_OWN if not needed[own]], "gone: remove the line"


FOUND_BY_FILE = (
    "app/commands/",
    "assets/builders/",
    "dsp/channels/",
    "estimation/estimators/",
    "lab/groups/",
    "lab/stability/s",
    "rendering/audio/mixers/",
    "rendering/audio/recipes/",
    "rendering/haptic/controllers/built_in/",
    "rendering/haptic/devices/built_in/",
    "world/components/",
)
"""Members that are found by their files, and the makers of shipped files, which are no part of the product."""

_SHORT = 75

MOST_SHORT = 25
"""Short modules of the product with one importer; their number may only fall."""


def test_few_short_modules_have_one_importer() -> None:
    users = _importers()
    found = [
        path
        for path, text in ((path.removesuffix(".py"), text) for path, text in texts().items())
        if text.count("\n") <= _SHORT and len(users.get(path, ())) == 1 and not path.endswith("__init__")
    ]
    found = [path for path in found if not path.startswith(FOUND_BY_FILE)]
    assert len(found) <= MOST_SHORT, f"fold one into its importer: {found}"


@pytest.mark.parametrize(("count", "users", "found"), [(40, {"a"}, True), (41, {"a"}, False), (40, {"a", "b"}, False)])
def test_a_planted_small_module_is_found(count: int, users: set[str], found: bool) -> None:
    lines = {"a": 100, "b": 100, "planted": count}
    assert (_foldable(lines, {"a": {"b", "c"}, "b": {"a", "c"}, "planted": users}) == ["planted"]) is found


_MOST_ARGUMENTS = 9

LONG_SIGNATURES = {
    "lab/stability/replayed_wall.py: _stroke": "calls the tick as the loop does",
    "rendering/haptic/kernels/tick.py: tick": "all that a tick depends on, which is recorded and replayed",
    "rendering/haptic/loop_tick.py: loop_tick": "the tick with its input and output, called by address",
    "rendering/haptic/replay_loop.py: replay_recorded": "calls the tick with recorded inputs",
}
"""Functions with more arguments, and why they have no record for them."""


def _long_signatures(path: str, tree: ast.Module) -> list[str]:
    """Functions of a module with more than `_MOST_ARGUMENTS` arguments."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    counts = [(each.name, each.args.posonlyargs + each.args.args + each.args.kwonlyargs) for each in functions]
    return [f"{path}: {name}" for name, arguments in counts if len(arguments) > _MOST_ARGUMENTS]


def test_functions_take_records_instead_of_many_arguments() -> None:
    found = {long for path, tree in modules().items() for long in _long_signatures(path, tree)}
    assert found == set(LONG_SIGNATURES)


def test_a_planted_long_signature_is_found() -> None:
    nine, ten = (", ".join(f"a{k}" for k in range(count)) for count in (9, 10))
    tree = ast.parse(f"def short({nine}): ...\nclass A:\n    def long({ten}): ...\n")
    assert _long_signatures("x.py", tree) == ["x.py: long"]
