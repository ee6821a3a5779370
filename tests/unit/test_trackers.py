"""Trackers: poses between and after reports, calibration, tapes, and what of noise is believed (nothing)."""

from __future__ import annotations

import math
import random
import socket
import struct
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError, SceneError, UsageError
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.contracts.ports.input_port import WindowFrame
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers import vrpn_wire
from mimics_app.inputs.trackers.ascension import FlockParser, flock_record
from mimics_app.inputs.trackers.calibration import axis_map, fit_room
from mimics_app.inputs.trackers.emulated_line import emulated_fastrak, emulated_flock
from mimics_app.inputs.trackers.hub import MountedTracker, TrackerHub
from mimics_app.inputs.trackers.lsl import LslTracker
from mimics_app.inputs.trackers.osc import OscTracker
from mimics_app.inputs.trackers.plausibility import Plausibility
from mimics_app.inputs.trackers.polhemus import RECORD_BYTES, FastrakParser, euler_quaternion, fastrak_record
from mimics_app.inputs.trackers.polled_tracker import HeadsetTracker, PolledTracker
from mimics_app.inputs.trackers.pose_senders import OscSender, VrpnServer
from mimics_app.inputs.trackers.scripted_person import PERSON_SENSORS, PointerTracker, ScriptedPerson, person_at
from mimics_app.inputs.trackers.serial_tracker import fastrak, flock_of_birds
from mimics_app.inputs.trackers.tape import TapeTracker, TapeWriter, read_tape
from mimics_app.inputs.trackers.track import Track
from mimics_app.inputs.trackers.vrpn import VrpnTracker
from mimics_app.maths.poses import pose_from_parts, rotation_from_vector, rotation_vector
from tests.support.full_disk import largest_file

MS = 1_000_000
SEED = 7


def wait_for(true: Callable[[], bool], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.002)


def sample(t_ns: int, x: float, turn_deg: float = 0.0) -> TrackerSample:
    return TrackerSample("1", t_ns, (x, 0.0, 0.0), euler_quaternion(turn_deg, 0.0, 0.0))


def test_a_pose_between_two_reports_is_between_them() -> None:
    track = Track()
    assert track.pose(0) is None
    track.add(sample(10 * MS, 1.0, 0.0))
    track.add(sample(20 * MS, 2.0, 40.0))
    pose = track.pose(15 * MS)
    assert pose is not None and not pose.stale
    assert pose.pose[0, 3] == pytest.approx(1.5, abs=1e-12)
    assert np.linalg.norm(rotation_vector(pose.pose[:3, :3])) == pytest.approx(math.radians(20.0), abs=1e-12)
    assert track.pose(0).pose[0, 3] == 1.0  # before the first report: where it was first


def test_after_the_last_report_it_goes_on_for_50_ms_and_no_farther() -> None:
    track = Track()
    track.add(sample(0, 0.0, 0.0))
    track.add(sample(10 * MS, 0.01, 1.0))
    for ahead, moved, capped, stale in ((20, 0.03, False, False), (50, 0.06, False, False), (80, 0.06, True, False)):
        pose = track.pose((10 + ahead) * MS)
        assert pose is not None
        assert pose.pose[0, 3] == pytest.approx(moved, abs=1e-12)
        assert (pose.capped, pose.stale) == (capped, stale)
    lost = track.pose(111 * MS)
    assert lost is not None and lost.stale and lost.capped
    assert lost.pose[0, 3] == 0.01  # where it was seen last, not where it might have gone


def test_prediction_of_a_turning_head_errs_no_more_than_its_curvature_allows() -> None:
    """+-30 deg at 1 Hz, 30 ms ahead of reports at 120 Hz: A w^2 t (t + step) / 2 = 0.68 deg at most."""
    track, worst, held = Track(), 0.0, 0.0
    step = 1 / 120
    amplitude, omega, ahead = math.radians(30.0), 2 * math.pi, 0.030
    for k in range(240):
        t = k * step
        track.add(sample(round(t * 1e9), 0.0, math.degrees(amplitude * math.sin(omega * t))))
        if k < 2:
            continue
        pose = track.pose(round((t + ahead) * 1e9))
        true = amplitude * math.sin(omega * (t + ahead))
        assert pose is not None
        worst = max(worst, abs(rotation_vector(pose.pose[:3, :3])[2] - true))
        held = max(held, abs(amplitude * math.sin(omega * t) - true))
    assert worst <= amplitude * omega**2 * ahead * (ahead + step) / 2 + 1e-9
    assert worst <= held / 6.0


