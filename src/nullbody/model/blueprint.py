"""What a model is made from: names and programs; derived once, then read from the cache.

The cache is that of native code, and trusted like it. The key holds the mechanism, what was asked for, and sizes
and times of this package's files, so that another version, or an edit, finds nothing.
"""

from __future__ import annotations

import marshal
import os
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import cache
from hashlib import blake2b
from pathlib import Path

from nullbody.equations import Equations, Mobility, derive, programs
from nullbody.expr import Tape
from nullbody.kernels import Program, load, store
from nullbody.mechanism import Mechanism, fingerprint

__all__ = ["Blueprint", "blueprint"]

_FORMAT = 1
_SOURCES = ("expr", "nullspace", "mechanism", "equations", "model")

Names = Sequence[str] | None


@dataclass(frozen=True)
class Blueprint:
    """Names and programs of a model; attributes as `Model`."""

    independent: tuple[str, ...]
    basis: tuple[str, ...]
    labels: tuple[str, ...]
    closure_labels: tuple[str, ...]
    facing: tuple[str, ...]
    mobility: Mobility
    programs: tuple[Program, ...]

    @classmethod
    def of(cls, equations: Equations) -> Blueprint:
        """The blueprint of a model of some equations."""
        e = equations
        return cls(e.independent, e.basis, e.labels, e.closure_labels, e.facing, e.mobility, tuple(programs(equations)))

    @property
    def body(self) -> bytes:
        """The blueprint as bytes."""
        tapes = [
            (p.name, p.inputs, p.outputs, p.tape.inputs, p.tape.constants, p.tape.code, p.tape.outputs)
            for p in self.programs
        ]
        names = (self.independent, self.basis, self.labels, self.closure_labels, self.facing)
        return marshal.dumps((*names, astuple(self.mobility), tapes), 4)

    @classmethod
    def read(cls, body: bytes) -> Blueprint:
        """The blueprint of `body`, which only this user can have written."""
        independent, basis, labels, closures, facing, mobility, tapes = marshal.loads(body)
        made = tuple(Program(name, inputs, outputs, Tape(*tape)) for name, inputs, outputs, *tape in tapes)
        return cls(independent, basis, labels, closures, facing, Mobility(*mobility), made)


def blueprint(mechanism: Mechanism, independent: Names, rows: Names, basis: Names) -> Blueprint:
    """The blueprint of `derive(mechanism, independent, rows=rows, basis=basis)`, from the cache where it is there.

    Raises:
        InputError, MechanismError, SingularityError, CacheError: as `derive` and the cache.
    """
    key = _key(mechanism, independent, rows, basis)
    if key is None:
        return Blueprint.of(derive(mechanism, independent, rows=rows, basis=basis))
    body = load(key)
    if body is not None:
        return Blueprint.read(body)
    made = Blueprint.of(derive(mechanism, independent, rows=rows, basis=basis))
    store(key, made.body)
    return made


def _key(mechanism: Mechanism, *asked: Names) -> str | None:
    """The key of a blueprint; None where a part of the mechanism, or a name, is of somebody else's type."""
    if not all(_readable(names) for names in asked):
        return None
    digest = fingerprint(mechanism)
    if digest is None:
        return None
    wanted = [None if names is None else tuple(names) for names in asked]
    said = repr((_FORMAT, _sources(), digest, wanted))
    return blake2b(said.encode(), digest_size=20).hexdigest()


def _readable(names: object) -> bool:
    """Whether these are names as they can be kept, or nothing; `derive` says what is wrong with what is no name.

    A kind of its own, such as numpy.str_, would come back from the cache as bytes.
    """
    return names is None or (isinstance(names, list | tuple) and all(type(name) is str for name in names))


@cache
def _sources() -> str:
    """A digest of sizes and times of the files that the derivation is in."""
    root, digest = Path(__file__).parents[1], blake2b(digest_size=20)
    for place in (root, *(root / package for package in _SOURCES)):
        for folder, inner, files in os.walk(place):
            if place == root:
                inner.clear()  # the modules beside the packages, such as the tolerances
            inner.sort()
            for name in sorted(files):
                if name.endswith(".py"):
                    digest.update(_stamp(Path(folder) / name).encode())
    return digest.hexdigest()


def _stamp(path: Path) -> str:
    """What changes with a file, also where an installer sets the time of modification: st_ctime is the system's own."""
    status = path.stat()
    return f"{path} {status.st_size} {status.st_mtime_ns} {status.st_ctime_ns}\n"


_sources()  # now: files that are edited while this process runs are not what it has imported
