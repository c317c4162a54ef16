"""MJCF that is read moves as in MuJoCo; what changes the dynamics and is not known is refused by element and line."""

from __future__ import annotations

import re

import numpy as np
import pytest

from nullbody import InputError, MechanismError, ModelFileError, UnknownName
from nullbody.catalog import MODELS
from nullbody.formats import read_mjcf, read_model, write_mjcf
from nullbody.mechanism import Coupling, Distance, Driver, Energy, Friction, Holonomic, Spherical, Spring, Weld
from tests.formats.dynamics import difference, evaluated, rates_of
from tests.formats.zoo import chain
from tests.mechanisms import four_bar, slider_crank, two_bodies

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

ZOO = """<mujoco model="zoo">
 <compiler angle="degree" eulerseq="XYz"/>
 <option gravity="0.1 0.2 -9"/>
 <default>
  <geom density="700" contype="0" conaffinity="0"/>
  <joint damping="0.3"/>
  <tendon damping="0.7"/>
  <default class="arm"><joint axis="0 1 0" stiffness="4" springref="20"/><geom type="capsule" size="0.05 0.2"/>
    <default class="fine"><joint damping="0.01" armature="0.02"/></default></default>
 </default>
 <worldbody>
  <light pos="0 0 3"/>
  <body name="base" pos="0.1 0.2 0.3" quat="1 2 3 4">
   <freejoint name="root"/>
   <geom type="box" size="0.1 0.2 0.3" euler="10 20 30"/>
   <geom size="0.1" pos="0.4 0 0" mass="0.7"/>
   <body name="arm-1" pos="0 0 0.5" axisangle="1 1 0 33" childclass="arm">
     <joint name="shoulder" pos="0.01 0.02 0.03" ref="15"/>
     <joint name="slide" type="slide" axis="1 2 3" class="fine" pos="1 1 1" ref="0.2"/>
     <geom fromto="0 0 0 0.3 0.1 0.2" size="0.04"/>
     <geom type="box" fromto="0 0 0 0.1 0.1 0.2" size="0.03"/>
     <geom type="ellipsoid" size="0.1 0.2 0.05" pos="0.1 0 0" zaxis="1 0.5 0.2"/>
     <body name="plate" xyaxes="1 0.2 0 0 1 0.3" pos="0.3 0 0">
       <joint name="knuckle" type="ball" pos="0.1 -0.1 0" stiffness="0" damping="0"/>
       <inertial pos="0.01 0.02 0.03" mass="2" fullinertia="0.3 0.4 0.5 0.02 0.03 -0.01"/>
       <body name="fixed" pos="0.2 0 0" euler="0 90 40"><geom type="cylinder" size="0.1 0.3"/>
         <geom class="main" type="ellipsoid" fromto="0 0 0 0.1 0 0" size="0.02"/>
         <site name="tip" pos="0.1 0.1 0"/>
         <body name="last" pos="0 0 0.1">
          <joint name="l1" class="fine" axis="0 0 1"/><joint name="l2" class="fine"/><joint name="l3" axis="1 0 0"/>
          <inertial pos="0.1 0 0" quat="1 1 0 0" mass="0.5" diaginertia="0.1 0.15 0.2"/>
          <site name="end" pos="0 0 0.3"/></body>
       </body>
     </body>
   </body>
  </body>
  <site name="peg" pos="1 0 0" rgba="1 0 0 1"/>
 </worldbody>
 <tendon>
  <spatial name="t" stiffness="30" damping="2" springlength="0.4"><site site="peg"/><site site="end"/></spatial>
  <spatial name="t2" stiffness="20"><site site="peg"/><site site="tip"/></spatial>
 </tendon>
 <actuator><motor name="shoulder" joint="shoulder" gear="-3" ctrlrange="-1 2"/><general joint="l1" forcerange="-1 1"
   gainprm="2" ctrlrange="0 3"/></actuator>
 <sensor><jointpos joint="l1"/></sensor>
 <keyframe><key name="home" qpos="0 0 1 1 0 0 0 0.1 0.2 1 0 0 0 0.3 0.4 0.5"/></keyframe>
</mujoco>"""


def test_what_is_read_moves_as_in_mujoco() -> None:
    made = read_mjcf(ZOO)
    assert difference(made, ZOO, states=4) < 1e-12
    assert difference(read_mjcf(write_mjcf(made)), write_mjcf(made)) < 1e-12


