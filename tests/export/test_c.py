"""A model as C: compiled, its own test program run, and its safe functions against the Model that refuses the same."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nullbody
from nullbody import Mechanism, Model
from nullbody.errors import InputError, OutputError, SingularityError
from nullbody.export.c import CFolder, cortex_m7_size, write_c
from nullbody.export.c.judge import STATUSES
from nullbody.mechanism import GROUND, Actuator, Body, Parameter, Prismatic
from nullbody.verify import admissible_states
from tests.architecture.source import ROOT
from tests.equations.test_drivers import driven
from tests.mechanisms import tip_mass, two_bodies
from tests.native import compiled, compiler
from tests.verify.hard import SPECIAL

STATUS = {name: k for k, (name, _) in enumerate(STATUSES)}


def awkward() -> Mechanism:
    """Names that C cannot take, or that differ only in what C cannot take."""
    return Mechanism(
        "2 carts */ λ",
        (Body("cart", "int"), Body("other", "int_ + m")),
        (
            Prismatic("rail", GROUND, "cart", ("double",), axis="x"),
            Prismatic("second", "cart", "other", ("while",), axis="x"),
        ),
        actuators=(Actuator("NULL", "double"), Actuator("volatile", "while")),
        parameters=(
            Parameter("int", 2.0, "kg", "a comment that ends */ here"),
            Parameter("int_", 1.0, "kg", "ends with \\"),
            Parameter("m", 0.5, "kg", "λ"),
        ),
    )


CASES: dict[str, Callable[[], Mechanism]] = {
    **{name: nullbody.catalog.MODELS[name] for name in ("three_prs", "four_bar", "delta", "rolling_disc")},
    "driven": lambda: driven(A="-1 + 0.3*t"),  # the time enters, and no freedom is left
    "same_pair": SPECIAL["same_pair"],  # the time enters
    "two_bodies": two_bodies,  # no loop
    "awkward": awkward,
}


@pytest.fixture(scope="module")
def models() -> dict[str, Model]:
    return {name: nullbody.build(nullbody.derive(make())) for name, make in CASES.items()}


def ran(written: CFolder, *options: str) -> subprocess.CompletedProcess[str]:
    """The test program of a folder, compiled and run."""
    program = compiled([written.source, written.test], written.folder / "run", "-O0", *options)
    return subprocess.run([str(program)], capture_output=True, text=True, check=False)


class Library:
    """The safe functions of a folder, called with arrays of double."""

    def __init__(self, model: Model, folder: Path) -> None:
        written = write_c(model, folder, prefix="m")
        self.model = model
        self.library = ctypes.CDLL(str(compiled([written.source], folder / "m.so", "-O0", "-shared", "-fPIC")))
        self.params = (ctypes.c_double * max(1, len(model.values)))()
        self.library.m_default_params(self.params)

    def __call__(self, name: str, *groups: Any, sizes: tuple[int, ...]) -> tuple[int, list[np.ndarray]]:
        arrays = [np.array(group, dtype=float) for group in groups if np.size(group)]
        found = [np.full(size, 7.0) for size in sizes]
        places = [ctypes.c_void_p(array.ctypes.data) for array in (*arrays, *found)]
        return int(self.library[f"m_{name}"](self.params, *places)), found


@pytest.mark.parametrize(
    ("name", "real"),
    [*((name, "double") for name in CASES), *((name, "float") for name in ("three_prs", "rolling_disc", "same_pair"))],
)
def test_test_program_agrees_with_llvm(models: Mapping[str, Model], folder: Path, name: str, real: str) -> None:
    """Every function within its bound; strict compilers find nothing to warn of."""
    ended = ran(write_c(models[name], folder, real=real))
    assert ended.returncode == 0, ended.stdout
    assert "; 0 wrong" in ended.stdout
    distances = [float(x) for x in re.findall(r"([\d.]+) ulp, bound", ended.stdout)]
    assert len(distances) > 10
    assert max(distances) <= 100


def test_dynamics_of_three_prs_are_within_4_ulp(models: Mapping[str, Model], folder: Path) -> None:
    """Of the kernels that fuse multiply-adds and have their own sines; without these the bits are equal (test_c99)."""
    printed = ran(write_c(models["three_prs"], folder), "-O2").stdout
    for result in ("kinematics N", "forward_dynamics q_ddot", "inverse_dynamics u", "reactions lam", "energy T"):
        (distance,) = re.findall(rf"^{result} +([\d.]+) ulp", printed, re.MULTILINE)
        assert float(distance) <= 4, result


def test_planted_sign_errors_fail(models: Mapping[str, Model], folder: Path) -> None:
    """One sum of the forward dynamics made a difference: the test program ends with 1 and names the result."""
    written = write_c(models["three_prs"], folder)
    text = written.source.read_text(encoding="utf-8")
    begin = text.index("\nvoid three_prs_kernel_forward_dynamics(")
    sums = [found.start() for found in re.finditer(r" \+ ", text[begin : text.index("\n}\n", begin)])]
    for place in np.random.default_rng(0).choice(sums, 4, replace=False):
        at = begin + int(place)
        written.source.write_text(text[:at] + " - " + text[at + 3 :], encoding="utf-8")
        ended = ran(written)
        assert ended.returncode == 1, text[at - 60 : at + 40]
        assert re.search(r"^forward_dynamics .*WRONG$", ended.stdout, re.MULTILINE)


def test_planted_status_fails(models: Mapping[str, Model], folder: Path) -> None:
    """A check that lets everything pass is found too."""
    written = write_c(models["four_bar"], folder, prefix="fb")
    text = written.source.read_text(encoding="utf-8")
    blind = text.replace("int good = 1;", "return 1;\n    int good = 1;")
    assert blind != text
    written.source.write_text(blind, encoding="utf-8")
    ended = ran(written)
    assert ended.returncode == 1
    assert "of infinity" in ended.stdout


def test_safe_functions_find_what_the_model_finds(models: Mapping[str, Model], folder: Path) -> None:
    model = models["three_prs"]
    code, random = Library(model, folder), np.random.default_rng(3)
    for state in admissible_states(model, 8, seed=2):
        u, v_dot = random.normal(size=3), random.normal(size=3)
        expected = {
            "velocity": (("q", "v"), [model.velocity(state)]),
            "null_space": (("q", "v"), list(model.null_space(state)[:2])),
            "forward_dynamics": (("q", "v", "u"), [model.forward_dynamics(state, u)]),
            "inverse_dynamics": (("q", "v", "v_dot"), [model.inverse_dynamics(state, v_dot)]),
            "reactions": (("q", "v", "u"), [model.reactions(state, u)]),
            "energy": (("q", "v"), [np.array(x) for x in model.energy(state)]),
        }
        given = {"q": state.q, "v": state.v, "u": u, "v_dot": v_dot}
        for name, (groups, values) in expected.items():
            status, found = code(name, *(given[g] for g in groups), sizes=tuple(np.size(x) for x in values))
            assert status == STATUS["ok"]
            for one, other in zip(found, values, strict=True):
                np.testing.assert_allclose(one, np.ravel(other), rtol=1e-11, atol=1e-11 * np.abs(other).max())


def test_close_finds_what_assemble_finds(models: Mapping[str, Model], folder: Path) -> None:
    model = models["three_prs"]
    code = Library(model, folder)
    start = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6})
    target = nullbody.assemble(model, {"s1": 0.63, "s2": 0.58, "s3": 0.6}, guess=start)
    q = start.q.copy()
    q[model.independent_columns] = target.q[model.independent_columns]
    assert code("check_state", q, sizes=())[0] == STATUS["open_loop"]
    assert code.library.m_close(code.params, ctypes.c_void_p(q.ctypes.data)) == STATUS["ok"]
    np.testing.assert_allclose(q, target.q, atol=1e-13)
    q[model.independent_columns[0]] = kept = 5.0  # out of reach
    assert code.library.m_close(code.params, ctypes.c_void_p(q.ctypes.data)) != STATUS["ok"]
    assert q[model.independent_columns[0]] == kept


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused_and_outputs_stay(
    models: Mapping[str, Model], folder: Path, wrong: float
) -> None:
    model = models["four_bar"]
    code, state = Library(model, folder), admissible_states(model, 1)[0]
    size = len(state.q)
    for group, k in (("q", 0), ("q", size - 1), ("v", 0), ("u", 0)):
        given = {"q": state.q.copy(), "v": state.v.copy(), "u": np.zeros(1)}
        given[group][k] = wrong
        status, (q_ddot,) = code("forward_dynamics", *given.values(), sizes=(size,))
        assert (status, set(q_ddot)) == (STATUS["not_finite"], {7.0})
    code.params[2] = wrong
    assert code("forward_dynamics", state.q, state.v, [0.0], sizes=(size,))[0] == STATUS["not_finite"]


def test_singular_states_are_refused_where_the_model_refuses(folder: Path) -> None:
    """A slider at its dead point does not determine the crank; with two arms stretched out a motion moves no mass."""
    model = nullbody.build(nullbody.derive(nullbody.catalog.mechanism("slider_crank"), independent=("s",)))
    state = model.state({"theta": 0.0, "beta": 0.0, "s": model.parameters["r"] + model.parameters["l"]})
    with pytest.raises(SingularityError, match="independent coordinates"):
        model.forward_dynamics(state, np.zeros(len(model.inputs)))
    (folder / "a").mkdir()
    code, size = Library(model, folder / "a"), len(state.q)
    status, (q_ddot,) = code("forward_dynamics", state.q, state.v, np.zeros(len(model.inputs)), sizes=(size,))
    assert (status, set(q_ddot)) == (STATUS["singular_coordinates"], {7.0})
    assert code("velocity", state.q, state.v, sizes=(size,))[0] == STATUS["singular_coordinates"]

    massless = nullbody.build(nullbody.derive(tip_mass()))
    stretched = massless.state({"q1": 0.3, "q2": 0.0})
    with pytest.raises(SingularityError, match="mass matrix"):
        massless.forward_dynamics(stretched)
    (folder / "b").mkdir()
    code = Library(massless, folder / "b")
    status, (q_ddot,) = code("forward_dynamics", stretched.q, stretched.v, [0.0, 0.0], sizes=(2,))
    assert (status, set(q_ddot)) == (STATUS["singular_mass"], {7.0})


def test_singular_inputs_are_refused(folder: Path) -> None:
    """One input for one freedom, along a coordinate that stands still at the dead point."""
    model = nullbody.build(nullbody.derive(_pushed_slider(), independent=("theta",)))
    code = Library(model, folder)
    straight = model.state({"theta": 0.0, "beta": 0.0, "s": 0.45})
    with pytest.raises(SingularityError, match="cannot drive"):
        model.inverse_dynamics(straight, [1.0])
    status, (u,) = code("inverse_dynamics", straight.q, straight.v, [1.0], sizes=(1,))
    assert (status, set(u)) == (STATUS["singular_inputs"], {7.0})
    bent = nullbody.assemble(model, {"theta": 0.7})
    status, (u,) = code("inverse_dynamics", bent.q, bent.v, [1.0], sizes=(1,))
    assert status == STATUS["ok"]
    np.testing.assert_allclose(u, model.inverse_dynamics(bent, [1.0]), rtol=1e-12)


def _pushed_slider() -> Mechanism:
    return replace(nullbody.catalog.mechanism("slider_crank"), actuators=(Actuator("push", "s"),))


def test_parameters_are_those_of_the_model(models: Mapping[str, Model], folder: Path) -> None:
    """The structure holds the model's values, not the mechanism's; its fields are the parameters' names."""
    model = models["three_prs"].replace(l=0.55, M=3.0)
    code = Library(model, folder)
    assert list(code.params) == list(model.values)
    header = (folder / "m.h").read_text(encoding="utf-8")
    fields = re.findall(r"double (\w+); /\*", header)
    assert fields == list(model.parameters)
    assert "changed parameters: l = 0.55, M = 3.0" in header
    state = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6})
    found = code("forward_dynamics", state.q, state.v, np.ones(3), sizes=(12,))[1][0]
    np.testing.assert_allclose(found, model.forward_dynamics(state, np.ones(3)), atol=1e-11)


