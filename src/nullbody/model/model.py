"""Model: compiled kernels with parameter values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from nullbody.equations import Mobility
from nullbody.errors import InputError, UnknownName
from nullbody.kernels import BoundKernel, Library
from nullbody.mechanism import Mechanism
from nullbody.model.actuation import Actuation, required, solved
from nullbody.model.check import check_closed
from nullbody.model.evaluated import forward, inverse, kinematics
from nullbody.model.state import State, vector
from nullbody.model.values import Energy, NullSpaceValues
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.batch import Batch
    from nullbody.model.derivatives import Derivatives
    from nullbody.model.jax_functions import JaxFunctions

__all__ = ["Model", "checked_model"]


def checked_model(model: object) -> None:
    """Raise unless this is a Model.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(model, Model):
        raise InputError(f"a Model from nullbody.build(equations) is needed here, not {type(model).__name__}")


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism as native code, for one set of parameter values. It has no setters: threads may share it.

    Attributes:
        mechanism: what it models.
        independent: names of the independent coordinates; v holds their rates.
        basis: names of the coordinates in whose rates the kernels of the dynamics are written inside.
        labels: where every row of A comes from ("leg1 x"), in the order of lambda.
        closure_labels: the same for Phi.
        facing: loops that could also close with an axis reversed.
        mobility: how many degrees of freedom there are, and why.
        given: parameter values that differ from the mechanism's own.
        values: values of all parameters, in the mechanism's order.
        library: the kernels.
    """

    mechanism: Mechanism
    independent: tuple[str, ...]
    basis: tuple[str, ...]
    labels: tuple[str, ...]
    closure_labels: tuple[str, ...]
    facing: tuple[str, ...]
    mobility: Mobility
    given: Mapping[str, float]
    values: tuple[float, ...]
    library: Library

    # -- names ----------------------------------------------------------------------------------------------

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of q."""
        return self.mechanism.coordinates

    @cached_property
    def dependent(self) -> tuple[str, ...]:
        """Names of the coordinates that the loops determine, in the order of q."""
        return tuple(name for name in self.coordinates if name not in self.independent)

    @cached_property
    def independent_columns(self) -> list[int]:
        """Places of the independent coordinates in q."""
        return [self.coordinates.index(name) for name in self.independent]

    @cached_property
    def actuated_columns(self) -> list[int]:
        """Places in q of the coordinates that the inputs act on."""
        return [self.coordinates.index(name) for name in self.mechanism.actuated]

    @cached_property
    def angular(self) -> list[bool]:
        """For every coordinate whether it is an angle."""
        units = self.mechanism.units
        return [units[name] == "rad" for name in self.coordinates]

    @cached_property
    def rheonomic(self) -> bool:
        """Whether the time itself enters."""
        return self.mechanism.rheonomic

    @cached_property
    def holonomic_rank(self) -> int:
        """How many closures are independent on the constraint manifold: rank A less the nonholonomic rows."""
        slips = {label for label, _ in self.mechanism.nonholonomic_rows}
        return sum(label not in slips for label in self.labels)

    @cached_property
    def all_labels(self) -> tuple[str, ...]:
        """Labels of all rows: those of Phi, then nonholonomic ones."""
        return (*self.closure_labels, *(label for label in self.labels if label not in self.closure_labels))

    @property
    def freedom(self) -> int:
        """Degrees of freedom of positions; more than those of velocities where something rolls."""
        return len(self.coordinates) - self.holonomic_rank

    @cached_property
    def limits(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest inputs [N, N m]; infinite where there are none."""
        pairs = np.array(self.mechanism.limits(self.parameters), dtype=float).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs u."""
        return self.mechanism.inputs

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Parameter values by name."""
        names = (parameter.name for parameter in self.mechanism.parameters)
        return MappingProxyType(dict(zip(names, self.values, strict=True)))

    @cached_property
    def derivatives(self) -> Derivatives:
        """Exact Jacobians of the rates, of forward and inverse dynamics and of a step; compiled when first called."""
        from nullbody.model.derivatives import Derivatives

        return Derivatives(self)

    def as_jax(self) -> JaxFunctions:
        """JAX functions of the rates, of forward and inverse dynamics, differentiable once.

        Raises:
            InputError: JAX is not installed, or computes in single precision.
        """
        from nullbody.model.jax_functions import jax_functions

        return jax_functions(self.plain)

    def replace(self, **values: float) -> Model:
        """The same code with other parameter values; nothing is compiled.

        Parameters whose default is an expression follow: with another b the platform's disc changes too,
        unless Ixx, Iyy, Izz were given.

        Raises:
            UnknownName, ParameterError: unknown or non-physical values.
        """
        given = {**self.given, **values}
        return replace(self, given=MappingProxyType(given), values=tuple(self.mechanism.values(given).values()))

    # -- states ---------------------------------------------------------------------------------------------

    def in_chart(self, independent: Sequence[str], rows: Sequence[str] | None = None) -> Model:
        """The same model written in other independent coordinates; derived and compiled once a process.

        Raises:
            UnknownName, InputError, SingularityError: as `derive`.
        """
        from nullbody.model.chart import chart

        if tuple(independent) == self.independent and rows is None:
            return self
        return chart(self, tuple(independent), None if rows is None else tuple(rows))

    @property
    def plain(self) -> Model:
        """The same model with all its kernels written in the independent coordinates; itself where it is one.

        Where the basis is singular, the kernels of the dynamics refuse states in which this one is regular.
        """
        from nullbody.model.chart import chart

        return self if self.basis == self.independent else chart(self, self.independent, self.labels)

    def state(self, q: object, v: object = None, *, t: float = 0.0) -> State:
        """A checked state.

        Args:
            q: all coordinates, in the order of `coordinates` or by name [m, rad].
            v: independent rates, in the order of `independent` or by name; at rest by default [m/s, rad/s].
            t: the time [s], for mechanisms with drivers.

        Raises:
            UnknownName, InputError: wrong names, sizes or values.
            StateError: a loop is open by more than a nanometre; the message names it. `assemble` closes loops.
            AssemblyError: the loops can never close for these parameters.
        """
        position = vector(q, self.coordinates, "coordinate")
        rate = np.zeros(len(self.independent)) if v is None else vector(v, self.independent, "independent rate")
        check_closed(self, position, t)
        return self.trusted_state(position, rate, t)

    def trusted_state(self, q: FloatArray, v: FloatArray, t: float = 0.0) -> State:
        """A state that the caller has closed already (Newton, projection): not checked."""
        return State(q, v, self.coordinates, self.independent, self.values, t)

    # -- kernels --------------------------------------------------------------------------------------------

    @cached_property
    def batch(self) -> Batch:
        """The same on arrays with a row for each state."""
        from nullbody.model.batch import Batch

        return Batch(self)

    @cached_property
    def _p(self) -> FloatArray:
        array = np.array(self.values, dtype=np.float64)
        array.flags.writeable = False
        return array

    def evaluate(self, routine: str, *groups: FloatArray, t: float = 0.0) -> tuple[FloatArray, ...]:
        """Call a kernel on raw vectors, without any check: all outputs of the routine in their order."""
        if self.rheonomic:
            return self.library.kernels[routine](*groups, np.array([t]), self._p)
        return self.library.kernels[routine](*groups, self._p)

    def bound(self, routine: str) -> BoundKernel:
        """A kernel for a fast loop, its parameters filled in: no check, no new arrays, about a microsecond a call."""
        if routine not in self.library.kernels:
            raise UnknownName("routine", routine, self.library.kernels)
        kernel = self.library.kernels[routine].bound()
        kernel.inputs["p"][:] = self.values
        return kernel

    def residual(self, q: FloatArray, t: float = 0.0) -> FloatArray:
        """Phi(q, t) [m], without any check."""
        return self.evaluate("closure", q, t=t)[0]

    def jacobian(self, q: FloatArray, t: float = 0.0) -> FloatArray:
        """dPhi/dq, a row for each of `closure_labels`, without any check."""
        return self.evaluate("closure", q, t=t)[1].reshape(len(self.closure_labels), len(self.coordinates))

    def rows(self, q: FloatArray, t: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """A and b of A q' + b = 0, a row for each of `labels`, without any check."""
        A, b = self.evaluate("rows", q, t=t)
        return A.reshape(len(self.labels), len(self.coordinates)), b

    def all_rows(self, q: FloatArray, t: float = 0.0) -> tuple[tuple[str, ...], FloatArray]:
        """Labels and rows of A, those included that repeat others only where the loops are closed."""
        if len(self.all_labels) == len(self.closure_labels):
            return self.all_labels, self.jacobian(q, t)
        A, _ = self.rows(q, t)
        slips = [i for i, label in enumerate(self.labels) if label not in self.closure_labels]
        return self.all_labels, np.vstack([self.jacobian(q, t), A[slips]])

    def null_space(self, state: State) -> NullSpaceValues:
        """N, gamma and delta at a state: q' = N v + beta, q'' = N v' + gamma.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        N, gamma, _, delta = kinematics(self, state)
        return NullSpaceValues(N, gamma, float(delta))

    def velocity(self, state: State) -> FloatArray:
        """q' = N v + beta, all rates [m/s, rad/s].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        return kinematics(self, state)[2]

    def acceleration(self, state: State, v_dot: object) -> FloatArray:
        """q'' = N v' + gamma, all accelerations for given independent ones [m/s^2, rad/s^2].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        N, gamma, _ = self.null_space(state)
        found: FloatArray = N @ vector(v_dot, self.independent, "independent acceleration") + gamma
        return found

    def forward_dynamics(self, state: State, u: object = None) -> FloatArray:
        """q'' = N v' + gamma with Mr v' + hr = Br u: accelerations of all coordinates [39-46].

        Args:
            state: where and how fast.
            u: inputs, in the order of `inputs` or by name; zero by default [N, N m].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        return forward(self, self.own(state), self.input_vector(u))[0]

    def inverse_dynamics(self, state: State, v_dot: object) -> FloatArray:
        """u with Br u = Mr v' + hr: the inputs for given independent accelerations [42].

        With more inputs than degrees of freedom, the inputs of least norm; `actuation` gives the others too.

        Args:
            state: where and how fast.
            v_dot: accelerations of the independent coordinates, in order or by name.

        Raises:
            InputError: fewer inputs than degrees of freedom; `actuation` gives what they can do.
            SingularityError: |B| vanishes, or the inputs cannot drive the mechanism here.
        """
        wanted = vector(v_dot, self.independent, "independent acceleration")
        if len(self.inputs) < len(self.independent):
            raise InputError(
                f"{self.mechanism.name!r} has {len(self.inputs)} inputs for {len(self.independent)} degrees of "
                "freedom: not every motion can be driven. `actuation` gives the inputs that come nearest and the "
                "forces that are missing, `generalized_forces` gives N^T Q"
            )
        state = self.own(state)
        Qr, u, Br = inverse(self, state, wanted)
        return required(self, state, Qr, u, Br.reshape(len(Qr), len(self.inputs)))

    def actuation(self, state: State, v_dot: object) -> Actuation:
        """What the inputs can do for given independent accelerations, with any number of inputs.

            minimise |Br u - Qr|, then |u|;   residual = Qr - Br u;   Br null_space = 0

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        wanted = vector(v_dot, self.independent, "independent acceleration")
        state = self.own(state)
        Qr, _, Br = inverse(self, state, wanted)
        return solved(self, state, Qr, Br.reshape(len(Qr), len(self.inputs)))

    def generalized_forces(self, state: State, v_dot: object) -> FloatArray:
        """N^T Q = Mr v' + hr: forces along the independent coordinates for given accelerations [42].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        return inverse(self, self.own(state), vector(v_dot, self.independent, "independent acceleration"))[0]

    def reactions(self, state: State, u: object = None) -> FloatArray:
        """lambda with A^T lambda = Q - M q'' - h, for the motion that the inputs u cause.

        The paper's sign: the loop joint acts on its parent with -lambda, on its child with +lambda (Phi = a - b).
        Rows that repeat others are not in `labels`: they take no force here, which in a redundant mechanism is one
        choice of many; A^T lambda is the same for all.

        Returns:
            One force [N] or torque [N m] for each row of A, in the order of `labels`.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        inputs = self.input_vector(u)
        state = self.own(state)
        q_ddot, q_dot = forward(self, state, inputs)
        return self.evaluate("reactions", state.q, q_dot, inputs, q_ddot, t=state.t)[0]

    def energy(self, state: State) -> Energy:
        """Kinetic and potential energy [J].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        state = self.own(state)
        T, U = self.evaluate("energy", state.q, self.velocity(state), t=state.t)
        return Energy(float(T), float(U))

    # -- checks ---------------------------------------------------------------------------------------------

    def input_vector(self, u: object) -> FloatArray:
        """Inputs as a vector; None is zero, a mapping is by name."""
        return np.zeros(len(self.inputs)) if u is None else vector(u, self.inputs, "input")

    def own(self, state: State) -> State:
        """The state in this model's independent coordinates, checked.

        Raises:
            InputError: not a State, or one of another mechanism.
            StateError: its loops are open for these parameter values.
            SingularityError: it is a state of other independent coordinates, which are singular.
        """
        if not isinstance(state, State):
            raise InputError(f"a State from model.state(q, v) or assemble(...) is needed, not {type(state).__name__}")
        if state.coordinates != self.coordinates:
            raise InputError(f"the state is one of another mechanism than {self.mechanism.name!r}")
        if state.parameters is not self.values and state.parameters != self.values:
            check_closed(self, state.q, state.t)
        if state.independent != self.independent:
            q_dot = self.in_chart(state.independent).velocity(state)
            return self.trusted_state(state.q.copy(), q_dot[self.independent_columns], state.t)
        return state

    def __repr__(self) -> str:
        changed = "".join(f", {name}={value:g}" for name, value in self.given.items())
        return f"<Model of {self.mechanism.name!r}, v = rates of {', '.join(self.independent)}{changed}>"
