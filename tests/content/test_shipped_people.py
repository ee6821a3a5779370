"""Every shipped person, as the file has them: bent as far as people bend, with lids shut and lips closed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from assets.builders.avatars.face_shape import EYE_RADIUS
from assets.builders.avatars.folds import BENDS
from assets.builders.avatars.postures import Pose
from mimics_app.contracts.system.resources import root
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.buffers import GltfBuffers
from mimics_app.world.files.gltf.gltf_document import open_gltf
from tests.support.reference_skinning import skin_dual, skin_linear, volume
from tests.support.shipped_people import NAMES, Part, Shipped, load_shipped

F8 = NDArray[np.float64]
I8 = NDArray[np.int64]
Bent = dict[tuple[str, str, str], F8]

_BENDING = ("skin_head", "skin_body", "top", "bottom", "socks")
_OUTWARDS = 1e-4
"""How far over and under a triangle its outside is asked for [m]."""
_MOST_OUT = 0.001
"""How far skin may stand out of a garment that covered it [m]."""
_MOST_TURN = 4.0
"""How many times faster than a circle of its length a hem may turn; torn ones turn twenty times faster."""


@pytest.fixture(scope="module", params=NAMES)
def shipped(request: pytest.FixtureRequest) -> Shipped:
    return load_shipped(request.param)


@pytest.fixture(scope="module")
def bent(shipped: Shipped) -> Bent:
    """Places of every part that bends by (bend and side, way of skinning, part), [n, 3]."""
    found = {}
    for name, pose in _poses(shipped).items():
        for part in _BENDING:
            if part in shipped.parts:
                own = shipped.parts[part]
                for skin in (skin_linear, skin_dual):
                    found[name, skin.__name__, part] = skin(own.places, own.weights, pose)
    return found


def _poses(shipped: Shipped) -> dict[str, Pose]:
    return {f"{name} {side}": bend(shipped.bones, side) for name, bend in BENDS.items() for side in (1, -1)}


def test_normals_are_as_long_as_they_should_be(shipped: Shipped) -> None:
    """In the file: the reader scales others, and notes it."""
    file = root() / "assets" / "models" / "avatars" / f"{shipped.person.name}.glb"
    source = open_gltf(file, file.parent, file.name)
    accessors = GltfAccessors(source, GltfBuffers(source))
    for number, mesh in enumerate(source.table("meshes")):
        for primitive in mesh["primitives"]:
            normals = accessors.floats(primitive["attributes"]["NORMAL"], f"/meshes/{number}", "VEC3")
            assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-6)


def test_every_surface_encloses_what_is_inside_of_it(shipped: Shipped) -> None:
    """Ears, locks of hair and a tail were inside out: of them the farther half was drawn."""
    for part, piece in shipped.parts.items():
        if part == "wisps":  # flat, seen from both sides
            continue
        _, same = np.unique(np.round(piece.places, 6), axis=0, return_inverse=True)
        corners = same.reshape(-1)[piece.triangles]
        pairs = (np.ones(2 * len(corners)), (corners[:, :2].ravel(), corners[:, 1:].ravel()))
        surfaces = connected_components(coo_array(pairs, shape=(same.max() + 1,) * 2), directed=False)[1]
        for surface in np.unique(surfaces):
            own = piece.triangles[surfaces[corners[:, 0]] == surface]
            if len(own):
                assert volume(piece.places - piece.places[own[0, 0]], own) > 0.0, (part, len(own))


def test_bends_turn_no_triangle_inside_out(shipped: Shipped, bent: Bent) -> None:
    """Against where the flesh under each has its outside."""
    poses = _poses(shipped)
    for part, piece in shipped.parts.items():
        if part not in _BENDING:
            continue
        t = piece.triangles
        rest = _normals(piece.places, t)
        size = np.linalg.norm(rest, axis=1)
        unit = rest / np.maximum(size, 1e-15)[:, None]
        middle, mean = piece.places[t].mean(axis=1), piece.weights[t].mean(axis=1)
        for name, pose in poses.items():
            above, below = (skin_dual(middle + far * unit, mean, pose) for far in (_OUTWARDS, -_OUTWARDS))
            for skin in ("skin_linear", "skin_dual"):
                facing = (_normals(bent[name, skin, part], t) * (above - below)).sum(axis=1)
                assert not ((facing < 0.0) & (size > 1e-7)).any(), (part, name, skin)


def test_bends_keep_nine_tenths_of_the_volume(shipped: Shipped, bent: Bent) -> None:
    skirt = ("bottom", "skirt") if "skirt" in dict(shipped.person.clothes) else ()
    for (name, skin, part), places in bent.items():
        if part in skirt and name.startswith(("knee", "hip")):
            continue  # a skirt is air
        triangles = shipped.parts[part].triangles
        assert volume(places, triangles) >= 0.9 * volume(shipped.parts[part].places, triangles), (name, skin, part)


@pytest.mark.parametrize(("inner", "outer"), [("skin_body", "top"), ("bottom", "top"), ("skin_body", "bottom")])
def test_what_a_garment_covers_stays_under_it(shipped: Shipped, bent: Bent, inner: str, outer: str) -> None:
    under, over = shipped.parts[inner], shipped.parts[outer]
    corners, triangles, shares = _covered(under, over)
    assert len(corners) > 20 or (inner == "skin_body" and outer == "bottom")
    for (name, skin, part), places in bent.items():
        if part != outer:
            continue
        t = over.triangles[triangles]
        normals = _normals(places, t)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        here = np.einsum("nk,nkj->nj", shares, places[t])
        out = ((bent[name, skin, inner][corners] - here) * normals).sum(axis=1)
        assert out.max(initial=0.0) <= _MOST_OUT, (name, skin, out.max())


def _normals(places: F8, triangles: I8) -> F8:
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def _covered(under: Part, over: Part) -> tuple[I8, I8, F8]:
    """Corners right below a garment, its triangles over them, and barycentric coordinates in these, [n, 3]."""
    t = over.triangles
    normals = _normals(over.places, t)
    size = np.linalg.norm(normals, axis=1)
    near = KDTree(over.places[t].mean(axis=1)).query(under.places, k=12)[1]
    corners = np.repeat(np.arange(len(under.places)), 12)
    found = near.ravel()
    a, b, c = (over.places[t[found, k]] for k in range(3))
    unit = normals[found] / np.maximum(size[found], 1e-15)[:, None]
    offset = under.places[corners] - a
    high = (offset * unit).sum(axis=1)
    flat = under.places[corners] - high[:, None] * unit
    shares = np.stack([(np.cross(q - p, flat - p) * unit).sum(axis=1) for p, q in ((b, c), (c, a), (a, b))], axis=1)
    shares /= np.maximum(size[found], 1e-15)[:, None]
    facing = (unit * under.normals[corners]).sum(axis=1) > 0.3
    good = (shares.min(axis=1) > -0.02) & (high > -0.03) & (high < 0.0) & facing & (size[found] > 1e-7)
    order = np.lexsort((-high, corners, ~good))
    order = order[good[order]]
    _, first = np.unique(corners[order], return_index=True)
    kept = order[first]
    return corners[kept], found[kept], shares[kept]


def test_shut_lids_hide_the_eyeballs(shipped: Shipped) -> None:
    """Seen from ahead and from 30 degrees aside nothing of an eyeball is before the lids, and no lid is in it."""
    head, eyes = shipped.parts["skin_head"], shipped.parts["eye"]
    shut = head.places + head.moves["blink"]
    balls = eyes.places[eyes.triangles]
    points = np.concatenate([eyes.places, balls.mean(axis=1), 0.5 * (balls + np.roll(balls, 1, axis=1)).reshape(-1, 3)])
    for side in (1.0, -1.0):
        own = points[points[:, 0] * side > 0.0]
        middle = shipped.bones.place("leftEye" if side > 0.0 else "rightEye")
        front = own[own[:, 2] > middle[2] + 0.3 * EYE_RADIUS]
        for degrees in (-30.0, 0.0, 30.0):
            seen = ~_hidden(front, shut, head.triangles, degrees)
            assert not seen.any(), (side, degrees, np.round(1e3 * (front[seen] - middle), 1))
        moved = np.linalg.norm(head.moves["blink"], axis=1) > 1e-3
        away = np.linalg.norm(shut[moved & (shut[:, 0] * side > 0.0)] - middle, axis=1)
        assert len(away) > 10 and away.min() >= EYE_RADIUS


@pytest.mark.parametrize("morph", ["", "smile", "brows", "blink"])
def test_closed_lips_hide_teeth_and_tongue(shipped: Shipped, morph: str) -> None:
    head, mouth = shipped.parts["skin_head"], shipped.parts["mouth"]
    lips, teeth = (
        part.places + part.moves[morph] if morph and morph in part.moves else part.places for part in (head, mouth)
    )
    for degrees in (-30.0, 0.0, 30.0):
        seen = ~_hidden(teeth, lips, head.triangles, degrees)
        assert not seen.any(), (degrees, teeth[seen])


def _hidden(points: F8, places: F8, triangles: I8, degrees: float) -> NDArray[np.bool_]:
    """Which points lie behind a surface for who looks from ahead, or from so far aside."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    points, corners = points @ turn.T, (places @ turn.T)[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    reach_low, reach_high = points.min(axis=0), points.max(axis=0)
    near = ((low[:, :2] <= reach_high[:2]) & (high[:, :2] >= reach_low[:2])).all(axis=1)
    a, b, c_ = (corners[near][:, k] for k in range(3))
    area = _across(b - a, c_ - a)
    whole = np.abs(area) > 1e-12
    a, b, c_, area = a[whole], b[whole], c_[whole], area[whole]
    p = points[:, None, :]
    u, v = _across(b - p, c_ - p) / area, _across(c_ - p, a - p) / area
    w = 1.0 - u - v
    depth = u * a[:, 2] + v * b[:, 2] + w * c_[:, 2]
    inside = (np.minimum(np.minimum(u, v), w) >= -1e-6) & (depth > points[:, 2:])
    return np.asarray(inside.any(axis=1))


