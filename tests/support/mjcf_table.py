"""Every element and attribute of MuJoCo's schema: honoured, warned of, or without effect on what Ulna computes.

A sample gives the attribute a value that is not its default. `Sample.without` is the same document without it.
"""

from __future__ import annotations

from collections.abc import Iterator

from support import mjcf_documents as doc
from support import mjcf_table_parts as parts
from support import mjcf_table_shapes as shapes
from support.mjcf_actuators import ACTUATORS, actuators
from support.mjcf_physics import schema
from support.mjcf_sample import TURNS, Sample, attributes, rows, with_defaults

OPTION = 'ccd_iterations="10" ccd_tolerance="1e-3" cone="elliptic" impratio="2" integrator="implicit" iterations="5" jacobian="dense" '
OPTION += 'ls_iterations="3" ls_tolerance="0.1" magnetic="1 2 3" noslip_iterations="3" noslip_tolerance="1e-3" o_friction="2 2 1 1 1" '
OPTION += 'o_margin="0.1" o_solimp="0.5 0.6 0.1 0.5 2" o_solref="0.1 1" sdf_initpoints="3" sdf_iterations="3" sleep_tolerance="0.1" '
OPTION += 'solver="CG" timestep="0.01" tolerance="1e-3"'
FLAGS = "autoreset eulerdamp midphase multiccd nativeccd refsafe sensor warmstart island"
FLAGS_ON = "diagexact energy fwdinv invdiscrete override sleep speculative"


def options() -> Iterator[Sample]:
    plain, wet = doc.options("@"), doc.options('density="1.2" @')
    yield from rows(
        "option",
        plain,
        honoured={"gravity": 'gravity="1 2 3"', "actuatorgroupdisable": 'actuatorgroupdisable="3"'},
        warned={
            "density": ('density="1.2"', "<option density>"),
            "viscosity": ('viscosity="0.1"', "<option viscosity>"),
        },
        irrelevant=attributes(OPTION),
    )
    yield from rows("option", wet, warned={"wind": ('wind="1 2 3"', "wind>")})
    off = {name: f'{name}="disable"' for name in FLAGS.split()}
    on = {name: f'{name}="enable"' for name in FLAGS_ON.split()}
    switched = [
        "gravity",
        "constraint",
        "equality",
        "frictionloss",
        "limit",
        "contact",
        "damper",
        "clampctrl",
        "actuation",
    ]
    yield from rows(
        "option/flag",
        doc.flags("@"),
        honoured={name: f'{name}="disable"' for name in switched},
        warned={"filterparent": ('filterparent="disable"', '<flag filterparent="disable">')},
        irrelevant={**off, **on},
        without_sample="ipc",
    )
    yield from rows("option/flag", doc.flags("@", 3.0), honoured={"spring": 'spring="disable"'})


def compiler() -> Iterator[Sample]:
    yield from rows(
        "compiler",
        doc.COMPILER,
        honoured={
            "alignfree": ('inertiafromgeom="true"', 'inertiafromgeom="true" alignfree="true"'),
            "angle": 'angle="radian"',
            "boundinertia": 'boundinertia="3"',
            "boundmass": 'boundmass="400"',
            "discardvisual": 'discardvisual="true"',
            "eulerseq": 'eulerseq="zyx"',
            "fusestatic": 'fusestatic="true"',
            "inertiafromgeom": 'inertiafromgeom="true"',
            "inertiagrouprange": 'inertiagrouprange="4 4"',
            "settotalmass": 'settotalmass="3"',
        },
        irrelevant={
            "autolimits": 'autolimits="false"',
            "coordinate": 'coordinate="local"',
            "usethread": 'usethread="false"',
            "saveinertial": 'saveinertial="true"',
        },
        without_sample="conflict passthrough savecanonical savecompiled texturedir",
    )
    yield from rows("compiler", doc.BALANCE, honoured={"balanceinertia": (None, 'balanceinertia="true"')})
    yield from rows(
        "compiler", doc.FITTED.replace("@", "").replace("!", "@"), honoured={"fitaabb": 'fitaabb="true"'}
    )
    yield from rows("compiler/lengthrange", without_sample=" ".join(schema()["compiler/lengthrange"]))
    moved = doc.MESHES.replace("@", 'file="MESH"').replace("%", "").replace("!", "@")
    for attribute, text, mesh in (
        ("meshdir", 'meshdir="parts"', "small.obj"),
        ("assetdir", 'assetdir="parts"', "small.obj"),
        ("strippath", 'strippath="true"', "nowhere/tetra.obj"),
    ):
        yield from rows("compiler", moved.replace("MESH", mesh), honoured={attribute: (None, text)})


