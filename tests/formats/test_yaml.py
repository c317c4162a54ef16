"""YAML model files: what is written is read again, and every mistake is named with file, line and place."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

import nullbody
from nullbody import ExpressionError, MechanismError, ModelFileError, UnknownName
from nullbody.catalog import MODELS
from nullbody.formats import read_yaml, write_yaml
from nullbody.formats.document import LARGEST
from nullbody.formats.schema import SECTIONS, json_schema
from nullbody.mechanism import Body, Mechanism, MechanismBuilder, Parameter, Revolute
from tests.architecture.source import SRC
from tests.formats.zoo import chain, everything

CRANK = """\
nullbody: 1
name: crank
gravity: [0, 0, -9.81]
parameters:
  r: {default: 0.1, unit: m, meaning: crank}
  l: 1e-1
bodies:
  crank: {type: rod, mass: 0.2, length: r}
  rod: {type: rod, mass: 0.4, length: l, radius: 0.01}
  slider: {mass: 0.5}
joints:
  shaft: {type: revolute, parent: ground, child: crank, axis: x}
  ball: {type: spherical, parent: crank, child: rod, at: [0, r, 0]}
  fork: {type: universal, parent: rod, child: slider, at: [l, 0, 0]}
  rail: {type: prismatic, parent: ground, child: slider, at: {position: [0, 0, l], rotations: [{axis: x, degrees: 30}]},
         axis: [1, 1, 0], names: s}
actuators:
  torque: {coordinate: shaft, limits: [-1, r]}
