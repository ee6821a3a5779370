"""Every reader of a file that people write is given spoiled files: it takes them or refuses them, and nothing else.

10^4 of them in `make test`, 10^6 in `make test-long`. The readers of recordings have theirs in test_mutated_recordings.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from mimics_app.app.commands.check import examine
from mimics_app.app.sweep.experiments import NAMES, find_experiment
from mimics_app.contracts.action_space import ActionParameter, ActionSpace
from mimics_app.contracts.resources import root
from mimics_app.lab.sweep.spec import load_sweep, span_of
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.world.gltf.file import load_gltf
from tests.support.gltf_maker import glb
from tests.support.mutations import as_text, spoil_bytes, spoil_json, survey