def test_reports_out_of_order_are_left_out_and_the_ring_forgets() -> None:
    track = Track()
    for k in range(3000):
        track.add(sample(k * MS, k * 1e-3))
        track.add(sample(k * MS - 1, 99.0))
    assert track.pose(2900 * MS + MS // 2).pose[0, 3] == pytest.approx(2.9005, abs=1e-9)
    assert track.pose(5 * MS).pose[0, 3] == pytest.approx((3000 - 1023) * 1e-3, abs=1e-9)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 2), (-2, 1, 2), (0, -3, 4)])
@pytest.mark.parametrize("angle", [1e-9, 1.0, 2.5, 3.0, 3.1415926])
def test_a_rotation_is_found_again_from_its_matrix(axis: tuple[int, int, int], angle: float) -> None:
    vector = angle * np.array(axis) / np.linalg.norm(axis)
    found = rotation_vector(rotation_from_vector(vector))
    np.testing.assert_allclose(found, vector, atol=1e-7 if angle > 3.1 else 1e-12)


def test_a_room_is_found_again_from_its_points() -> None:
    chance = np.random.default_rng(SEED)
    rotation, move = rotation_from_vector(np.array([0.3, -1.2, 0.4])), np.array([1.0, 0.5, -2.0])
    seen = chance.uniform(-1.0, 1.0, (6, 3))
    found = fit_room(seen, 1.03 * seen @ rotation.T + move)
    np.testing.assert_allclose(found.rotation, rotation, atol=1e-12)
    assert found.scale == pytest.approx(1.03, abs=1e-12)
    assert found.residual_m <= 1e-12
    assert found.fault == ""
    noisy = fit_room(seen, seen + chance.normal(0.0, 0.002, (6, 3)))
    # Six points, seven numbers fitted to eighteen: sigma sqrt(3 (1 - 7/18)) = 2.7 mm is left in the mean.
    assert 0.0005 < noisy.residual_m < 0.008
    assert noisy.worst_m >= noisy.residual_m


def test_a_calibration_that_cannot_be_is_refused_or_named() -> None:
    chance = np.random.default_rng(SEED)
    seen = chance.uniform(-1.0, 1.0, (5, 3))
    with pytest.raises(UsageError, match="at least 4"):
        fit_room(seen[:3], seen[:3])
    with pytest.raises(UsageError, match="plane"):
        fit_room(seen, seen * [1.0, 0.0, 1.0])
    with pytest.raises(UsageError, match="plane"):
        fit_room(seen, np.ones((5, 3)))
    with pytest.raises(UsageError, match="the same point"):
        fit_room(np.ones((5, 3)), seen)
    assert "mirror image" in fit_room(seen, seen * [-1.0, 1.0, 1.0]).fault
    assert "upside down" in fit_room(seen, seen * [1.0, -1.0, -1.0]).fault
    assert "another order" in fit_room(seen, seen[[1, 0, 2, 4, 3]]).fault


def test_axes_are_read_and_mirror_images_refused() -> None:
    np.testing.assert_array_equal(axis_map("x,-z,y") @ [1.0, 2.0, 3.0], [1.0, -3.0, 2.0])
    for wrong in ("x,y", "x,x,y", "x,y,-z", "a,b,c", ""):
        with pytest.raises(UsageError):
            axis_map(wrong)


