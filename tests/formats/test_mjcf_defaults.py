"""What a file says by MuJoCo's defaults, and what two elements of one name would hide."""

from __future__ import annotations

import time

import pytest

import nullbody
from nullbody import InputError, MechanismError, ModelFileError
from nullbody.formats import read_mjcf, write_mjcf
from nullbody.mechanism import Coupling, Mechanism, MechanismBuilder
from tests.formats.dynamics import difference

ARM = """<mujoco><compiler {compiler}/><default>{defaults}</default><worldbody>
  <site name="w"/><body name="a"><joint name="q1" axis="0 1 0"/><geom name="g" size="0.1" pos="0.1 0 0"/>
   <body name="b" pos="1 0 0"><joint name="q2" axis="0 1 0" ref="10"/><geom size="0.1" pos="0.1 0 0"/>
    <site name="s"/></body></body>{world}</worldbody>
 <tendon><spatial name="t"><site site="w"/><site site="s"/></spatial></tendon>
 <equality>{equality}</equality><actuator>{actuator}</actuator></mujoco>"""


def arm(**parts: str) -> str:
    return ARM.format(**{"compiler": "", "defaults": "", "world": "", "equality": "", "actuator": "", **parts})


@pytest.mark.parametrize("polycoef", ['polycoef="0.1"', 'polycoef="0.1 0.5"', ""])
def test_a_coupling_has_the_slope_1_unless_it_gives_another(polycoef: str) -> None:
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    document = arm(equality=f'<joint joint1="q1" joint2="q2" {polycoef}/>')
    made = read_mjcf(document)
    assert [part.ratio for part in made.constraints if isinstance(part, Coupling)] == [0.5 if "0.5" in polycoef else 1]
    assert difference(made, document) < 1e-12


LAWS = ['gainprm="5"', 'dyntype="integrator"', 'biastype="affine"', 'gaintype="affine"']


@pytest.mark.parametrize("law", LAWS)
def test_a_motor_has_a_law_of_its_own_whatever_the_default_is(law: str) -> None:
    document = arm(defaults=f'<general {law} ctrlrange="-1 2" gear="3"/>', actuator='<motor joint="q1"/>')
    assert read_mjcf(document).actuators[0].limits == (-3, 6)


def test_a_motor_among_the_defaults_resets_the_law_and_a_position_brings_its_own() -> None:
    general = '<general joint="q1" ctrlrange="-1 2"/>'
    assert read_mjcf(arm(defaults='<general gainprm="5"/><motor/>', actuator=general)).actuators[0].limits == (-1, 2)
    with pytest.raises(ModelFileError, match="biastype='position' is a law of its own"):
        read_mjcf(arm(defaults="<position/>", actuator=general))


