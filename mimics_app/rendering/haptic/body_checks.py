"""Checks of a scene's haptic objects before the loop starts: masses, sizes, and the stability of their contacts.

A contact is a spring and a damper that act once a tick. A body resting on it is stable while

    m > n (h^2 k + 2 h b) / 4

with k, b of the pair (17) and n = lambda (1 + m/m'). lambda is the largest eigenvalue of the stiffness of all its
contacts together per mass, for k = 1 N/m and m = 1 kg: 1 for a body that one contact only shifts, 2 between two
contacts, more where the body can also turn and where friction holds it. m' is the mass of the partner, which also
yields.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.loop.haptic_objects import STATIC, BodyFlag, ObjectIntegrator, ShapeKind
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.rendering.haptic.kernels.objects.manifold import CORNER_SHARE
from mimics_app.rendering.haptic.kernels.objects.pairs import join_surfaces
from mimics_app.rendering.haptic.kernels.objects.records import PAIR
from mimics_app.rendering.haptic.mesh_table import MeshTable, build_mesh_table
from mimics_app.rendering.haptic.row_checks import SIZE_COMPONENTS
from mimics_app.world.files.scene.object_bodies import rotation_of

__all__ = ["BodyFault", "check_bodies", "contact_modes"]

Table = NDArray[np.void]

_SURFACE = ("law", "stiffness", "damping", "exponent", "friction_static", "friction_dynamic", "friction_stiffness")

_RIM = 8
"""Points of contact on the rim of a cylinder."""

_NO_VERTICES = np.zeros((0, 3))

_LEVEL = 1e-6
"""Vertices of a hull belong to one side within this share of the hull's size."""

_FARTHEST = 16
"""Number of vertices farthest from the centroid that are tried one at a time."""

_FREE = int(BodyFlag.TRANSLATION | BodyFlag.ROTATION)
_PUSHED = int(BodyFlag.FORCE_ON_OBJECT)
_HELD_FORCE = (ObjectIntegrator.EXACT_DRAG, ObjectIntegrator.IMPLICIT_MIDPOINT)


@dataclass(frozen=True, slots=True)
class BodyFault:
    """One fault of a body or a shape.

    Attributes:
        body: Row of BODY, or -1 for a shape of the static scene.
        shape: Row of SHAPE, or -1 for the body as a whole.
        what: What is wrong, with numbers.
        fix: What to do.
    """

    body: int
    shape: int
    what: str
    fix: str


def check_bodies(rows: Rows, counts: np.void, dt: float, meshes: MeshTable | None = None) -> list[BodyFault]:
    """Return all faults of the rows; empty when the loop can simulate them.

    Args:
        rows: Rows as passed to the loop.
        counts: OBJECT_COUNTS record.
        dt: Tick [s].
        meshes: Meshes by SHAPE.mesh; None: no meshes.
    """
    table = meshes or build_mesh_table()
    shapes, bodies = rows.shapes[: int(counts["shapes"])], rows.bodies[: int(counts["bodies"])]
    faults = [fault for k, body in enumerate(bodies) for fault in _check_body(k, body)]
    faults += [fault for i, shape in enumerate(shapes) for fault in _check_shape(i, shape)]
    if faults:
        return faults
    for k, body in enumerate(bodies):
        if body["flags"] & _FREE:
            touched = int(counts["points"]) > 0 and bool(body["flags"] & _PUSHED)
            found = _check_drag(k, body, dt) or _check_contacts(k, bodies, shapes, table, dt)
            faults += found or (_check_touch(k, body, shapes, table, dt) if touched else [])
    return faults