def test_inputs_limits_and_home() -> None:
    made = read_mjcf(ZOO)
    assert [(a.name, a.coordinate, a.limits) for a in made.actuators] == [
        ("shoulder_2", "shoulder", (-6.0, 3.0)),
        ("motor", "l1", (0.0, 1.0)),
    ]
    home = made.home_values({})
    assert [home[name] for name in ("root_z", "root_e0", "shoulder", "l3")] == [1, 1, 0.1, 0.5]
    without = read_mjcf(re.sub("<keyframe>.*</keyframe>", "", ZOO)).home_values({})
    assert without["shoulder"] == pytest.approx(np.radians(15))
    assert [without[f"root_e{k}"] for k in range(4)] == pytest.approx(np.array([1, 2, 3, 4]) / np.sqrt(30))


@pytest.mark.parametrize("make", [chain, two_bodies, four_bar, slider_crank], ids=lambda make: make.__name__)
def test_round_trip_keeps_the_dynamics(make) -> None:
    made = make()
    document = write_mjcf(made)
    again = read_mjcf(document)
    assert difference(made, document) < 1e-12
    assert difference(again, document) < 1e-12
    assert difference(read_mjcf(write_mjcf(again)), document) < 1e-12


@pytest.mark.parametrize("name", MODELS)
def test_the_catalog_survives_or_says_why_not(name: str) -> None:
    made = MODELS[name]()
    try:
        document = write_mjcf(made)
    except MechanismError as error:
        assert re.search("MuJoCo|has no word", str(error))
        return
    again = read_mjcf(document)
    assert len(again.coordinates) == len(made.coordinates)
    assert difference(again, document, states=1) < 1e-11


LOOPS = """<mujoco>
 <compiler angle="radian"/>
 <option gravity="0 -9.81 0"><flag contact="disable"/></option>
 <worldbody>
  <site name="s0" pos="0.3 0.2 0.1" euler="0.1 0.2 0.3"/><site name="s4" pos="0.3 0.1 0" euler="0.1 0.2 0.3"/>
  <body name="a" pos="0.1 0 0"><joint name="q1" axis="0 0 1" ref="0.3"/><geom size="0.1" pos="0.1 0 0"/>
   <site name="s3" pos="0.2 0.1 0" euler="0.1 0.2 0.3"/>
   <body name="b" pos="0.3 0 0"><joint name="q2" axis="0 1 0"/><geom size="0.1" pos="0.1 0.1 0"/>
    <site name="s1" pos="0.2 0 0" euler="0.5 0 0"/></body></body>
  <body name="c" pos="0 1 0"><joint name="q3" type="slide" axis="1 0 0" ref="-0.2"/><joint name="q4" type="ball"/>
    <geom size="0.2 0.1 0.1" type="box"/><site name="s2" pos="0 0 0.1"/></body>
 </worldbody>
 <tendon><spatial name="rope"><site site="s1"/><site site="s2"/></spatial></tendon>
 <equality>{}</equality>
</mujoco>"""

EQUALITIES = {
    "connect": ('<connect body1="b" body2="c" anchor="0.2 0.1 0"/>', Spherical),
    "connect to the world": ('<connect body1="c" anchor="0.1 0 0.1" solref="0.01 1"/>', Spherical),
    "connect sites": ('<connect site1="s2" site2="s0"/>', Spherical),
    "weld": ('<weld body1="c" body2="b"/>', Weld),
    "weld with a pose": ('<weld body1="a" body2="c" relpose="-0.1 1 0 1 0 0 0" torquescale="2"/>', Weld),
    "weld to the world": ('<weld body1="c" anchor="0 1 0"/>', Weld),
    "weld sites": ('<weld site1="s4" site2="s3"/>', Weld),
    "joint": ('<joint joint1="q1" joint2="q3" polycoef="0.1 0.7"/>', Coupling),
    "one joint": ('<joint joint1="q1" polycoef="0.1"/>', Driver),
    "polynomial": ('<joint joint1="q1" joint2="q2" polycoef="0.1 0.7 -0.3 2 1"/>', Holonomic),
    "tendon": ('<tendon tendon1="rope" polycoef="0.1 0 0 0 0"/>', Distance),
}


@pytest.mark.parametrize("case", EQUALITIES)
def test_equalities_hold_the_same_motions(case: str) -> None:
    """Rows of A and of MuJoCo's constraint Jacobian span the same space, where the constraint is nearly fulfilled."""
    text, kind = EQUALITIES[case]
    document = LOOPS.format(text)
    made = read_mjcf(document)
    parts = [part for part in (*made.loops, *made.constraints) if isinstance(part, kind)]
    assert len(parts) == 1
    model = mujoco.MjModel.from_xml_string(document)
    data = mujoco.MjData(model)
    home = made.home_values({})
    q = np.array([home[name] for name in made.coordinates])
    T = rates_of(made, model, data, q)
    mujoco.mj_forward(model, data)
    theirs = data.efc_J.reshape(-1, model.nv)[: data.ne] @ T
    phi, A = evaluated(made, ("Phi", "A"), q, np.zeros(len(q)))
    norm = np.zeros((1, len(q)))
    norm[0, [made.coordinates.index(f"q4_e{k}") for k in range(4)]] = 1, 0, 0, 0
    ours, theirs = np.vstack([A.reshape(-1, len(q)), norm]), np.vstack([theirs, norm])
    rank = np.linalg.matrix_rank(theirs, 1e-9)
    assert np.linalg.matrix_rank(ours, 1e-9) == np.linalg.matrix_rank(np.vstack([ours, theirs]), 1e-9) == rank > 1
    residual = np.abs(data.efc_pos[: data.ne]).max()
    assert np.abs(phi).max() == pytest.approx(residual, abs=1e-12, rel=0.2)


