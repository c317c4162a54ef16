"""The reference that --reference names."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from nullbody.cli.options import assignments
from nullbody.errors import InputError, UnknownName

if TYPE_CHECKING:
    from nullbody.control import AbstractReference
    from nullbody.model import Model, State

__all__ = ["reference_of"]


def reference_of(text: str, model: Model, start: State | None, until: float) -> AbstractReference:
    """The paper's sinusoids, or a quintic from a start to the values of a list such as s1=0.7,s2=0.5.

    Args:
        text: "paper", or independent coordinates at the end; those not named stay.
        model: that will follow it; its independent coordinates must be the actuated ones.
        start: where a quintic starts.
        until: when it ends [s].

    Raises:
        InputError, UnknownName: a text that is neither, or a model that cannot follow it.
    """
    from nullbody.control import Quintic, paper_reference

    actuated = model.mechanism.actuated
    if model.independent != actuated:
        raise InputError(f"references move the actuated coordinates: use --independent {','.join(actuated)}")
    if not 0 < until < inf:
        raise InputError(f"--until must be a positive number of seconds, not {until}")
    if text == "paper":
        if len(actuated) != 3:
            raise InputError(
                f"the paper's reference moves 3 sliders, {model.mechanism.name!r} has {len(actuated)} inputs"
            )
        return paper_reference()
    if start is None:
        raise InputError(f"a reference to the point {text} needs a state to start from")
    end = assignments([text], "--reference")
    for name in end:
        if name not in model.independent:
            raise UnknownName("independent coordinate", name, model.independent)
    begin = tuple(start[name] for name in model.independent)
    return Quintic(begin, tuple(end.get(name, x) for name, x in zip(model.independent, begin, strict=True)), until)