def _check_body(k: int, body: np.void) -> list[BodyFault]:
    if not (np.isfinite(body["mass"]) and body["mass"] > 0.0):
        return [BodyFault(k, -1, f"a mass of {body['mass']:g} kg", "give a mass above 0")]
    inertia = np.asarray(body["inertia"])
    if not np.all(np.isfinite(inertia)) or not np.allclose(inertia, inertia.T):
        return [BodyFault(k, -1, "its inertia is not a symmetric 3 x 3 matrix", "give it about the centre of mass")]
    moments = np.linalg.eigvalsh(inertia)
    if moments[2] <= 0.0 or moments[0] < -1e-9 * moments[2]:
        return [BodyFault(k, -1, f"principal moments of {moments} kg m^2", "give moments above 0")]
    if moments[2] > (1.0 + 1e-6) * (moments[0] + moments[1]):
        what = f"principal moments of {moments} kg m^2: the largest exceeds the sum of the others"
        return [BodyFault(k, -1, what, "no distribution of mass has these: check the inertia")]
    return []


def _check_shape(i: int, shape: np.void) -> list[BodyFault]:
    body = int(shape["body"])
    size = np.asarray(shape["size"])[: SIZE_COMPONENTS[int(shape["kind"])]]
    if not np.all(np.isfinite(size) & (size > 0.0)):
        return [BodyFault(body, i, f"a size of {size} m", "every size must be above 0")]
    if not (np.isfinite(shape["stiffness"]) and shape["stiffness"] > 0.0):
        return [BodyFault(body, i, f"a stiffness of {shape['stiffness']:g} N/m", "give a stiffness above 0")]
    if not (np.isfinite(shape["damping"]) and shape["damping"] >= 0.0):
        return [BodyFault(body, i, f"a damping of {shape['damping']:g} N s/m", "give a damping of 0 or more")]
    return []


def _hull_of(shape: np.void, meshes: MeshTable) -> F8:
    """Return the vertices of the convex hull of a mesh shape; none for other kinds."""
    if shape["kind"] != ShapeKind.MESH:
        return _NO_VERTICES
    mesh = meshes.rows[int(shape["mesh"])]
    first = int(mesh["first_hull"])
    return meshes.hulls[first : first + int(mesh["hull_corners"])]


def _hull_patches(hull: F8) -> list[tuple[F8, F8, F8]]:
    """Return the patches of a hull: flat sides and outermost vertices (`kernels.objects.collisions_carried_mesh`)."""
    axes, patches = np.eye(3), []
    level = _LEVEL * float(np.ptp(hull, axis=0).max())
    for d in (*axes, *-axes):
        side = hull[hull @ d > (hull @ d).max() - level]
        patches.append((d, side, np.full(len(side), min(CORNER_SHARE, 1.0 / len(side)))))
    far = np.argsort(-np.linalg.norm(hull - hull.mean(axis=0), axis=1))[:_FARTHEST]
    patches += [(d, hull[i][None], np.array([CORNER_SHARE])) for i in far for d in axes]
    return patches


def _patches(shape: np.void, hull: F8) -> list[tuple[F8, F8, F8]]:
    """Return (direction, points, shares) of each contact patch, shape frame; see `kernels.objects.manifold`."""
    size, kind = np.asarray(shape["size"]), ShapeKind(int(shape["kind"]))
    x, y, z = np.eye(3)
    if kind is ShapeKind.MESH:
        return _hull_patches(hull) if len(hull) else []
    if kind is ShapeKind.SPHERE:
        return [(d, (size[0] * d)[None], np.ones(1)) for d in (x, y, z)]
    if kind is ShapeKind.BOX:
        corners = 0.5 * size * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        return [(d, corners[corners @ d > 0.0], np.full(4, 0.25)) for d in (x, y, z)]
    if kind not in (ShapeKind.CYLINDER, ShapeKind.CAPSULE):
        return []
    radius, half = size[0], 0.5 * size[1]
    sides = [(d, np.array([radius * d - half * y, radius * d + half * y]), np.full(2, 0.5)) for d in (x, z)]
    if kind is ShapeKind.CAPSULE:
        return [*sides, (y, ((half + radius) * y)[None], np.full(1, 0.5))]
    angles = 2.0 * np.pi * np.arange(_RIM) / _RIM
    rim = radius * (np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * z) + half * y
    return [*sides, (y, rim, np.full(_RIM, 1.0 / _RIM))]