def test_a_constraint_that_is_not_active_is_left_out() -> None:
    made = read_mjcf(LOOPS.format('<connect body1="b" body2="c" anchor="0 0 0" active="false"/>'))
    assert made.loops == ()


def test_friction_and_armature() -> None:
    made = read_mjcf(LOOPS.format("").replace('axis="0 1 0"', 'axis="0 1 0" frictionloss="0.4" armature="0.03"'))
    assert made.loads == (
        Energy("q2 armature", 0, "0.03*q2_dot^2/2"),
        Friction("q2 friction", "q2", 0.4),
    )


def test_loops_that_are_written_are_read() -> None:
    """Revolute loops become two connects, rods tendons of a fixed length, springs tendons."""
    made = read_mjcf(LOOPS.format(EQUALITIES["tendon"][0]))
    again = read_mjcf(write_mjcf(made))
    assert again.loops == made.loops
    spring = two_bodies()
    assert [type(load) for load in read_mjcf(write_mjcf(chain())).loads].count(Spring) == 2
    assert spring.loops == ()


#: what is put in place of what in ZOO, and what the message says
REFUSED = {
    "gravcomp": ('<body name="plate"', '<body name="plate" gravcomp="1"', r"<body name='plate'>: mocap and gravcomp"),
    "unknown element": (
        "<light",
        '<frame pos="1 0 0"/><light',
        r"line 12, <frame>: <frame> is not read here: .*mj_saveLastXML",
    ),
    "include": ("<light", '<include file="x"/><light', "<include>"),
    "plugin": ("<light", "<plugin/><light", "<plugin> is not known here"),
    "unknown attribute": ('name="l2"', 'name="l2" wobble="1"', r"line 30, <joint name='l2'>: the attribute 'wobble'"),
    "a stop": ('name="l2"', 'name="l2" range="-1 1"', r"<joint name='l2'>: stops are not modelled"),
    "ball spring": ('damping="0"/>', 'damping="0.1"/>', r"<joint name='knuckle'>: damping of a ball joint"),
    "springdamper": ('name="l2"', 'name="l2" springdamper="1 1"', "springdamper is not known here"),
    "touching": ('contype="0" conaffinity="0"', "", r"<geom>: it can touch .*of line \d+, and contact is not modelled"),
    "pair": ("<sensor>", '<contact><pair geom1="a" geom2="b"/></contact><sensor>', "<pair>: contact is not modelled"),
    "mesh with density": (
        '<geom size="0.1" pos="0.4 0 0" mass="0.7"/>',
        '<geom type="mesh" mesh="m"/>',
        "mass of a mesh",
    ),
    "shell": ('<geom size="0.1"', '<geom shellinertia="true" size="0.1"', "shellinertia"),
    "position servo": ("<general joint", "<position joint", "<position> acts by a law of its own"),
    "muscle": ("<general joint", '<general dyntype="filter" joint', "dyntype='filter'"),
    "motor on a site": ('<motor name="shoulder" joint="shoulder"', '<motor site="tip"', "the attribute 'site'"),
    "gear of six": ('gear="-3"', 'gear="1 2"', "only the first number of gear"),
    "slack tendon": ('springlength="0.4"', 'springlength="0.2 0.4"', "slack between two lengths"),
    "long tendon": ('<site site="tip"/>', '<site site="tip"/><site site="end"/>', "straight line between two sites"),
    "wind": ('gravity="0.1', 'density="1.2" gravity="0.1', "<option>: density: there is no air"),
    "switched off": ("<default>\n", '<option><flag passive="disable"/></option><default>\n', "passive='disable'"),
    "bound": ('eulerseq="XYz"', 'eulerseq="XYz" boundmass="0.1"', "boundmass changes masses"),
    "total": ('eulerseq="XYz"', 'eulerseq="XYz" settotalmass="1"', "settotalmass"),
    "balance": ('eulerseq="XYz"', 'eulerseq="XYz" balanceinertia="true"', "balanceinertia"),
    "eulerseq": ('eulerseq="XYz"', 'eulerseq="XYw"', "eulerseq is three of"),
    "angle": ('angle="degree"', 'angle="turn"', "angle is 'turn'; choose one of degree, radian"),
    "two orientations": ('quat="1 2 3 4"', 'quat="1 2 3 4" euler="0 0 0"', "two orientations"),
    "zero quaternion": ('quat="1 2 3 4"', 'quat="0 0 0 0"', "quat must not be zero"),
    "three numbers": ('quat="1 2 3 4"', 'quat="1 2 3"', "quat has 3 numbers where 4 belong"),
    "no number": ('quat="1 2 3 4"', 'quat="1 2 3 x"', "must hold finite numbers, not 'x'"),
    "not finite": ('quat="1 2 3 4"', 'quat="1 2 3 nan"', "must hold finite numbers, not 'nan'"),
    "class": ('class="fine" axis', 'class="find" axis', "no class 'find'"),
    "site": ('<site site="peg"/>', '<site site="pig"/>', "no site 'pig'"),
    "joint": ('joint="l1" forcerange', 'joint="l9" forcerange', "no hinge or slide 'l9'"),
    "two bodies": ('<body name="last"', '<body name="plate"', "another body of this name"),
    "free inside": (
        '<joint name="knuckle" type="ball"',
        '<joint name="knuckle" type="free"',
        "free joint stands alone",
    ),
    "keyframe": ('qpos="0 0 1', 'qpos="0 1', "qpos has 15 numbers where 16 belong"),
    "size": ('size="0.1 0.2 0.3" euler', 'size="0.1 0.2" euler', "a box needs 3 positive sizes"),
    "mass": ('mass="0.5" diag', 'mass="-0.5" diag', "'last' would have the mass"),
    "doctype": ("<mujoco model", '<!DOCTYPE a [<!ENTITY b "c">]><mujoco model', "line 1: a DOCTYPE is not allowed"),
    "not closed": ("</mujoco>", "", "this is no XML"),
    "empty": (re.search("<worldbody>.*</worldbody>", ZOO, re.S)[0], "<worldbody/>", "there is no body in it"),
    "mocap": ('<body name="plate"', '<body name="plate" mocap="true"', "mocap"),
    "inertials": ('<inertial pos="0.1 0 0"', '<inertial mass="1"/><inertial pos="0.1 0 0"', "one <inertial>"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_known_is_refused(case: str) -> None:
    old, new, message = REFUSED[case]
    assert old in ZOO
    with pytest.raises((ModelFileError, MechanismError, InputError), match=message):
        read_mjcf(ZOO.replace(old, new, 1))


def test_contacts_and_stops_may_be_left_out_on_request() -> None:
    document = ZOO.replace('contype="0" conaffinity="0"', "").replace('name="l2"', 'name="l2" range="-1 1"')
    assert read_model(document, ignore=("contact", "limit")) == read_mjcf(ZOO)
    with pytest.raises(InputError, match="nothing to ignore called 'gravity'"):
        read_model(document, ignore="gravity")


def test_contact_rules_are_those_of_mujoco() -> None:
    pendulum = """<mujoco><worldbody>{}<body name="a"><joint name="q1"/><geom size="0.1"/>
      <body name="b" pos="1 0 0"><joint name="q2"/><geom size="0.1"/>{}</body></body></worldbody>{}</mujoco>"""
    third = '<body name="c" pos="1 0 0"><joint name="q3"/><geom size="0.1"/></body>'
    assert read_mjcf(pendulum.format("", "", "")).coordinates == ("q1", "q2")
    exclude = '<contact><exclude body1="a" body2="c"/></contact>'
    assert len(read_mjcf(pendulum.format("", third, exclude)).coordinates) == 3
    for touching in (pendulum.format("", third, ""), pendulum.format('<geom type="plane" size="1 1 1"/>', "", "")):
        with pytest.raises(ModelFileError, match="it can touch"):
            read_mjcf(touching)


def test_names_that_are_no_symbols() -> None:
    made = read_mjcf(
        """<mujoco><worldbody><body name="1-arm"><joint name="t"/><joint name="a/b"/><joint name="a.b"/>
        <geom size="0.1"/></body><body name="ground" pos="9 0 0"><joint/><geom size="0.1" contype="0" conaffinity="0"/>
        </body></worldbody></mujoco>"""
    )
    assert made.coordinates == ("t_2", "a_b", "a_b_2", "ground_2_hinge")
    assert made.bodies[-1].name == "ground_2"


def test_an_unknown_body_of_a_constraint_is_named() -> None:
    with pytest.raises(
        (ModelFileError, UnknownName), match="<connect>: body2: there is no body 'd'; known: world, a, b, c"
    ):
        read_mjcf(LOOPS.format('<connect body1="b" body2="d" anchor="0 0 0"/>'))