home: {shaft: 0.3}
"""


@pytest.mark.parametrize("name", MODELS)
def test_every_mechanism_of_the_catalog_is_read_again(name: str) -> None:
    made = MODELS[name]()
    assert read_yaml(write_yaml(made)) == made


@pytest.mark.parametrize("make", [chain, everything])
def test_every_feature_is_read_again(make) -> None:
    made = make()
    text = write_yaml(made)
    again = read_yaml(text)
    assert again == made
    assert list(again.home) == list(made.home)
    assert write_yaml(again) == text


def test_the_zoo_has_every_method_of_the_schema() -> None:
    text = write_yaml(everything())
    written = set(SECTIONS["joints"] + SECTIONS["constraints"] + SECTIONS["loads"])
    made_of_others = {"screw", "gear", "rack", "damper", "coordinate_damper"}
    assert {method for method in written if f"type: {method}," not in text} == made_of_others


def test_a_file_says_what_a_builder_is_told() -> None:
    b = MechanismBuilder("crank", gravity=(0, 0, -9.81))
    b.parameter("r", 0.1, "m", "crank")
    b.parameter("l", 0.1)
    b.rod("crank", 0.2, "r")
    b.rod("rod", 0.4, "l", radius=0.01)
    b.point_mass("slider", 0.5)
    b.revolute("shaft", "ground", "crank", axis="x")
    b.spherical("ball", "crank", "rod", at=(0, "r", 0))
    b.universal("fork", "rod", "slider", at=("l", 0, 0))
    frame = nullbody.mechanism.Placement((0, 0, "l"), (nullbody.mechanism.Rotation("x", 30),))
    b.prismatic("rail", "ground", "slider", at=frame, axis=(1, 1, 0), names="s")
    b.actuator("torque", "shaft", (-1, "r"))
    b.home(shaft=0.3)
    assert read_yaml(CRANK) == b.build()


def test_from_a_path(tmp_path: Path) -> None:
    path = tmp_path / "crank.yaml"
    path.write_text(CRANK, encoding="utf-8")
    assert nullbody.read_model(path) == nullbody.read_model(str(path)) == read_yaml(CRANK)


def test_published_schema_is_what_is_read() -> None:
    published = (SRC / "formats" / "schema.json").read_text(encoding="utf-8")
    assert json.loads(published) == json_schema(), "make regenerate rewrites it"


@pytest.mark.parametrize(
    "text", ["on", "yes", "1e-3", "0x10", "1_000", "12:30", "2020-01-01", "null", "~", "true", "=", "<<"]
)
def test_names_and_texts_that_look_like_something_else(text: str) -> None:
    made = Mechanism(
        text,
        (Body("a", 1, (0, 0, 0), (1, 1, 1)),),
        (Revolute(text, "ground", "a", ("q",)),),
        parameters=(Parameter("p", 1.0, "", text),),
    )
    assert read_yaml(write_yaml(made)) == made


GRAMMAR = {
    "__import__('os').system('true')": "line 8, bodies.crank.mass: unexpected character",
    "().__class__": "line 8, bodies.crank.mass",
    "exp(r)": "line 8, bodies.crank.mass",
    "r if r else 1": "line 8, bodies.crank.mass",
    "2**99999999": "line 8, bodies.crank.mass",
    "r +": "line 8, bodies.crank.mass: the expression ends too early",
    ".inf": "line 8, bodies.crank.mass",
    "'" + "(" * 500 + "'": "line 8, bodies.crank.mass: too deeply nested",
}


@pytest.mark.parametrize("text", GRAMMAR)
def test_only_the_small_grammar_is_read(text: str) -> None:
    quoted = text if text.startswith("'") else json.dumps(text)
    with pytest.raises(ExpressionError, match=GRAMMAR[text]):
        read_yaml(CRANK.replace("mass: 0.2", f"mass: {quoted}"))


#: what is replaced, by what, error, and what its message says
WRONG = [
    (
        "mass: 0.2",
        "masss: 0.2",
        ModelFileError,
        "text, line 8, bodies.crank.masss: there is no key 'masss' here; did you mean 'mass'",
    ),
    ("mass: 0.4, ", "", ModelFileError, "line 9, bodies.rod: the key 'mass' is missing"),
    (
        "type: universal",
        "type: univ",
        ModelFileError,
        "line 14, joints.fork: there is no type 'univ'; did you mean 'universal'",
    ),
    ("type: prismatic, ", "", ModelFileError, "joints.rail: the key 'type' is missing; choose one of 'revolute'"),
    ("axis: x}\n", "axis: w}\n", ModelFileError, "line 12, joints.shaft.axis: 'w' is not one of"),
    ("[l, 0, 0]", "[l, 0]", ModelFileError, "joints.fork.at: it has 2 entries where 3 belong"),
    ("degrees: 30", "degrees: r", ModelFileError, "expected a number of degrees .expressions are in radians., not 'r'"),
    ("degrees: 30", "radians: 1, degrees: 3", ModelFileError, "joints.rail.at.rotations.0"),
    ("mass: 0.5", "mass: true", ModelFileError, "bodies.slider.mass: expected a number or an expression, not True"),
    ("mass: 0.5", "mass: ", ModelFileError, "expected a number or an expression, not None"),
    (
        "mass: 0.5",
        "mass: 1e999",
        ModelFileError,
        "line 10, bodies.slider.mass: a number must lie in the range of doubles",
    ),
    ("{mass: 0.5}", "5", ModelFileError, "line 10, bodies.slider: expected a mapping"),
    ("name: crank", "name: 3", ModelFileError, "line 2, name: expected a text .*in quotes.*, not 3"),
    ("name: crank\n", "", ModelFileError, "the key 'name' is missing"),
    ("nullbody: 1", "nullbody: 2", ModelFileError, "line 1, nullbody: 2 is not one of 1"),
    ("  rod: {", "  crank: {", ModelFileError, "line 9, bodies: the key 'crank' is there twice, first in line 8"),
    ("mass: 0.5", "mass: &a 0.5", ModelFileError, "bodies.slider.mass: anchors and aliases"),
    ("mass: 0.5", "mass: *a", ModelFileError, "anchors and aliases|no YAML"),
    ("mass: 0.5", "mass: !!python/object/apply:os.system [ls]", ModelFileError, "tags such as tag:yaml"),
    ("home: {", "- home: {", ModelFileError, "line 19: this is no YAML"),
    ("home:", "---\nhome:", ModelFileError, "another one begins"),
    ("[l, 0, 0]", "[" * 40 + "]" * 40, ModelFileError, "nested more than 24 deep"),
    ("slider: {mass", "1slider: {mass", ModelFileError, "'1slider' cannot be a name"),
    ("limits: [-1, r]", "limits: [1]", ModelFileError, "line 18, actuators.torque.limits: it has 1 entries where 2"),
    ("unit: m,", "unit: mm,", MechanismError, "text, line 5, parameters.r: .*'mm' is no SI unit"),
    ("child: slider, at: [l", "child: slyder, at: [l", UnknownName, "line 14, joints.fork: .*mean 'slider'"),
    ("shaft: 0.3", "shafft: 0.3", UnknownName, "line 19, home.shafft: .*mean 'shaft'"),
    ("mass: 0.5", "mass: R", UnknownName, "line 10, bodies.slider: .*mean 'r'"),
    ("coordinate: shaft", "coordinate: ball", MechanismError, "line 18, actuators.torque: .*has 4 coordinates"),
    ("mass: 0.5", "mass: -0.5", nullbody.ParameterError, "line 10, bodies.slider: body 'slider' would have the mass"),
    ("names: s", "names: [s, u]", MechanismError, "line 15, joints.rail: .*1 coordinates"),
]


@pytest.mark.parametrize(("old", "new", "error", "message"), WRONG)
def test_mistakes_are_named_with_line_and_place(old: str, new: str, error: type[Exception], message: str) -> None:
    assert old in CRANK
    with pytest.raises(error, match=message):
        read_yaml(CRANK.replace(old, new, 1))


def test_the_error_knows_its_place(tmp_path: Path) -> None:
    path = tmp_path / "crank.yaml"
    path.write_text(CRANK.replace("axis: x}", "axis: w}"), encoding="utf-8")
    with pytest.raises(ModelFileError) as caught:
        read_yaml(path)
    assert (caught.value.file, caught.value.place, caught.value.line) == (str(path), "joints.shaft.axis", 12)
    assert str(caught.value).startswith(f"{path}, line 12, joints.shaft.axis: ")


def garbage() -> dict[str, bytes]:
    """Files that are none."""
    lines = "".join(f"a{k}: {k}\n" for k in range(110_000))
    return {
        "empty": b"",
        "blank": b"\n\n# nothing\n",
        "zeros": b"\0" * 1000,
        "noise": os.urandom(10_000_000),
        "short noise": bytes(range(256)) * 100,
        "large text": b"name: x\n" * 1_500_000,
        "many keys": lines.encode(),
        "deep": b"[" * 500_000,
        "deep mapping": b"".join(b" " * k + b"a:\n" for k in range(1000)),
        "laughs": b"a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n",
        "no bodies": b"name: x\n",
        "a number": b"3\n",
        "a list": b"- 1\n- 2\n",
        "another encoding": CRANK.encode("utf-16"),
        "escape": b"name: \x1b[0m\n",
        "json": json.dumps({"name": "x", "extra": 1}).encode(),
        "long line": b"name: " + b"x" * 900_000,
        "a long expression": b"name: x\nbodies: {a: {mass: '" + b"1+" * 300_000 + b"1'}}\n",
    }


@pytest.mark.parametrize("kind", garbage())
@pytest.mark.parametrize("suffix", [".yaml", ".xml", ".urdf"])
def test_garbage_is_refused_within_seconds(kind: str, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"model{suffix}"
    path.write_bytes(garbage()[kind])
    began = time.perf_counter()
    with pytest.raises((ModelFileError, ExpressionError, MechanismError), match=str(path)):
        nullbody.read_model(path)
    assert time.perf_counter() - began < 20  # a bound against what never ends, not a measurement


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    for source in (tmp_path, tmp_path / "none.yaml", "none.yaml", "x" * 5000, "a\0b.yaml"):
        with pytest.raises(ModelFileError, match=r"no such file|cannot be read|this is a directory"):
            nullbody.read_model(source)
    other = tmp_path / "model.json"
    other.write_text("{}")
    with pytest.raises(ModelFileError, match=r"ends in one of \.yaml"):
        nullbody.read_model(other)
    for source in (3, None, b"name: x\n", "name: x\n" + "\ud800"):
        with pytest.raises(ModelFileError):
            nullbody.read_model(source)
    with pytest.raises(ModelFileError, match="more than a model file may have"):
        nullbody.read_model("a\n" + "b" * LARGEST)


def test_a_type_of_ones_own_cannot_be_written() -> None:
    class Mine(Revolute):
        """A joint."""

    made = Mechanism("m", (Body("a", 1, (0, 0, 0), (1, 1, 1)),), (Mine("j", "ground", "a", ("q",)),))
    with pytest.raises(MechanismError, match="'j' is a Mine: a model file knows revolute"):
        write_yaml(made)


def test_an_angle_is_given_once() -> None:
    at = "{rotations: [{axis: x, degrees: 1, radians: 1}]}"
    text = f"name: p\nbodies: {{a: {{mass: 1}}}}\njoints: {{q: {{type: weld, parent: ground, child: a, at: {at}}}}}\n"
    with pytest.raises(ModelFileError, match=r"joints\.q\.at\.rotations\.0: give degrees or radians"):
        nullbody.read_model(text)
    with pytest.raises(ModelFileError, match="this is a directory"):
        nullbody.read_model(Path(__file__).parent)
