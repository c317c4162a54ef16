"""MJCF: what MuJoCo reads is the robot that was written."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from nullbody import MechanismError, ParameterError, derive
from nullbody.catalog import three_prs
from nullbody.equations import flat
from nullbody.expr import Tape
from nullbody.formats import frame, write_mjcf
from nullbody.mechanism import Body, Mechanism, MechanismBuilder, Placement, Revolute, Rotation
from tests.formats.dynamics import difference
from tests.formats.zoo import chain
from tests.mechanisms import four_bar, two_bodies

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

GENERAL = {"Ixx": 0.02, "Iyy": 0.03, "Izz": 0.025, "ms": 0.3, "l": 0.6}


def mass_matrices(mechanism: Mechanism, seed: int):
    """M at a random q that no loop holds: from the symbolic equations, and from MuJoCo."""
    q = np.random.default_rng(seed).normal(size=len(mechanism.coordinates))
    values = mechanism.values()
    equations = derive(mechanism)
    ours = Tape.of(list(flat(equations["M"])), [*mechanism.coordinates, *values]).run([*q, *values.values()])
    model = mujoco.MjModel.from_xml_string(write_mjcf(mechanism))
    data = mujoco.MjData(model)
    at = [model.joint(name).dofadr[0] for name in mechanism.coordinates]
    data.qpos[at] = q
    mujoco.mj_forward(model, data)
    columns = np.zeros((model.nv, model.nv))
    for column, unit in zip(columns, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return np.reshape(ours, (len(q), len(q))), columns[np.ix_(at, at)]


@pytest.mark.parametrize("values", [{}, GENERAL], ids=["massless sliders", "general"])
def test_mass_matrix_of_the_robot(values) -> None:
    for seed in range(3):
        ours, theirs = mass_matrices(three_prs(**values), seed)
        assert np.abs(ours - theirs).max() < 1e-14


def test_mass_matrix_of_turned_frames_products_of_inertia_and_a_merged_body() -> None:
    for seed in range(3):
        ours, theirs = mass_matrices(two_bodies(), seed)
        assert np.abs(ours - theirs).max() < 1e-14


def test_massless_slider_is_merged_into_the_link() -> None:
    merged = ElementTree.fromstring(write_mjcf(three_prs()))
    kept = ElementTree.fromstring(write_mjcf(three_prs(ms=0.1)))
    assert [joint.get("name") for joint in merged.find(".//body[@name='link2']")][:2] == ["s2", "alpha2"]
    assert merged.find(".//body[@name='slider2']") is None
    assert kept.find(".//body[@name='slider2']/body[@name='link2']") is not None


def test_look_changes_neither_mass_nor_contacts() -> None:
    document = ElementTree.fromstring(write_mjcf(three_prs(**GENERAL)))
    looks = list(document.iter("geom"))
    model = mujoco.MjModel.from_xml_string(write_mjcf(three_prs(**GENERAL)))
    assert looks
    assert all(geom.get("mass") == geom.get("contype") == geom.get("conaffinity") == "0" for geom in looks)
    assert model.body_mass.sum() == pytest.approx(1.0 + 3 * 0.1 + 3 * 0.3, rel=1e-15)


def test_sites_of_every_loop_meet_at_home() -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(three_prs(b=0.25)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    for loop in ("leg1", "leg2", "leg3"):
        gap = data.site(f"{loop}_a").xpos - data.site(f"{loop}_b").xpos
        assert np.abs(gap).max() < 1e-15
    assert [model.actuator(i).name for i in range(model.nu)] == ["F1", "F2", "F3"]


def test_soft_simulation_in_mujoco_stays_near_home_with_balanced_forces() -> None:
    """The document as a user opens it, with MuJoCo's own constraints: vertical links stand for a moment."""
    model = mujoco.MjModel.from_xml_string(write_mjcf(three_prs()))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_step(model, data, nstep=50)
    assert abs(data.joint("y").qpos[0] - 0.5) < 1e-3


def test_numbers_are_written_in_full() -> None:
    document = ElementTree.fromstring(write_mjcf(three_prs(), {"l": 0.1 + 0.2}))
    assert document.find(".//site[@name='leg1_a']").get("pos") == "0 0 -0.30000000000000004"


def test_massless_body_in_a_loop_is_refused() -> None:
    bar = four_bar()
    hollow = replace(bar, bodies=(*bar.bodies[:1], Body("coupler"), *bar.bodies[2:]))
    with pytest.raises(MechanismError, match="'coupler' has neither mass nor inertia, and loop 'pin' holds it"):
        write_mjcf(hollow)


def test_massless_body_at_the_end_is_refused() -> None:
    joint = Revolute("hinge", "ground", "ghost", ("q",))
    with pytest.raises(MechanismError, match="'ghost' has neither mass nor inertia, and it carries 0 bodies"):
        write_mjcf(Mechanism("lost", (Body("ghost"),), (joint,)))


def test_name_that_mujoco_reserves_is_refused() -> None:
    joint = Revolute("hinge", "ground", "world", ("q",))
    with pytest.raises(MechanismError, match="MuJoCo keeps the name 'world'"):
        write_mjcf(Mechanism("globe", (Body("world", 1, (0, 0, 0), (1, 1, 1)),), (joint,)))


def test_impossible_value_is_refused() -> None:
    with pytest.raises(ParameterError, match="parameter l"):
        write_mjcf(three_prs(), {"l": -1.0})


