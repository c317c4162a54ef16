"""A model in JAX: functions that call the native kernels and know their exact Jacobians.

    f(x + dx) = f(x) + J(x) dx,      J from `Derivatives`, one call back for f and J together

A call back is compiled in no time; the same operations traced one by one take XLA 1.5 s for the forward dynamics of the
3-PRS and 15 to 27 s for its derivatives, and then run no faster for many states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nullbody.errors import InputError
from nullbody.kernels import Kernel
from nullbody.model.jacobian_programs import Kind
from nullbody.tolerances import REGULAR_DOUBT, REGULAR_LOSS, REGULAR_SPREAD
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["JaxFunctions", "jax_functions"]

Values = dict[str, FloatArray]


class JaxFunctions(NamedTuple):
    """JAX functions of q (nq), v (nv), a third vector, t and p, in float64, through which `jit`, `vmap`, `grad` go.

    t is 0, p the model's own parameter values by default. Loops are not checked. Where the independent coordinates or
    the reduced mass matrix are singular, results are NaN. Second derivatives are those of `equations.to_casadi()`.

    Attributes:
        rate: (q, v, u, t, p) -> (q', v'), nq + nv; what an integrator of JAX takes.
        forward_dynamics: (q, v, u, t, p) -> q'', nq.
        inverse_dynamics: (q, v, v_dot, t, p) -> u where there is one input for each degree of freedom, else N^T Q.
    """

    rate: Callable[..., Any]
    forward_dynamics: Callable[..., Any]
    inverse_dynamics: Callable[..., Any]


def jax_functions(model: Model) -> JaxFunctions:
    """The functions of a model.

    Raises:
        InputError: JAX is not installed, or computes in single precision.
    """
    try:
        jax: Any = import_module("jax")
    except ImportError:
        raise InputError("JAX is not installed; run: python -m pip install 'nullbody[jax]'") from None
    _check_precision(jax)
    rate, forward, inverse = (_Native(model, kind) for kind in ("rate", "forward_dynamics", "inverse_dynamics"))
    return JaxFunctions(*(_function(jax, native) for native in (rate, forward, inverse)))


def _check_precision(jax: Any) -> None:
    if not jax.config.jax_enable_x64:
        raise InputError(
            "JAX computes in single precision, which is not enough for closed loops: "
            "call jax.config.update('jax_enable_x64', True) before any array is made"
        )


class _Native:
    """The kernels of one function: values alone, and values with Jacobians by its arguments."""

    def __init__(self, model: Model, kind: Kind) -> None:
        self.model, self.kind = model, kind
        nq, nv, nu = len(model.coordinates), len(model.independent), len(model.inputs)
        self.inverse = kind == "inverse_dynamics"
        third = ("v_dot", nv) if self.inverse else ("u", nu)
        self.groups = (("q", nq), ("v", nv), third, *((("t", 1),) if model.rheonomic else ()), ("p", len(model.values)))
        self.size = {"rate": nq + nv, "forward_dynamics": nq, "inverse_dynamics": nv}[kind]
        self.force = "u" if nu == nv else "Qr"

    def values(self, *groups: Any) -> FloatArray:
        """y for one state or many."""
        found = _evaluated(
            self.model.library.kernels["inverse_dynamics" if self.inverse else "forward_dynamics"], groups
        )
        y = found[self.force if self.inverse else "q_ddot"]
        if self.kind == "rate":
            y = np.concatenate([found["q_dot"], y[..., self.model.independent_columns]], axis=-1)
        return _refused(found, y)[0]

    def jacobians(self, parameters: bool, *groups: Any) -> tuple[FloatArray, ...]:
        """y, and dy by each group of arguments, p only where it is wanted."""
        found = _evaluated(self.model.derivatives.kernel(self.kind, parameters=parameters), groups)
        names = [name for name, _ in self.groups if parameters or name != "p"]
        if self.kind == "rate":
            nq = len(self.model.coordinates)
            by_state = {"q": found["A"][..., :nq], "v": found["A"][..., nq:], "u": found["B"]}
            return _refused(found, found["rate"], *(by_state.get(name, found.get(f"x_{name}")) for name in names))
        if self.inverse:
            return _refused(found, found[self.force], *(found[f"u_{name}"] for name in names))
        return _refused(found, found["q_ddot"], *(found[f"q_ddot_{name}"] for name in names))


def _function(jax: Any, native: _Native) -> Callable[..., Any]:
    """One JAX function with its derivative."""
    jnp = jax.numpy

    def shaped(*shape: int) -> Any:
        return jax.ShapeDtypeStruct(shape, np.float64)

    def evaluate(*groups: Any) -> Any:
        return jax.pure_callback(native.values, shaped(native.size), *groups, vmap_method="expand_dims")

    def linearise(parameters: bool, *groups: Any) -> Any:
        sizes = [size for name, size in native.groups if parameters or name != "p"]
        shapes = (shaped(native.size), *(shaped(native.size, size) for size in sizes))
        return jax.pure_callback(partial(native.jacobians, parameters), shapes, *groups, vmap_method="expand_dims")

    primal, linearised = jax.custom_jvp(evaluate), jax.custom_jvp(linearise, nondiff_argnums=(0,))

    def tangent(groups: Sequence[Any], changes: Sequence[Any]) -> Any:
        moved = [not isinstance(change, jax.custom_derivatives.SymbolicZero) for change in changes]
        y, *slopes = linearised(moved[-1], *groups)
        terms = [slope @ change for slope, change, moves in zip(slopes, changes, moved, strict=False) if moves]
        return y, sum(terms, jnp.zeros_like(y))

    def second(*_: Any) -> Any:
        raise InputError(
            "the JAX functions of a model have no second derivatives; equations.to_casadi() gives functions that have"
        )

    primal.defjvp(tangent, symbolic_zeros=True)
    linearised.defjvp(second)

    def function(q: Any, v: Any, third: Any = None, t: Any = 0.0, p: Any = None) -> Any:
        _check_precision(jax)
        sizes = {"t": 1, **dict(native.groups)}
        name = "v_dot" if native.inverse else "u"
        third = np.zeros(sizes.get("u", 0)) if third is None else third
        given = {"q": q, "v": v, name: third, "t": t, "p": native.model.values if p is None else p}
        groups = {key: _argument(jnp, native.kind, key, value, sizes[key]) for key, value in given.items()}
        return primal(*(groups[key] for key, _ in native.groups))

    function.__name__ = native.kind
    return function


def _argument(jnp: Any, kind: Kind, name: str, value: Any, size: int) -> Any:
    """An argument as an array (size,) in float64; t may be a number."""
    try:
        array = jnp.asarray(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{kind}: {name} is no array of numbers: {error!s:.200}") from None
    if not (jnp.issubdtype(array.dtype, jnp.integer) or jnp.issubdtype(array.dtype, jnp.floating)):
        raise InputError(f"{kind}: {name} must hold real numbers, not {array.dtype}")
    if name == "t" and array.shape == ():
        array = array.reshape(1)
    if array.shape != (size,):
        raise InputError(f"{kind}: {name} must have the shape ({size},), not {array.shape}; jax.vmap takes many states")
    return array.astype(np.float64)


def _evaluated(kernel: Kernel, groups: Sequence[Any]) -> Values:
    """The outputs of a kernel by name, with the leading axes (a batch) that the groups have."""
    arrays = [np.asarray(group, dtype=np.float64) for group in groups]
    batch = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    outputs = kernel.program.outputs
    if prod(batch) == 1:
        results = kernel(*(array.reshape(-1) for array in arrays))
    else:
        results = kernel.batch(*(_rows(array, batch) for array in arrays))
    return {name: result.reshape((*batch, *shape)) for (name, shape), result in zip(outputs, results, strict=True)}


def _rows(array: FloatArray, batch: tuple[int, ...]) -> FloatArray:
    """(states, size), or (size,) where all states share it."""
    size = array.shape[-1]
    if prod(array.shape[:-1]) == 1:
        return array.reshape(size)
    return np.broadcast_to(array, (*batch, size)).reshape(prod(batch), size)


def _refused(found: Values, *arrays: Any) -> tuple[FloatArray, ...]:
    """The arrays, y first, or NaN where the model would refuse y."""
    regular = (found["spread"] < REGULAR_SPREAD) & (found["doubt"] < REGULAR_DOUBT)
    good = regular & (abs(found["loss"]) < REGULAR_LOSS) & np.isfinite(arrays[0]).all(axis=-1)
    return tuple(np.where(good.reshape(good.shape + (1,) * (a.ndim - good.ndim)), a, np.nan) for a in arrays)
