"""URDF that is read moves as in Pinocchio; loops come from a list; mistakes are named with element and line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nullbody
from nullbody import ExpressionError, MechanismError, ModelFileError, UnknownName
from nullbody.formats import read_urdf
from nullbody.mechanism import Coupling, FreeQuaternion, Friction, Planar, Revolute, Spherical, Weld
from tests.formats.dynamics import evaluated

ARM = """<?xml version="1.0"?>
<robot name="arm">
 <material name="red"><color rgba="1 0 0 1"/></material>
 <link name="base_link"/>
 <link name="l1"><inertial><origin xyz="0.1 0.2 0.3" rpy="0.1 0.2 0.3"/><mass value="2"/>
  <inertia ixx="0.3" iyy="0.4" izz="0.5" ixy="0.02" ixz="0.03" iyz="-0.01"/></inertial>
  <visual><geometry><box size="1 1 1"/></geometry></visual></link>
 <link name="l2"><inertial><mass value="1.5"/><inertia ixx="0.1" iyy="0.15" izz="0.2"/></inertial></link>
 <link name="l3"><inertial><origin xyz="0 0 0.2"/><mass value="0.5"/><inertia ixx="0.01" iyy="0.015" izz="0.02" ixy="0"
   ixz="0" iyz="0"/></inertial></link>
 <link name="tool"><inertial><mass value="0.1"/><inertia ixx="0.01" iyy="0.015" izz="0.02" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
 <joint name="j1" type="revolute"><parent link="base_link"/><child link="l1"/>
  <origin xyz="0 0 0.5" rpy="1.5707963267948966 0 0.3"/><axis xyz="0 0.6 0.8"/>
  <limit lower="-1" upper="1" effort="3" velocity="1"/><dynamics damping="0.4" friction="0"/></joint>
 <joint name="j2" type="prismatic"><parent link="l1"/><child link="l2"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="3" velocity="1"/></joint>
 <joint name="j3" type="continuous"><parent link="l2"/><child link="l3"/><origin xyz="0.1 0.4 0" rpy="0 0.7 0"/></joint>
 <joint name="j4" type="fixed"><parent link="l3"/><child link="tool"/><origin xyz="0 0.4 0" rpy="0 0.7 0"/></joint>
