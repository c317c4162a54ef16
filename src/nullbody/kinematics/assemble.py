"""assemble: close the loops for given coordinates (forward and inverse kinematics by continuation and Newton)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real

import numpy as np

from nullbody.errors import AssemblyError, InputError, UnknownName
from nullbody.kinematics.newton import Closed, close_loops
from nullbody.model import Model, State, checked_model, vector
from nullbody.model.check import check_redundant
from nullbody.typing import FloatArray, IndexArray

__all__ = ["assemble", "known_coordinates", "start_coordinates"]

_SMALLEST_STEP = 1e-4  # of the way from the guess to the target
_LARGEST_CORRECTION = 0.15  # [m, rad] by which Newton may correct a predicted point on the same branch
_PERTURBED_STARTS = 24
_FAR = 1e6  # instead of a residual that has no value [m]
_END_OF_BRANCH = 1e8  # condition number of the free columns


def assemble(
    model: Model,
    known: Mapping[str, float],
    v: object = None,
    guess: State | Mapping[str, float] | None = None,
    *,
    same_branch: bool = False,
    t: float = 0.0,
) -> State:
    """The state in which some coordinates have given values and all loops are closed, |Phi| <= 1e-14 m.

    The branch (assembly mode) is the one that continues the guess: known coordinates are moved from their
    values there to the given ones, with tangent steps and Newton corrections. Where that branch ends before
    the target, the assembly nearest to the guess is taken.

    Args:
        model: the model.
        known: coordinates by name [m, rad], at most as many as there are degrees of freedom. With fewer, the
            others stay near the guess.
        v: independent rates, in order or by name; at rest by default.
        guess: a state or coordinates near the wanted branch; the mechanism's home by default.
        same_branch: raise where the branch of the guess ends before the target.
        t: the time [s], for mechanisms with drivers.

    Raises:
        UnknownName, InputError: unknown names, too many, or values that are no finite numbers.
        AssemblyError: the loops cannot be closed; names the loop, the gap and the reach.
    """
    if isinstance(t, bool) or not isinstance(t, Real) or not np.isfinite(t):
        raise InputError(f"the time t must be a finite number, not {t!r}")
    rate = np.zeros(len(model.independent)) if v is None else vector(v, model.independent, "independent rate")
    fixed, target = known_coordinates(model, known)
    if len(fixed) > model.freedom:
        raise InputError(
            f"{model.mechanism.name!r} has {model.freedom} degrees of freedom: "
            f"give at most as many coordinates, not {len(fixed)}; `model.state` takes all of them"
        )
    start = start_coordinates(model, guess)
    free = np.setdiff1d(np.arange(len(model.coordinates)), fixed)
    path = _Path(model, fixed, free, start[fixed], target, t)
    closed, reach = path.followed(start)
    if not closed.converged:
        closed = path.searched(start, closed)
        if closed.converged and same_branch:
            raise _branch_ends(known, reach, path)
    if not closed.converged:
        raise _unreachable(model, known, closed, reach, path)
    check_redundant(model, closed.q, t)
    return model.trusted_state(closed.q, rate, t)


def known_coordinates(model: Model, known: Mapping[str, float]) -> tuple[IndexArray, FloatArray]:
    """Indices and values of coordinates given by name.

    Raises:
        UnknownName, InputError: unknown names, or values that are no finite numbers.
    """
    checked_model(model)
    if not isinstance(known, Mapping):
        raise InputError(f"give coordinates by name, such as {{{model.coordinates[0]!r}: 0.6}}, not {known!r}")
    for name in known:
        if name not in model.coordinates:
            raise UnknownName("coordinate", name, model.coordinates)
    names = tuple(known)
    return np.array([model.coordinates.index(name) for name in names], dtype=np.intp), vector(
        known, names, "coordinate"
    )


def start_coordinates(model: Model, guess: State | Mapping[str, float] | None) -> FloatArray:
    """All coordinates of a guess; those that it does not name come from the mechanism's home."""
    if isinstance(guess, State):
        if guess.coordinates != model.coordinates:
            raise InputError("the guess is a state of another mechanism")
        return guess.q.copy()
    home = model.mechanism.home_values(model.parameters)
    if guess is not None:
        indices, values = known_coordinates(model, guess)
        home.update({model.coordinates[i]: float(value) for i, value in zip(indices, values, strict=True)})
    return np.array([home[name] for name in model.coordinates])


