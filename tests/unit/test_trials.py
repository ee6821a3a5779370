"""Orders of trials: seeded, reproducible on every machine, balanced; and their files."""

from __future__ import annotations

import json
from collections import Counter
from itertools import pairwise

import msgspec
import pytest

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.tasks.scene_section import check_section
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import load_blocks, resolve_trials
from mimics_app.tasks.trial_specs import BlockSpec
from mimics_app.tasks.trials import order_conditions, plan_trials, trial_blocks, williams_square
from mimics_app.world.components.visible import Sound
from mimics_app.world.files.scene.scene import Scene

BLOCKS = msgspec.convert(
    [
        {"name": "practice", "practice": True, "trials": [{"label": "easy"}]},
        {"name": "main", "repetitions": 3, "order": "shuffled", "trials": [{"label": c} for c in "abcde"]},
    ],
    list[BlockSpec],
)


def labels(seed):
    return [trial.label for trial in plan_trials(BLOCKS, seed)]


def test_order_of_a_seed_is_the_same_for_ever():
    assert "".join(labels(7)[1:]) == PINNED


PINNED = "bcedabeacdceabd"


def test_seeds_and_repetitions_differ():
    assert labels(7) == labels(7) != labels(8)
    main = labels(7)[1:]
    assert len({tuple(main[i : i + 5]) for i in (0, 5, 10)}) > 1
    assert all(sorted(main[i : i + 5]) == list("abcde") for i in (0, 5, 10))


def test_plan_numbers_trials_and_keeps_blocks_together():
    plan = plan_trials(BLOCKS, 1)
    assert [trial.number for trial in plan] == list(range(16))
    assert [trial.block for trial in plan] == ["practice"] + ["main"] * 15
    assert [trial.practice for trial in plan] == [True] + [False] * 15
    assert [trial.repetition for trial in plan] == [0] + [0] * 5 + [1] * 5 + [2] * 5


def test_listed_order_is_the_files():
    assert order_conditions(3, 2, "listed", seed=5) == [[0, 1, 2], [0, 1, 2]]