</robot>"""

PIN = {
    "name": "pin",
    "type": "spherical",
    "parent": "tool",
    "child": "base_link",
    "at": [0, 0, "0.3"],
    "on": [0.5, 0, 1],
}


def test_what_is_read_moves_as_in_pinocchio() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="Pinocchio is not installed: pip install pin")
    made = read_urdf(ARM)
    full = ARM.replace(
        '<inertia ixx="0.1" iyy="0.15" izz="0.2"/>', '<inertia ixx="0.1" iyy="0.15" izz="0.2" ixy="0" ixz="0" iyz="0"/>'
    )
    model = pinocchio.buildModelFromXML(full)
    data = model.createData()
    generator = np.random.default_rng(0)
    joints = [model.joints[model.getJointId(name)] for name in made.coordinates]
    at = [joint.idx_v for joint in joints]
    for _ in range(3):
        q, q_dot = generator.normal(size=(2, 3))
        placed, rates = pinocchio.neutral(model), np.zeros(3)
        rates[at] = q_dot
        for joint, angle in zip(joints, q, strict=True):
            placed[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(angle), np.sin(angle)] if joint.nq == 2 else [angle]
        M, h = evaluated(made, ("M", "h"), q, q_dot)
        theirs = np.triu(pinocchio.crba(model, data, placed))
        theirs = (theirs + np.triu(theirs, 1).T)[np.ix_(at, at)]
        assert np.abs(M.reshape(3, 3) - theirs).max() < 1e-14
        bias = pinocchio.nle(model, data, placed, rates)[at] + np.array([0.4, 0, 0]) * q_dot
        assert np.abs(h - bias).max() < 1e-13


def test_loops_come_from_a_list_or_a_mapping(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    made = nullbody.read_model(path, loops=[PIN], actuators=["j1"])
    (loop,) = made.loops
    assert isinstance(loop, Spherical)
    assert (loop.parent, loop.child, loop.at.position, loop.on.position) == (
        "tool",
        "base_link",
        (0, 0, "0.3"),
        (0.5, 0, 1),
    )
    assert [(a.name, a.coordinate) for a in made.actuators] == [("u_j1", "j1")]
    mapping = {"pin": {key: value for key, value in PIN.items() if key != "name"}}
    assert read_urdf(ARM, loops=mapping, actuators=["j1"]) == made
    rod = {"rod": {"type": "distance", "parent": "tool", "child": "l1", "length": 0.5}}
    assert len(read_urdf(ARM, loops=rod).loops) == 1


def test_a_four_bar_with_its_loop_runs() -> None:
    """Links of 0.2, 0.5, 0.4 on a base of 0.6 m: the angle of the rocker in closed form."""
    inertia = '<mass value="1"/><inertia ixx="0.001" iyy="0.01" izz="0.01"/>'
    link = f'<link name="{{0}}"><inertial><origin xyz="{{1}} 0 0"/>{inertia}</inertial></link>'
    joint = (
        '<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{2}"/>'
        '<origin xyz="{3} 0 0"/><axis xyz="0 0 1"/></joint>'
    )
    text = "<robot name='four_bar'><link name='base'/>"
    text += "".join(link.format(*x) for x in (("crank", 0.1), ("coupler", 0.25), ("rocker", 0.2)))
    text += "".join(
        joint.format(*x)
        for x in (("q1", "base", "crank", 0), ("q2", "crank", "coupler", 0.2), ("q3", "base", "rocker", 0.6))
    )
    pin = {"type": "revolute", "parent": "coupler", "child": "rocker", "at": [0.5, 0, 0], "on": [0.4, 0, 0]}
    made = read_urdf(text + "</robot>", loops={"pin": pin}, actuators=["q1"])
    model = nullbody.build(nullbody.derive(made))
    state = nullbody.assemble(model, {"q1": 1.3}, guess={"q1": 1.3, "q2": -1.0, "q3": 1.7})
    x, y = 0.2 * np.cos(1.3) - 0.6, 0.2 * np.sin(1.3)
    r = np.hypot(x, y)
    wanted = np.arctan2(y, x) - np.arccos((0.4**2 + r**2 - 0.5**2) / (2 * 0.4 * r))
    assert state["q3"] == pytest.approx(wanted, abs=1e-12)


def test_other_joints_friction_and_mimic() -> None:
    text = ARM.replace('type="fixed"', 'type="planar"').replace('type="prismatic"', 'type="floating"')
    text = text.replace('friction="0"', 'friction="0.2"')
    more = (
        '<link name="x-1"/><joint name="j 5" type="revolute"><parent link="tool"/><child link="x-1"/>'
        '<mimic joint="j1" multiplier="-2" offset="0.1"/></joint></robot>'
    )
    made = read_urdf(text.replace("</robot>", more))
    assert [type(joint) for joint in made.joints] == [Weld, Revolute, FreeQuaternion, Revolute, Planar, Revolute]
    assert made.constraints == (Coupling("j_5 mimics j1", "j_5", "j1", -2.0, 0.1),)
    assert made.loads[1] == Friction("j1 friction", "j1", 0.2)


WRONG = [
    ('<?xml version="1.0"?>', '<!DOCTYPE a [<!ENTITY b "c">]>', ModelFileError, "line 1: a DOCTYPE is not allowed"),
    (
        'type="fixed"',
        'type="ball"',
        ModelFileError,
        "line 19, <joint name='j4'>: type is 'ball'; choose one of revolute",
    ),
    ('child link="tool"', 'child link="tol"', ModelFileError, "<child>: there is no link 'tol'; known: base_link, l1"),
    ('<child link="tool"/>', "", ModelFileError, "<joint name='j4'>: it needs one <child>, not 0"),
    ('mass value="2"', 'mass value="two"', ModelFileError, "line 5, <mass>: value must hold finite numbers, not 'two'"),
    ('<mass value="2"/>', "", ModelFileError, "<inertial>: it needs one <mass>, not 0"),
    ('mass value="2"', 'mass value="-2"', nullbody.ParameterError, "'l1' would have the mass -2 kg"),
    ('ixx="0.3"', 'ixx="3"', nullbody.ParameterError, "'l1' would have the principal moments"),
    ('<link name="l3">', '<link name="l2">', ModelFileError, "<link name='l2'>: there is another link of this name"),
    ('<origin xyz="0 0 0.2"/>', "<origin/><origin/>", ModelFileError, "<inertial> has one <origin>, not 2"),
    ('<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><axis/>', ModelFileError, "<joint name='j2'> has one <axis>, not 2"),
    ('<link name="l2">', '<link name="l2"><inertial/>', ModelFileError, "<link name='l2'> has one <inertial>, not 2"),
    ('name="j2"', 'name="j1"', ModelFileError, "line 16, <joint name='j1'>: there is another joint of this name"),
    ('xyz="0 0.6 0.8"', 'xyz="0 0 0"', MechanismError, "line 13, <joint name='j1'>: .*points nowhere"),
    ("<material", "<xacro/><material", ModelFileError, "<xacro> is not known here; expand xacro files first"),
    ('child link="l1"', 'child link="l3"', MechanismError, "closes a circle|exactly one|not connected"),
    ('type="revolute"', 'type="planar"', ModelFileError, "line 15, <dynamics>: damping and friction of a planar joint"),
    ("</robot>", "", ModelFileError, "this is no XML: no element found"),
    ("<robot", "<robots", ModelFileError, "no XML|mismatched|begins with"),
]


@pytest.mark.parametrize(("old", "new", "error", "message"), WRONG)
def test_mistakes_are_named(old: str, new: str, error: type[Exception], message: str) -> None:
    assert old in ARM
    with pytest.raises(error, match=message):
        read_urdf(ARM.replace(old, new, 1))


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            {"type": "sphericl"},
            ModelFileError,
            "loops, joints.pin: there is no type 'sphericl'; did you mean 'spherical'",
        ),
        ({"parent": "toool"}, UnknownName, "joint 'pin': .*mean 'tool'"),
        ({"at": ["exp(1)", 0, 0]}, ExpressionError, "loops, joints.pin.at"),
        ({"name": 3}, ModelFileError, "a loop needs a name"),
        ({"axis": "z"}, ModelFileError, "there is no key 'axis'"),
    ],
)
def test_mistakes_in_loops_are_named(change: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        read_urdf(ARM, loops=[{**PIN, **change}])
    for loops in ([3], [PIN, PIN]):
        with pytest.raises(ModelFileError, match="loop"):
            read_urdf(ARM, loops=loops)  # type: ignore[arg-type]


def test_unknown_options_and_actuators() -> None:
    with pytest.raises(UnknownName, match=r"mean 'j1'|no coordinate 'j9'"):
        read_urdf(ARM, actuators=["j9"])
    with pytest.raises(ModelFileError, match="a YAML file takes no option"):
        nullbody.read_model("name: x\n", loops=[])


LISTS = "actuators is a list of names|loops are a list|expected a text|no option 'x'; it takes: loops, actuators"


@pytest.mark.parametrize(
    "options",
    [
        *({"x": 1}, {"loops": None}, {"loops": 3}, {"loops": "pin"}, {"loops": [{**PIN, "parent": []}]}),
        *({"actuators": None}, {"actuators": 3}, {"actuators": "j1"}, {"actuators": [[]]}),
    ],
)
def test_options_that_are_no_lists(options) -> None:
    with pytest.raises(nullbody.InputError, match=LISTS):
        nullbody.read_model(ARM, **options)
