"""Joints turned round move the other way, and their coordinates keep their meaning where that is possible."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from nullbody.errors import MechanismError
from nullbody.expr.parse import parse
from nullbody.mechanism import (
    Cylindrical,
    Free,
    MechanismBuilder,
    Placement,
    Planar,
    Prismatic,
    Revolute,
    Rotation,
    Spherical,
    Universal,
    Weld,
)
from nullbody.mechanism.builder.direction import directed, directed_pair, rotations_of
from nullbody.mechanism.builder.turning import turned, turned_home
from nullbody.mechanism.joints.base import axis_vector, elementary_rotation

JOINTS: list[Any] = [
    Revolute("j", "a", "b", ("q",), axis="y"),
    Prismatic("j", "a", "b", ("q",), axis="-x"),
    Cylindrical("j", "a", "b", ("s", "q"), axis="z"),
    Universal("j", "a", "b", ("p", "q"), axis="x", axis2="-z"),
    Weld("j", "a", "b"),
    Planar("j", "a", "b", ("u", "w", "q"), axis="-y"),
    Spherical("j", "a", "b", ("e0", "e1", "e2", "e3")),
]


def pose(joint: Any, q: dict[str, float]) -> np.ndarray:
    """The motion as a 4 x 4 matrix."""
    made = joint.motion([q[name] for name in joint.coordinates], math.sin, math.cos).pose
    return np.block([[np.array(made.rotation, float), np.array(made.position, float)[:, None]], [0, 0, 0, 1]])


@pytest.mark.parametrize("joint", JOINTS, ids=lambda joint: type(joint).__name__)
def test_the_turned_joint_moves_by_the_inverse(joint: Any) -> None:
    q = dict(zip(joint.coordinates, np.random.default_rng(0).normal(size=7), strict=False))
    if isinstance(joint, Spherical):
        size = math.sqrt(sum(value**2 for value in q.values()))
        q = {name: value / size for name, value in q.items()}
    other = turned(joint)
    assert (other.parent, other.child, other.at, other.on) == ("b", "a", joint.on, joint.at)
    home = turned_home(joint, q)
    back = {name: float(parse(value, float)) for name, value in home.items()}
    assert np.abs(pose(joint, q) @ pose(other, back) - np.eye(4)).max() < 1e-15 * 4
    if not isinstance(joint, Planar | Spherical):
        assert back == q


def test_a_free_joint_is_not_turned() -> None:
    with pytest.raises(MechanismError, match="exchange its parent 'a' and its child 'b'"):
        turned(Free("j", "a", "b", ("x", "y", "z", "p", "q", "r")))


def matrix(rotations: tuple[Rotation, ...]) -> np.ndarray:
    result = np.eye(3)
    for turn in rotations:
        angle = math.radians(turn.degrees) if turn.radians is None else float(turn.radians)
        result = result @ np.array(elementary_rotation(turn.axis, math.sin(angle), math.cos(angle)), float)
    return result


VECTORS = [(0, 0, -2), (1, 1, 0), (0, -1, 1), (1, 0, "sqrt(3)"), (1, 2, 3), (-1, 0.2, -5), (0.0, 1e-9, 1), (0, 0, 7)]


@pytest.mark.parametrize("vector", VECTORS)
def test_an_axis_along_any_vector(vector: Any) -> None:
    axis, rotations = directed(vector, "joint")
    wanted = np.array([math.sqrt(3) if part == "sqrt(3)" else part for part in vector], float)
    found = matrix(rotations) @ axis_vector(axis)
    assert np.abs(found - wanted / np.linalg.norm(wanted)).max() < 1e-15 * 2


def test_multiples_of_15_degrees_are_exact() -> None:
    assert directed((1, 1, 0), "j") == ("x", (Rotation("z", degrees=45),))
    assert directed((1, 0, "sqrt(3)"), "j") == ("z", (Rotation("y", degrees=30),))
    assert directed((0, 0, -3), "j") == ("-z", ())


def test_two_axes_at_right_angles() -> None:
    first, second, rotations = directed_pair((1, 2, 2), (2, 1, -2), "joint")
    found = matrix(rotations) @ np.column_stack([axis_vector(first), axis_vector(second)])
    assert np.abs(found - np.array([[1, 2], [2, 1], [2, -2]]) / 3).max() < 1e-15 * 2
    with pytest.raises(MechanismError, match="right angles"):
        directed_pair("x", (1, 1, 0), "joint")


def test_rotation_matrices_of_every_pose_are_found_again() -> None:
    generator = np.random.default_rng(1)
    poses = [np.linalg.qr(generator.normal(size=(3, 3)))[0] for _ in range(20)]
    poses = [given * np.linalg.det(given).round() for given in poses]
    poses += [matrix((Rotation("y", degrees=sign * 90), Rotation("x", radians=0.3))) for sign in (1, -1)]
    for given in poses:
        assert np.abs(matrix(rotations_of(given.tolist())) - given).max() < 1e-14


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        ((0, 0, 0), "points nowhere"),
        ("w", "axis 'w'"),
        ((1, 2), "three components"),
        (("r", 0, 0), "is given by numbers"),
    ],
)
def test_what_is_no_axis_is_refused(axis: Any, message: str) -> None:
    builder = MechanismBuilder("m")
    builder.body("a", 1, inertia=(1, 1, 1))
    with pytest.raises(ValueError, match=message):
        builder.revolute("j", "ground", "a", axis=axis)


def test_an_oblique_axis_turns_both_frames() -> None:
    builder = MechanismBuilder("m")
    builder.body("a", 1, inertia=(1, 1, 1))
    builder.revolute("j", "ground", "a", at=(1, 2, 3), on=Placement((0, 1, 0), (Rotation("x", 30),)), axis=(0, 1, 1))
    (joint,) = builder.build().joints
    assert joint.at == Placement((1, 2, 3), (Rotation("x", degrees=45),))
    assert joint.on == Placement((0, 1, 0), (Rotation("x", 30), Rotation("x", degrees=45)))
    assert joint.axis == "y"