FREE = '<body name="f" pos="0 9 0">{}<geom size="0.1" contype="0" conaffinity="0"/>{}</body>'
REFUSED = {
    "torquescale": ({"equality": '<weld body1="b" torquescale="0"/>'}, "<weld>: a torquescale of 0"),
    "align": ({"world": FREE.format('<freejoint align="true"/>', "")}, "<freejoint>: align, or alignfree"),
    "alignfree": (
        {"compiler": 'alignfree="true"', "world": FREE.format('<joint type="free"/>', "")},
        "<joint>: align, or alignfree",
    ),
    "law of a motor": ({"actuator": '<motor joint="q1" gainprm="5"/>'}, "a <motor> has no gainprm"),
    "joint": ({"world": '<body><joint name="q1" type="ball"/></body>'}, "<joint name='q1'>: there is another joint"),
    "free joint": ({"world": '<body><freejoint name="q1"/></body>'}, "<freejoint name='q1'>: there is another joint"),
    "site": ({"world": '<site name="s"/>'}, "<site name='s'>: there is another site of this name"),
    "geom": ({"world": '<geom name="g" size="1"/>'}, "<geom name='g'>: there is another geom of this name"),
    "body": ({"world": '<body name="b"/>'}, "<body name='b'>: there is another body of this name"),
    "equality": ({"equality": 2 * '<joint name="e" joint1="q1"/>'}, "there is another equality of this name"),
    "actuator": ({"actuator": 2 * '<motor name="m" joint="q1"/>'}, "there is another actuator of this name"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_would_be_read_wrongly_is_refused(case: str) -> None:
    parts, message = REFUSED[case]
    with pytest.raises(ModelFileError, match=message):
        read_mjcf(arm(**parts))


def test_the_frame_of_a_free_body_stays_where_mujoco_leaves_it() -> None:
    inner = '<body><joint/><geom size="0.1" contype="0" conaffinity="0"/></body>'
    for word, inside in (("false", ""), ("auto", inner)):
        made = read_mjcf(arm(compiler='alignfree="true"', world=FREE.format(f'<freejoint align="{word}"/>', inside)))
        assert "f_free_e0" in made.coordinates


def test_bodies_without_a_name() -> None:
    two = """<mujoco><worldbody><body><joint/><geom size="0.1"/></body><body name="body1"><joint/><geom size="0.1"/>
      </body></worldbody><contact><exclude body1="{}" body2="body1"/></contact></mujoco>"""
    assert [body.name for body in read_mjcf(two.format("world"), ignore="contact").bodies] == ["body1", "body1_2"]
    with pytest.raises(ModelFileError, match="it can touch"):
        read_mjcf(two.format("world"))
    for wrong in ("", "b"):
        with pytest.raises(ModelFileError, match=f"<exclude>: there is no body '{wrong}'"):
            read_mjcf(two.format(wrong))


def test_a_tendon_without_a_name_hides_none() -> None:
    unnamed = '<spatial stiffness="1"><site site="w"/><site site="w"/></spatial>'
    document = arm(equality='<tendon tendon1="tendon2"/>').replace('"t"', '"tendon2"')
    made = read_mjcf(document.replace("</spatial>", f"</spatial>{unnamed}"))
    assert [(loop.parent, loop.child) for loop in made.loops] == [("ground", "b")]


@pytest.mark.parametrize("part", ["<!---->", "<?a?>", " ", "\n", "<!-- a -->\n"])
def test_what_stands_before_the_root_is_skipped_in_linear_time(part: str) -> None:
    began = time.perf_counter()
    with pytest.raises(ModelFileError):
        nullbody.read_model("<?a?>" + part * 20000 + "x")
    assert time.perf_counter() - began < 10  # a bound against what never ends, not a measurement
    assert nullbody.read_model("<?a?>" + part * 20000 + "<!-- <robot> -->" + arm()).coordinates == ("q1", "q2")


@pytest.mark.parametrize("options", [{"x": 1}, {"loops": ()}, {"ignore": 3}, {"ignore": None}, {"ignore": [[]]}])
def test_options_that_make_no_sense(options: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"an MJCF file takes no option|ignore is a list|nothing to ignore"):
        nullbody.read_model(arm(), **options)


def line(count: int) -> MechanismBuilder:
    """A chain of rods."""
    builder = MechanismBuilder("line")
    for k in range(count):
        builder.rod(f"b{k}", 1, 0.5)
        builder.revolute(f"q{k}", f"b{k - 1}" if k else "ground", f"b{k}", at=(0.5, 0, 0))
    return builder


def crossed(first: str, second: str) -> Mechanism:
    """Two loops and a spring, with names that the helpers of a revolute loop would also like to have."""
    builder = line(3)
    builder.spherical(first, "ground", "b0", at=(0.5, 0, 0), loop=True)
    builder.revolute(second, "ground", "b2", at=(1.5, 0, 0), loop=True)
    builder.distance("rod", "ground", "b1", 1)
    builder.spring("rod", "ground", "b2", 1, 1)
    builder.spring("rod_spring", "ground", "b2", 1, 1)
    return builder.build()


@pytest.mark.parametrize("names", [("j_axis", "j"), ("j_a", "j"), ("j_axis_a", "j")])
def test_names_that_are_written_are_unique(names: tuple[str, str]) -> None:
    made = crossed(*names)
    again = read_mjcf(write_mjcf(made))
    assert len(again.loops) == len(made.loops) + 1  # a revolute loop becomes two
    assert {loop.name for loop in made.loops} <= {loop.name for loop in again.loops}


def test_what_cannot_be_written_is_refused() -> None:
    with pytest.raises(MechanismError, match="'b496' is number 497 of a chain; MuJoCo reads no more than 496"):
        write_mjcf(line(1200).build())
    quick = line(1)
    quick.friction("rubbing", "q0", 1, 0, 0.01)
    with pytest.raises(MechanismError, match=r"friction 'rubbing' is smooth below speed = 0.01"):
        write_mjcf(quick.build())
    odd = MechanismBuilder("a\x00b")
    odd.rod("arm", 1, 0.5)
    odd.revolute("q", "ground", "arm")
    with pytest.raises(MechanismError, match="cannot stand in XML"):
        write_mjcf(odd.build())