def test_a_record_says_what_it_was_made_from() -> None:
    place, angles = (0.12, -0.34, 0.56), (120.25, -45.5, 9.99)
    record = fastrak_record(1, place, angles, 0.01)
    assert len(record) == RECORD_BYTES
    (found,) = FastrakParser(0.01).feed(record, 5)
    assert found.position == pytest.approx(place, abs=1e-12)
    assert found.rotation == pytest.approx(euler_quaternion(*angles), abs=1e-12)
    (bird,) = FlockParser().feed(flock_record(place, angles), 5)
    assert bird.position == pytest.approx(place, abs=36 * 0.0254 / 8192)  # 14 bits
    turn = (
        pose_from_parts((0, 0, 0), bird.rotation)[:3, :3].T
        @ pose_from_parts((0, 0, 0), euler_quaternion(*angles))[:3, :3]
    )
    assert np.linalg.norm(rotation_vector(turn)) <= math.radians(3 * 180 / 8192)


def test_a_record_whose_numbers_stand_in_other_columns_is_none() -> None:
    """A byte lost in one number and a space gained in another: the length is right, and each is still a number."""
    record = fastrak_record(1, (0.12, -0.34, 0.56), (120.25, -45.5, 9.99), 0.01)
    moved = record.replace(b"  12.00", b" 12.00", 1).replace(b" -34.00", b"  -34.00", 1)
    assert len(moved) == len(record) and moved != record
    parser = FastrakParser(0.01)
    assert parser.feed(moved, 5) == [] and parser.rejected == 1


@pytest.mark.parametrize(("parser", "record"), [("fastrak", 47), ("flock", 12)])
def test_of_a_stream_that_loses_bytes_only_whole_records_are_used_and_two_later_all_is_well(
    parser: str, record: int
) -> None:
    chance = random.Random(SEED)
    reader = FastrakParser(0.01) if parser == "fastrak" else FlockParser()
    believed, sent, accepted = Plausibility(), {}, 0
    for k in range(4000):
        place, angles = person_at("hand_right", k / 120, SEED)
        place = (place[0], place[1] - 1.0, place[2])
        data = fastrak_record(1, place, angles, 0.01) if parser == "fastrak" else flock_record(place, angles)
        (clean,) = (FastrakParser(0.01) if parser == "fastrak" else FlockParser()).feed(data, k)
        sent[k] = clean.position
        if k % 10 == 5:
            at = chance.randrange(record)
            data = data[:at] + data[at + 1 :]
        for found in reader.feed(data, k * 8 * MS):
            if believed.admits(found):
                accepted += 1
                assert found.position in (sent[k], sent.get(k - 1))
    # One record in ten is hit; it is lost, and at most the one after it.
    assert accepted >= 4000 * 0.8 - 2
    assert reader.rejected >= 399


def test_two_reports_with_an_impossible_one_between_them_do_not_confirm_each_other() -> None:
    believed = Plausibility()
    assert [believed.admits(sample(k * 8 * MS, x)) for k, x in enumerate((1.0, math.nan, 1.0, 1.0))] == [
        False,
        False,
        False,
        True,
    ]


@pytest.mark.parametrize("kind", ["noise", "digits", "phases"])
@pytest.mark.parametrize("parser", ["fastrak", "flock"])
def test_a_million_bytes_of_noise_make_no_pose(parser: str, kind: str) -> None:
    chance = np.random.default_rng(SEED)
    alphabet = {
        "noise": np.arange(256, dtype=np.uint8),
        "digits": np.frombuffer(b"0123456789 .-\r\n01 ", np.uint8),
        "phases": np.array([0x80, *range(12)], np.uint8),
    }[kind]
    data = chance.choice(alphabet, 1_000_000).tobytes()
    reader = FastrakParser(0.01) if parser == "fastrak" else FlockParser()
    believed = Plausibility()
    taken = [s for at in range(0, len(data), 4096) for s in reader.feed(data[at : at + 4096], at) if believed.admits(s)]
    if (parser, kind) == ("flock", "phases"):
        # An alphabet made to look like records does make some of them; in line noise there is none.
        assert all(math.hypot(*s.position) < 20.0 for s in taken)
    else:
        assert taken == []


@settings(max_examples=60)
@given(st.binary(max_size=300), st.integers(1, 60))
def test_no_bytes_break_a_reader(data: bytes, cut: int) -> None:
    for reader in (FastrakParser(1.0), FlockParser()):
        for at in range(0, len(data), cut):
            reader.feed(data[at : at + cut], at)
    wire = vrpn_wire.MessageReader()
    try:
        for message in wire.feed(vrpn_wire.COOKIE + data):
            assert message.pose is None or len(message.pose[1]) == 7
    except ValueError:
        pass  # a line that cannot be trusted is closed


