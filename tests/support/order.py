"""In which order files of tests begin, where several processes work them off."""

from __future__ import annotations

from collections import Counter

import pytest

__all__ = ["LONGEST", "longest_first"]

LONGEST = (
    "test_operators_stories",
    "test_window_run",
    "test_window_journey",
    "test_live_sound",
    "test_bounds_checked",
    "test_window_pick",
    "test_replay_view",
    "test_patients",
    "test_python_interface",
    "test_wavy_tunnel_run",
    "test_avatars",
    "test_bench_realtime",
    "test_pick_and_place",
    "test_limp_hand",
    "test_lokomat_lines",
    "test_operators_page",
    "test_serial_robot",
    "test_recordings_malformed",
    "test_hapticmaster",
    "test_window_launcher",
    "test_audio_process",
    "test_limits_hold",
    "test_safety_machine",
    "test_full_disk",
    "test_device_plugin_wheel",
    "test_task_kind_plugin_wheel",
    "test_method_plugin",
    "test_explained_cost",
    "test_code_free",
    "test_exchange",
    "test_device_life",
    "test_orthosis",
    "test_lokomat_session",
    "test_walks",
    "test_task_kind_contract",
)
"""Files that take longest, by waiting or by computing: at the end one of them would keep everybody waiting."""


def longest_first(items: list[pytest.Item]) -> None:
    """Sort tests in place; what is not among `LONGEST` by the number of its tests, as pytest-xdist would have it."""
    counts = Counter(item.path for item in items)
    place = {name: number for number, name in enumerate(LONGEST)}
    items.sort(key=lambda item: (place.get(item.path.stem, len(LONGEST)), -counts[item.path]))