@dataclass(frozen=True)
class _Path:
    """The way of the known coordinates from the guess to the target."""

    model: Model
    fixed: IndexArray
    free: IndexArray
    begin: FloatArray
    target: FloatArray
    t: float

    def at(self, part: float) -> str:
        """The known coordinates after some part of the way, as a text."""
        values = self.begin + part * (self.target - self.begin)
        return ", ".join(f"{self.model.coordinates[i]} = {x:.4g}" for i, x in zip(self.fixed, values, strict=True))

    def followed(self, start: FloatArray) -> tuple[Closed, float]:
        """Continue from the guess; the result at the target, or where it ended, and the part of the way covered."""
        here = self._closed(start)
        if not here.converged:
            return here, 0.0
        done, step = 0.0, 1.0
        while done < 1.0:
            step = min(step, 1.0 - done)
            trial = self._trial(here.q, done + step)
            if trial is None:
                step *= 0.5
                if step < _SMALLEST_STEP:
                    return Closed(here.q, np.inf, 0, 0.0, converged=False), done
                continue
            here, done, step = trial, done + step if done + step < 1.0 - 1e-12 else 1.0, 2.0 * step
        return here, done

    def _trial(self, q: FloatArray, where: float) -> Closed | None:
        """Tangent prediction and Newton correction to a point of the way; None if they do not belong together."""
        predicted = q.copy()
        predicted[self.fixed] = self.begin + where * (self.target - self.begin) if where < 1.0 else self.target
        A, side = self.model.jacobian(q, self.t), self._side(q)
        moved = predicted[self.fixed] - q[self.fixed]
        predicted[self.free] += np.linalg.lstsq(A[:, self.free], -A[:, self.fixed] @ moved, rcond=1e-6)[0]
        closed = self._closed(predicted)
        near = float(np.abs(closed.q - predicted).max(initial=0.0)) <= _LARGEST_CORRECTION
        return closed if closed.converged and near and side * self._side(closed.q) >= 0 else None

    def _closed(self, q: FloatArray) -> Closed:
        """Loops closed from a start; not where one is closed the wrong way round."""
        closed = close_loops(self.model, q, self.free, self.t)
        if not closed.converged:
            return closed
        cosines = self.model.evaluate("facing", closed.q, t=self.t)[0]
        return closed if (cosines > 0).all() else closed._replace(converged=False)

    def _side(self, q: FloatArray) -> float:
        """Sign of |A_free|, which no branch changes between its ends; 0 where it is not square, or at an end."""
        A = self.model.jacobian(q, self.t)[:, self.free]
        if A.shape[0] != A.shape[1] or not A.size or np.linalg.cond(A) > _END_OF_BRANCH:
            return 0.0
        return float(np.linalg.slogdet(A)[0])

    def searched(self, start: FloatArray, last: Closed) -> Closed:
        """Newton at the target from the guess and from starts around it; the solution nearest to the guess."""
        draw = np.random.default_rng(0)
        found: list[Closed] = []
        closest = last
        for k in range(_PERTURBED_STARTS + 2):
            q = last.q.copy() if k == 1 else start.copy()
            if k > 1:
                q[self.free] += draw.normal(scale=0.1 + 0.3 * (k % 3), size=len(self.free))
            q[self.fixed] = self.target
            closed = self._closed(q)
            if closed.converged:
                found.append(closed)
            elif closed.residual < closest.residual:
                closest = closed
            if k <= 1 and found:
                break
        return min(found, key=lambda c: float(np.linalg.norm(c.q - start)), default=self._nearest_miss(closest))

    def _nearest_miss(self, closed: Closed) -> Closed:
        """Least squares at the target: the smallest gaps that remain."""
        from scipy.optimize import least_squares

        q = closed.q.copy()
        q[self.fixed] = self.target

        def gaps(x: FloatArray) -> FloatArray:
            q[self.free] = x
            return np.nan_to_num(self.model.residual(q, self.t), nan=_FAR, posinf=_FAR, neginf=-_FAR)

        def slopes(x: FloatArray) -> FloatArray:
            q[self.free] = x
            return np.nan_to_num(self.model.jacobian(q, self.t)[:, self.free])

        fit = least_squares(gaps, q[self.free].copy(), jac=slopes, method="trf", x_scale=1.0)
        q[self.free] = fit.x
        polished = self._closed(q)  # near rows that repeat others on the manifold Newton alone may not get here
        if polished.converged:
            return polished
        residual = float(np.abs(fit.fun).max(initial=0.0))
        return Closed(q, residual, closed.steps, closed.moved, converged=False)


def _branch_ends(known: Mapping[str, float], reach: float, path: _Path) -> AssemblyError:
    wanted = ", ".join(f"{name} = {float(value):.4g}" for name, value in known.items())
    return AssemblyError(
        f"the branch of the guess ends before {wanted}: these coordinates become singular after {reach:.0%} of the "
        f"way, at {path.at(reach)}. nullbody.branches lists other assemblies; a detour may lead around",
        gap=0.0,
        reach=reach,
    )


def _unreachable(model: Model, known: Mapping[str, float], closed: Closed, reach: float, path: _Path) -> AssemblyError:
    Phi = model.residual(closed.q, path.t)
    gaps: dict[str, float] = {}
    for label, component in zip(model.closure_labels, Phi, strict=True):
        loop = label.rpartition(" ")[0]
        gaps[loop] = float(np.hypot(gaps.get(loop, 0.0), component))
    worst = max(gaps, key=lambda loop: gaps[loop])
    wanted = ", ".join(f"{name} = {float(value):.4g}" for name, value in known.items())
    way = f"Coming from the guess, they close over {reach:.0%} of the way, up to {path.at(reach)}. "
    return AssemblyError(
        f"the loops cannot be closed{f' for {wanted}' if known else ''}: loop {worst!r} stays open by "
        f"{gaps[worst]:.3g} m at best. {way if known else ''}"
        f"Choose {'values nearer to that, ' if known else ''}other lengths, or a guess on another branch",
        loop=worst,
        gap=gaps[worst],
        reach=reach,
    )
