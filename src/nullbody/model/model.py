"""Model: compiled kernels with parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from nullbody.errors import AssemblyError, InputError, SingularityError, StateError
from nullbody.kernels import Library
from nullbody.mechanism import Mechanism
from nullbody.model.state import State, vector
from nullbody.tolerances import GIVEN_CLOSED, LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS, REGULAR_SPREAD
from nullbody.typing import FloatArray

__all__ = ["Energy", "Model", "NullSpaceValues", "checked_model"]


def checked_model(model: object) -> None:
    """Raise unless this is a Model.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(model, Model):
        raise InputError(f"a Model from nullbody.build(equations) is needed here, not {type(model).__name__}")


class Energy(NamedTuple):
    """Kinetic and potential energy [J]."""

    kinetic: float
    potential: float

    @property
    def total(self) -> float:
        """T + U [J]."""
        return self.kinetic + self.potential


class NullSpaceValues(NamedTuple):
    """N (nq x nv), gamma (nq) and delta = |B| at one state."""

    N: FloatArray
    gamma: FloatArray
    delta: float


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism as native code, for one set of parameter values. It has no setters: threads may share it.

    Attributes:
        mechanism: what it models.
        independent: names of the independent coordinates; v holds their rates.
        labels: loop and direction of every closure equation.
        given: parameter values that differ from the mechanism's own.
        values: values of all parameters, in the mechanism's order.
        library: the kernels.
    """

    mechanism: Mechanism
    independent: tuple[str, ...]
    labels: tuple[str, ...]
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
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs u."""
        return self.mechanism.inputs

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Parameter values by name."""
        names = (parameter.name for parameter in self.mechanism.parameters)
        return MappingProxyType(dict(zip(names, self.values, strict=True)))

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

    def state(self, q: object, v: object = None) -> State:
        """A checked state.

        Args:
            q: all coordinates, in the order of `coordinates` or by name [m, rad].
            v: independent rates, in the order of `independent` or by name; at rest by default [m/s, rad/s].

        Raises:
            UnknownName, InputError: wrong names, sizes or values.
            StateError: a loop is open by more than a nanometre; the message names it. `assemble` closes loops.
            AssemblyError: the loops can never close for these parameters.
        """
        position = vector(q, self.coordinates, "coordinate")
        rate = np.zeros(len(self.independent)) if v is None else vector(v, self.independent, "independent rate")
        self._check_closed(position)
        return self.trusted_state(position, rate)

    def trusted_state(self, q: FloatArray, v: FloatArray) -> State:
        """A state that the caller has closed already (Newton, projection): not checked."""
        return State(q, v, self.coordinates, self.independent, self.values)

    # -- kernels --------------------------------------------------------------------------------------------

    @cached_property
    def _p(self) -> FloatArray:
        array = np.array(self.values, dtype=np.float64)
        array.flags.writeable = False
        return array

    def evaluate(self, routine: str, *groups: FloatArray) -> tuple[FloatArray, ...]:
        """Call a kernel on raw vectors, without any check: all outputs of the routine in their order."""
        return self.library.kernels[routine](*groups, self._p)

    def residual(self, q: FloatArray) -> FloatArray:
        """Phi(q) [m], without any check."""
        return self.evaluate("closure", q)[0]

    def jacobian(self, q: FloatArray) -> FloatArray:
        """A(q) = dPhi/dq, nc x nq, without any check."""
        return self.evaluate("closure", q)[1].reshape(len(self.labels), len(self.coordinates))

    def null_space(self, state: State) -> NullSpaceValues:
        """N, gamma and delta at a state: q' = N v, q'' = N v' + gamma.

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        N, gamma, _, delta = self._kinematics(state)
        return NullSpaceValues(N, gamma, float(delta))

    def velocity(self, state: State) -> FloatArray:
        """q' = N v, all rates [m/s, rad/s].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        return self._kinematics(state)[2]

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
        return self._forward(state, self.input_vector(u))[0]

    def inverse_dynamics(self, state: State, v_dot: object) -> FloatArray:
        """u with Br u = Mr v' + hr: the inputs for given independent accelerations [42].

        Args:
            state: where and how fast.
            v_dot: accelerations of the independent coordinates, in order or by name.

        Raises:
            InputError: the mechanism has not one input for each degree of freedom.
            SingularityError: |B| vanishes, or the inputs cannot drive the mechanism here.
        """
        wanted = vector(v_dot, self.independent, "independent acceleration")
        if len(self.inputs) != len(self.independent):
            raise InputError(
                f"inverse dynamics needs one input for each of the {len(self.independent)} degrees of freedom; "
                f"{self.mechanism.name!r} has {len(self.inputs)}. `generalized_forces` gives N^T Q instead"
            )
        self.own(state)
        Qr, u, *measures = self.evaluate("inverse_dynamics", state.q, state.v, wanted)
        self._check_dynamic(Qr, *measures)
        if len(u) != len(self.inputs) or not np.isfinite(u).all():
            where = "anywhere" if len(u) != len(self.inputs) else "here: some motion needs no work of theirs"
            raise SingularityError(f"the inputs {', '.join(self.inputs)} cannot drive all degrees of freedom {where}")
        return u

    def generalized_forces(self, state: State, v_dot: object) -> FloatArray:
        """N^T Q = Mr v' + hr: forces along the independent coordinates for given accelerations [42].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        wanted = vector(v_dot, self.independent, "independent acceleration")
        self.own(state)
        Qr, _, *measures = self.evaluate("inverse_dynamics", state.q, state.v, wanted)
        self._check_dynamic(Qr, *measures)
        return Qr

    def reactions(self, state: State, u: object = None) -> FloatArray:
        """lambda with A^T lambda = Q - M q'' - h, for the motion that the inputs u cause.

        The paper's sign: the loop joint acts on body a with -lambda, on body b with +lambda (Phi = a - b).

        Returns:
            One force component for each closure equation, in the order of `labels` [N].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        inputs = self.input_vector(u)
        q_ddot, q_dot = self._forward(state, inputs)
        return self.evaluate("reactions", state.q, q_dot, inputs, q_ddot)[0]

    def energy(self, state: State) -> Energy:
        """Kinetic and potential energy [J].

        Raises:
            SingularityError: |B| vanishes for these independent coordinates.
        """
        T, U = self.evaluate("energy", state.q, self.velocity(state))
        return Energy(float(T), float(U))

    # -- checks ---------------------------------------------------------------------------------------------

    def input_vector(self, u: object) -> FloatArray:
        """Inputs as a vector; None is zero, a mapping is by name."""
        return np.zeros(len(self.inputs)) if u is None else vector(u, self.inputs, "input")

    def own(self, state: State) -> State:
        """The state, if it is one of this model: same coordinates, closed for these parameters.

        Raises:
            InputError: not a State, or one of other coordinates.
            StateError: its loops are open for these parameter values.
        """
        if not isinstance(state, State):
            raise InputError(f"a State from model.state(q, v) or assemble(...) is needed, not {type(state).__name__}")
        if (state.coordinates, state.independent) != (self.coordinates, self.independent):
            raise InputError(
                f"the state has v = rates of {', '.join(state.independent)}, the model has rates of "
                f"{', '.join(self.independent)}: make the state with this model"
            )
        if state.parameters is not self.values and state.parameters != self.values:
            self._check_closed(state.q)
        return state

    def _check_closed(self, q: FloatArray) -> None:
        residual = self.residual(q)
        if not np.abs(residual).max(initial=0.0) <= GIVEN_CLOSED:
            worst = int(np.abs(residual).argmax())
            raise StateError(
                f"loop {self.labels[worst].rpartition(' ')[0]!r} is open by {abs(residual[worst]):.3g} m along "
                f"{self.labels[worst].rpartition(' ')[2]}: the state is not on the constraint manifold of these "
                "parameters. nullbody.assemble(model, {...}) closes the loops for given coordinates"
            )
        self.check_redundant(q)

    def check_redundant(self, q: FloatArray) -> None:
        """Raise where an equation that `derive` left out as a repetition is not fulfilled: no motion can mend that.

        Raises:
            AssemblyError: it is open by more than a nanometre for these parameter values.
        """
        dropped = self.evaluate("redundant", q)[0]
        if not np.abs(dropped).max(initial=0.0) <= GIVEN_CLOSED:
            raise AssemblyError(
                f"the loops of {self.mechanism.name!r} can never close for these parameters: an equation that no "
                f"coordinate changes independently is open by {np.abs(dropped).max():.3g} m. Check the lengths"
            )

    def _kinematics(self, state: State) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """(N, gamma, q', delta), checked."""
        self.own(state)
        N, gamma, q_dot, delta, spread, doubt = self.evaluate("kinematics", state.q, state.v)
        self._check_regular(delta, spread, doubt)
        return N, gamma, q_dot, delta

    def _forward(self, state: State, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(q'', q') for given inputs, checked."""
        self.own(state)
        q_ddot, q_dot, *measures = self.evaluate("forward_dynamics", state.q, state.v, inputs)
        self._check_dynamic(q_ddot, *measures)
        return q_ddot, q_dot

    def _check_dynamic(
        self, result: FloatArray, delta: FloatArray, spread: FloatArray, doubt: FloatArray, loss: FloatArray
    ) -> None:
        lost = not abs(loss) < REGULAR_LOSS or not np.isfinite(result).all()
        self._check_regular(delta, spread, doubt, limit=LARGE_SPREAD if lost else REGULAR_SPREAD)
        if lost:
            raise SingularityError(
                "the reduced mass matrix is singular here, to rounding: a motion of the mechanism moves no mass, or "
                "next to none, or a free joint stands at theta = +-90 degrees. Check the masses and inertias, or "
                "stay away"
            )

    def _check_regular(
        self, delta: FloatArray, spread: FloatArray, doubt: FloatArray, *, limit: float = REGULAR_SPREAD
    ) -> None:
        if spread < limit and doubt < REGULAR_DOUBT:
            return
        size = float(np.sqrt(spread)) if np.isfinite(spread) else float("inf")
        lost = min(16.0, max(0.0, np.log10(size))) if doubt < REGULAR_DOUBT else 16.0
        raise SingularityError(
            f"the independent coordinates {', '.join(self.independent)} are singular here: "
            f"|B| = {float(delta):.3g}, |N| = {size:.3g}, so results would lose {lost:.0f} of 16 digits. "
            "Derive with other independent coordinates, or stay away from this configuration"
        )

    def __repr__(self) -> str:
        changed = "".join(f", {name}={value:g}" for name, value in self.given.items())
        return f"<Model of {self.mechanism.name!r}, v = rates of {', '.join(self.independent)}{changed}>"
