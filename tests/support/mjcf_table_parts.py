"""The parts of the table about tendons, equalities, soft bodies and what plays no part."""

from __future__ import annotations

from collections.abc import Iterator

from support import mjcf_documents as doc
from support.mjcf_physics import schema
from support.mjcf_sample import SOFT_SOLVER, Sample, rows

NOTHING = ["size", "statistic", "visual", "custom", "sensor", "extension"]
"""Sections of which nothing plays a part here: memory, looks, the user's own data, sensors, declarations."""

LOOKS = [
    "asset/texture",
    "asset/material",
    "asset/skin",
    "deformable/skin",
    "body/camera",
    "body/light",
    "default/texture",
    "default/material",
    "default/camera",
    "default/light",
]
"""Elements that only look, with all below them."""


def tendons() -> Iterator[Sample]:
    for path, document in (("tendon/fixed", doc.FIXED), ("tendon/spatial", doc.SPATIAL)):
        known = schema()[path]
        yield from rows(
            path,
            document,
            warned={
                "stiffness": ('stiffness="3"', "<tendon stiffness> of tendon 't'"),
                "springlength": ('stiffness="3" springlength="1"', "<tendon stiffness> of tendon 't'"),
                "springyield": ('stiffness="3" springyield=".1"', "<tendon stiffness> of tendon 't'"),
                "damping": ('damping="3"', "<tendon damping> of tendon 't'"),
                "frictionloss": ('frictionloss="3"', "<tendon frictionloss> of tendon 't'"),
                "range": ('range="-1 1"', "<tendon range> of tendon 't'"),
                "limited": ('range="-1 1" limited="true"', "<tendon range> of tendon 't'"),
                "armature": ('armature="3"', "<tendon armature> of tendon 't'"),
            },
            irrelevant={
                name: text
                for name, text in {
                    "class": 'class="c"',
                    "group": 'group="4"',
                    "user": 'user="1 2"',
                    "width": 'width="2"',
                    "rgba": 'rgba="1 0 0 1"',
                    "margin": 'margin="2"',
                }.items()
                if name in known
            },
            without_sample=" ".join(
                known
                & set(["name", "material", "solimplimit", "solreflimit", "solreffriction", "solimpfriction"])
            ),
        )
        driven = doc.DRIVEN_TENDON if path == "tendon/fixed" else doc.DRIVEN_SPATIAL
        limit = 'actuatorfrcrange="-1 1"'
        yield from rows(
            path,
            driven,
            warned={
                "actuatorfrcrange": (limit, "<actuator> that does not act on a hinge"),
                "actuatorfrclimited": (
                    f'{limit} actuatorfrclimited="true"',
                    "<actuator> that does not act on a hinge",
                ),
            },
        )


