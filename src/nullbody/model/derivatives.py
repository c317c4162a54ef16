"""Exact derivatives of a model: of its rates, forward and inverse dynamics, and of a Runge-Kutta step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nullbody.equations.scalar import ParameterScalars
from nullbody.errors import InputError, UnknownName
from nullbody.expr import Graph, Tape, jacobian
from nullbody.kernels import Kernel
from nullbody.model.actuation import required
from nullbody.model.chart import Key
from nullbody.model.check import check_dynamic
from nullbody.model.jacobian_programs import Kind, jacobian_kernel
from nullbody.model.state import State, vector
from nullbody.model.values import (
    ForwardDerivatives,
    InverseDerivatives,
    LinearModel,
    RateDerivatives,
    StepDerivatives,
)
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["Derivatives"]


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Exact partial derivatives at a state, as native code that is compiled when first asked for: `model.derivatives`.

    All coordinates q are varied freely, the dependent ones too: off the manifold Phi(q) = 0 the equations go on
    smoothly. On it only the directions dq = N dq_f mean motions; `minimal` has those. v, u, t are varied on their own,
    and so are all parameters p, in the order of `model.parameters`: those whose default is an expression do not
    follow. `following` makes them: dy/db = p @ following("b").

    Methods that take `parameters` leave p empty with False: fewer operations. Errors are those of the model's methods.
    """

    model: Model

    def rate(self, state: State, u: object = None, *, parameters: bool = True) -> RateDerivatives:
        """A = df/dx and B = df/du of x' = f(x, u, t, p) with x = (q, v).

        Args:
            state: where and how fast.
            u: inputs, in order or by name; zero by default.
            parameters: whether p is wanted.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        state = self.model.own(state)
        return self._rate(state.q, state.v, self.model.input_vector(u), state.t, parameters)

    def forward_dynamics(self, state: State, u: object = None, *, parameters: bool = True) -> ForwardDerivatives:
        """dq''/d(q, v, u, t, p) of the accelerations q'' that the inputs cause.

        Args:
            state: where and how fast.
            u: inputs, in order or by name; zero by default.
            parameters: whether p is wanted.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        state = self.model.own(state)
        found = self._evaluate("forward_dynamics", state.q, state.v, self.model.input_vector(u), state.t, parameters)
        self._check(found["q_ddot"], found)
        q, v, u_part = (found[f"q_ddot_{x}"] for x in ("q", "v", "u"))
        return ForwardDerivatives(found["q_ddot"], q, v, u_part, *self._rest("q_ddot", found))

    def inverse_dynamics(self, state: State, v_dot: object, *, parameters: bool = True) -> InverseDerivatives:
        """du/d(q, v, v', t, p) of the inputs that given independent accelerations need, or d(N^T Q).

        Args:
            state: where and how fast.
            v_dot: accelerations of the independent coordinates, in order or by name.
            parameters: whether p is wanted.

        Raises:
            SingularityError: |B| vanishes, or the inputs cannot drive the mechanism here.
        """
        model, state = self.model, self.model.own(state)
        wanted = vector(v_dot, model.independent, "independent acceleration")
        found = self._evaluate("inverse_dynamics", state.q, state.v, wanted, state.t, parameters)
        Qr, u = found["Qr"], found["u"]
        self._check(Qr, found)
        if len(model.inputs) == len(Qr):
            u = required(model, state, Qr, u, found["Br"])
        force = u if len(model.inputs) == len(Qr) else Qr
        return InverseDerivatives(force, found["u_q"], found["u_v"], found["u_v_dot"], *self._rest("u", found))

    def minimal(self, state: State, u: object = None) -> LinearModel:
        """The linear model on the manifold, dq = T dq_f with T = N where nothing rolls:

            A = [f_q' T, N_f; f_v' T, dv'/dv],  rows of q' only for q_f;   B = [0; dv'/du]

        where f_q' and f_v' are the rows of df/dq in `rate`. q_f are the independent coordinates; where something rolls
        positions have more degrees of freedom than rates, and the dependent ones that move most are added.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        model = self.model
        state = model.own(state)
        found = self._rate(state.q, state.v, model.input_vector(u), state.t, False)
        nq = len(model.coordinates)
        free = list(model.independent_columns)
        tangent = found.A[:nq, nq:]
        if model.freedom > len(free):
            tangent, free = _tangent(model.jacobian(state.q, state.t), free, model.freedom)
        rows = [*free, *range(nq, len(found.rate))]
        A = np.hstack([found.A[rows, :nq] @ tangent, found.A[rows, nq:]])
        names = [*(model.coordinates[k] for k in free), *(f"{name}'" for name in model.independent)]
        return LinearModel(tuple(names), A, found.B[rows], tangent)

    def step(self, state: State, u: object, h: float, *, parameters: bool = True) -> StepDerivatives:
        """One step of the classical Runge-Kutta method with u held, and its exact derivative by the chain rule:

            k_i = f(x + a_i h k_(i-1), u, t + a_i h),   a = (0, 1/2, 1/2, 1),   x+ = x + h/6 (k_1 + 2 k_2 + 2 k_3 + k_4)
            dk_i = A_i (dx + a_i h dk_(i-1)) + B_i du + p_i dp

        Args:
            state: where and how fast, x = (q, v).
            u: inputs, in order or by name; None is zero.
            h: the step [s]; any finite number.
            parameters: whether p is wanted.

        Raises:
            InputError: h is no finite number, or an input has a wrong name or size.
            SingularityError: |B| vanishes at the state or at a stage of the step.
        """
        (h,) = vector([h], ("h",), "step")
        state, inputs = self.model.own(state), self.model.input_vector(u)
        nq, nu = len(state.q), len(inputs)
        x = np.concatenate([state.q, state.v])
        n = len(x)
        k, dk, rise, slope = np.zeros(n), np.zeros(0), np.zeros(n), np.zeros(0)
        for a, weight in ((0.0, 1 / 6), (0.5, 1 / 3), (0.5, 1 / 3), (1.0, 1 / 6)):
            at = x + a * h * k
            found = self._rate(at[:nq], at[nq:], inputs, state.t + a * h, parameters)
            k, direct = found.rate, np.hstack([found.A, found.B, found.p])
            dk = direct + a * h * (found.A @ dk) if dk.size else direct
            rise, slope = rise + weight * k, slope + weight * dk if slope.size else weight * dk
        after, change = x + h * rise, h * slope
        change[:, :n] += np.eye(n)
        return StepDerivatives(after[:nq], after[nq:], change[:, :n], change[:, n : n + nu], change[:, n + nu :])

    def following(self, *names: str) -> FloatArray:
        """dp/d(names), np x len(names), where parameters whose default is an expression follow, as in `Model.replace`.

            D = S D + E,   S_ij = d(default of p_i)/dp_j,   E the unit columns of the names

        Those that were given, to `build`, `replace` or here, do not follow.

        Raises:
            UnknownName: a name is no parameter.
        """
        parameters = {parameter.name: parameter for parameter in self.model.mechanism.parameters}
        for name in names:
            if name not in tuple(parameters):
                raise UnknownName("parameter", name, parameters)
        graph = Graph()
        symbols = [graph.symbol(name) for name in parameters]
        scalars = ParameterScalars(graph, tuple(parameters))
        held = {*names, *self.model.given}
        defaults = [scalars(0 if name in held else parameter.default) for name, parameter in parameters.items()]
        direct = [entry for row in jacobian(defaults, symbols) for entry in row]
        slopes = np.array(Tape.of(direct, list(parameters)).run(list(self.model.values)), dtype=float)
        varied = [list(parameters).index(name) for name in names]
        unit = np.eye(len(parameters))
        return np.linalg.solve(unit - slopes.reshape(unit.shape), unit[:, varied])

    def kernel(self, kind: Kind, *, parameters: bool = True) -> Kernel:
        """The native function behind a method, for many states: `kernel("rate").batch(q, v, u, p)`; t before p.

        Args:
            kind: "rate", "forward_dynamics" or "inverse_dynamics" (v' in the place of u).
            parameters: whether derivatives with respect to them are wanted.

        Raises:
            UnknownName: there is no such kind.
            InputError: `parameters` is neither True nor False.
        """
        kinds = ("rate", "forward_dynamics", "inverse_dynamics")
        if kind not in kinds:
            raise UnknownName("kind of derivatives", kind, kinds)
        if not isinstance(parameters, bool):
            raise InputError(f"parameters must be True or False, not {parameters!r:.80}")
        model = self.model
        return jacobian_kernel(Key(model.mechanism), model.independent, model.labels, kind, parameters)

    # -- pieces ---------------------------------------------------------------------------------------------

    def _rate(self, q: FloatArray, v: FloatArray, u: FloatArray, t: float, parameters: bool) -> RateDerivatives:
        found = self._evaluate("rate", q, v, u, t, parameters)
        self._check(found["rate"], found)
        return RateDerivatives(found["rate"], found["A"], found["B"], *self._rest("x", found))

    def _evaluate(
        self, kind: Kind, q: FloatArray, v: FloatArray, third: FloatArray, t: float, parameters: bool
    ) -> dict[str, FloatArray]:
        kernel = self.kernel(kind, parameters=parameters)
        groups = (q, v, third, np.array([t])) if self.model.rheonomic else (q, v, third)
        values = kernel(*groups, np.array(self.model.values))
        return dict(zip((name for name, _ in kernel.program.outputs), values, strict=True))

    def _rest(self, name: str, found: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray]:
        """The derivatives by t and p, as zeros and without columns where the kernel has none."""
        rows = len(next(iter(found.values())))
        t = found[f"{name}_t"][:, 0] if f"{name}_t" in found else np.zeros(rows)
        return t, found.get(f"{name}_p", np.zeros((rows, 0)))

    def _check(self, result: FloatArray, found: dict[str, FloatArray]) -> None:
        measures = (found[name] for name in ("delta", "spread", "doubt", "loss"))
        check_dynamic(self.model.independent, result, *measures)


def _tangent(A: FloatArray, free: list[int], count: int) -> tuple[FloatArray, list[int]]:
    """T with A T = 0 and unit rows in `free`, which is made as many as `count` by the rows that are left largest."""
    Z = np.linalg.svd(A)[2][-count:].T
    while len(free) < count:
        left = np.linalg.svd(Z[free])[2][len(free) :]
        free = [*free, int(np.argmax(np.linalg.norm(Z @ left.T, axis=1)))]
    return Z @ np.linalg.inv(Z[free]), free
