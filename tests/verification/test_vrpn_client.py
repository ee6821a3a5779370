"""The VRPN server against a client that its maker did not write: the VRPN library within Panda3D."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from mimics_app.inputs.trackers.pose_senders import VrpnServer

CLIENT = """
import json, sys, time
from panda3d.core import ClockObject, DataGraphTraverser, DataNode, NodePath, TrackerNode
from panda3d.vrpn import VrpnClient

client = VrpnClient(sys.argv[1])
node, root, traverser = TrackerNode(client, sys.argv[2]), NodePath(DataNode("root")), DataGraphTraverser()
root.attachNewNode(node)
until = time.monotonic() + 60.0
while time.monotonic() < until:
    ClockObject.getGlobalClock().tick()  # a client polls once a frame
    client.poll()
    traverser.traverse(root.node())
    try:
        print(json.dumps([*node.get_pos(), *node.get_orient(), node.get_time()]))
        break
    except AssertionError:  # no report yet
        time.sleep(0.005)
"""
POSITION = (0.1, 1.6, -0.3)
ROTATION = (0.5, -0.1, 0.7, 0.5)  # x, y, z, w: of length one
T_NS = 1_250_000_000


@pytest.fixture(scope="module")
def panda(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with Panda3D, which is too large to be a requirement of the tests."""
    folder = tmp_path_factory.mktemp("panda3d")
    install = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(folder), "panda3d==1.10.16"]
    if subprocess.run(install, check=False, timeout=600).returncode:
        pytest.skip("Panda3D cannot be installed here")
    return folder


@pytest.fixture
def server() -> Iterator[VrpnServer]:
    serving, closing = VrpnServer("mocap"), threading.Event()

    def send() -> None:
        while not closing.wait(0.01):
            serving.send(0, POSITION, ROTATION, T_NS)

    sender = threading.Thread(target=send)
    sender.start()
    yield serving
    closing.set()
    sender.join()
    serving.close()


@pytest.mark.slow
@pytest.mark.parametrize("by", ["", "tcp://"])
def test_a_client_of_the_vrpn_library_reads_the_pose(panda: Path, server: VrpnServer, by: str) -> None:
    """Called by UDP as `TRACKER@HOST` asks, or connected by TCP; Panda3D orders a quaternion w, x, y, z."""
    client = [sys.executable, "-c", CLIENT, f"{by}127.0.0.1:{server.port}", "mocap"]
    answer = subprocess.run(client, env={"PYTHONPATH": str(panda)}, capture_output=True, text=True, timeout=90)
    *place, w, x, y, z, seconds = json.loads(answer.stdout.splitlines()[-1])
    assert place == pytest.approx(POSITION, abs=1e-6)
    assert (x, y, z, w) == pytest.approx(ROTATION, abs=1e-6)
    assert seconds == pytest.approx(T_NS * 1e-9, abs=1e-5)
