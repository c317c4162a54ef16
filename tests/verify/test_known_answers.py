"""Constraints and loads against answers that are known by heart: engines share their residuals with the model."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    CoordinateSpring,
    Coupling,
    Distance,
    Driver,
    Energy,
    Free,
    FreeQuaternion,
    Friction,
    Holonomic,
    KnifeEdge,
    Mechanism,
    Nonholonomic,
    Placement,
    Planar,
    Prismatic,
    Revolute,
    RollingDisc,
    Rotation,
    Spherical,
    Spring,
    Wrench,
)
from nullbody.verify import MultiplierEngine

G = 9.81


def forward(mechanism: Mechanism, q, q_dot, t: float = 0.0, u=()) -> tuple[np.ndarray, dict[str, float]]:
    """q'' and multipliers by label."""
    rows = (*mechanism.holonomic_rows, *mechanism.nonholonomic_rows)
    labels = tuple(label for label, _ in rows)
    engine = MultiplierEngine(mechanism, mechanism.values(), labels)
    q_ddot, lam = engine.forward_dynamics(np.array(q, float), np.array(q_dot, float), np.array(u, float), t)
    return q_ddot, dict(zip(labels, lam.tolist(), strict=True))


def cart(*loads, mass: float = 2.0, **more) -> Mechanism:
    """A mass on a horizontal rail."""
    rail = Prismatic("rail", GROUND, "cart", ("s",), axis="x")
    return Mechanism("cart", (Body("cart", mass),), (rail,), loads=loads, gravity=(0, -G, 0), **more)


def wheels(**more) -> Mechanism:
    """Two rotors of 2 and 3 kg m^2 on the ground, with a motor on the first."""
    bodies = tuple(Body(name, 1, (0, 0, 0), (2, 2, moment)) for name, moment in (("one", 2), ("two", 3)))
    joints = tuple(Revolute(name, GROUND, name, (name[0] + "q",)) for name in ("one", "two"))
    return Mechanism("wheels", bodies, joints, actuators=(Actuator("u", "oq"),), **more)


def plate(**more) -> Mechanism:
    """A body of 2 kg and 0.5 kg m^2 that slides on a plane."""
    joint = Planar("table", GROUND, "plate", ("x", "y", "phi"))
    return Mechanism("plate", (Body("plate", 2, (0, 0, 0), (1, 1, 0.5)),), (joint,), **more)


def test_spring_and_damper_between_points() -> None:
    """s'' = -(k (L - l) + c L') (s / L) / m with L = sqrt(s^2 + 0.3^2)."""
    load = Spring("spring", GROUND, (0, 0.3, 0), "cart", (0, 0, 0), stiffness=50, length=0.2, damping=4)
    length = sqrt(0.4**2 + 0.3**2)
    force = 50 * (length - 0.2) + 4 * (0.4 * 1.5 / length)
    assert forward(cart(load), [0.4], [1.5])[0] == pytest.approx([-force * 0.4 / length / 2], rel=1e-14)
    straight = replace(load, length=0, damping=0)
    assert forward(cart(straight), [0.4], [1.5])[0] == pytest.approx([-50 * 0.4 / 2], rel=1e-14)


def test_spring_along_a_coordinate_friction_and_energy() -> None:
    assert forward(cart(CoordinateSpring("k", "s", 50, 0.1, 4)), [0.4], [1.5])[0] == pytest.approx([-(15 + 6) / 2])
    friction = Friction("f", "s", 3, 0.5, 0.2)
    expected = -(3 * 1.5 / sqrt(1.5**2 + 0.2**2) + 0.5 * 1.5) / 2
    assert forward(cart(friction), [0.4], [1.5])[0] == pytest.approx([expected], rel=1e-14)
    # T = (2 + 3 s^2) s'^2 / 2, U = s^3: (2 + 3 s^2) s'' + 3 s s'^2 + 3 s^2 = 0
    own = Energy("own", "s^3", "3*s^2*s_dot^2/2")
    expected = -(3 * 0.4 * 1.5**2 + 3 * 0.4**2) / (2 + 3 * 0.4**2)
    assert forward(cart(own), [0.4], [1.5])[0] == pytest.approx([expected], rel=1e-14)


def test_wrench_in_both_kinds_of_axes() -> None:
    """A force of 3 N along the body's x axis at (0, 0.2): phi'' = -3 0.2 / 0.5; at the body's angle of 90 degrees."""
    jet = Wrench("jet", "plate", (0, 0.2, 0), ("3*t", 0, 0), (0, 0, 1), "body")
    found = forward(plate(loads=(jet,)), [0, 0, pi / 2], [0, 0, 0], t=1.0)[0]
    assert found == pytest.approx([0, 1.5, (-0.6 + 1) / 0.5], abs=1e-15)
    wind = replace(jet, axes="ground")
    found = forward(plate(loads=(wind,)), [0, 0, pi / 2], [0, 0, 0], t=1.0)[0]
    assert found == pytest.approx([1.5, 0, (0 + 1) / 0.5], abs=1e-15)


def test_gear_pair() -> None:
    """tq = -2 oq + 0.1: (2 + 4 3) oq'' = u; the multiplier is the torque on the driven wheel."""
    gears = wheels(constraints=(Coupling("gear", "tq", "oq", -2, 0.1),))
    q_ddot, lam = forward(gears, [0.2, -0.3], [1, -2], u=[7])
    assert q_ddot == pytest.approx([0.5, -1], rel=1e-14)
    assert -lam["gear coupling"] == pytest.approx(3 * -1, rel=1e-14)


def test_driver_needs_minus_its_multiplier() -> None:
    """oq = sin(2 t): oq'' = -4 sin(2 t), and 2 oq'' = u - lambda."""
    driven = wheels(constraints=(Driver("drive", "oq", "sin(2*t)"),))
    q_ddot, lam = forward(driven, [sin(0.6), 0], [2 * cos(0.6), 0], t=0.3, u=[1.5])
    assert q_ddot == pytest.approx([-4 * sin(0.6), 0], rel=1e-14)
    assert 1.5 - lam["drive drive"] == pytest.approx(2 * q_ddot[0], rel=1e-14)


def test_tension_of_a_rod() -> None:
    """A point mass on a rod of 0.5 m that swings through the lowest point at 2 m/s: m (g + v^2 / l)."""
    rod = Distance("rod", GROUND, "bob", length=0.5)
    free = Free("free", GROUND, "bob", ("x", "y", "z", "psi", "theta", "phi"))
    pendulum = Mechanism("pendulum", (Body("bob", 2, (0, 0, 0), (1, 1, 1)),), (free,), (rod,), gravity=(0, -G, 0))
    q_ddot, lam = forward(pendulum, [0, -0.5, 0, 0, 0, 0], [2, 0, 0, 0, 0, 0])
    assert q_ddot == pytest.approx([0, 8, 0, 0, 0, 0], abs=1e-13)
    assert lam["rod length"] == pytest.approx(2 * (G + 8), rel=1e-14)


def test_own_equations_in_coordinates_and_rates() -> None:
    """A bead on y = x^2 + 0.1 t^2 without gravity; a skate that turns: x' sin phi = y' cos phi."""
    bead = plate(constraints=(Holonomic("wire", ("y - x^2 - t^2/10",)),))
    (x_ddot, y_ddot, _), lam = forward(bead, [0.5, 0.25, 0], [2, 2, 0])
    assert y_ddot == pytest.approx(2 * 4 + x_ddot + 0.2, rel=1e-14)
    assert (2 * x_ddot, 2 * y_ddot) == pytest.approx((lam["wire 1"], -lam["wire 1"]), rel=1e-14)
    skate = plate(constraints=(Nonholonomic("edge", ("x_dot*sin(phi) - y_dot*cos(phi)",)),))
    q_ddot, lam = forward(skate, [0, 0, 0], [3, 0, 2])
    assert q_ddot == pytest.approx([0, 6, 0], abs=1e-15)
    assert lam["edge 1"] == pytest.approx(2 * 6)


def test_blade_gives_the_centripetal_force() -> None:
    """v = 3 m/s along the blade, turning at 2 rad/s: a force m v omega along the normal, on the body."""
    q_ddot, lam = forward(plate(constraints=(KnifeEdge("blade", "plate"),)), [0, 0, 0], [3, 0, 2])
    assert q_ddot == pytest.approx([0, 6, 0], abs=1e-15)
    assert lam["blade slip"] == pytest.approx(2 * 6)


def test_disc_rolls_down_a_slope_with_two_thirds_of_g() -> None:
    """x'' = (2/3) g sin(beta); the contact carries m g cos(beta) and m g sin(beta) / 3 against the motion."""
    beta, r, m = 0.3, 0.2, 1.5
    slope = Placement((0, 0, 0), (Rotation("y", radians=beta),))
    moments = (m * r**2 / 4, m * r**2 / 2, m * r**2 / 4)
    e = (cos(beta / 2), 0, sin(beta / 2), 0)
    disc = Mechanism(
        "disc",
        (Body("disc", m, (0, 0, 0), moments),),
        (FreeQuaternion("free", GROUND, "disc", ("x", "y", "z", "e0", "e1", "e2", "e3")),),
        constraints=(RollingDisc("roll", "disc", r, axis="y", plane=slope),),
        gravity=(0, 0, -G),
    )
    speed = 1.2
    e_dot = np.array([-e[2], 0, e[0], 0]) * speed / r / 2
    along, up = np.array([cos(beta), 0, -sin(beta)]), np.array([sin(beta), 0, cos(beta)])
    q_ddot, lam = forward(disc, [*(r * up), *e], [*(speed * along), *e_dot])
    assert q_ddot[:3] == pytest.approx(2 / 3 * G * sin(beta) * along, rel=1e-12)
    assert lam["roll height"] == pytest.approx(m * G * cos(beta), rel=1e-12)
    assert lam["roll slip_x"] == pytest.approx(-m * G * sin(beta) / 3, rel=1e-12)
    assert lam["roll slip_y"] == pytest.approx(0, abs=1e-12)


def test_free_rotation_is_euler_s() -> None:
    """I omega' + omega x I omega = 0 with omega = 2 G(e) e'."""
    body = Body("top", 1, (0, 0, 0), (0.2, 0.3, 0.4))
    top = Mechanism("top", (body,), (Spherical("ball", GROUND, "top", ("e0", "e1", "e2", "e3")),))
    e, omega, moments = np.array([0.8, 0.36, -0.48, 0.0]), np.array([1, -2, 3]), np.array([0.2, 0.3, 0.4])

    def e_dot(of, rate) -> np.ndarray:
        """e' = e (0, omega) / 2, a product of quaternions."""
        return np.array([-of[1:] @ rate, *(of[0] * rate + np.cross(of[1:], rate))]) / 2

    turning = -np.cross(omega, moments * omega) / moments
    q_ddot, _ = forward(top, e, e_dot(e, omega))
    assert q_ddot == pytest.approx(e_dot(e, turning) + e_dot(e_dot(e, omega), omega), abs=1e-14)
