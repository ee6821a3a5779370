"""Pairs of shapes that may touch: their list, their contact state, and the joint properties of two surfaces.

A pair keeps normal, friction and contact state from tick to tick while its shapes are near each other. Pairs are stored
densely in one array; a hash of both shapes finds a pair when the list is updated.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.compiled.kernel import kernel
from mimics_app.contracts.arrays import I8
from mimics_app.contracts.loop.haptic_objects import ForceLaw
from mimics_app.maths.vec import fill
from mimics_app.rendering.haptic.kernels.contact_law import pair_damping, pair_stiffness

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import DynamicsRecord, PairRecord, ShapeRecord, Table

__all__ = ["add_pair", "drop_pairs", "forget_contact", "forget_pairs", "join_surfaces"]


_SPRING_DAMPER, _HUNT_CROSSLEY = int(ForceLaw.SPRING_DAMPER), int(ForceLaw.HUNT_CROSSLEY)

_RANKS = np.array([5, 0, 3, 2, 1, 4], np.int64)
"""Rank by ShapeKind: the shape of lower rank is the first of a pair, so that each pair of kinds has one test."""

_USUAL_DEPTH = 1e-3
"""Depth at which a Hunt-Crossley surface is linearised against a surface of another law or exponent [m]."""

_LONG_APART = 1 << 30
"""Initial PAIR.ticks_apart [ticks]: the first contact is a new one."""

_PRIME_A, _PRIME_B, _FOLD = 73856093, 19349663, 15
"""Factors of the hash of two numbers (Teschner et al. 2003), and the shift that folds its high bits [bits]."""


@kernel
def forget_contact(pair: PairRecord) -> None:
    """Clear the state of a contact that ended."""
    fill(pair.stretch, 0.0)
    pair.twist = 0.0
    pair.share = 0.0
    pair.force = 0.0
    pair.touching = 0
    pair.sticking = 1


@kernel
def _forget(pair: PairRecord) -> None:
    """Set the initial state of a pair."""
    forget_contact(pair)
    fill(pair.normal, 0.0)
    pair.rest_force = 0.0
    pair.feature = 0
    pair.ticks_apart = _LONG_APART


@kernel
def _series_of_powers(first: ShapeRecord, second: ShapeRecord, pair: PairRecord) -> None:
    """Set the law of two Hunt-Crossley surfaces of one exponent: equal forces, depths add.

    k = (k1^(-1/n) + k2^(-1/n))^-n, and at low speed a = s1^2 a1 + s2^2 a2 with the shares s = (k/ki)^(1/n) of depth.
    """
    n = first.exponent
    soft1, soft2 = first.stiffness ** (-1.0 / n), second.stiffness ** (-1.0 / n)
    share1, share2 = soft1 / (soft1 + soft2), soft2 / (soft1 + soft2)
    pair.stiffness = (soft1 + soft2) ** (-n)
    pair.damping = share1 * share1 * first.damping + share2 * share2 * second.damping
    pair.exponent = n


@kernel
def _as_spring(shape: ShapeRecord) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of a surface; a Hunt-Crossley one is linearised at `_USUAL_DEPTH`."""
    if shape.law != _HUNT_CROSSLEY:
        return shape.stiffness, shape.damping
    pressed = shape.stiffness * _USUAL_DEPTH**shape.exponent
    return shape.exponent * pressed / _USUAL_DEPTH, shape.damping * pressed