@pytest.mark.parametrize("kind", ["fastrak", "flock"])
def test_a_tracker_on_a_serial_line_follows_its_person(kind: str) -> None:
    line = emulated_fastrak(stations=2, seed=SEED) if kind == "fastrak" else emulated_flock(seed=SEED)
    make = fastrak if kind == "fastrak" else flock_of_birds
    tracker, taken = make("desk", line.port), []
    try:
        tracker.start(taken.append)
        wait_for(lambda: len(taken) >= 60)
    finally:
        tracker.stop()
        line.close()
    # The line carries a record of 47 bytes in 4.1 ms at 115200 baud: nothing arrives before it could.
    bits = 10 * (2 * 47 if kind == "fastrak" else 12) / 115200
    for sensor, role in (("1", "head"), ("2", "chest")) if kind == "fastrak" else (("1", "hand_right"),):
        reports = [s for s in taken if s.sensor == sensor]
        assert len(reports) >= 20
        for report in reports[5:]:
            place = person_at(role, report.t_ns * 1e-9 - bits, SEED)[0]
            height = 1.0 if kind == "flock" else 0.0
            # The person moves 0.4 m/s at most; a stalled process may be half a second late.
            assert math.dist((report.position[0], report.position[1] + height, report.position[2]), place) < 0.25
    assert tracker.problem == ""


def test_a_line_that_goes_away_is_reported_and_ends_nothing() -> None:
    line = emulated_fastrak()
    tracker, taken = fastrak("desk", line.port), []
    tracker.start(taken.append)
    wait_for(lambda: len(taken) > 3)
    line.close()
    wait_for(lambda: tracker.problem != "")
    assert "gone" in tracker.problem
    tracker.stop()


def test_a_port_that_is_not_there_is_one_clear_error() -> None:
    with pytest.raises(DeviceError, match="desk"):
        fastrak("desk", "/dev/no_such_port").start(print)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        free = taken.getsockname()[1]
    with pytest.raises(DeviceError, match="VRPN"):
        VrpnTracker("v", f"Tracker0@127.0.0.1:{free}").start(print)


@pytest.mark.parametrize("by", ["", "tcp://"])
def test_vrpn_from_our_server_to_our_client(by: str) -> None:
    server, taken = VrpnServer("mocap"), []
    tracker = VrpnTracker("mocap", f"mocap@{by}127.0.0.1:{server.port}")
    tracker.start(taken.append)
    try:
        wait_for(lambda: server.clients == 1)
        for k in range(100):
            server.send(3, (k * 1e-3, 0.1, 0.2), (0.0, 0.0, 0.0, 1.0), k * MS)
        server.send(3, (math.nan, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 0)
        server.send(3, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), 0)
        wait_for(lambda: tracker.rejected >= 3)  # the first, held back, and the two that cannot be
    finally:
        tracker.stop()
        server.close()
    assert [s.position[0] for s in taken] == pytest.approx([k * 1e-3 for k in range(1, 100)])
    assert {s.sensor for s in taken} == {"3"}
    assert [s.device_ns for s in taken] == [k * MS for k in range(1, 100)]


def message_of_vrpn(sender: int, kind: int, body: bytes = b"") -> bytes:
    """A message as VRPN describes it: length, seconds, microseconds, sender, type, 4 bytes; bodies padded to 8."""
    header = struct.pack(">5i4x", 24 + len(body), 0, 0, sender, kind)
    return header + body + bytes(-len(body) % 8)


def name_of_vrpn(kind: int, number: int, name: str) -> bytes:
    """A description of a sender (-1) or a type (-2), as a client of the library sends it."""
    text = name.encode() + b"\0"
    return message_of_vrpn(number, kind, struct.pack(">i", len(text)) + text)


