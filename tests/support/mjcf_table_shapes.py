"""The parts of the table about geoms, sites, meshes and pairs of contacts."""

from __future__ import annotations

from collections.abc import Iterator

from support import mjcf_documents as doc
from support.mjcf_physics import schema
from support.mjcf_sample import SOFT_SOLVER, TURNS, Sample, rows


def geoms() -> Iterator[Sample]:
    box = 'type="box" size=".1 .2 .3"'
    yield from rows(
        "body/geom",
        doc.GEOM,
        box,
        honoured={
            "type": (box, 'type="ellipsoid" size=".1 .2 .3"'),
            "size": (box, 'type="box" size=".1 .2 .4"'),
            "pos": 'pos=".1 .2 .3"',
            **TURNS,
            "fromto": ('type="capsule" size=".1 .2"', 'type="capsule" size=".1" fromto="0 0 0 1 2 3"'),
            "mass": 'mass="3"',
            "density": 'density="300"',
            "shellinertia": 'shellinertia="true"',
            "group": 'group="4"',
            "class": 'class="c"',
        },
        irrelevant={
            **SOFT_SOLVER,
            "adhesion": 'adhesion="1"',
            "condim": 'condim="6"',
            "friction": 'friction="2 2 2"',
            "gap": 'margin="1" gap="1"',
            "margin": 'margin=".1"',
            "priority": 'priority="3"',
            "solmix": 'solmix="2"',
            "surfacevel": 'surfacevel="1 2 3 1 1 1"',
            "rgba": 'rgba=".1 .2 .3 1"',
            "material": 'material="red"',
            "castshadow": 'castshadow="false"',
            "user": 'user="1 2"',
        },
        without_sample="name",
    )
    yield from rows(
        "body/geom",
        doc.FLUID,
        warned={
            "fluidshape": ('fluidshape="ellipsoid"', "<option density>"),
            "fluidcoef": ('fluidshape="ellipsoid" fluidcoef="1 1 1 1 1"', "<option density>"),
        },
    )
    yield from rows("body/geom", doc.FITTED, honoured={"fitscale": 'fitscale="2"'})
    meshed = doc.MESHES.replace('mesh="t"', "@").replace('name="t" @', 'name="t" file="tetra.obj"')
    yield from rows("body/geom", meshed, honoured={"mesh": (None, 'mesh="t"')})
    field = doc.GEOM.replace(
        "<asset>", '<asset><hfield name="f" nrow="2" ncol="2" size="1 1 1 1" elevation="0 1 0 1"/>'
    )
    field = field.replace("</worldbody>", "<geom @/></worldbody>").replace('<geom name="g" @/>', "")
    yield from rows(
        "body/geom", field, warned={"hfield": (('size=".1"', 'type="hfield" hfield="f"'), "height fields")}
    )
    for name in schema()["asset/hfield"]:
        yield from rows(
            "asset/hfield", field, warned={name: (('size=".1"', 'type="hfield" hfield="f"'), "height fields")}
        )
    distance = """<mujoco><extension><plugin plugin="mujoco.sdf.torus"><instance name="i"/></plugin></extension>
    <asset><mesh name="t"><plugin instance="i"/></mesh></asset><worldbody><body name="a"><joint/><geom size=".1"/>@</body></worldbody></mujoco>"""
    shape = '<geom type="sdf" mesh="t"><plugin instance="i"/></geom>'
    for path in ("asset/mesh/plugin", "body/geom/plugin"):
        for name in schema()[path]:
            yield from rows(path, distance, warned={name: (("", shape), "signed distance")})
        yield from rows(f"{path}/config", without_sample="key value")


def masks() -> Iterator[Sample]:
    apart = 'contype="2" conaffinity="2"'
    mixed = (f'size=".2" {apart}', "<geom contype conaffinity>")
    yield from rows(
        "body/geom",
        doc.GEOM,
        'size=".2"',
        warned={"contype": ((mixed[0].replace(apart, ""), mixed[0]), mixed[1])},
    )
    yield from rows(
        "body/geom",
        doc.MASKS.replace("%", ""),
        honoured={
            "contype": ('contype="2" conaffinity="0"', 'contype="1" conaffinity="0"'),
            "conaffinity": ('contype="2" conaffinity="0"', 'contype="2" conaffinity="1"'),
        },
    )
    general = doc.MASKS.replace("@", "").replace("%", "<geom @/>")
    yield from rows(
        "default/geom", general, honoured={"contype": 'contype="0"', "conaffinity": 'conaffinity="0"'}
    )


def sites() -> Iterator[Sample]:
    yield from rows(
        "body/site",
        doc.SITE,
        honoured={
            "pos": 'pos=".1 .2 .3"',
            **TURNS,
            "fromto": ('type="capsule" size=".1"', 'type="capsule" size=".1" fromto="0 0 0 1 2 3"'),
            "class": 'class="c"',
        },
        irrelevant={
            "size": 'size=".3"',
            "type": 'type="box"',
            "group": 'group="4"',
            "rgba": 'rgba="1 0 0 1"',
        },
        without_sample="name material mesh user",
    )


def meshes() -> Iterator[Sample]:
    file = 'file="tetra.obj"'
    corners = 'vertex="0 0 0 1 0 0 0 1 0 0 0 1"'
    yield from rows(
        "asset/mesh",
        doc.MESHES,
        file,
        honoured={
            "file": (file, 'file="parts/small.obj"'),
            "scale": 'scale="1 2 3"',
            "refpos": 'refpos="1 2 3"',
            "refquat": 'refquat="1 .2 .3 .4"',
            "inertia": 'inertia="shell"',
            "class": 'class="c"',
        },
        warned={
            "refquat": ('scale="1 2 3" refquat="1 1 0 0"', "meshes with refquat and unequal scales"),
            "vertex": ((None, corners), "meshes without a file"),
            "face": ((None, f'{corners} face="0 2 1 0 1 3 0 3 2 1 2 3"'), "meshes without a file"),
            "builtin": ((None, 'builtin="sphere" params="1"'), "meshes without a file"),
            "params": ((None, 'builtin="sphere" params="1"'), "meshes without a file"),
        },
        irrelevant={
            "maxhullvert": 'maxhullvert="4"',
            "smoothnormal": 'smoothnormal="true"',
            "content_type": 'content_type="model/obj"',
        },
        without_sample="name normal texcoord material",
    )


def pairs() -> Iterator[Sample]:
    yield from rows(
        "contact/pair",
        doc.TWO_PARTS,
        honoured={
            "geom1": ("", '<pair geom1="g" geom2="gd"/>'),
            "geom2": ("", '<pair geom1="gc" geom2="gd"/>'),
        },
    )
    near = ("", '<pair geom1="g" geom2="h"/>'), "<contact><pair> of 'a' and 'a'"
    yield from rows("contact/pair", doc.TWO_PARTS, warned={"geom1": near, "geom2": near})
    yield from rows(
        "contact/pair",
        doc.PAIR,
        irrelevant={
            **SOFT_SOLVER,
            "class": 'class="c"',
            "adhesion": 'adhesion="1"',
            "condim": 'condim="1"',
            "friction": 'friction="2 2 1 1 1"',
            "gap": 'margin="1" gap="1"',
            "margin": 'margin=".1"',
            "solreffriction": 'solreffriction=".1 1"',
        },
        without_sample="name",
    )