@kernel
def join_surfaces(first: ShapeRecord, second: ShapeRecord, pair: PairRecord) -> None:
    """Set the pair's stiffness, damping and friction from its two shapes, (17) corrected.

    Two Hunt-Crossley surfaces of one exponent join to one of that law; any others to spring-dampers in series.
    Coefficients of friction join as their geometric mean: against a frictionless surface there is none.

    Args:
        first: SHAPE of one.
        second: SHAPE of the other.
        pair: PAIR, updated.
    """
    k1, b1 = _as_spring(first)
    k2, b2 = _as_spring(second)
    powers = first.law == _HUNT_CROSSLEY and second.law == _HUNT_CROSSLEY and first.exponent == second.exponent
    pair.law = _HUNT_CROSSLEY if powers else _SPRING_DAMPER
    k = pair_stiffness(k1, k2)
    if powers:
        _series_of_powers(first, second, pair)
    else:
        pair.stiffness = k
        pair.damping = pair_damping(k1, b1, k2, b2)
        pair.exponent = 1.0
    pair.friction_dynamic = math.sqrt(first.friction_dynamic * second.friction_dynamic)
    pair.friction_static = max(pair.friction_dynamic, math.sqrt(first.friction_static * second.friction_static))
    t1 = first.friction_stiffness if first.friction_stiffness > 0.0 else k1
    t2 = second.friction_stiffness if second.friction_stiffness > 0.0 else k2
    pair.friction_stiffness = pair_stiffness(t1, t2)
    pair.friction_damping = pair_damping(k1, b1, k2, b2) * pair.friction_stiffness / k


@kernel
def _home(a: int, b: int, slots: I8) -> int:
    """First slot of a pair in the hash; the length of the table is a power of two."""
    mixed = (a * _PRIME_A) ^ (b * _PRIME_B)
    return (mixed ^ (mixed >> _FOLD)) & (slots.shape[0] - 1)


@kernel
def _find_pair(a: int, b: int, pairs: Table[PairRecord], slots: I8) -> int:
    """Row of the pair of shapes a and b; if there is none, -1 - (the free slot found)."""
    slot = _home(a, b, slots)
    while slots[slot] >= 0:
        pair = pairs[slots[slot]]
        if pair.a == a and pair.b == b:
            return slots[slot]
        slot = (slot + 1) & (slots.shape[0] - 1)
    return -slot - 1


@kernel
def add_pair(i: int, j: int, shapes: Table[ShapeRecord], pairs: Table[PairRecord], slots: I8, count: int) -> int:
    """Keep or begin the pair of shapes i and j; return the number of pairs, or -1 when the table is full.

    Args:
        i: Row of a shape.
        j: Row of another.
        shapes: Rows of SHAPE.
        pairs: PAIR rows of which the first `count` are in use.
        slots: Hash, rows of pairs or -1; at least twice as long as `pairs`, a power of two.
        count: Number of pairs in use.
    """
    first = _RANKS[shapes[i].kind] * shapes.shape[0] + i
    second = _RANKS[shapes[j].kind] * shapes.shape[0] + j
    a, b = (i, j) if first < second else (j, i)
    found = _find_pair(a, b, pairs, slots)
    if found >= 0:
        pairs[found].kept = 1
        return count
    if count >= pairs.shape[0]:
        return -1
    pair = pairs[count]
    pair.a, pair.b = a, b
    pair.body_a, pair.body_b = shapes[a].body, shapes[b].body
    pair.kept = 1
    pair.slot = -found - 1
    slots[pair.slot] = count
    _forget(pair)
    join_surfaces(shapes[a], shapes[b], pair)
    return count + 1


@kernel
def drop_pairs(pairs: Table[PairRecord], slots: I8, count: int) -> int:
    """Remove the pairs that were not kept, without changing the order; return the number of pairs left."""
    left = 0
    for k in range(count):
        left += pairs[k].kept
    if left == count:
        return count
    for k in range(count):
        slots[pairs[k].slot] = -1
    left = 0
    for k in range(count):
        if pairs[k].kept:
            if left != k:
                pairs[left] = pairs[k]
            left += 1
    for k in range(left):
        pair = pairs[k]
        pair.slot = -_find_pair(pair.a, pair.b, pairs, slots) - 1
        slots[pair.slot] = k
    return left


@kernel
def forget_pairs(pairs: Table[PairRecord], count: int, dynamics: Table[DynamicsRecord]) -> None:
    """Clear the state of pairs of bodies that were placed."""
    for k in range(count):
        pair = pairs[k]
        moved_a = pair.body_a >= 0 and dynamics[pair.body_a].placed
        moved_b = pair.body_b >= 0 and dynamics[pair.body_b].placed
        if moved_a or moved_b:
            _forget(pair)
