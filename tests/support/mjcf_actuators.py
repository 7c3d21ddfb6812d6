"""The part of the table about actuators: limits of force, armature and damping count, laws of control do not."""

from __future__ import annotations

from support import mjcf_documents as doc
from support.mjcf_physics import schema
from support.mjcf_sample import Sample, Text, rows

ACTUATORS = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "plugin",
]

LAWS = [
    "name",
    "user",
    "lengthrange",
    "delay",
    "interp",
    "nsample",
    "actdim",
    "actearly",
    "actlimited",
    "actrange",
    "dynprm",
    "biasprm",
    "biastype",
    "dyntype",
    "gainprm",
    "gaintype",
    "inheritrange",
    "input",
    "velrange",
    "ffrange",
    "posrange",
    "kp",
    "kv",
    "ki",
    "imax",
    "slewmax",
    "dampratio",
    "timeconst",
    "area",
    "bias",
    "diameter",
    "force",
    "fpmax",
    "fvmax",
    "lmax",
    "lmin",
    "range",
    "scale",
    "vmax",
    "tausmooth",
    "gain",
    "cogging",
    "controller",
    "inductance",
    "lugre",
    "motorconst",
    "nominal",
    "resistance",
    "saturation",
    "thermal",
    "cranklength",
]
"""Names, and what turns a control into a force: Ulna takes the torques of joints."""

ELSEWHERE = "<actuator> that does not act on a hinge or slide of actuator"
BOUNDED = 'forcerange="-3 3"'


def actuators(tag: str) -> list[Sample]:
    """The samples of one kind of actuator."""
    known = schema()[f"actuator/{tag}"]
    path = f"actuator/{tag}"
    plain = [*rows(path, without_sample=" ".join(known & set(LAWS)))]
    if tag == "plugin":
        return [*plain, *_plugin(known)]
    if tag == "adhesion":
        return [*plain, *_adhesion(known)]
    if tag == "orientation":
        return [*plain, *_orientation(known)]
    extra = {
        "muscle": 'lengthrange="0 1"',
        "dcmotor": 'motorconst="1" resistance="1"',
        "damper": 'ctrlrange="0 1"',
    }
    base = f'joint="k" {extra.get(tag, "")}'.strip()
    moved: dict[str, Text] = {
        "armature": f'{base} armature=".5"',
        "damping": f'{base} damping=".5"',
        "jointinparent": f'{base} armature=".5"'.replace("joint=", "jointinparent="),
    }
    honoured: dict[str, Text] = {
        name: (base, after) for name, after in moved.items() if isinstance(after, str)
    }
    honoured["joint"] = (f'{base} armature=".5"', f'{base} armature=".5"'.replace('"k"', '"l"'))
    honoured["gear"] = (f'{base} armature=".5"', f'{base} armature=".5" gear="3"')
    honoured["class"] = (base, f'{base} class="c"') if tag in ("general", "motor", "position") else ("", "")
    if "forcerange" in known:
        pushing = base if tag != "damper" else f"{base}"
        if tag in ("general", "motor", "position", "pid", "cylinder", "intvelocity", "velocity"):
            honoured["forcerange"] = (pushing, f"{pushing} {BOUNDED}")
            honoured["forcelimited"] = (f"{pushing} {BOUNDED}", f'{pushing} {BOUNDED} forcelimited="false"')
            honoured["group"] = (f"{pushing} {BOUNDED}", f'{pushing} {BOUNDED} group="3"')
    if tag in ("general", "motor"):
        honoured["ctrlrange"] = (base, f'{base} ctrlrange="-2 2"')
        honoured["ctrllimited"] = (f'{base} ctrlrange="-2 2"', f'{base} ctrlrange="-2 2" ctrllimited="false"')
    honoured = {name: text for name, text in honoured.items() if text != ("", "")}
    rest = " ".join(
        (known & {"forcerange", "forcelimited", "group", "ctrlrange", "ctrllimited", "class"}) - set(honoured)
    )
    found = [*plain, *rows(path, _document(tag), base, honoured=honoured, without_sample=rest)]
    return [*found, *_on_other_things(tag, base)]