def bodies() -> Iterator[Sample]:
    yield from rows(
        "body",
        doc.BODY,
        honoured={"pos": 'pos="1 2 3"', **TURNS, "childclass": 'childclass="c"'},
        warned={"gravcomp": ('gravcomp="1"', "<body gravcomp> of body 'x'")},
        without_sample="name user simple",
    )
    yield from rows("body", doc.MOCAP, warned={"mocap": ('mocap="true"', "<body mocap> of body 'x'")})
    yield from rows("body", doc.SLEEP, irrelevant={"sleep": 'sleep="never"'})
    yield from rows("body", doc.FUSED, honoured={"fuse": 'fuse="false"'})
    base = 'mass="2" pos=".1 .2 .3" diaginertia=".1 .2 .25"'
    yield from rows(
        "body/inertial",
        doc.INERTIAL,
        base,
        honoured={
            "mass": (base, base.replace("2", "3", 1)),
            "pos": (base, base.replace(".1 .2 .3", "0 0 1")),
            "diaginertia": (base, base.replace(".25", ".3")),
            "fullinertia": (base, 'mass="2" pos=".1 .2 .3" fullinertia=".1 .2 .25 .01 .02 .03"'),
            **TURNS,
        },
    )
    yield from rows(
        "body/freejoint", doc.FREEJOINT, honoured={"align": 'align="true"'}, without_sample="group name"
    )
    yield from rows(
        "body/attach",
        doc.ATTACHED,
        honoured={
            "model": (None, 'model="other" body="root" prefix="p_"'),
            "body": (None, 'model="other" body="tip" prefix="p_"'),
            "frame": (None, 'model="other" frame="f" prefix="p_"'),
            "prefix": ('model="other" body="root" prefix="p_"', 'model="other" body="root" prefix="q_"'),
        },
    )


def joints() -> Iterator[Sample]:
    bounded = 'range="-10 20"'
    yield from rows(
        "body/joint",
        doc.JOINT,
        honoured={
            "type": 'type="slide"',
            "pos": 'pos=".1 .2 .3"',
            "axis": 'axis="1 2 3"',
            "ref": 'ref="20"',
            "range": bounded,
            "limited": (bounded, f'{bounded} limited="false"'),
            "damping": 'damping="3"',
            "frictionloss": 'frictionloss="3"',
            "armature": 'armature="3"',
            "class": 'class="c"',
        },
        warned={
            "stiffness": ('stiffness="3"', "<joint stiffness> of joint 'j'"),
            "stiffness#": ('stiffness="0 2 1"', "<joint stiffness> of joint 'j'"),
            "springref": ('stiffness="3" springref="10"', "<joint stiffness> of joint 'j'"),
            "springdamper": ('springdamper="1 1"', "<joint stiffness> of joint 'j'"),
            "springyield": ('stiffness="3" springyield="10"', "<joint stiffness> of joint 'j'"),
            "damping": ('damping="0 2 1"', "<joint damping> of joint 'j'"),
            "range": ('type="ball" range="0 20"', "<joint range> of joint 'j'"),
            "type": ('type="ball" stiffness="1"', "<joint stiffness> of joint 'j'"),
        },
        irrelevant={
            "margin": (bounded, f'{bounded} margin=".1"'),
            "solreflimit": (bounded, f'{bounded} solreflimit=".1 1"'),
            "solimplimit": (bounded, f'{bounded} solimplimit=".5 .6 .1 .5 2"'),
            "solreffriction": ('frictionloss="1"', 'frictionloss="1" solreffriction=".1 1"'),
            "solimpfriction": ('frictionloss="1"', 'frictionloss="1" solimpfriction=".5 .6 .1 .5 2"'),
            "group": 'group="4"',
            "user": 'user="1 2"',
        },
        without_sample="name",
    )
    yield from rows(
        "body/joint",
        doc.LONE_JOINT,
        warned={
            "armature": ('type="free" armature="1"', "<joint armature> of joint 'j'"),
            "frictionloss": ('type="free" frictionloss="1"', "<joint frictionloss> of joint 'j'"),
        },
    )
    forced = 'actuatorfrcrange="-3 3"'
    yield from rows(
        "body/joint",
        doc.DRIVEN_JOINT,
        honoured={
            "actuatorfrcrange": forced,
            "actuatorfrclimited": (forced, f'{forced} actuatorfrclimited="false"'),
        },
        warned={"actuatorfrcrange": ('actuatorfrcrange="-3 5"', "actuatorfrcrange>, or")},
    )
    yield from rows(
        "body/joint",
        doc.JOINT_GRAVCOMP,
        warned={"actuatorgravcomp": ((None, 'actuatorgravcomp="true"'), "<body gravcomp> of body 'a'")},
    )


def table() -> list[Sample]:
    """Every attribute of the schema, some with several samples."""
    found = [*options(), *compiler(), *bodies(), *with_defaults(joints(), "joint")]
    found += with_defaults(shapes.geoms(), "geom")
    found += shapes.masks()
    found += with_defaults(shapes.sites(), "site")
    found += with_defaults(shapes.meshes(), "mesh")
    found += with_defaults(shapes.pairs(), "pair")
    found += with_defaults(parts.tendons(), "tendon")
    found += with_defaults(parts.equalities(), "equality")
    found += parts.others()
    for tag in ACTUATORS:
        samples = actuators(tag)
        found += with_defaults(samples, tag) if f"default/{tag}" in schema() else samples
    return found
