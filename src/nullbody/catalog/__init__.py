"""Layer 4: ready-made mechanisms, and what is known of them in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from nullbody.catalog.three_prs import three_prs
from nullbody.errors import UnknownName
from nullbody.mechanism import Mechanism

if TYPE_CHECKING:
    from nullbody.catalog.closed_form import ClosedForm

__all__ = ["MODELS", "closed_form_of", "mechanism", "three_prs"]

#: Every mechanism of the catalog by name.
MODELS: dict[str, Callable[..., Mechanism]] = {"three_prs": three_prs}


def mechanism(name: str, **values: float) -> Mechanism:
    """A mechanism of the catalog by name.

    Raises:
        UnknownName: there is none of this name.
    """
    if name not in MODELS:
        raise UnknownName("model in the catalog", name, MODELS)
    return MODELS[name](**values)


def closed_form_of(name: str) -> ClosedForm | None:
    """Closed-form kinematics of a mechanism of the catalog, or None."""
    if name != "three_prs":
        return None
    from nullbody.catalog.three_prs_kinematics import CLOSED_FORM

    return CLOSED_FORM