def _stiffness(direction: F8, points: F8, shares: F8, tangential: float) -> F8:
    """Return the 6 x 6 stiffness of one patch for shift and rotation, at 1 N/m; points from the centre of mass."""
    total = np.zeros((6, 6))
    along = np.outer(direction, direction)
    grip = along + tangential * (np.eye(3) - along)
    for p, share in zip(points, shares, strict=True):
        arm = np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])
        moves = np.hstack([np.eye(3), -arm])  # velocity at p of (v, omega)
        total += share * moves.T @ grip @ moves
    return total


def contact_modes(shape: np.void, body: np.void, contacts: int, tangential: float, hull: F8 = _NO_VERTICES) -> float:
    """Return the largest eigenvalue lambda of the stiffness of a body's contacts per mass, for k = 1 N/m and m = 1 kg.

    Args:
        shape: SHAPE row of the body.
        body: BODY row.
        contacts: 1, or 2 for contacts on two opposite sides of the shape.
        tangential: Stiffness of friction as a share of k; 0: frictionless.
        hull: Vertices of a mesh's convex hull, shape frame [m], shape [n, 3].
    """
    R, offset = rotation_of(tuple(shape["orientation"])), np.asarray(shape["position"]) - np.asarray(body["centre"])
    free = np.repeat([bool(body["flags"] & 1), bool(body["flags"] & 2)], 3)
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = np.eye(3), np.asarray(body["inertia"]) / body["mass"]
    # Keeps the matrix positive definite for an axis without a moment.
    mass[3:, 3:] += np.eye(3) * 1e-9 * np.trace(mass[3:, 3:])
    root = np.linalg.inv(np.linalg.cholesky(mass))
    largest = 0.0
    for direction, points, shares in _patches(shape, hull):
        total = np.zeros((6, 6))
        for side in (1.0, -1.0)[:contacts]:
            placed = side * points @ R.T + offset
            total += _stiffness(R @ direction, placed, shares, tangential)
        modes = (root @ total @ root.T) * np.outer(free, free)
        largest = max(largest, float(np.linalg.eigvalsh(modes)[-1]))
    return largest


def _partners(k: int, bodies: Table, shapes: Table) -> list[int]:
    """Return the shapes that a body can meet, one per combination of surface and mass."""
    seen: dict[tuple[float, ...], int] = {}
    for j in np.flatnonzero((shapes["body"] != k) & (shapes["enabled"] != 0)):
        shape = shapes[j]
        other = int(shape["body"])
        mass = float("inf") if other == STATIC else float(bodies[other]["mass"])
        seen.setdefault((mass, *(shape[name].item() for name in _SURFACE)), int(j))
    return list(seen.values())


def _check_contacts(k: int, bodies: Table, shapes: Table, meshes: MeshTable, dt: float) -> list[BodyFault]:
    """Return the faults of the worst pair of a body's shapes with their possible partners."""
    body, worst = bodies[k], 0.0
    faults: list[BodyFault] = []
    partners = _partners(k, bodies, shapes)
    meets = int(np.sum((shapes["body"] != k) & (shapes["enabled"] != 0)))
    pair = np.zeros(1, PAIR)[0]
    for i in np.flatnonzero((shapes["body"] == k) & (shapes["enabled"] != 0)):
        modes: dict[float, float] = {}
        hull = _hull_of(shapes[i], meshes)
        for j in partners:
            join_surfaces(shapes[i], shapes[j], pair)
            stiffness, damping = _at_usual_depth(pair)
            tangential = float(pair["friction_stiffness"]) / stiffness if pair["friction_static"] > 0.0 else 0.0
            if tangential not in modes:
                modes[tangential] = contact_modes(shapes[i], body, min(meets, 2), tangential, hull)
            other = int(shapes[j]["body"])
            yields = 1.0 if other == STATIC else 1.0 + float(body["mass"]) / float(bodies[other]["mass"])
            n = modes[tangential] * yields
            least = n * (dt * dt * stiffness + 2.0 * dt * damping) / 4.0
            if least >= body["mass"] and least > worst:
                worst = least
                faults = [_too_light(k, int(i), float(body["mass"]), least, n, stiffness, damping, dt)]
            faults += _check_integrator(k, int(i), body, stiffness, damping, dt) if not faults else []
    return faults


