"""Layer 4: ready-made mechanisms, and what is known of them in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING

from nullbody.catalog.a01_pendulum import a01_pendulum
from nullbody.catalog.andrews import andrews
from nullbody.catalog.bricard import bricard
from nullbody.catalog.chaplygin_sleigh import chaplygin_sleigh
from nullbody.catalog.delta import delta
from nullbody.catalog.entries import ENTRIES
from nullbody.catalog.entry import Entry
from nullbody.catalog.five_bar import five_bar
from nullbody.catalog.flyball_governor import flyball_governor
from nullbody.catalog.four_bar import four_bar
from nullbody.catalog.n_four_bar import n_four_bar
from nullbody.catalog.rolling_disc import rolling_disc
from nullbody.catalog.rssr import rssr
from nullbody.catalog.slider_crank import slider_crank
from nullbody.catalog.spatial_slider_crank import spatial_slider_crank
from nullbody.catalog.start import Start
from nullbody.catalog.stewart_platform import stewart_platform
from nullbody.catalog.three_prs import three_prs
from nullbody.catalog.three_prs_vertical import three_prs_vertical
from nullbody.catalog.three_rps import three_rps
from nullbody.catalog.three_rrr import three_rrr
from nullbody.errors import UnknownName
from nullbody.mechanism import Mechanism

if TYPE_CHECKING:
    from nullbody.catalog.closed_form import ClosedForm

__all__ = [
    "CLOSED_FORMS",
    "ENTRIES",
    "MODELS",
    "STARTS",
    "Entry",
    "Start",
    "a01_pendulum",
    "andrews",
    "bricard",
    "chaplygin_sleigh",
    "closed_form_of",
    "delta",
    "describe",
    "five_bar",
    "flyball_governor",
    "four_bar",
    "mechanism",
    "n_four_bar",
    "rolling_disc",
    "rssr",
    "slider_crank",
    "spatial_slider_crank",
    "starts",
    "stewart_platform",
    "three_prs",
    "three_prs_vertical",
    "three_rps",
    "three_rrr",
]

#: Every mechanism of the catalog by name.
MODELS: dict[str, Callable[..., Mechanism]] = {
    "a01_pendulum": a01_pendulum,
    "andrews": andrews,
    "bricard": bricard,
    "chaplygin_sleigh": chaplygin_sleigh,
    "delta": delta,
    "five_bar": five_bar,
    "flyball_governor": flyball_governor,
    "four_bar": four_bar,
    "n_four_bar": n_four_bar,
    "rolling_disc": rolling_disc,
    "rssr": rssr,
    "slider_crank": slider_crank,
    "spatial_slider_crank": spatial_slider_crank,
    "stewart_platform": stewart_platform,
    "three_prs": three_prs,
    "three_prs_vertical": three_prs_vertical,
    "three_rps": three_rps,
    "three_rrr": three_rrr,
}

#: Where starts of published motions are, by the mechanism's name.
STARTS = {
    "a01_pendulum": "nullbody.catalog.a01_pendulum",
    "andrews": "nullbody.catalog.andrews",
    "bricard": "nullbody.catalog.bricard",
    "chaplygin_sleigh": "nullbody.catalog.chaplygin_sleigh",
    "flyball_governor": "nullbody.catalog.flyball_governor",
    "four_bar": "nullbody.catalog.four_bar",
    "n_four_bar": "nullbody.catalog.n_four_bar",
    "rolling_disc": "nullbody.catalog.rolling_disc",
}

#: Where closed-form kinematics are, by the mechanism's name.
CLOSED_FORMS = {
    "delta": "nullbody.catalog.delta_kinematics",
    "five_bar": "nullbody.catalog.five_bar_kinematics",
    "four_bar": "nullbody.catalog.four_bar_kinematics",
    "rssr": "nullbody.catalog.rssr_kinematics",
    "slider_crank": "nullbody.catalog.slider_crank_kinematics",
    "spatial_slider_crank": "nullbody.catalog.spatial_slider_crank_kinematics",
    "stewart_platform": "nullbody.catalog.stewart_platform_kinematics",
    "three_prs": "nullbody.catalog.three_prs_kinematics",
    "three_prs_vertical": "nullbody.catalog.three_prs_vertical_kinematics",
    "three_rps": "nullbody.catalog.three_rps_kinematics",
    "three_rrr": "nullbody.catalog.three_rrr_kinematics",
}


def mechanism(name: str, **values: float) -> Mechanism:
    """A mechanism of the catalog by name.

    Raises:
        UnknownName: there is none of this name.
    """
    if name not in MODELS:
        raise UnknownName("model in the catalog", name, MODELS)
    return MODELS[name](**values)


def describe(name: str) -> Entry:
    """Title, mobility, source, picture and more of a mechanism of the catalog.

    Raises:
        UnknownName: there is none of this name.
    """
    if name not in ENTRIES:
        raise UnknownName("model in the catalog", name, ENTRIES)
    return ENTRIES[name]


def starts(name: str, **values: float) -> dict[str, Start]:
    """The starts of published motions of a mechanism by their names; at rest at home where none was published.

    Args:
        name: of the mechanism.
        values: parameters that differ from those of the publication.

    Raises:
        UnknownName, ParameterError: there is no mechanism of this name, or no such parameter.
    """
    if name not in STARTS:
        return {"home": Start(mechanism(name, **values))}
    found: dict[str, Start] = import_module(STARTS[name]).starts(**values)
    return found


def closed_form_of(given: Mechanism) -> ClosedForm | None:
    """Closed-form kinematics of a mechanism of the catalog, with any parameter values, or None."""
    if given.name not in CLOSED_FORMS:
        return None
    known = MODELS[given.name]()
    names = [[*made.coordinates, *(p.name for p in made.parameters)] for made in (given, known)]
    if names[0] != names[1] or replace(given, parameters=known.parameters, home=known.home) != known:
        return None
    found: ClosedForm = import_module(CLOSED_FORMS[given.name]).CLOSED_FORM
    return found