def test_frame_moves_first_and_turns_about_the_new_axes() -> None:
    placed = frame(Placement((1, "r", 0), (Rotation("z", degrees=90), Rotation("x", radians="pi/2"))), {"r": 2.0})
    assert placed.position.tolist() == [1, 2, 0]
    assert placed.rotation @ [0, 0, 1] == pytest.approx([1, 0, 0], abs=1e-15)
    back = placed @ placed.inverse()
    assert np.abs(back.rotation - np.eye(3)).max() + np.abs(back.position).max() < 1e-15


def one_loop(kind: str, **geometry: object) -> Mechanism:
    """Two pendulums joined by a loop joint of some kind."""
    b = MechanismBuilder("loop")
    for name in "ab":
        b.rod(name, 1, 0.5, radius=0.01)
    b.revolute("qa", "ground", "a")
    b.revolute("qb", "ground", "b", at=(0.4, 0, 0))
    choice = {} if kind == "distance" else {"loop": True}
    getattr(b, kind)("tie", "a", "b", **geometry, **choice)
    return b.build()


@pytest.mark.parametrize(
    ("kind", "equalities"),
    [
        ("spherical", ["connect"]),
        ("weld", ["weld"]),
        ("revolute", ["connect", "connect"]),
        ("distance", ["tendon"]),
    ],
)
def test_loops_are_written_as_equalities(kind: str, equalities: list[str]) -> None:
    geometry = (
        {"length": 0.3, "at": (0, 0.1, 0), "on": (0.3, 0, 0)}
        if kind == "distance"
        else {"at": (0.5, 0, 0), "on": (0.3, 0, 0)}
    )
    document = write_mjcf(one_loop(kind, **geometry))
    assert [child.tag for child in ElementTree.fromstring(document).find("equality")] == equalities
    model = mujoco.MjModel.from_xml_string(document)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if kind == "distance":
        assert data.efc_pos[0] == pytest.approx(0.5**0.5 - 0.3)
    if kind == "revolute":
        assert data.efc_pos[: data.ne].tolist() == pytest.approx([-0.2, 0, 0, -0.2, 0, 0])


@pytest.mark.parametrize("kind", ["prismatic", "cylindrical", "universal", "planar"])
def test_a_loop_that_mujoco_has_no_word_for_is_named(kind: str) -> None:
    with pytest.raises(MechanismError, match=f"'tie' is a {kind.title()}, which MuJoCo has no word for: close it by"):
        write_mjcf(one_loop(kind))


def cart(call: str, *arguments: object, **more: object) -> Mechanism:
    """A cart with a ball on it and one more part."""
    b = MechanismBuilder("cart")
    b.sphere("cart", 1, 0.1)
    b.sphere("load", 1, 0.1)
    b.prismatic("x", "ground", "cart", axis="x")
    b.spherical("ball", "cart", "load")
    getattr(b, call)(*arguments, **more)
    return b.build()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (("wrench", "push", "cart", (1, 0, 0)), "'push' is a Wrench"),
        (("energy", "well", "x^2"), "'well' is an energy of your own"),
        (("energy", "rotor", 0, "x*x_dot^2/2"), "'rotor' is an energy of your own"),
        (("driver", "drive", "x", "sin(t)"), "driver 'drive' follows the time"),
        (("knife_edge", "blade", "cart"), "'blade' is a KnifeEdge"),
        (("holonomic", "mine", "x^2 - 1"), "'mine' is a Holonomic"),
        (("coordinate_spring", "spring", "ball_e1", 1), "'spring' acts on 'ball_e1', one of a ball's Euler parameters"),
        (("coupling", "belt", "ball_e1", "x", 1), "'belt' acts on 'ball_e1'"),
        (("actuator", "push", "ball_e1"), "'push' acts on 'ball_e1'"),
    ],
)
def test_a_part_that_mujoco_has_no_word_for_is_named(call: tuple[str, ...], message: str) -> None:
    with pytest.raises(MechanismError, match=message):
        write_mjcf(cart(*call))


def test_springs_of_one_joint_add_up() -> None:
    b = MechanismBuilder("cart")
    b.sphere("cart", 1, 0.1)
    b.prismatic("x", "ground", "cart", axis="x")
    b.coordinate_spring("one", "x", 3, 0.2, 0.5)
    b.coordinate_spring("two", "x", 1, -0.2)
    b.friction("rub", "x", 0.4, 0.25)
    b.actuator("push", "x", ("-1", 2))
    b.driver("hold", "x", 0.1)
    document = ElementTree.fromstring(write_mjcf(b.build()))
    joint = document.find(".//joint[@name='x']").attrib
    assert [float(joint[key]) for key in ("stiffness", "springref", "damping", "frictionloss")] == pytest.approx(
        [4, 0.1, 0.75, 0.4]
    )
    assert document.find(".//motor").attrib["ctrlrange"] == "-1 2"
    assert document.find("equality/joint").attrib == {"name": "hold", "joint1": "x", "polycoef": "0.1 0 0 0 0"}


def test_a_massless_body_that_is_fixed_needs_no_merging() -> None:
    b = MechanismBuilder("stand")
    b.body("stand")
    b.sphere("a", 1, 0.1)
    b.sphere("b", 1, 0.1)
    b.weld("bolts", "ground", "stand", at=(0, 0, 1))
    b.revolute("qa", "stand", "a")
    b.revolute("qb", "stand", "b", at=(1, 0, 0))
    model = mujoco.MjModel.from_xml_string(write_mjcf(b.build()))
    assert (model.nbody, model.nv) == (4, 2)


def test_a_ball_in_a_turned_frame_keeps_its_euler_parameters() -> None:
    made = chain()
    document = write_mjcf(made)
    assert difference(made, document) < 1e-12
    model = mujoco.MjModel.from_xml_string(document)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    assert data.joint("s_e0").qpos.tolist() == [1, 0, 0, 0]
