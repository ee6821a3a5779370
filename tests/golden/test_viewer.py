"""`mimics view` as a person meets it: pictures, sheets, and a window that is clicked, dragged and typed into."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.viewer.sheet import draw_sheet
from mimics_app.app.viewer.shown import open_shown
from mimics_app.app.viewer.stills import draw_turntable
from mimics_app.contracts.errors import SceneError
from mimics_app.world.primitives import box
from tests.support.gltf_maker import *  # noqa: F403
from tests.support.shared_data import shared_folder
from tests.support.xvfb import display

_ROOT = Path(__file__).parents[2]