def equalities() -> Iterator[Sample]:
    linear = '<joint joint1="k" joint2="l" polycoef=".1 2 0 0 0" @/>'
    free, bound = doc.EQUALITY.replace("@", linear), doc.EQUALITY
    yield from rows(
        "equality/joint",
        free,
        honoured={"active": 'active="false"'},
        irrelevant={**SOFT_SOLVER, "class": 'class="c"'},
        without_sample="name",
    )
    yield from rows(
        "equality/joint",
        bound,
        honoured={
            "joint1": (linear.replace("@", ""), linear.replace("k", "j").replace("@", "")),
            "joint2": (linear.replace("@", ""), linear.replace('joint2="l"', 'joint2="j"').replace("@", "")),
            "polycoef": (linear.replace("@", ""), linear.replace(".1 2", ".2 3").replace("@", "")),
        },
        warned={
            "polycoef": (
                ("", '<joint joint1="k" joint2="l" polycoef="0 2 1 0 0"/>'),
                "<equality><joint polycoef>",
            ),
            "joint2": (("", '<joint joint1="k" polycoef=".1 0 0 0 0"/>'), "<equality><joint> of equality"),
        },
    )
    for tag, element in (
        ("connect", '<connect body1="a" body2="c" anchor="0 0 .1" @/>'),
        ("weld", '<weld body1="a" body2="c" relpose="0 0 1 1 0 0 0" anchor="0 0 .1" torquescale="2" @/>'),
        ("tendon", '<tendon tendon1="t" tendon2="u" polycoef="0 1 0 0 0" @/>'),
    ):
        said = f"<{tag}> of equality" if tag != "tendon" else "<equality><tendon> of equality"
        document = doc.EQUALITY.replace("@", element)
        written = [name for name in schema()[f"equality/{tag}"] if f'{name}="' in element]
        whole = {name: (("", element.replace("@", "")), said) for name in written}
        yield from rows(f"equality/{tag}", bound, warned=whole)
        yield from rows(
            f"equality/{tag}",
            document,
            honoured={"active": (None, 'active="false"')},
            irrelevant={**SOFT_SOLVER, "class": 'class="c"'},
            without_sample="name",
        )
        if tag != "tendon":
            sites = f'<{tag} site1="s" site2="w"/>'
            yield from rows(
                f"equality/{tag}", bound, warned={"site1": (("", sites), said), "site2": (("", sites), said)}
            )
    for tag in ("flex", "flexstrain"):
        yield from rows(f"equality/{tag}", without_sample=" ".join(schema()[f"equality/{tag}"]))


def others() -> Iterator[Sample]:
    for path, names in schema().items():
        if path.split("/")[0] in NOTHING or any(path == x or path.startswith(f"{x}/") for x in LOOKS):
            yield from rows(path, without_sample=" ".join(names))
    yield from rows("", without_sample="model")
    yield from rows("default", without_sample="class")
    yield from rows("asset/model", without_sample="content_type file name")
    yield from rows(
        "contact/exclude",
        doc.EQUALITY.replace("<equality>@</equality>", "<contact>@</contact>"),
        honoured={
            "body1": ("", '<exclude body1="b" body2="c"/>'),
            "body2": ("", '<exclude body1="a" body2="c"/>'),
        },
        without_sample="name",
    )
    parts = {
        "tendon/spatial/site": "site",
        "tendon/spatial/geom": "geom sidesite",
        "tendon/spatial/pulley": "divisor",
    }
    for path, names in {**parts, "tendon/fixed/joint": "coef joint"}.items():
        yield from rows(
            path, without_sample=names
        )  # of no effect unless the tendon has one, and that is warned of
    yield from rows(
        "keyframe/key",
        doc.KEY,
        honoured={"qpos": ("", 'qpos=".1 .2 1 2 3 1 0 0 0"'), "name": ("", 'name="n"')},
        irrelevant={
            "time": 'time="1"',
            "qvel": 'qvel="1 2 3 4 5 6 7 8"',
        },
        without_sample="act ctrl plastic",
    )
    yield from rows(
        "keyframe/key", doc.MOCAP_KEY, irrelevant={"mpos": 'mpos="1 2 3"', "mquat": 'mquat="0 1 0 0"'}
    )
    for name in schema()["body/plugin"]:  # MuJoCo's package brings no plugin for bodies
        yield Sample("body/plugin", name, "warned")
    yield from rows("body/plugin/config", without_sample="key value")
    flexcomp = '<flexcomp name="f" type="grid" count="2 2 2" spacing=".1 .1 .1" dim="3" mass="1"/>'
    flex = '<deformable><flex name="f" dim="1" body="a b" vertex="0 0 0 0 0 0" element="0 1"/></deformable>'
    for path, names in schema().items():
        for root, element, slot in (("body/flexcomp", flexcomp, "%"), ("deformable/flex", flex, "@")):
            if path == root or path.startswith(f"{root}/"):
                document = doc.FLEX.replace("@" if slot == "%" else "%", "").replace(slot, "@")
                for name in names:
                    yield from rows(
                        path, document, warned={name: (("", element), "<flex> and <flexcomp> of flex 'f'")}
                    )