def _check_touch(k: int, body: np.void, shapes: Table, meshes: MeshTable, dt: float) -> list[BodyFault]:
    """Return the fault of a body pushed by the HIP with the full stiffness of its surface; the HIP counts as rigid."""
    for i in np.flatnonzero((shapes["body"] == k) & (shapes["enabled"] != 0)):
        stiffness, damping = _at_usual_depth(shapes[i])
        rough = float(shapes[i]["friction_stiffness"]) or stiffness
        tangential = rough / stiffness if shapes[i]["friction_static"] > 0.0 else 0.0
        n = contact_modes(shapes[i], body, 1, tangential, _hull_of(shapes[i], meshes))
        least = n * (dt * dt * stiffness + 2.0 * dt * damping) / 4.0
        if least >= body["mass"]:
            return [_too_light(k, int(i), float(body["mass"]), least, n, stiffness, damping, dt)]
    return []


def _check_drag(k: int, body: np.void, dt: float) -> list[BodyFault]:
    """Return the faults of drag that reverses a motion within a tick: m > h b/2, and likewise for each moment."""
    if ObjectIntegrator(int(body["integrator"])) in _HELD_FORCE:
        return []
    moments = np.linalg.eigvalsh(np.asarray(body["inertia"]))
    rest = [("mass", "kg", float(body["mass"]), float(body["damping_translation"]))] if body["flags"] & 1 else []
    if body["flags"] & 2:
        rest.append(("smallest moment", "kg m^2", float(moments[moments > 0.0].min()), float(body["damping_rotation"])))
    for name, unit, inert, b in rest:
        if 0.5 * dt * b >= inert:
            what = f"its {name} of {inert:.4g} {unit} is below h b/2 = {0.5 * dt * b:.4g} of the environment's damping"
            return [BodyFault(k, -1, what, "use the integrator exact_drag, or less damping")]
    return []


def _at_usual_depth(pair: np.void) -> tuple[float, float]:
    """Return stiffness and damping of a pair; of a Hunt-Crossley law those at a depth of 1 mm."""
    if pair["law"] == 0:
        return float(pair["stiffness"]), float(pair["damping"])
    pressed = float(pair["stiffness"]) * 1e-3 ** float(pair["exponent"])
    return float(pair["exponent"]) * pressed / 1e-3, float(pair["damping"]) * pressed


def _too_light(
    k: int, i: int, mass: float, least: float, n: float, stiffness: float, damping: float, dt: float
) -> BodyFault:
    what = (
        f"{mass:.4g} kg is too light: contacts of {stiffness:g} N/m and {damping:g} N s/m at {1e3 * dt:g} ms need "
        f"m > n (h^2 k + 2 h b)/4 = {least:.4g} kg, n = {n:.3g} with rotation, friction and partner included"
    )
    return BodyFault(k, i, what, f"make it heavier than {least:.2g} kg, or its surface softer or less damped")


def _check_integrator(k: int, i: int, body: np.void, stiffness: float, damping: float, dt: float) -> list[BodyFault]:
    """Return the fault of too little damping for an integrator that also uses the old velocity and so gains energy."""
    which = ObjectIntegrator(int(body["integrator"]))
    if which is ObjectIntegrator.SEMI_IMPLICIT:
        return []
    rule, least = ("k h/2", 0.5 * stiffness * dt) if which in _HELD_FORCE else ("k h", stiffness * dt)
    if damping > least:
        return []
    what = f"{which.name.lower()} is stable at a contact of {stiffness:g} N/m with b > {rule} = {least:.4g} N s/m only"
    return [BodyFault(k, i, what, "use the integrator semi_implicit, or more damping")]
