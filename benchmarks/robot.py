"""The 3-PRS: derivation, building, forward and inverse dynamics, a free swing."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator

import numpy as np

import nullbody
from benchmarks.measure import Timing, measure
from nullbody.errors import VerificationError
from nullbody.verify import AbstractEngine, MujocoEngine, PinocchioEngine

__all__ = ["timings"]

_INDEPENDENT = ("s1", "s2", "s3")
_HANGING = {"y": -0.5, "alpha1": -1.57, "alpha2": -1.57, "alpha3": -1.57}


def timings() -> Iterator[Timing]:
    """All measurements, ours first in each group."""
    robot = nullbody.catalog.three_prs()
    equations = nullbody.derive(robot, _INDEPENDENT)
    yield measure("derive", "nullbody", lambda: nullbody.derive(robot, _INDEPENDENT), repeats=5)
    yield measure("build cold", "nullbody", lambda: _cold(equations), repeats=5)
    model = nullbody.build(equations)
    yield measure("build warm", "nullbody", lambda: nullbody.build(equations), repeats=5)
    state = nullbody.assemble(model, {"s1": 0.62, "s2": 0.55, "s3": 0.58}, v=[0.1, -0.2, 0.05])
    u = np.array([0.3, -0.2, 0.5])
    q_dot = model.velocity(state)
    q_ddot = model.forward_dynamics(state, u)
    v_dot = q_ddot[-3:]
    yield measure("forward dynamics", "nullbody", lambda: model.forward_dynamics(state, u))
    peers = _engines(model)
    for name, peer in peers.items():
        yield measure("forward dynamics", name, lambda peer=peer: peer.forward_dynamics(state.q, q_dot, u))
    yield measure("inverse dynamics", "nullbody", lambda: model.inverse_dynamics(state, v_dot))
    for name, peer in peers.items():
        yield measure("inverse dynamics", name, lambda peer=peer: peer.inverse_dynamics(state.q, q_dot, q_ddot))
    swing = nullbody.assemble(model, {"s1": 0.5, "s2": 0.6, "s3": 0.7}, guess=_HANGING)
    yield measure("2 s swing, rtol 1e-10", "nullbody", lambda: nullbody.simulate(model, swing, 2.0), repeats=5)


def _cold(equations: nullbody.Equations) -> None:
    before = os.environ.get("NULLBODY_CACHE")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["NULLBODY_CACHE"] = folder
        try:
            nullbody.build(equations)
        finally:
            if before is None:
                del os.environ["NULLBODY_CACHE"]
            else:
                os.environ["NULLBODY_CACHE"] = before


def _engines(model: nullbody.Model) -> dict[str, AbstractEngine]:
    """The engines that are installed."""
    found: dict[str, AbstractEngine] = {}
    for name, make in (("pinocchio", PinocchioEngine), ("mujoco terms + KKT", MujocoEngine)):
        try:
            found[name] = make(model.mechanism, model.parameters, model.labels)
        except VerificationError as error:
            print(f"{name} is left out: {error}", file=sys.stderr)
    return found