def _across(a: F8, b: F8) -> F8:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def test_no_hem_is_torn(shipped: Shipped) -> None:
    """Sharp edges that run around a limb or the trunk turn nowhere much faster than a circle as long as they are."""
    hems = 0
    for name in ("top", "bottom", "socks"):
        for ring in _sharp_rings(shipped.parts[name]) if name in shipped.parts else ():
            steps = np.roll(ring, -1, axis=0) - ring
            size = np.linalg.norm(steps, axis=1)
            before = np.roll(steps, 1, axis=0)
            cosines = (steps * before).sum(axis=1) / (size * np.roll(size, 1))
            faster = np.arccos(np.clip(cosines, -1.0, 1.0)) / (0.5 * (size + np.roll(size, 1)))
            hems += 1
            assert faster.max() < _MOST_TURN * 2.0 * math.pi / size.sum(), (name, ring[int(faster.argmax())])
    assert hems >= 3


def _sharp_rings(part: Part) -> list[F8]:
    """Closed chains of edges between faces that meet at more than 45 degrees, at least 8 edges long, [n, 3] each."""
    _, same = np.unique(np.round(part.places, 6), axis=0, return_inverse=True)
    places = np.zeros((int(same.max()) + 1, 3))
    places[same.reshape(-1)] = part.places
    t = same.reshape(-1)[part.triangles]
    normals = _normals(places, t)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-15)[:, None]
    faces: dict[tuple[int, int], list[int]] = {}
    for number, triangle in enumerate(t.tolist()):
        for i in range(3):
            a, b = sorted((triangle[i], triangle[(i + 1) % 3]))
            faces.setdefault((a, b), []).append(number)
    near: dict[int, list[int]] = {}
    for (a, b), two in faces.items():
        if a != b and len(two) == 2 and normals[two[0]] @ normals[two[1]] < math.cos(math.radians(45.0)):
            near.setdefault(a, []).append(b)
            near.setdefault(b, []).append(a)
    rings, known = [], set[int]()
    for start in near:
        chain = [start]
        while start not in known and len(near[chain[-1]]) == 2:
            ahead = [each for each in near[chain[-1]] if len(chain) < 2 or each != chain[-2]]
            if ahead[0] == start:
                break
            chain.append(ahead[0])
        if start not in known and len(near[chain[-1]]) == 2 and len(chain) >= 8:
            rings.append(places[chain])
            known |= set(chain)
    return rings
