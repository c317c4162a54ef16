"""Batch: a model on arrays with a row for each state, by native code over blocks of 8 states and all cores."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from nullbody.errors import InputError, SingularityError
from nullbody.model.actuation import required
from nullbody.model.batch_assembly import Assemblies, closed_by_newton
from nullbody.model.batch_bodies import checked_parameters
from nullbody.model.batch_check import dtype_of, limits_of, refuse, singular_dynamics, singular_kinematics
from nullbody.model.batch_inputs import moments, room, rows
from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from typing import Unpack

    from nullbody.model.model import Model

__all__ = ["Batch", "BatchCall", "BatchOptions", "Energies", "NullSpaces"]

_DOUBT = 1e-6  # smallest singular value of Br against the largest or 1, below which a state is looked at by itself
_COORDINATES = "the independent coordinates are singular in"
_MASSES = "the independent coordinates or the reduced mass matrix are singular in"


class BatchOptions(TypedDict, total=False):
    """Options of all methods of `Batch`.

    Attributes:
        t: the time [s] of mechanisms with drivers: a number, or one for each state (states,); 0 by default.
        parameters: values in the order of `model.parameters`, (np,) or (states, np), or by name, a number or (states,)
            each, where other defaults that are formulas follow; those of the model by default.
        dtype: float64, or float32: every operation is rounded to 6e-8.
        threads: how many work at the same time; all cores that this process may use by default.
        singular: "raise" a SingularityError, or "nan": all results of singular states are NaN, and only theirs.
    """

    t: ArrayLike
    parameters: ArrayLike | Mapping[str, ArrayLike] | None
    dtype: DTypeLike
    threads: int | None
    singular: str


class NullSpaces(NamedTuple):
    """N (states, nq, nv), gamma (states, nq) and delta = |B| (states,)."""

    N: NDArray[Any]
    gamma: NDArray[Any]
    delta: NDArray[Any]


class Energies(NamedTuple):
    """Kinetic and potential energy of every state [J]."""

    kinetic: NDArray[Any]
    potential: NDArray[Any]


class BatchCall:
    """One call with its options: numbers of a type, states counted, kernels by routine and outputs."""

    def __init__(self, model: Model, options: BatchOptions, states: int, dtype: np.dtype[Any]) -> None:
        if unknown := sorted(set(options) - set(BatchOptions.__annotations__)):
            raise InputError(f"there is no option {unknown[0]!r}; known: {', '.join(BatchOptions.__annotations__)}")
        self.model, self.dtype, self.states = model, dtype, states
        self.threads, self.singular = options.get("threads"), options.get("singular", "raise")
        self.p = checked_parameters(model, options.get("parameters"), states).astype(dtype, copy=False)
        self.t = moments(options.get("t", 0.0), states, dtype)

    def of(self, model: Model, lanes: IndexArray) -> BatchCall:
        """The same for some states, with the kernels of another chart."""
        other = copy(self)
        other.model, other.states = model, len(lanes)
        other.p, other.t = (values[lanes] if values.ndim == 2 else values for values in (self.p, self.t))
        return other

    def __call__(
        self,
        routine: str,
        outputs: tuple[str, ...],
        *groups: NDArray[Any],
        lanes: IndexArray | None = None,
        out: NDArray[Any] | None = None,
    ) -> tuple[NDArray[Any], ...]:
        """Some outputs of a routine; `lanes` says which states the rows are, `out` takes the first output."""
        extra = [*([self.t] if self.model.rheonomic else []), self.p]
        if lanes is not None:
            extra = [values[lanes] if values.ndim == 2 else values for values in extra]
        blocks = self.model.library.kernels[routine].blocks(self.dtype, outputs)
        states = len(groups[0])
        room = None
        if out is not None:
            shapes = [shape for _, shape in blocks.program.outputs]
            room = [out, *(np.empty((states, *shape), self.dtype) for shape in shapes[1:])]
        return blocks(*groups, *extra, out=room, threads=self.threads)


def _dynamics(
    call: BatchCall, routine: str, outputs: tuple[str, ...], groups: tuple[NDArray[Any], ...], out: Any = None
) -> tuple[list[NDArray[Any]], NDArray[np.bool_]]:
    """Outputs of a routine of the dynamics and |B|, and where they have lost their digits.

    The first output must be finite. Where the basis of the kernels is singular the plain kernels answer.
    """
    limits, model = limits_of(call.dtype), call.model
    *results, spread, doubt, loss = call(routine, (*outputs, "delta", "spread", "doubt", "loss"), *groups, out=out)
    wrong = singular_dynamics(limits, results[0], spread, doubt, loss)
    if wrong.any() and model.plain is not model:
        lanes: IndexArray = np.flatnonzero(wrong)
        some = tuple(group[lanes] if group.ndim == 2 else group for group in groups)
        found, still = _dynamics(call.of(model.plain, lanes), routine, outputs, some)
        for result, better in zip(results, found, strict=True):
            result[lanes] = better
        wrong[lanes] = still
    return results, wrong


class Batch:
    """A model on arrays of states, `model.batch`: q is (states, nq), v (states, nv).

    Results are those of the model for one state to 1e-13 of their size, whatever the number of states and threads. The
    loops are not looked at: `residual` says how open they are, `assemble` closes them. States where the independent
    coordinates or the reduced mass matrix are singular are never passed over: a SingularityError says how many there
    are and which is the first; with `singular="nan"` exactly their results are NaN, so that `np.isnan` finds them.

    Every method takes the keywords of `BatchOptions`: t, parameters, dtype, threads, singular.

    Args:
        model: the model.
    """

    def __init__(self, model: Model) -> None:
        self.model = model

    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike | None = None,
        *,
        out: NDArray[Any] | None = None,
        **options: Unpack[BatchOptions],
    ) -> NDArray[Any]:
        """q'' = N v' + gamma with Mr v' + hr = Br u: accelerations of all coordinates [39-46].

        Args:
            q: coordinates, (states, nq) [m, rad].
            v: rates of the independent coordinates, (states, nv) [m/s, rad/s].
            u: inputs, (states, nu), or (nu,) for all; none by default [N, N m].
            out: a contiguous array (states, nq) for the result.
            options: see `BatchOptions`.

        Returns:
            (states, nq) [m/s^2, rad/s^2].

        Raises:
            InputError: wrong shapes or types, or values that are not finite: names the first state.
            SingularityError: states are singular; says how many and the first.
        """
        q, v, call = self._states(q, v, options)
        inputs = np.zeros(len(self.model.inputs), call.dtype) if u is None else self._inputs(u, call)
        (q_ddot, delta), wrong = _dynamics(call, "forward_dynamics", ("q_ddot",), (q, v, inputs), out)
        refuse(wrong, call.singular, _MASSES, delta, q_ddot)
        return q_ddot

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        v_dot: ArrayLike,
        *,
        out: NDArray[Any] | None = None,
        **options: Unpack[BatchOptions],
    ) -> NDArray[Any]:
        """u with Br u = Mr v' + hr: the inputs for given independent accelerations [42].

        With more inputs than degrees of freedom, the inputs of least norm.

        Args:
            q: coordinates, (states, nq) [m, rad].
            v: rates of the independent coordinates, (states, nv) [m/s, rad/s].
            v_dot: their accelerations, (states, nv), or (nv,) for all [m/s^2, rad/s^2].
            out: a contiguous array (states, nu) for the result.
            options: see `BatchOptions`.

        Returns:
            (states, nu) [N, N m].

        Raises:
            InputError: wrong shapes or types, values that are not finite, or fewer inputs than degrees of freedom.
            SingularityError: states are singular, or the inputs cannot drive the mechanism there.
        """
        model = self.model
        nv, nu = len(model.independent), len(model.inputs)
        if nu < nv:
            raise InputError(
                f"{model.mechanism.name!r} has {nu} inputs for {nv} degrees of freedom: not every motion can be "
                "driven. `generalized_forces` gives N^T Q"
            )
        q, v, call = self._states(q, v, options)
        names = model.independent
        wanted = self._shared(rows(v_dot, names, "independent acceleration", call.dtype, one=True), call)
        groups = q, v, wanted
        if set(model.actuated_columns) <= set(model.independent_columns) and nu == nv:  # Br only sorts the inputs
            (u, delta), wrong = _dynamics(call, "inverse_dynamics", ("u",), groups, out)
        else:
            place = None if out is None else room(out, (len(q), nu), call.dtype, groups)
            (Qr, u, Br, delta), wrong = _dynamics(call, "inverse_dynamics", ("Qr", "u", "Br"), groups)
            u = self._required(call, q, v, (Qr, u, Br.reshape(len(q), nv, nu)), wrong)
            if place is not None:
                place[...] = u
                u = place
        refuse(wrong, call.singular, "the mechanism is singular, or its inputs cannot drive it, in", delta, u)
        return u

    def generalized_forces(
        self, q: ArrayLike, v: ArrayLike, v_dot: ArrayLike, **options: Unpack[BatchOptions]
    ) -> NDArray[Any]:
        """N^T Q = Mr v' + hr, (states, nv): forces along the independent coordinates for given accelerations [42].

        Raises:
            InputError, SingularityError: as `inverse_dynamics`.
        """
        q, v, call = self._states(q, v, options)
        wanted = rows(v_dot, self.model.independent, "independent acceleration", call.dtype, one=True)
        (Qr, delta), wrong = _dynamics(call, "inverse_dynamics", ("Qr",), (q, v, self._shared(wanted, call)))
        refuse(wrong, call.singular, _MASSES, delta, Qr)
        return Qr

    def null_space(self, q: ArrayLike, v: ArrayLike | None = None, **options: Unpack[BatchOptions]) -> NullSpaces:
        """N, gamma and delta of every state: q' = N v + beta, q'' = N v' + gamma.

        Args:
            q: coordinates, (states, nq) [m, rad].
            v: rates of the independent coordinates, (states, nv), on which gamma depends; at rest by default.
            options: see `BatchOptions`.

        Raises:
            InputError: wrong shapes or types, or values that are not finite.
            SingularityError: |B| vanishes for these independent coordinates in some states.
        """
        q, v, call = self._states(q, v, options)
        N, gamma, delta, *measures = call("kinematics", ("N", "gamma", "delta", "spread", "doubt"), q, v)
        N = N.reshape(len(q), len(self.model.coordinates), len(self.model.independent))
        wrong = singular_kinematics(limits_of(call.dtype), *measures)
        refuse(wrong, call.singular, _COORDINATES, delta, N, gamma)
        return NullSpaces(N, gamma, delta)

    def velocity(self, q: ArrayLike, v: ArrayLike, **options: Unpack[BatchOptions]) -> NDArray[Any]:
        """q' = N v + beta, all rates (states, nq) [m/s, rad/s].

        Raises:
            InputError, SingularityError: as `null_space`.
        """
        q, v, call = self._states(q, v, options)
        q_dot, delta, *measures = call("kinematics", ("q_dot", "delta", "spread", "doubt"), q, v)
        refuse(singular_kinematics(limits_of(call.dtype), *measures), call.singular, _COORDINATES, delta, q_dot)
        return q_dot

    def energy(self, q: ArrayLike, v: ArrayLike, **options: Unpack[BatchOptions]) -> Energies:
        """Kinetic and potential energy of every state, (states,) each [J].

        Raises:
            InputError, SingularityError: as `null_space`.
        """
        q, v, call = self._states(q, v, options)
        q_dot, delta, *measures = call("kinematics", ("q_dot", "delta", "spread", "doubt"), q, v)
        T, U = call("energy", ("T", "U"), q, q_dot)
        refuse(singular_kinematics(limits_of(call.dtype), *measures), call.singular, _COORDINATES, delta, T, U)
        return Energies(T, U)

    def residual(self, q: ArrayLike, **options: Unpack[BatchOptions]) -> NDArray[Any]:
        """Phi(q, t) of every state, (states, number of closures) [m].

        Raises:
            InputError: wrong shapes or types, or values that are not finite.
        """
        dtype = dtype_of(options.get("dtype", np.float64))
        q = rows(q, self.model.coordinates, "coordinate", dtype)
        return BatchCall(self.model, options, len(q), dtype)("closure", ("Phi",), q)[0]

    def assemble(self, q: ArrayLike, **options: Unpack[BatchOptions]) -> Assemblies:
        """Close the loops of every state by Newton, the independent coordinates held: |Phi| <= 1e-14 m.

        Newton's steps are cut at 0.5 [m, rad]. `nullbody.assemble` follows a branch from afar; this takes the assembly
        that Newton finds from each guess.

        Args:
            q: a guess of all coordinates of every state, (states, nq), the independent ones as wanted [m, rad].
            options: see `BatchOptions`; dtype is float64, and singular states are an outcome here.

        Returns:
            The closed coordinates, NaN where the loops do not close, and how each state ended.

        Raises:
            InputError: wrong shapes or types, or values that are not finite: names the first state.
        """
        if {"dtype", "singular"} & set(options):
            raise InputError("assemble works in float64 and returns an outcome for every state: no dtype, no singular")
        dtype = np.dtype(np.float64)
        start = rows(q, self.model.coordinates, "coordinate", dtype).copy()
        call = BatchCall(self.model, options, len(start), dtype)
        return closed_by_newton(
            lambda routine, outputs, q, lanes: call(routine, outputs, np.ascontiguousarray(q), lanes=lanes), start
        )

    # -- inputs ---------------------------------------------------------------------------------------------

    def _states(
        self, q: ArrayLike, v: ArrayLike | None, options: BatchOptions
    ) -> tuple[NDArray[Any], NDArray[Any], BatchCall]:
        """q and v, checked, and the call."""
        model, dtype = self.model, dtype_of(options.get("dtype", np.float64))
        position = rows(q, model.coordinates, "coordinate", dtype)
        if v is None:
            return position, np.zeros(len(model.independent), dtype), BatchCall(model, options, len(position), dtype)
        rate = rows(v, model.independent, "independent rate", dtype)
        if len(rate) != len(position):
            raise InputError(f"there are coordinates for {len(position)} states and rates for {len(rate)}")
        return position, rate, BatchCall(model, options, len(position), dtype)

    def _inputs(self, u: ArrayLike, call: BatchCall) -> NDArray[Any]:
        return self._shared(rows(u, self.model.inputs, "input", call.dtype, one=True), call)

    def _shared(self, values: NDArray[Any], call: BatchCall) -> NDArray[Any]:
        if values.ndim == 2 and len(values) != call.states:
            raise InputError(f"there are {call.states} states, but values for {len(values)}")
        return values

    def _required(
        self,
        call: BatchCall,
        q: NDArray[Any],
        v: NDArray[Any],
        forces: tuple[NDArray[Any], ...],
        wrong: NDArray[np.bool_],
    ) -> NDArray[Any]:
        """u of every state from (Qr, u, Br); marks states where the inputs cannot drive the mechanism."""
        model = self.model
        Qr, u, Br = forces
        given = np.where(wrong[:, None, None], np.eye(*Br.shape[1:], dtype=Br.dtype), Br)
        sizes = np.linalg.svd(given, compute_uv=False)
        doubtful = ~(sizes.min(axis=1, initial=np.inf) > _DOUBT * np.maximum(sizes.max(axis=1, initial=0.0), 1.0))
        if Br.shape[1] != Br.shape[2]:
            u = np.einsum("ijk,ik->ij", np.linalg.pinv(given), Qr)
        for k in np.flatnonzero(~wrong & (doubtful | ~np.isfinite(u).all(axis=1))):
            t = float(call.t[k, 0] if call.t.ndim == 2 else call.t[0])
            state = model.trusted_state(q[k].astype(np.float64), v[k].astype(np.float64), t)
            one: list[FloatArray] = [np.asarray(array[k], dtype=np.float64) for array in forces]
            try:
                u[k] = required(model, state, *one)
            except SingularityError:
                wrong[k] = True
        return u
