"""Models, data and small objects through pickle, copy, text and files."""

import copy
import os
import pickle
import tempfile

import numpy as np
import pinocchio as pin

model = pin.buildSampleModelHumanoid()
model.referenceConfigurations["ready"] = pin.neutral(model)
twin = pickle.loads(pickle.dumps(model))
print(twin == model, twin.nq, twin.name == model.name, len(twin.referenceConfigurations))
with tempfile.TemporaryDirectory() as folder:
    for save, load, ending in (
        ("saveToText", "loadFromText", "txt"),
        ("saveToBinary", "loadFromBinary", "bin"),
        ("saveToXML", "loadFromXML", "xml"),
    ):
        path = os.path.join(folder, "model." + ending)
        getattr(model, save)(path, *(["model"] if ending == "xml" else []))
        other = pin.Model()
        getattr(other, load)(path, *(["model"] if ending == "xml" else []))
        print(ending, other == model, other.njoints)
text = model.saveToString()
other = pin.Model()
other.loadFromString(text)
print(other == model)
M = pin.XYZQUATToSE3(np.array([1.0, 2.0, 3.0, 0.0, 0.0, np.sin(0.2), np.cos(0.2)]))
v, f = pin.Motion(np.arange(6.0)), pin.Force(np.arange(6.0)[::-1].copy())
Y = pin.Inertia(2.0, np.array([0.1, 0.2, 0.3]), np.diag([0.3, 0.4, 0.5]))
for thing in (M, v, f, Y):
    again = pickle.loads(pickle.dumps(thing))
    print(type(again).__name__, again == thing, copy.copy(thing) == thing, copy.deepcopy(thing) == thing)
    print(thing)
print(pin.SE3ToXYZQUAT(M), pin.SE3ToXYZQUATtuple(M))
data = model.createData()
pin.rnea(model, data, pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv))
saved = data.copy()
print(np.array_equal(saved.tau, data.tau), saved.oMi[1] == data.oMi[1])
vec = pin.StdVec_Force()
vec.extend([f, f])
print(len(vec), pickle.loads(pickle.dumps(vec))[1] == f)
print(pin.StdVec_SE3([M, M])[0] == M, list(pin.StdVec_Index([1, 2])), list(pin.StdVec_StdString(["a", "b"])))
