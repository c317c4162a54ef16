"""States of the 3-PRS for the benchmark: at random, and at a distance from |B| = 0."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["INPUTS", "random_states", "singular_height", "state", "state_near_singular"]

#: What the entries of A depend on: the coordinates q and the lengths a, b, l.
INPUTS = ("x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "s1", "s2", "s3", "a", "b", "l")

_LENGTHS = {"a": 0.8, "b": 0.2, "l": 0.5}  # [m], Table 2 of the paper
_TILT = (0.2, -0.1)  # psi, phi [rad] of the states near |B| = 0
_BRACKET = (0.13, 0.16)  # heights [m] between which |B| changes its sign there
_LARGEST = 30.0  # entry of N in a regular state; farther from |B| = 0 all methods keep 14 digits


def state(y: float, psi: float, phi: float, branch: int = 0) -> FloatArray:
    """The values of `INPUTS` for a platform at height y [m] that rolls by psi and turns by phi [rad].

    Args:
        y, psi, phi: the pose; the rest of it follows from the legs' planes.
        branch: which of the 8 choices of legs that lean inwards or outwards.
    """
    from nullbody.catalog.three_prs_kinematics import CLOSED_FORM

    found = CLOSED_FORM.inverse(_LENGTHS, {"y": y, "psi": psi, "phi": phi}) or []
    values = {**_LENGTHS, **found[branch]}
    return np.array([values[name] for name in INPUTS])


def random_states(random: np.random.Generator, count: int, jacobian: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Values of `INPUTS` in random regular states of the upright robot, count x 15.

    Args:
        random: generator.
        count: number of states.
        jacobian: values -> A, for many states; states where an entry of N exceeds 30 are drawn again.
    """
    kept = np.empty((0, len(INPUTS)))
    while len(kept) < count:
        poses = random.uniform((0.3, -0.3, -0.3), (0.42, 0.3, 0.3), (count, 3))
        drawn = np.array([state(y, psi, phi, int(random.integers(8))) for y, psi, phi in poses])
        A = jacobian(drawn)
        N = np.linalg.solve(A[:, :, :9], A[:, :, 9:])
        kept = np.concatenate([kept, drawn[np.abs(N).max(axis=(1, 2)) < _LARGEST]])
    return kept[:count]


def state_near_singular(distance: float, height: float) -> FloatArray:
    """The values of `INPUTS` where the platform is a distance [m] above the height of |B| = 0, its tilt fixed."""
    return state(height + distance, *_TILT)


def singular_height(jacobian: Callable[[FloatArray], FloatArray]) -> float:
    """The height y [m] at which |B| = 0 for the tilt of `state_near_singular`, to the last bit, by bisection.

    A keeps its rank there: it is the slides that are a bad choice of independent coordinates (theory 1).
    """

    def delta(y: float) -> float:
        return float(np.linalg.det(jacobian(state(y, *_TILT)[None])[0, :, :9]))

    low, high = _BRACKET
    falling = delta(low) > delta(high)
    for _ in range(60):
        middle = (low + high) / 2
        if (delta(middle) > 0) == falling:
            low = middle
        else:
            high = middle
    return low
