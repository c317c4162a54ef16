"""What MJCF may say here: attributes that are read, those that do not matter, and the rest, which is refused."""

from __future__ import annotations

from collections.abc import Mapping

from nullbody.formats.xml_tree import XmlElement

__all__ = ["check_attributes", "check_children", "check_names", "check_options"]

_PLACED = {"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"}
_LOOKS = {"name", "class", "group", "user", "rgba", "material"}
_SOFT = {"name", "class", "active", "solref", "solimp"}  # of equality constraints, which are exact here
_LIMITS = {"limited", "range", "margin", "solreflimit", "solimplimit"}

#: Attributes by element; an element that is not named here has no meaning for the dynamics.
_KNOWN: Mapping[str, set[str]] = {
    "compiler": {
        *("angle", "eulerseq", "autolimits", "inertiafromgeom", "inertiagrouprange", "coordinate", "boundmass"),
        *("boundinertia", "settotalmass", "balanceinertia", "meshdir", "texturedir", "assetdir", "strippath"),
        *("discardvisual", "fusestatic", "usethread", "exactmeshinertia", "convexhull", "alignfree", "saveinertial"),
        *("fitaabb", "conflict"),
    },
    "body": {"name", "childclass", "mocap", "gravcomp", "user", "sleep", *_PLACED},
    "inertial": {"mass", "diaginertia", "fullinertia", *_PLACED},
    "joint": {
        *("name", "class", "type", "group", "pos", "axis", "stiffness", "springref", "springdamper", "ref", "damping"),
        *("armature", "frictionloss", "solreffriction", "solimpfriction", "actuatorfrcrange", "actuatorfrclimited"),
        *("actuatorgravcomp", "user", *_LIMITS),
    },
    "freejoint": {"name", "group", "align"},
    "geom": {
        *("type", "contype", "conaffinity", "condim", "priority", "size", "friction", "mass", "density", "solmix"),
        *("shellinertia", "solref", "solimp", "margin", "gap", "fromto", "hfield", "mesh", "fitscale", "fluidshape"),
        *("fluidcoef", *_PLACED, *_LOOKS),
    },
    "site": {"type", "size", "fromto", *_PLACED, *_LOOKS},
    "connect": {"body1", "body2", "anchor", "site1", "site2", *_SOFT},
    "weld": {"body1", "body2", "anchor", "relpose", "site1", "site2", "torquescale", *_SOFT},
    "equality joint": {"joint1", "joint2", "polycoef", *_SOFT},
    "equality tendon": {"tendon1", "tendon2", "polycoef", *_SOFT},
    "spatial": {
        *("stiffness", "springlength", "damping", "frictionloss", "solreffriction", "solimpfriction", "armature"),
        *("width", "actuatorfrcrange", "actuatorfrclimited", *_LOOKS, *_LIMITS),
    },
    "actuator": {
        *("name", "class", "group", "user", "joint", "jointinparent", "gear", "ctrlrange", "ctrllimited", "forcerange"),
        *(
            "forcelimited",
            "lengthrange",
            "dyntype",
            "gaintype",
            "biastype",
            "gainprm",
            "actlimited",
            "delay",
            "nsample",
        ),
        *("interp", "cranklength", "dynprm", "biasprm"),
    },
}

_IN_MUJOCO = {
    *("compiler", "option", "size", "visual", "statistic", "default", "custom", "asset", "worldbody", "contact"),
    *("equality", "tendon", "actuator", "sensor", "keyframe"),
}
_IN_BODY = {"inertial", "joint", "freejoint", "geom", "site", "camera", "light", "body"}
_NAMED = {"body": "body", "joint": "joint", "freejoint": "joint", "geom": "geom", "site": "site"}  # tag -> kind
_MACROS = ("include", "frame", "replicate", "composite", "flexcomp", "attach", "model")
_HARMLESS_FLAGS = {
    *("contact", "limit", "gravity", "warmstart", "filterparent", "refsafe", "sensor", "midphase", "eulerdamp"),
    *("autoreset", "nativeccd", "island", "multiccd", "override", "energy", "fwdinv", "invdiscrete", "sleep"),
}
_ABSENT = {"density": 0.0, "viscosity": 0.0}  # of the medium around


def check_attributes(element: XmlElement, kind: str = "") -> None:
    """Raise at an attribute that is not known here: it might change the dynamics."""
    known = _KNOWN[kind or element.tag]
    for name in element.attributes:
        if name not in known:
            element.refuse(f"the attribute {name!r} is not known here and might change the dynamics: take it out")


def check_children(element: XmlElement) -> None:
    """Raise at an element that is not known here."""
    known = _IN_MUJOCO if element.tag == "mujoco" else _IN_BODY
    for child in element.children:
        if child.tag in _MACROS:
            child.refuse(
                f"<{child.tag}> is not read here: load the file in MuJoCo once and save it with mj_saveLastXML, which "
                "writes it out"
            )
        if child.tag not in known and not (child.tag in ("extension", "deformable") and not child.children):
            child.refuse(f"<{child.tag}> is not known here and might change the dynamics: take it out")


def check_names(root: XmlElement) -> None:
    """Raise at a second element of a kind with the same name, as MuJoCo does: one of the two would be lost."""
    found = [
        (section.tag, e)
        for s in ("tendon", "equality", "actuator", "keyframe")
        for section in root.all(s)
        for e in section.children
    ]
    bodies = list(root.all("worldbody"))
    while bodies:
        children = bodies.pop().children
        found += [(_NAMED[child.tag], child) for child in children if child.tag in _NAMED]
        bodies += [child for child in children if child.tag == "body"]
    taken = set()
    for kind, element in sorted(found, key=lambda pair: pair[1].line):
        name = element.text("name")
        if name and (kind, name) in taken:
            element.refuse(f"there is another {kind} of this name")
        taken.add((kind, name))


def check_options(root: XmlElement) -> None:
    """Raise at options of the compiler or the physics that change the dynamics."""
    for compiler in root.all("compiler"):
        check_attributes(compiler)
        for name in ("boundmass", "boundinertia", "settotalmass"):
            if compiler.number(name) > 0:
                compiler.refuse(
                    f"{name} changes masses when the model is compiled: put the masses themselves in the file"
                )
        if compiler.text("balanceinertia", "false") == "true":
            compiler.refuse("balanceinertia changes inertias when the model is compiled: put the inertias in the file")
        if compiler.text("coordinate", "local") != "local":
            compiler.refuse("global coordinates are not read here, and no longer by MuJoCo")
    for option in root.all("option"):
        for name, absent in _ABSENT.items():
            if option.number(name) != absent:
                option.refuse(f"{name}: there is no air or water here; take it out")
        if option.text("actuatorgroupdisable").strip():
            option.refuse("actuatorgroupdisable is not known here: take those actuators out")
        for flags in option.all("flag"):
            for name, value in flags.attributes.items():
                if name not in _HARMLESS_FLAGS and value != "enable":
                    flags.refuse(f"{name}='{value}' is not known here: take out what it switches off")