def test_awkward_names_stay_apart(models: Mapping[str, Model], folder: Path) -> None:
    header = write_c(models["awkward"], folder).header
    assert header.name.startswith("n_2_carts")
    text = header.read_text(encoding="utf-8")
    assert text.isascii()
    assert re.findall(r"    double (\w+); /\*", text) == ["int_", "int__", "m"]


@pytest.mark.parametrize("options", [["-std=c99", "-pedantic"], ["-std=gnu99"]])
def test_parameters_named_as_macros(folder: Path, options: list[str]) -> None:
    names = ("M_E", "M_NQ", "M_H", "M_LOSS", "DBL_MAX", "FLT_EPSILON", "EOF", "stdin", "HUGE_VALF", "m_params", "p")
    mechanism = Mechanism(
        "m",
        (Body("cart", " + ".join(names)),),
        (Prismatic("rail", GROUND, "cart", ("NQ",), axis="x"),),
        actuators=(Actuator("stdout", "NQ"),),
        parameters=tuple(Parameter(name, 1.0 + k, "kg") for k, name in enumerate(names)),
    )
    done = ran(write_c(nullbody.build(mechanism), folder), *options)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(("name", "prefix"), [("math", "math_"), ("test", "test_"), ("Con", "Con_")])
def test_files_are_not_called_as_headers_targets_or_devices(folder: Path, name: str, prefix: str) -> None:
    model = nullbody.build(replace(two_bodies(), name=name))
    written = write_c(model, folder)
    assert written.prefix == prefix
    done = ran(written, "-I", str(folder))
    assert done.returncode == 0, done.stdout
    with pytest.raises(InputError, match=f"files cannot be called '{name}'.*use '{prefix}'"):
        write_c(model, folder, prefix=name)


