"""Map of the space around a person at rest to that around a person of other measures.

Every chain of bones has a smooth map of its own, and a vertex moves by the mean of the maps of its bones, weighted as
for skinning: cloth moves with the skin below it, and surfaces that were closed stay so. Along a limb lengths are
scaled, across it girths by a factor that changes smoothly from girth to girth; heights of trunk and legs go through one
monotone curve, so that those that were asked come out exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.world.files.people.body_table import Body

__all__ = ["CHAINS", "BodyMap", "chain_of"]

_SIDES = ("left", "right")
CHAINS = ("trunk", "head", *(f"{side}_{part}" for side in _SIDES for part in ("arm", "hand", "leg", "foot")))
"""Chains of bones, each with one map."""

_HEAD_GROWTH = 0.4
"""Exponent of a head's size over the stature's: heads of tall and small people differ little."""
_SPINE_Z = -0.015
"""Where the axis of the trunk lies, behind the ears' plane [m]."""
_DEEPER = 1.25
"""Exponent of the waist's depth: a belly grows ahead more than aside."""

_Curve = Callable[[F8], F8]
_Chain = Callable[[F8], F8]


def chain_of(joint: str) -> str:
    """Return the chain of a joint that is named as in VRM 1.0."""
    side = next((side for side in _SIDES if joint.startswith(side)), "")
    part = joint.removeprefix(side)
    if part in ("Eye", "head"):
        return "head"
    if not side or part == "Shoulder":
        return "trunk"
    if part in ("UpperArm", "LowerArm"):
        return f"{side}_arm"
    if part in ("UpperLeg", "LowerLeg"):
        return f"{side}_leg"
    return f"{side}_foot" if part in ("Foot", "Toes") else f"{side}_hand"