def messages_of_vrpn(line: socket.socket, until: Callable[[list[tuple[int, int, bytes]]], bool]) -> list:
    """Read the cookie, then messages (sender, type, body) until there are enough."""
    data, found = b"", []
    while len(data) < 24:
        data += line.recv(4096)
    assert data.startswith(b"vrpn: ver. 07.")
    data = data[24:]
    while not until(found):
        while len(data) < 24 or len(data) < 24 + -(-(struct.unpack_from(">i", data)[0] - 24) // 8) * 8:
            data += line.recv(4096)
        length, _, _, sender, kind = struct.unpack_from(">5i", data)
        found.append((sender, kind, data[24:length]))
        data = data[24 + -(-(length - 24) // 8) * 8 :]
    return found


def test_a_client_that_asks_by_udp_is_called_by_tcp_and_its_pings_are_answered() -> None:
    """As the clients of VRPN's library do with the address TRACKER@HOST: the datagram holds their host and port."""
    server = VrpnServer("mocap")
    try:
        with socket.create_server(("127.0.0.1", 0)) as listening, socket.socket(type=socket.SOCK_DGRAM) as asking:
            listening.settimeout(5.0)
            asking.sendto(b"no request\0", ("127.0.0.1", server.port))
            asking.sendto(b"198.51.100.1 %d\0" % listening.getsockname()[1], ("127.0.0.1", server.port))
            line, _ = listening.accept()  # the sender is called, whatever host its datagram names
            line.settimeout(5.0)
            line.sendall(b"vrpn: ver. 07.35  0".ljust(24, b"\0") + name_of_vrpn(-1, 4, "mocap"))
            line.sendall(name_of_vrpn(-2, 6, "vrpn_Base ping_message") + message_of_vrpn(4, 6))
            wait_for(lambda: server.clients == 1)
            server.send(2, (0.1, 0.2, 0.3), (0.0, 0.0, 0.0, 1.0), 5_000_000)
            found = messages_of_vrpn(line, lambda found: len(found) >= 5)
            line.close()
        names = {(kind, sender): body[4:].rstrip(b"\0").decode() for sender, kind, body in found if kind < 0}
        assert names[-1, 0] == "mocap"
        named = {names[-2, kind]: body for sender, kind, body in found if kind >= 0 and names[-1, sender] == "mocap"}
        assert struct.unpack(">ii7d", named["vrpn_Tracker Pos_Quat"]) == (2, 0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0)
        assert named["vrpn_Base pong_message"] == b""
        wait_for(lambda: server.clients == 0)  # one that leaves is forgotten without another pose
    finally:
        server.close()


def test_a_server_that_speaks_something_else_is_reported() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        tracker = VrpnTracker("v", f"a@127.0.0.1:{server.getsockname()[1]}")
        tracker.start(print)
        client, _ = server.accept()
        client.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
        wait_for(lambda: "VRPN" in tracker.problem)
        client.close()
    tracker.stop()


def test_a_skeleton_arrives_by_osc_joint_by_joint() -> None:
    tracker, taken = OscTracker("mocap", "0"), []
    tracker.start(taken.append)
    sender = OscSender(tracker.port)
    try:
        for k in range(200):
            for joint in PERSON_SENSORS:
                place, angles = person_at(joint, k / 120, SEED)
                sender.send(f"person/{joint}", place, euler_quaternion(*angles))
            if len(taken) >= 40:
                break
            time.sleep(0.005)
        sender._client.send_message("/pose/x", "no numbers")
        wait_for(lambda: tracker.rejected >= 5)
    finally:
        tracker.stop()
        sender.close()
    assert {s.sensor for s in taken} == {f"person/{joint}" for joint in PERSON_SENSORS}


def test_a_tape_gives_back_every_bit(tmp_path: Path) -> None:
    file = tmp_path / "tape.jsonl"
    hub = TrackerHub([MountedTracker(ScriptedPerson("p", SEED), {"head": "head"})], TapeWriter(file))
    hub.start()
    poses = []
    for frame in range(120):
        hub.poll(frame * 16 * MS)
        poses.append(hub.head(frame * 16 * MS + 20 * MS))
    hub.stop()
    again = TrackerHub([MountedTracker(TapeTracker("t", file), {"head": "head"})])
    again.start()
    for frame in range(120):
        again.poll(frame * 16 * MS)
        found = again.head(frame * 16 * MS + 20 * MS)
        assert (found is None) == (poses[frame] is None)
        assert found is None or found.tobytes() == poses[frame].tobytes()
    text = file.read_bytes()
    file.write_bytes(text[:-20])  # cut off by a crash
    assert len(list(read_tape(file))) == text.count(b"\n") - 1
    file.write_bytes(b'{"sensor": 1}\n' + text)
    with pytest.raises(SceneError) as caught:
        list(read_tape(file))
    assert caught.value.issues[0].pointer == "line 1"


def test_a_tape_that_does_not_fit_ends_and_the_tracker_goes_on(tmp_path: Path) -> None:
    file = tmp_path / "tape.jsonl"
    hub = TrackerHub([MountedTracker(ScriptedPerson("p", SEED), {"head": "head"})], TapeWriter(file))
    hub.start()
    with largest_file(100_000):
        for frame in range(3000):
            hub.poll(frame * 16 * MS)
        problems = [*hub.take_problems(), *hub.take_problems()]
        assert hub.pose("head", 2999 * 16 * MS).age_ns < 20 * MS
        hub.stop()
    assert problems == ["tape of the trackers: tape.jsonl ends here: File too large"]
    assert 0 < len(list(read_tape(file))) < 3000


@pytest.mark.parametrize("rotation", ["[0,0,0,0]", "[0,0,0,1e200]"])
def test_a_tape_with_a_rotation_that_is_none_is_refused(tmp_path: Path, rotation: str) -> None:
    file = tmp_path / "tape.jsonl"
    file.write_text(f'{{"sensor":"1","t_ns":0,"position":[0,0,0],"rotation":{rotation}}}\n')
    with pytest.raises(SceneError, match="unit quaternion"):
        list(read_tape(file))


def test_the_hub_brings_sensors_into_the_room_and_falls_back_to_whoever_still_sees() -> None:
    person, pointer = ScriptedPerson("p", SEED), PointerTracker("desk")
    seen = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    turned = rotation_from_vector(np.array([0.0, math.pi / 2, 0.0]))
    room = fit_room(seen, seen @ turned.T + [0.0, 1.0, 0.0])
    hub = TrackerHub(
        [
            MountedTracker(person, {"head": "head"}, calibration=room),
            MountedTracker(pointer, {"head": "head", "hand_left": "hand_left"}),
        ]
    )
    hub.start()
    hub.poll(10 * MS)
    place, _ = person_at("head", 8_333_333e-9, SEED)
    expected = turned @ place + [0.0, 1.0, 0.0]
    np.testing.assert_allclose(hub.pose("head", 8_333_333).pose[:3, 3], expected, atol=1e-9)
    assert hub.roles == ("head", "hand_left")
    assert hub.pose("foot", 0) is None
    pointer.poll(500 * MS)  # the person has not been heard of for half a second
    np.testing.assert_allclose(hub.pose("head", 500 * MS).pose[:3, 3], [0.0, 1.7, 0.0], atol=1e-12)


def test_the_pointer_of_a_window_turns_the_head_and_a_stick_moves_a_hand() -> None:
    hub = TrackerHub([MountedTracker(PointerTracker("desk"), {"head": "head", "hand_left": "hand_left"})])
    hub.start()
    gamepad = GamepadState("pad", {"left_x": 1.0, "left_y": 0.0})
    hub.take_window(WindowFrame((InputEvent("move", x=1.0, y=0.0),), gamepad))
    hub.poll(MS)
    head, hand = hub.pose("head", MS), hub.pose("hand_left", MS)
    assert head is not None and hand is not None
    np.testing.assert_allclose(-head.pose[:3, 2], [math.sin(0.6), 0.0, -math.cos(0.6)], atol=1e-9)  # to the right
    np.testing.assert_allclose(hand.pose[:3, 3], [0.0, 1.05, -0.3], atol=1e-12)


def test_a_worn_headset_is_who_is_there_and_nobody_is_made_up_after_it() -> None:
    roles = {"head": "head"}
    hub = TrackerHub([MountedTracker(HeadsetTracker("worn"), roles), MountedTracker(ScriptedPerson("p", SEED), roles)])
    hub.start()
    hub.poll(10 * MS)
    made_up = hub.pose("head", 8_333_333)
    assert made_up is not None  # nobody wears it
    reports = [TrackerSample("head", 20 * MS, (0.3, 1.6, 0.0), (0.0, 0.0, 0.0, 1.0))]
    hub.attach_display(lambda: reports)
    for t in (20, 30, 40, 600):  # one report, requested again and again
        hub.poll(t * MS)
    found = hub.pose("head", 600 * MS)
    assert found is not None and found.stale
    np.testing.assert_allclose(found.pose[:3, 3], [0.3, 1.6, 0.0], atol=1e-12)


class OfAnotherPackage(PolledTracker):
    """A tracker that does all that built-in ones do: window, display, and a simulated person."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.simulated = True
        self._across, self._reports = 0.0, tuple

    def take_window(self, frame):
        self._across = sum(event.x for event in frame.events)

    def attach_display(self, reports):
        self._reports = reports

    def _report(self, now_ns, sink):
        sink(TrackerSample("mouse", now_ns, (self._across, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
        for sample in self._reports():
            sink(sample)


def test_a_tracker_of_another_package_has_window_and_display_and_yields_to_a_person() -> None:
    worn, added = HeadsetTracker("worn"), OfAnotherPackage("lab")
    roles = {"mouse": "hand_left", "head": "head"}
    hub = TrackerHub([MountedTracker(worn, {"hand": "hand_left"}), MountedTracker(added, roles)])
    reports = [TrackerSample("head", MS, (0.3, 1.6, 0.0), (0.0, 0.0, 0.0, 1.0))]
    hub.attach_display(lambda: reports)
    hub.start()
    hub.take_window(WindowFrame((InputEvent("move", x=0.5, y=0.0),)))
    hub.poll(MS)
    hand, head = hub.pose("hand_left", MS), hub.pose("head", MS)
    assert hand is not None and hand.pose[0, 3] == 0.5
    assert head is not None and head.pose[0, 3] == 0.3
    reports.append(TrackerSample("hand", 2 * MS, (0.9, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    for t in (2, 600):
        hub.poll(t * MS)
    lost = hub.pose("hand_left", 600 * MS)
    assert lost is not None and lost.stale and lost.pose[0, 3] == 0.9


class Scripted(PointerTracker):
    """A tracker that reports what a test hands it."""

    def report(self, sensor: str, t_ns: int, rotation: tuple[float, float, float, float]) -> None:
        assert self._sink is not None
        self._sink(TrackerSample(sensor, t_ns, (0.0, 1.7, 0.0), rotation))


def test_a_head_upside_down_and_one_asked_for_too_late_are_reported_once_by_name() -> None:
    source = Scripted("desk")
    hub = TrackerHub([MountedTracker(source, {"1": "head", "2": "hand_left"})])
    hub.start()
    for t in (0, 10 * MS):
        source.report("1", t, (0.0, 0.0, 0.0, 1.0))
        source.report("2", t, (1.0, 0.0, 0.0, 0.0))  # a hand may well be upside down
    assert hub.pose("head", 40 * MS) and hub.pose("hand_left", 40 * MS)
    assert hub.take_problems() == []
    assert hub.pose("head", 70 * MS).capped
    assert [problem for problem in hub.take_problems() if "desk" in problem and "50 ms" in problem]
    source.report("1", 80 * MS, (0.0, 0.0, 1.0, 0.0))
    for _ in range(2):
        hub.pose("head", 80 * MS)
    (said,) = hub.take_problems()
    assert "upside down" in said and "axes" in said
    hub.pose("head", 80 * MS)
    assert hub.take_problems() == []


def test_a_calibration_of_a_tracker_that_hangs_upside_down_is_reported() -> None:
    seen = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    hub = TrackerHub([MountedTracker(Scripted("ceiling"), {}, calibration=fit_room(seen, seen * [1.0, -1.0, -1.0]))])
    (said,) = hub.take_problems()
    assert "ceiling" in said and "upside down" in said


def test_poses_by_lsl_and_none_that_cannot_be() -> None:
    import pylsl

    name = f"mimics poses {time.monotonic_ns()}"
    outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, "MoCap", 14, 120.0, "float32", name))
    track, source = {"1": Track(), "2": Track()}, LslTracker("suit", name)
    try:
        source.start(lambda sample: track[sample.sensor].add(sample))
    except DeviceError as error:
        pytest.skip(f"no loopback of LSL here: {error}")
    nan = math.nan
    bad = [[nan, 1, 0, 0, 0, 0, 1], [0, 1, 0, 0, 0, 0, 0], [9e9, 1, 0, 0, 0, 0, 1], [0, 1, 0, nan, 0, 0, 1]]
    end = time.monotonic() + 20.0
    sent = 0
    while sent < 40 or (any(each.newest is None for each in track.values()) and time.monotonic() < end):
        good = [0.01 * (sent % 10), 1.5, -0.2, 0.0, 0.0, 0.0, 1.0]
        outlet.push_sample([*good, *(bad[sent // 2 % 4] if sent % 2 else [1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0])])
        sent += 1
        time.sleep(0.004)
    while source.rejected < 10 and time.monotonic() < end:
        time.sleep(0.01)
    source.stop()
    first, second = (track[sensor].newest for sensor in ("1", "2"))
    assert first is not None and second is not None
    assert first.position[1:] == pytest.approx((1.5, -0.2)) and second.position == pytest.approx((1.0, 1.0, 1.0))
    assert second.rotation == pytest.approx((0.0, 1.0, 0.0, 0.0))
    assert source.rejected >= 10


class _SilentInlet:
    """Stands for an inlet that waits for a lost sender: samples, then none, then samples again."""

    def __init__(self, answers: list[bool]) -> None:
        self.answers = answers

    def pull_sample(self, timeout: float) -> tuple[list[float] | None, float]:
        time.sleep(0.002)
        there = self.answers.pop(0) if self.answers else True
        return ([0.0, 1.5, 0.0, 0.0, 0.0, 0.0, 1.0], 0.0) if there else (None, 0.0)

    def close_stream(self) -> None:
        pass


def test_a_stream_of_lsl_that_falls_silent_is_told_and_taken_up_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The library waits for the sender for ever and raises nothing."""
    monkeypatch.setattr("mimics_app.inputs.trackers.lsl._SILENCE_NS", 50 * MS)
    source, told = LslTracker("suit", "suit"), []
    answers = [True] * 5 + [False] * 100 + [True] * 50
    monkeypatch.setattr(source, "_open", lambda: setattr(source, "_inlet", _SilentInlet(answers)))
    source.start(lambda sample: told.append(source.problem))
    wait_for(lambda: "suit" in source.problem)
    assert "no data" in source.problem
    wait_for(lambda: source.problem == "" and len(told) > 10)
    source.stop()
    assert told[0] == ""


def test_a_stream_of_lsl_that_nobody_sends_is_one_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mimics_app.inputs.trackers.lsl._PATIENCE_S", 0.2)
    with pytest.raises(DeviceError, match="nobody sends"):
        LslTracker("suit", "nobody sends").start(print)


def test_a_source_that_cannot_be_had_stops_those_begun_before_it() -> None:
    person = ScriptedPerson("p", SEED)
    hub = TrackerHub([MountedTracker(person, {"head": "head"}), MountedTracker(fastrak("f", "/dev/none"), {})])
    with pytest.raises(DeviceError):
        hub.start()
    assert person._sink is None


def test_bytes_become_a_pose_within_a_millisecond_of_work() -> None:
    """The work between a record's last byte and its pose, in units of reading the clock: far below 1 ms."""
    clock, parser, believed = MonotonicClock(), FastrakParser(0.01), Plausibility()
    track, spent = Track(), []
    for k in range(400):
        place, angles = person_at("head", k / 120, SEED)
        record = fastrak_record(1, place, angles, 0.01)
        begun = clock.now_ns()
        for found in parser.feed(record, k * 8 * MS + 1):
            if believed.admits(found):
                track.add(found)
        track.pose(k * 8 * MS + 10 * MS)
        spent.append(clock.now_ns() - begun)
    assert track.newest is not None
    assert sorted(spent)[200] < 5 * MS  # the median, on the slowest machine there is
