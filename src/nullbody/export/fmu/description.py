"""modelDescription.xml for FMI 2.0 and FMI 3.0."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from nullbody import __version__
from nullbody.export.fmu.units import base_units, display_unit
from nullbody.export.fmu.variables import Unit, Variable

__all__ = ["build_description", "model_description"]

#: Signs that XML cannot hold, not even escaped.
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

_FLAGS = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
_FLAGS_3 = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
_CATEGORIES = {"logStatusError": "what went wrong, by name", "logStatusDiscard": "why a step could not be completed"}


def model_description(unit: Unit, token: str, fmi: int, compiled: Sequence[str]) -> bytes:
    """The XML that says what is in the unit.

    Args:
        unit: what is exported.
        token: GUID or instantiation token.
        fmi: 2 or 3.
        compiled: the source files to compile.
    """
    root = _version_2(unit, token, compiled) if fmi == 2 else _version_3(unit, token)
    return _text(root)


def build_description(unit: Unit, compiled: Sequence[str]) -> bytes:
    """sources/buildDescription.xml of FMI 3.0: what to compile."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=unit.identifier)
    files = SubElement(configuration, "SourceFileSet", language="C99")
    for name in compiled:
        SubElement(files, "SourceFile", name=name)
    return _text(root)


def _text(root: Element) -> bytes:
    ElementTree.indent(root)
    text = _NO_XML.sub("_", ElementTree.tostring(root, encoding="unicode"))
    return f"<?xml version='1.0' encoding='utf-8'?>\n{text}\n".encode()


def _head(unit: Unit, version: str) -> dict[str, str]:
    mechanism = unit.model.mechanism
    return {
        "fmiVersion": version,
        "modelName": mechanism.name,
        "description": f"Equations of motion of {mechanism.name}, reduced to {len(unit.model.independent)} "
        "independent rates",
        "generationTool": f"nullbody {__version__}",
        "variableNamingConvention": "structured" if unit.structured else "flat",
    }


def _number(value: float) -> str:
    return repr(float(value))


# -- FMI 2.0 --------------------------------------------------------------------------------------------------------


def _version_2(unit: Unit, token: str, compiled: Sequence[str]) -> Element:
    root = Element("fmiModelDescription", _head(unit, "2.0") | {"guid": token, "numberOfEventIndicators": "0"})
    for kind, more in (("ModelExchange", {}), ("CoSimulation", {"canHandleVariableCommunicationStepSize": "true"})):
        interface = SubElement(root, kind, {"modelIdentifier": unit.identifier, **_FLAGS, **more})
        files = SubElement(interface, "SourceFiles")
        for name in compiled:
            SubElement(files, "File", name=name)
    _units(root, unit)
    _categories(root)
    _experiment(root, unit)
    variables = [v for v in unit.variables if v.causality != "independent"]
    index = {variable.reference: k for k, variable in enumerate(variables, 1)}
    listed = SubElement(root, "ModelVariables")
    for variable in variables:
        scalar = SubElement(listed, "ScalarVariable", _attributes(variable))
        real = SubElement(scalar, "Real", _type(variable))
        if variable.derivative_of is not None:
            real.set("derivative", str(index[variable.derivative_of]))
    structure = SubElement(root, "ModelStructure")
    for title, members in _structure(unit):
        entries = SubElement(structure, title)
        for variable in members:
            unknown = SubElement(entries, "Unknown", index=str(index[variable.reference]))
            if title != "InitialUnknowns":
                _depends(unknown, variable, [index[k] for k in variable.depends or ()])
    return root


def _structure(unit: Unit) -> list[tuple[str, list[Variable]]]:
    outputs = [v for v in unit.variables if v.causality == "output"]
    return [("Outputs", outputs), ("Derivatives", list(unit.derivatives)), ("InitialUnknowns", _unknown(unit))]


def _unknown(unit: Unit) -> list[Variable]:
    """What initialization calculates, in the order of the variables."""
    derivatives = {variable.reference for variable in unit.derivatives}
    return [
        v
        for v in unit.variables
        if v.initial in ("approx", "calculated")
        and (v.causality in ("output", "calculatedParameter") or v.reference in derivatives)
    ]


def _depends(element: Element, variable: Variable, on: Sequence[int]) -> None:
    """What an unknown depends on; without a word, on everything."""
    if variable.depends is not None:
        element.set("dependencies", " ".join(map(str, sorted(on))))


# -- FMI 3.0 --------------------------------------------------------------------------------------------------------


def _version_3(unit: Unit, token: str) -> Element:
    root = Element("fmiModelDescription", _head(unit, "3.0") | {"instantiationToken": token})
    SubElement(root, "ModelExchange", {"modelIdentifier": unit.identifier, **_FLAGS_3})
    more = {"canHandleVariableCommunicationStepSize": "true"}
    SubElement(root, "CoSimulation", {"modelIdentifier": unit.identifier, **_FLAGS_3, **more})
    _units(root, unit)
    _categories(root)
    _experiment(root, unit)
    listed = SubElement(root, "ModelVariables")
    for variable in unit.variables:
        real = SubElement(listed, "Float64", _attributes(variable) | _type(variable))
        if variable.derivative_of is not None:
            real.set("derivative", str(variable.derivative_of))
    structure = SubElement(root, "ModelStructure")
    titles = {"Outputs": "Output", "Derivatives": "ContinuousStateDerivative", "InitialUnknowns": "InitialUnknown"}
    for title, members in _structure(unit):
        for variable in members:
            unknown = SubElement(structure, titles[title], valueReference=str(variable.reference))
            if title != "InitialUnknowns":
                _depends(unknown, variable, variable.depends or ())
    return root


# -- both -----------------------------------------------------------------------------------------------------------


def _attributes(variable: Variable) -> dict[str, str]:
    found = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": variable.meaning,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    return found | ({"initial": variable.initial} if variable.initial else {})


def _type(variable: Variable) -> dict[str, str]:
    found = {}
    if variable.unit:
        found["unit"] = variable.unit
    shown = display_unit(variable.unit)
    if shown is not None:
        found["displayUnit"] = shown[0]
    if variable.least is not None:
        found["min"] = _number(variable.least)
    if variable.start is not None:
        found["start"] = _number(variable.start)
    return found


def _units(root: Element, unit: Unit) -> None:
    """Every unit in use, in SI base units where it is known."""
    names = sorted({variable.unit for variable in unit.variables if variable.unit})
    definitions = SubElement(root, "UnitDefinitions")
    for name in names:
        definition = SubElement(definitions, "Unit", name=name)
        exponents = base_units(name)
        if exponents is not None:
            SubElement(definition, "BaseUnit", {key: str(exponent) for key, exponent in exponents.items()})
        shown = display_unit(name)
        if shown is not None:
            SubElement(definition, "DisplayUnit", name=shown[0], factor=_number(shown[1]))


def _categories(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    for name, meaning in _CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=meaning)


def _experiment(root: Element, unit: Unit) -> None:
    start = float(unit.state.t)
    found = {"startTime": _number(start), "stopTime": _number(start + 1.0)}
    tolerance = next(v.start for v in unit.variables if v.name == "solver.tolerance")
    SubElement(root, "DefaultExperiment", found | {"tolerance": _number(tolerance or 0.0)})
