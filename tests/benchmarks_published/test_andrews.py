"""Test Set II-13, IFToMM A03: Andrews' mechanism coordinate by coordinate, and its multipliers."""

from __future__ import annotations

import numpy as np

from nullbody import Trajectory, catalog
from nullbody.typing import FloatArray
from tests.benchmarks_published.planar import Plant, turned
from tests.benchmarks_published.published import moved, reference

ANGLES = ("beta", "theta", "gamma", "phi", "delta", "omega", "epsilon")


def columns(suffix: str = "") -> FloatArray:
    """All seven of them, times first."""
    return np.array([reference("andrews", "test_set")[name + suffix] for name in ANGLES]).T


def published() -> Trajectory:
    return moved("andrews", "test_set", reference("andrews", "test_set")["t"])


def test_home_is_the_test_sets_start() -> None:
    start = catalog.starts("andrews")["test_set"]
    np.testing.assert_allclose([start.q[name] for name in ANGLES], columns()[0], rtol=0, atol=1e-15)
    assert catalog.andrews().coordinates == ANGLES


def test_angles_and_rates() -> None:
    """The printed 16 digits of the Test Set at t = 0.03 s are wrong beyond the tenth; ours have 11 and more."""
    found = published()
    np.testing.assert_allclose(found.q, columns(), rtol=0, atol=5e-10)
    np.testing.assert_allclose(found.q_dot, columns("_d"), rtol=0, atol=2e-7)
    assert found.statistics.residual < 1e-13


def test_accelerations_and_multipliers() -> None:
    """Rows E3, E4, E6 are the published constraints 1 to 6 with the same sign."""
    found = published()
    wanted = reference("andrews", "test_set")
    states = [found.state(t) for t in found.t]
    accelerations = [found.model.forward_dynamics(x) for x in states]
    np.testing.assert_allclose(accelerations, columns("_dd"), rtol=1e-9, atol=3e-4)
    multipliers = np.array([found.model.reactions(x) for x in states]).T
    np.testing.assert_allclose(multipliers, [wanted[f"lam{k}"] for k in range(1, 7)], rtol=0, atol=1e-7)
    assert found.model.labels == ("E3 x", "E3 y", "E4 x", "E4 y", "E6 x", "E6 y")


def test_the_point_f_of_benchmark_a03() -> None:
    """What A03 compares, F, is a point: the joint of K1 and K2 [m]."""
    found, wanted = published(), reference("andrews", "test_set")
    F = found.model.parameters["rr"] * np.array([np.cos(found["beta"]), np.sin(found["beta"])])
    np.testing.assert_allclose(F, [wanted["F_x"], wanted["F_y"]], rtol=0, atol=3e-12)


def test_energy_balances_with_the_motors_work() -> None:
    """T + V - E0 = mom (beta - beta0)."""
    found = published()
    energy = found.kinetic + found.potential
    np.testing.assert_allclose(energy - energy[0], 0.033 * (found["beta"] - found["beta"][0]), rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.work, 0.033 * (found["beta"] - found["beta"][0]), rtol=0, atol=1e-10)


def test_other_lengths_masses_and_springs() -> None:
    """Against seven bodies with pins: the angles of all bodies, and where they are."""
    values = {
        "rr": 0.0075,
        "ss": 0.0362,
        "zt": 0.041,
        "xb": -0.0355,
        "sc": 0.016,
        "sd": 0.022,
        "tb": -0.004,
        "ub": 0.01,
    }
    values |= {"c0": 2800.0, "l0": 0.07, "mom": 0.05, "m3": 0.05, "I2": 9e-7, "m6": 0.02}
    t = np.linspace(0, 0.015, 6)
    found = moved("andrews", "test_set", t, values)
    p = found.model.parameters

    def poses(q: FloatArray) -> FloatArray:
        beta, theta, gamma, phi, delta, omega, epsilon = q
        A, B = np.array([p["xa"], p["ya"]]), np.array([p["xb"], p["yb"]])
        angles = [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon]
        F = turned(beta, (p["rr"], 0))
        E = F + turned(beta + theta, (-p["d"], 0))
        origins = [np.zeros(2), F, B, E, A, E, A]
        return np.concatenate([[*(o + turned(a, c)), a] for o, a, c in zip(origins, angles, centres, strict=True)])

    centres = np.array(
        [
            (p["ra"], 0),
            (-p["da"], 0),
            (p["sb"], -p["sa"]),
            (0, p["ea"]),
            (p["ta"], p["tb"]),
            (-p["fa"], 0),
            (-p["ub"], -p["ua"]),
        ]
    )
    ends = {"O": 0, "F": 0, "f": 1, "E": 1, "B": 2, "e3": 2, "e4": 3, "G": 3, "A5": 4, "g": 4, "e6": 5, "H": 5, "A7": 6}
    local = {"F": (p["rr"], 0), "E": (-p["d"], 0), "e3": (0, -p["ss"]), "G": (0, p["e"]), "g": (p["zt"], 0)}
    local |= {"H": (-p["zf"], 0), "h": (0, -p["u"])}
    ends["h"] = 6
    points = {name: np.array(local.get(name, (0.0, 0.0))) - centres[body] for name, body in ends.items()}
    fixed = [("O", (0, 0)), ("B", (p["xb"], p["yb"])), ("A5", (p["xa"], p["ya"])), ("A7", (p["xa"], p["ya"]))]
    pairs = [("F", "f"), ("E", "e3"), ("E", "e4"), ("E", "e6"), ("G", "g"), ("H", "h")]
    plant = Plant(
        mass=[p[f"m{k}"] for k in range(1, 8)],
        moment=[p[f"I{k}"] for k in range(1, 8)],
        pins=[
            *((ends[name], points[name], None, point) for name, point in fixed),
            *((ends[a], points[a], ends[b], points[b]) for a, b in pairs),
        ],
        springs=[(2, np.array([p["sd"], -p["sc"]]) - centres[2], np.array([p["xc"], p["yc"]]), p["c0"], p["l0"])],
        torque={0: p["mom"]},
    )
    wanted = plant.motion(poses(found.q[0]), t)
    np.testing.assert_allclose([poses(q) for q in found.q], wanted, rtol=0, atol=1e-9)
