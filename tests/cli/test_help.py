"""Help texts: as committed, quick, and with examples that work."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from nullbody import __version__, report
from nullbody import bench as benchmark
from nullbody.bench import speed
from tests.bench.test_speed import SMALL
from tests.cli.help import NAMES, help_texts

GOLDEN = help_texts()
EXAMPLES = [line for text in GOLDEN.values() for line in re.findall(r"^ +nullbody ([a-z].*)$", text, re.MULTILINE)]
NOTHING = benchmark.Settings(limit=0.0, repeats=1, patience=0.0, parts=("symbolic",), search=0)
LIBRARIES = ("numpy", "rich", "xarray", "llvmlite", "jinja2")


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_help_is_as_committed(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == GOLDEN[path], "make regenerate rewrites it"


def test_golden_folder_has_nothing_else() -> None:
    assert set(next(iter(GOLDEN)).parent.iterdir()) == set(GOLDEN)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_help_has_an_example_and_json(path: Path) -> None:
    assert re.search(r"Examples:\n +nullbody ", GOLDEN[path])
    assert "--json" in GOLDEN[path]


@pytest.mark.parametrize("example", dict.fromkeys(EXAMPLES))
def test_example_works(nullbody, monkeypatch: pytest.MonkeyPatch, example: str) -> None:
    if example.startswith("reproduce"):  # a minute; the report has its own tests
        monkeypatch.setattr(report, "reproduce", lambda out, **options: {"checks": {"agrees": 1}})
    if example.startswith("bench"):  # likewise
        measured = benchmark.bench_null_space
        monkeypatch.setattr(benchmark, "bench_null_space", lambda settings, step: measured(NOTHING, step))
        timed = speed.bench_speed
        monkeypatch.setattr(speed, "bench_speed", lambda effort, subjects, step: timed(SMALL, subjects, step))
    if example.startswith("verify") and "multipliers" not in example and not find_spec("mujoco"):
        pytest.skip("needs the extra verify")
    if "--size" in example and not find_spec("ziglang"):
        pytest.skip("needs the extra native")
    ended = nullbody(example)
    assert ended.code == 0, ended.err
    assert ended.out
    if example.endswith(("--json", "--json -")):
        assert ended.json


def test_every_command_has_an_example() -> None:
    begun = {line for example in EXAMPLES for line in (example.split()[0], " ".join(example.split()[:2]))}
    assert begun >= set(NAMES) - {"nullbody"}


def test_help_loads_no_heavy_library() -> None:
    probe = "import sys; from nullbody.cli import main; main(['--help']); print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    loaded = done.stderr.split()
    assert "Commands:" in done.stdout
    assert "typer" in loaded
    assert not set(LIBRARIES) & set(loaded)


def test_module_exits_with_the_code() -> None:
    command = [sys.executable, "-m", "nullbody"]
    version = subprocess.run([*command, "--version"], capture_output=True, text=True)
    assert (version.returncode, version.stdout) == (0, f"nullbody {__version__}\n")
    wrong = subprocess.run([*command, "derive", "nothing"], capture_output=True, text=True)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.startswith("error: there is no model in the catalog 'nothing'; known: ")