def test_shuffling_favours_no_order():
    counts = Counter(tuple(order_conditions(3, 1, "shuffled", seed)[0]) for seed in range(6000))
    # 6 orders, expected 1000 each, standard deviation sqrt(6000 * 1/6 * 5/6) = 29; 5 of them
    assert len(counts) == 6 and all(abs(count - 1000) < 145 for count in counts.values())


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6, 9])
def test_williams_square_is_balanced_for_place_and_predecessor(n):
    square = williams_square(n)
    for column in zip(*square, strict=True):
        assert set(Counter(column).values()) == {len(square) // n}
    pairs = Counter(pair for row in square for pair in pairwise(row))
    assert len(pairs) == n * (n - 1) and len(set(pairs.values())) == 1


def test_williams_square_of_one_condition():
    assert williams_square(1) == [[0]]


def test_latin_order_is_balanced_over_its_repetitions():
    rows = order_conditions(4, 4, "latin", seed=3)
    pairs = Counter(pair for row in rows for pair in pairwise(row))
    assert set(pairs.values()) == {1} and len(pairs) == 12
    assert order_conditions(4, 5, "latin", seed=3)[4] == rows[0]
    assert rows != order_conditions(4, 4, "latin", seed=4)


def spec_with(trials, **fields):
    parameters = {"radius": {"default": 1, "min": 0.5, "max": 2, "maps": [{"to": "haptic.tunnel.radius_scale"}]}}
    return msgspec.convert({"parameters": parameters, "trials": trials, **fields}, TaskSpec)


def write(folder, document, name="trials.json"):
    (folder / name).write_text(document if isinstance(document, str) else json.dumps(document), encoding="utf-8")
    return name


def test_trial_file_is_read_beside_the_scene(tmp_path):
    name = write(tmp_path, [{"x-author": "me", "trials": [{"values": {"radius": 0.7}, "x-note": 1}], "repetitions": 2}])
    spec = resolve_trials(spec_with(name), tmp_path)
    assert [trial.values for trial in plan_trials(trial_blocks(spec), 0)] == [{"radius": 0.7}] * 2


def test_inline_trials_need_no_file(tmp_path):
    spec = spec_with([{"trials": [{}]}])
    assert resolve_trials(spec, tmp_path) is spec


def test_unread_trial_file_is_a_programming_error():
    with pytest.raises(TypeError, match="resolve_trials"):
        trial_blocks(spec_with("trials.json"))


@pytest.mark.parametrize(
    ("document", "places"),
    [
        ([{"trials": [{"values": {"raduis": 1}}]}], [("/0/trials/0/values/raduis", 'did you mean "radius"')]),
        ([{"trials": [{"values": {"radius": 3}}]}], [("/0/trials/0/values/radius", "inside the limits")]),
        ([{"trials": []}, {"order": "random"}], [("/0/trials", ""), ("/1/order", "known: latin, listed, shuffled")]),
        ([{"trials": [{"values": {"radius": "wide"}}]}], [("/0/trials/0/values/radius", "")]),
        ([{"trails": [{}]}], [("/0/trails", 'did you mean "trials"')]),
        ([{"repetitions": 0}], [("/0/repetitions", "")]),
        ([{"repetitions": 1000, "trials": [{}] * 11}], [("", "fewer repetitions")]),
        ('[{"trials": [{"time_limit_s": NaN}]}]', [("/0/trials/0/time_limit_s", "write a number")]),
        ([], [("", "")]),
        ({"trials": []}, [("", "")]),
        ("[{]", [("", "")]),
        ("[" * 100_000, [("", "")]),
    ],
    ids=[
        "misspelt",
        "outside",
        "two faults",
        "no number",
        "key",
        "zero",
        "too many",
        "NaN",
        "empty",
        "object",
        "text",
        "deep",
    ],
)
def test_every_fault_of_a_trial_file_has_its_place(tmp_path, document, places):
    name = write(tmp_path, document)
    with pytest.raises(SceneError) as caught:
        resolve_trials(spec_with(name), tmp_path)
    assert [issue.pointer for issue in caught.value.issues] == [pointer for pointer, _ in places]
    for issue, (_, fix) in zip(caught.value.issues, places, strict=True):
        assert issue.file.endswith("trials.json") and fix in issue.fix


def test_trial_file_that_is_not_there_or_elsewhere(tmp_path):
    with pytest.raises(SceneError, match="no file"):
        resolve_trials(spec_with("none.json"), tmp_path)
    (tmp_path / "scene").mkdir()
    write(tmp_path, [{}])
    with pytest.raises(SceneError, match="leads out of the folder"):
        resolve_trials(spec_with("../trials.json"), tmp_path / "scene")


def test_trial_file_that_is_no_text(tmp_path):
    (tmp_path / "trials.json").write_bytes(b"\xff\xfe[]")
    with pytest.raises(SceneError, match="UTF-8"):
        load_blocks(tmp_path / "trials.json")


class PaperScene:
    """As much of a scene as the check of its task needs."""

    check_names = Scene.check_names

    def __init__(self, folder, sounds=("goal",)):
        self.file, self.root, self._sounds = str(folder / "scene.json"), folder, sounds
        self.path = folder / "scene.json"
        self.entities, self.devices = (), ()
        self.by_id = {}
        self.document = {}

    def issue(self, pointer, what, fix=""):
        return Issue(self.file, pointer, what, fix)

    def components(self, struct):
        return [(name, None, "") for name in self._sounds] if struct is Sound else []

    def has(self, struct):
        return True


def test_check_of_a_scene_looks_into_the_trial_file(tmp_path):
    write(tmp_path, [{"trials": [{"values": {"radius": 9}}]}])
    (issue,) = check_section(spec_with("trials.json"), PaperScene(tmp_path))
    assert issue.file.endswith("trials.json") and issue.pointer == "/0/trials/0/values/radius"
    (issue,) = check_section(spec_with("trails.json"), PaperScene(tmp_path))
    assert (issue.file, issue.pointer) == (str(tmp_path / "scene.json"), "/task/trials")
    assert "trials.json" in issue.fix


def test_check_of_a_scene_knows_its_sounds(tmp_path):
    triggers = [{"when": {"kind": "contact"}, "do": [{"kind": "sound", "sound": "gaol"}]}]
    spec = spec_with([{"trials": [{}]}], triggers=triggers)
    (issue,) = check_section(spec, PaperScene(tmp_path))
    assert issue.pointer == "/task/triggers/0/do/0/sound" and issue.fix == 'did you mean "goal"'
    (issue,) = check_section(spec, PaperScene(tmp_path, sounds=()))
    assert "sound" in issue.fix
    assert check_section(spec, PaperScene(tmp_path, sounds=("gaol",))) == []