def _on_other_things(tag: str, base: str) -> list[Sample]:
    known = schema()[f"actuator/{tag}"]
    limited = f"{base} {BOUNDED}" if "forcerange" in known else f'{base} armature=".5"'
    said = ELSEWHERE if "forcerange" in known else "<actuator armature> of actuator"
    other = {
        "tendon": limited.replace('joint="k"', 'tendon="t"'),
        "site": limited.replace('joint="k"', 'site="s"'),
        "refsite": limited.replace('joint="k"', 'site="s" refsite="w"'),
        "cranksite": limited.replace('joint="k"', 'cranksite="s" slidersite="w" cranklength="1"'),
        "slidersite": limited.replace('joint="k"', 'cranksite="s" slidersite="w" cranklength="1"'),
        "body": limited.replace('joint="k"', 'body="a"'),
    }
    if "forcerange" not in known:  # armature is for joints and tendons only
        rest = " ".join(known & set(other) - {"tendon"})
        one = rows(
            f"actuator/{tag}",
            _document(tag),
            warned={"tendon": ((base, other["tendon"]), said)},
            without_sample=rest,
        )
        return [*one]
    warned: dict[str, tuple[Text, str]] = {
        name: ((base, text), said) for name, text in other.items() if name in known
    }
    on_tendon = base.replace('joint="k"', 'tendon="t"')
    warned["armature"] = ((on_tendon, f'{on_tendon} armature=".5"'), "<actuator armature> of actuator")
    warned["damping"] = ((base, f'{base} damping="1 2 3"'), "<actuator damping> of actuator")
    found = [*rows(f"actuator/{tag}", _document(tag), warned=warned)]
    if tag in ("general", "motor"):
        uneven: dict[str, tuple[Text, str]] = {
            "forcerange": ((base, f'{base} forcerange="-1 3"'), "the range of force is not symmetric"),
            "ctrlrange": ((base, f'{base} ctrlrange="-1 3"'), "the range of force is not symmetric"),
        }
        found += rows(f"actuator/{tag}", _document(tag), warned=uneven)
    return found


def _orientation(known: frozenset[str]) -> list[Sample]:
    site = 'site="s" refsite="w" forcerange="0 3"'
    ball = 'joint="j" forcerange="0 3"'
    document = doc.BALL_ACTUATOR.replace("MOTOR", "orientation")
    found = [
        *rows(
            "actuator/orientation",
            document,
            warned={
                "joint": (('joint="j"', ball), ELSEWHERE),
                "forcerange": (('joint="j"', ball), ELSEWHERE),
                "forcelimited": (('joint="j"', f'{ball} forcelimited="true"'), ELSEWHERE),
            },
        )
    ]
    on_site = _document("orientation")
    unlimited = 'site="s" refsite="w"'
    found += rows(
        "actuator/orientation",
        on_site,
        warned={n: ((unlimited, site), ELSEWHERE) for n in ("site", "refsite")},
    )
    return [
        *found,
        *rows("actuator/orientation", without_sample=" ".join(known & {"class", "ctrlrange", "group"})),
    ]


def _adhesion(known: frozenset[str]) -> list[Sample]:
    base = 'body="a" ctrlrange="0 1"'
    said: tuple[Text, str] = ((None, f'{base} forcerange="0 3"'), ELSEWHERE)
    held: dict[str, tuple[Text, str]] = {"body": said, "forcerange": said, "forcelimited": said}
    rest = " ".join(known & {"class", "ctrlrange", "group"})
    return [*rows("actuator/adhesion", _document("adhesion"), warned=held, without_sample=rest)]


def _plugin(known: frozenset[str]) -> list[Sample]:
    head = '<extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="4"/></instance></plugin></extension>'
    document = _document("plugin").replace("<option ", f"{head}<option ")
    said: tuple[Text, str] = (
        (None, 'joint="k" plugin="mujoco.pid" instance="i"'),
        "<actuator><plugin> of actuator",
    )
    warned = {name: said for name in known - set(LAWS)}
    return [
        *rows("actuator/plugin", document, warned=warned),
        *rows("actuator/plugin/config", without_sample="key value"),
    ]


def _document(tag: str) -> str:
    return doc.ACTUATOR.replace("MOTOR", tag)