def test_float_code_has_no_double(models: Mapping[str, Model], folder: Path) -> None:
    """-Wdouble-promotion and -Wconversion are errors above; here the text: constants, types, functions."""
    text = write_c(models["three_prs"], folder, real="float").source.read_text(encoding="utf-8")
    code = re.sub(r"/\*.*?\*/|\"[^\"]*\"", "", text, flags=re.DOTALL)
    assert re.findall(r"(?<![\w.])\d+\.\d*(?:e[-+]?\d+)?(?![\w.])", code) == []
    assert not re.search(r"\b(double|sin|cos|sqrt)\b", code)


def test_code_is_plain(models: Mapping[str, Model], folder: Path) -> None:
    """No allocation, no variables but const ones, of libm sin, cos and sqrt; values of kernels are declared once."""
    text = write_c(models["three_prs"], folder).source.read_text(encoding="utf-8")
    calls = set(re.findall(r"\b([a-z]\w*)\(", text)) - {"if", "for", "while", "defined", "return"}
    assert {call for call in calls if not call.startswith("three_prs_")} == {"sin", "cos", "sqrt"} & calls
    assert all("const" in line or "(" in line for line in re.findall(r"^ *static .*$", text, re.MULTILINE))
    begin = text.index("\nvoid three_prs_kernel_forward_dynamics(")
    kernel = text[begin : text.index("\n}\n", begin)]
    declared = re.findall(r"const double (t\d+) =", kernel)
    assert len(declared) == len(set(declared)) > 500
    assert not re.search(r"\b(if|for|while|goto)\b|\+\+|\+=", kernel)


