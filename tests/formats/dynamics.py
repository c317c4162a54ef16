"""M and h of the tree, of our equations and of MuJoCo on a document, at random states that no loop holds."""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody import derive
from nullbody.equations import flat
from nullbody.expr import Tape
from nullbody.formats import steps
from nullbody.mechanism import Mechanism

__all__ = ["difference", "engine_terms", "evaluated", "random_state", "rates_of"]

HINGE_OR_SLIDE = (2, 3)


def balls(mechanism: Mechanism) -> list[list[int]]:
    """Where the Euler parameters are among the coordinates."""
    place = {name: number for number, name in enumerate(mechanism.coordinates)}
    found = [step for joint in mechanism.joints for step in steps(joint) if step.kind == "ball"]
    return [[place[name] for name in step.coordinates] for step in found]


def random_state(mechanism: Mechanism, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """q and q' with Euler parameters of length 1."""
    q, q_dot = generator.normal(size=(2, len(mechanism.coordinates)))
    for at in balls(mechanism):
        q[at] /= np.linalg.norm(q[at])
        q_dot[at] -= q[at] * (q[at] @ q_dot[at])
    return q, q_dot


def evaluated(mechanism: Mechanism, outputs: tuple[str, ...], q: np.ndarray, q_dot: np.ndarray) -> list[np.ndarray]:
    """Outputs of our equations, flat."""
    equations, values = derive(mechanism), mechanism.values()
    names = [*mechanism.coordinates, *(f"{name}_dot" for name in mechanism.coordinates), *values, "t"]
    given = [*q, *q_dot, *values.values(), 0.0]
    return [np.array(Tape.of(list(flat(equations[name])), names).run(given)) for name in outputs]


def rates_of(mechanism: Mechanism, model: Any, data: Any, q: np.ndarray) -> np.ndarray:
    """Put q into MuJoCo; the matrix T with qvel = T q'. Joints of the document decide what is what."""
    place = {name: number for number, name in enumerate(mechanism.coordinates)}
    T = np.zeros((model.nv, len(q)))
    for number in range(model.njnt):
        joint, kind = model.joint(number), model.jnt_type[number]
        at, rate = joint.qposadr[0], joint.dofadr[0]
        if kind in HINGE_OR_SLIDE:
            data.qpos[at], T[rate, place[joint.name]] = q[place[joint.name]], 1
            continue
        stem = joint.name.removesuffix("_e0")
        if kind == 0:
            for axis in "xyz":
                data.qpos[at], T[rate, place[f"{stem}_{axis}"]] = q[place[f"{stem}_{axis}"]], 1
                at, rate = at + 1, rate + 1
        columns = [place[f"{stem}_e{k}"] for k in range(4)]
        data.qpos[at : at + 4] = e0, e1, e2, e3 = q[columns]
        G = np.array([[-e1, e0, e3, -e2], [-e2, -e3, e0, e1], [-e3, e2, -e1, e0]])
        T[rate : rate + 3, columns] = 2 * G
    return T


def engine_terms(
    mechanism: Mechanism, document: str, q: np.ndarray, q_dot: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """T^T M T and T^T (bias - passive forces) of MuJoCo, without constraints."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(document)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    T = rates_of(mechanism, model, data, q)
    data.qvel[:] = T @ q_dot
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    for column, unit in zip(M, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return T.T @ M @ T, T.T @ (data.qfrc_bias - data.qfrc_passive)


def difference(mechanism: Mechanism, document: str, seed: int = 0, states: int = 2) -> float:
    """Largest relative difference of M and h along motions that keep Euler parameters at length 1."""
    generator = np.random.default_rng(seed)
    worst = 0.0
    for _ in range(states):
        q, q_dot = random_state(mechanism, generator)
        M, h = evaluated(mechanism, ("M", "h"), q, q_dot)
        other_M, other_h = engine_terms(mechanism, document, q, q_dot)
        P = np.eye(len(q))
        for at in balls(mechanism):
            P[np.ix_(at, at)] -= np.outer(q[at], q[at])
        gaps = (P @ (np.reshape(M, P.shape) - other_M) @ P, P @ (h - other_h))
        worst = max(
            worst, *(np.abs(gap).max() / max(np.abs(of).max(), 1) for gap, of in zip(gaps, (M, h), strict=True))
        )
    return float(worst)