class BodyMap:
    """The map.

    Args:
        body: The shipped body.
        joints: Its joints at rest by name [m], [3] each.
        lengths: Of the new person, with "stature" [m].
        factors: On the girths of the shipped body, by name.
    """

    def __init__(
        self, body: Body, joints: Mapping[str, F8], lengths: Mapping[str, float], factors: Mapping[str, float]
    ) -> None:
        self._body, self._joints = body, joints
        self._factors = factors
        self._ratio = lengths["stature"] / body.stature
        self._ratios = {name: lengths[name] / value for name, value in body.lengths.items()}
        self._head_size = self._ratio**_HEAD_GROWTH
        self._levels = self._heights(lengths)
        self._maps: dict[str, _Chain] = {"trunk": self._trunk_map()}
        self._maps["head"] = self._sized("head", self._maps["trunk"], self._head_size)
        for side in _SIDES:
            self._maps[f"{side}_arm"] = self._arm_map(side)
            self._maps[f"{side}_hand"] = self._sized(f"{side}Hand", self._maps[f"{side}_arm"], self._ratios["hand"])
            self._maps[f"{side}_leg"] = self._leg_map(side)
            self._maps[f"{side}_foot"] = self._foot_map(side)

    def move(self, places: F8, shares: F8) -> F8:
        """Return where points go.

        Args:
            places: On the shipped person at rest [m], [n, 3].
            shares: Of each chain of `CHAINS` in the motion of a point, [n, chains].
        """
        result = np.zeros_like(places)
        for column, name in enumerate(CHAINS):
            moved = shares[:, column] > 0.0
            if moved.any():
                result[moved] += shares[moved, column, None] * self._maps[name](places[moved])
        return result

    def joint(self, name: str) -> F8:
        """Return where a joint goes [m], [3]."""
        return np.asarray(self._maps[chain_of(name)](self._joints[name][None])[0])

    def _heights(self, lengths: Mapping[str, float]) -> _Curve:
        body, head = self._body, float(self._joints["head"][1])
        ankle = float(self._joints["leftFoot"][1])
        pairs = [(0.0, 0.0), (ankle, ankle * self._ratios["foot"])]
        pairs += [(body.lengths[name], lengths[name]) for name in ("knee_height", "hip_height", "acromial_height")]
        pairs.append((head, lengths["stature"] - self._head_size * (body.stature - head)))
        return _curve(pairs, sloping=True)

    def _trunk_map(self) -> _Chain:
        factors, ratio = self._factors, self._ratio
        shoulder, head = (float(self._joints[name][1]) for name in ("leftUpperArm", "head"))
        wide = self._ratios["shoulders"]

        def across(depth: bool) -> _Curve:
            waist = ratio * (factors["waist"] / ratio) ** (_DEEPER if depth else 2.0 - _DEEPER)
            return _curve(
                [
                    (self._height("hip"), factors["hip"]),
                    (self._height("waist"), waist),
                    (self._height("chest"), factors["chest"]),
                    (shoulder, 0.5 * (wide + factors["chest"]) if depth else wide),
                    (self._body.lengths["acromial_height"], 0.5 * (wide + factors["neck"]) if depth else wide),
                    (self._height("neck"), factors["neck"]),
                    (head, self._head_size),
                ]
            )

        aside, ahead = across(depth=False), across(depth=True)

        def move(places: F8) -> F8:
            x, y, z = places.T
            return np.stack([aside(y) * x, self._levels(y), ratio * _SPINE_Z + ahead(y) * (z - _SPINE_Z)], axis=1)

        return move

    def _arm_map(self, side: str) -> _Chain:
        shoulder, elbow, wrist = (self._joints[f"{side}{name}"] for name in ("UpperArm", "LowerArm", "Hand"))
        start = self._maps["trunk"](shoulder[None])[0]
        along = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
        upper, lower = float((elbow - shoulder) @ along), float((wrist - elbow) @ along)
        long = upper * self._ratios["upper_arm"]
        ends = [(0.0, 0.0), (upper, long), (upper + lower, long + lower * self._ratios["forearm"])]
        reach = _curve(ends, sloping=True)
        top = self._joints["leftUpperArm"]
        at = {name: float(np.linalg.norm(self._body.ring(name).mean(axis=0) - top)) for name in ("biceps", "wrist")}
        thick, thin = self._factors["biceps"], self._factors["wrist"]
        girth = _curve(
            [
                (0.0, 0.5 * (self._factors["chest"] + thick)),
                (at["biceps"], thick),
                (upper, (thick * thin) ** 0.5),
                (upper + 0.26 * lower, 0.5 * (thick + thin)),
                (at["wrist"], thin),
            ]
        )

        def move(places: F8) -> F8:
            far = (places - shoulder) @ along
            away = places - shoulder - far[:, None] * along
            return np.asarray(start + reach(far)[:, None] * along + girth(far)[:, None] * away)

        return move

    def _leg_map(self, side: str) -> _Chain:
        hip, knee, ankle = (self._joints[f"{side}{name}"] for name in ("UpperLeg", "LowerLeg", "Foot"))
        thigh, calf = self._factors["thigh"], self._factors["calf"]
        girth = _curve(
            [
                (self._height("ankle"), self._factors["ankle"]),
                (self._height("calf"), calf),
                (float(knee[1]), (thigh * calf) ** 0.5),
                (self._height("thigh"), thigh),
                (float(hip[1]), self._factors["hip"]),
            ]
        )
        axis = [_curve([(float(joint[1]), float(joint[i])) for joint in (ankle, knee, hip)]) for i in (0, 2)]
        apart = 0.5 * (self._factors["hip"] + thigh)

        def move(places: F8) -> F8:
            x, y, z = places.T
            wide, (aside, ahead) = girth(y), (each(y) for each in axis)
            return np.stack(
                [apart * aside + wide * (x - aside), self._levels(y), self._ratio * ahead + wide * (z - ahead)], axis=1
            )

        return move

    def _foot_map(self, side: str) -> _Chain:
        ankle, size = self._joints[f"{side}Foot"], self._ratios["foot"]
        start = self._maps[f"{side}_leg"](ankle[None])[0]

        def move(places: F8) -> F8:
            moved = start + size * (places - ankle)
            moved[:, 1] = self._levels(places[:, 1])
            return np.asarray(moved)

        return move

    def _sized(self, joint: str, above: _Chain, size: float) -> _Chain:
        """Return a map that scales about a joint, which moves by another map."""
        middle = self._joints[joint]
        start = above(middle[None])[0]
        return lambda places: np.asarray(start + size * (places - middle))

    def _height(self, girth: str) -> float:
        return float(self._body.ring(girth)[:, 1].mean())


def _curve(pairs: Sequence[tuple[float, float]], *, sloping: bool = False) -> _Curve:
    """Return a smooth curve through points, monotone between them (Fritsch and Butland 1984).

    Args:
        pairs: The points, ascending.
        sloping: Whether it continues beyond its ends with the slope of the last two points; else it is constant there.
    """
    from scipy.interpolate import PchipInterpolator

    at, values = np.array(pairs).T
    between = PchipInterpolator(at, values)
    slopes = np.diff(values) / np.diff(at) if sloping else np.zeros(len(at) - 1)

    def read(where: F8) -> F8:
        inside = between(np.clip(where, at[0], at[-1]))
        beyond = slopes[0] * np.minimum(where - at[0], 0.0) + slopes[-1] * np.maximum(where - at[-1], 0.0)
        return np.asarray(inside + beyond)

    return read
