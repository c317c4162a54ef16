"""Layer 4: ready-made mechanisms, and what is known of them in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

from nullbody.catalog.three_prs import three_prs
from nullbody.errors import UnknownName
from nullbody.mechanism import Mechanism

if TYPE_CHECKING:
    from nullbody.catalog.closed_form import ClosedForm

__all__ = ["CLOSED_FORMS", "MODELS", "closed_form_of", "mechanism", "three_prs"]

#: Every mechanism of the catalog by name.
MODELS: dict[str, Callable[..., Mechanism]] = {"three_prs": three_prs}

#: Where closed-form kinematics are, by the mechanism's name.
CLOSED_FORMS = {"three_prs": "nullbody.catalog.three_prs_kinematics"}


def mechanism(name: str, **values: float) -> Mechanism:
    """A mechanism of the catalog by name.

    Raises:
        UnknownName: there is none of this name.
    """
    if name not in MODELS:
        raise UnknownName("model in the catalog", name, MODELS)
    return MODELS[name](**values)


def closed_form_of(given: Mechanism) -> ClosedForm | None:
    """Closed-form kinematics of a mechanism of the catalog, with any parameter values, or None."""
    if given.name not in CLOSED_FORMS:
        return None
    known = MODELS[given.name]()
    if replace(given, parameters=known.parameters) != known or [p.name for p in given.parameters] != [
        p.name for p in known.parameters
    ]:
        return None
    found: ClosedForm = import_module(CLOSED_FORMS[given.name]).CLOSED_FORM
    return found