def test_control_loop_of_the_docs_compiles(models: Mapping[str, Model], folder: Path) -> None:
    """It is strict C, and holds the platform in place: u of the loop for a state at rest is that of the Model."""
    page = (ROOT / "docs" / "how-to.md").read_text(encoding="utf-8")
    (loop,) = re.findall(r"^```c\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    written = write_c(models["three_prs"], folder, real="float")
    (folder / "loop.c").write_text(loop, encoding="utf-8")
    library = ctypes.CDLL(str(compiled([written.source, folder / "loop.c"], folder / "loop.so", "-shared", "-fPIC")))
    state = nullbody.assemble(models["three_prs"], {"s1": 0.6, "s2": 0.58, "s3": 0.61})
    params, u = (ctypes.c_float * 16)(), np.zeros(3, dtype=np.float32)
    library.three_prs_default_params(params)
    s, still = state.q[models["three_prs"].independent_columns].astype(np.float32), np.zeros(3, dtype=np.float32)
    q = (state.q + 1e-3 * (state.q != 0)).astype(np.float32)  # of the call before
    arrays = [ctypes.c_void_p(array.ctypes.data) for array in (s, still, s, still, still, q, u)]
    assert library.control(params, *arrays) == STATUS["ok"]
    np.testing.assert_allclose(u, models["three_prs"].inverse_dynamics(state, np.zeros(3)), atol=2e-6)


def test_cmake_builds_and_runs_the_test(models: Mapping[str, Model], folder: Path) -> None:
    cmake = shutil.which("cmake", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    if cmake is None:
        pytest.skip("needs cmake")
    write_c(models["four_bar"], folder)
    compiler()  # skips where there is none
    plain = {name: value for name, value in os.environ.items() if name not in ("ARGS", "MAKEFLAGS", "MAKEOVERRIDES")}
    for arguments in (["-B", "build"], ["--build", "build"], ["--build", "build", "--target", "test"]):
        done = subprocess.run([cmake, *arguments], cwd=folder, env=plain, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert "100% tests passed" in done.stdout


def test_size_on_a_cortex_m7(models: Mapping[str, Model], folder: Path) -> None:
    pytest.importorskip("ziglang")
    sizes = {real: cortex_m7_size(write_c(models["three_prs"], folder, real=real)) for real in ("double", "float")}
    for found in sizes.values():
        assert found.ram == 0  # no globals
        assert found.flash > sum(found.functions.values()) > 10_000
        assert "three_prs_forward_dynamics" in found.functions
    assert sizes["float"].flash < 0.75 * sizes["double"].flash


def test_equations_and_their_model_are_the_same_code(folder: Path) -> None:
    equations = nullbody.derive(nullbody.catalog.mechanism("four_bar"))
    one = write_c(equations, folder / "deeper" / "one")
    other = write_c(nullbody.build(equations), folder / "other")
    assert [path.name for path in one.files] == [path.name for path in other.files]
    for a, b in zip(one.files, other.files, strict=True):
        assert a.read_bytes() == b.read_bytes()


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"real": "half"}, "double or float, not for 'half'"),
        ({"prefix": "3 prs"}, "cannot begin with '3 prs'"),
        ({"prefix": ""}, "cannot begin with ''"),
        ({"prefix": "while"}, "cannot begin with 'while'"),
        ({"prefix": 3}, "begin with a text, not with 3"),
        ({"prefix": "math"}, "files cannot be called 'math'"),
        ({"seed": -1}, "seed must be a whole number from 0, not -1"),
        ({"seed": "x"}, "not 'x'"),
    ],
)
def test_bad_options_are_refused_and_nothing_is_written(
    models: Mapping[str, Model], folder: Path, options: dict[str, Any], why: str
) -> None:
    with pytest.raises(InputError, match=re.escape(why)):
        write_c(models["four_bar"], folder / "new", **options)
    assert not list(folder.iterdir())


def test_what_is_no_model_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="of Equations or a Model, not of Mechanism"):
        write_c(nullbody.catalog.mechanism("four_bar"), folder)


def test_folder_that_cannot_be_written(models: Mapping[str, Model], folder: Path) -> None:
    (folder / "file").write_text("kept", encoding="utf-8")
    for place in (folder / "file", folder / "file" / "below"):
        with pytest.raises(OutputError, match="cannot be made"):
            write_c(models["four_bar"], place)
    assert (folder / "file").read_text(encoding="utf-8") == "kept"
    (folder / "new" / "fb.c").mkdir(parents=True)
    with pytest.raises(OutputError, match="it is a folder"):
        write_c(models["four_bar"], folder / "new", prefix="fb")
