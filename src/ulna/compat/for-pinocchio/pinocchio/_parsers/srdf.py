"""SRDF: named configurations, rotors, and pairs of geometries that need no checking."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from pinocchio._algorithms.configurations import neutral
from pinocchio._containers.files import path_of
from pinocchio._containers.unknown_ids import known
from pinocchio._geometry.geometry_model import GeometryModel
from pinocchio._model.model import Model
from ulna.errors import ModelWarning
from ulna.formats.srdf import SrdfDocument, parse_srdf, read_srdf


def loadReferenceConfigurations(model: Model, srdf_filename: Any, verbose: bool = False) -> None:
    """Fills `model.referenceConfigurations` from the named states of an SRDF file.

    Args:
        verbose: Accepted and ignored.

    Raises:
        FormatError: The file is missing or broken. A state that does not fit a joint only warns.
    """
    _postures(model, read_srdf(path_of(srdf_filename)))


def loadReferenceConfigurationsFromXML(model: Model, srdf_xml_stream: str, verbose: bool = False) -> None:
    """Fills `model.referenceConfigurations` from the named states of an SRDF text.

    Args:
        srdf_xml_stream: The text.
        verbose: Accepted and ignored.
    """
    _postures(model, parse_srdf(srdf_xml_stream))


def _postures(model: Model, document: SrdfDocument) -> None:
    for state in document.states:
        q = np.array(neutral(model))
        for name, values in state.values.items():
            if not model.existJointName(name):
                continue  # fixed joints, and joints of other variants of the robot
            joint = model.joints[known(model.getJointId(name))]
            entries = values
            if joint.nq == 2 and len(values) == 1:  # an angle, written as cosine and sine
                entries = (np.cos(values[0]), np.sin(values[0]))
            if len(entries) != joint.nq:
                text = f"State {state.name!r} gives joint {name!r} {len(values)} numbers; it has {joint.nq}."
                warnings.warn(text, ModelWarning, stacklevel=3)
                continue
            q[joint.idx_q : joint.idx_q + joint.nq] = entries
        model.referenceConfigurations[state.name] = q


def loadRotorParameters(model: Model, srdf_filename: Any, verbose: bool = False) -> bool:
    """Fills `model.rotorInertia` and `model.rotorGearRatio` from an SRDF file.

    Args:
        verbose: Accepted and ignored.

    Returns:
        Whether it has any.
    """
    rotors = read_srdf(path_of(srdf_filename)).rotors
    for name, (inertia, ratio) in rotors.items():
        if model.existJointName(name):
            place = model.joints[known(model.getJointId(name))].idx_v
            model._arrays["rotorInertia"][place], model._arrays["rotorGearRatio"][place] = inertia, ratio
    return bool(rotors)


def removeCollisionPairs(
    model: Model, geom_model: GeometryModel, srdf_filename: Any, verbose: bool = False
) -> None:
    """Removes the pairs of links that an SRDF file disables.

    Args:
        geom_model: Its geometries, whose pairs are removed.
        verbose: Accepted and ignored.
    """
    _remove(model, geom_model, read_srdf(path_of(srdf_filename)))


def removeCollisionPairsFromXML(
    model: Model, geom_model: GeometryModel, srdf_xml_stream: str, verbose: bool = False
) -> None:
    """Removes the pairs of links that an SRDF text disables.

    Args:
        geom_model: Its geometries, whose pairs are removed.
        srdf_xml_stream: The text.
        verbose: Accepted and ignored.
    """
    _remove(model, geom_model, parse_srdf(srdf_xml_stream))


def _remove(model: Model, geom_model: GeometryModel, document: SrdfDocument) -> None:
    links = [
        model.frames[g.parentFrame].name if 0 <= g.parentFrame < model.nframes else ""
        for g in geom_model.geometryObjects
    ]
    disabled = {frozenset(pair) for pair in document.disabled_pairs}
    remaining = [
        p for p in geom_model.collisionPairs if frozenset((links[p.first], links[p.second])) not in disabled
    ]
    geom_model.collisionPairs.clear()
    geom_model.collisionPairs.extend(remaining)
