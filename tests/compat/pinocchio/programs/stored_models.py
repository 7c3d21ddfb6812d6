"""Models, data and geometries saved to text, XML, binary and strings, and read again."""

import os
import pickle
import tempfile

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelHumanoid()
model.referenceConfigurations["up"] = pin.neutral(model)
data = model.createData()
q = pin.neutral(model)
v = np.linspace(-0.5, 0.5, model.nv)
pin.computeAllTerms(model, data, q, v)
geometry = pin.buildSampleGeometryModelHumanoid(model)
folder = tempfile.mkdtemp()


def path(name):
    return os.path.join(folder, name)


for kind, suffix in (("Text", "txt"), ("XML", "xml"), ("Binary", "bin")):
    file = path(f"model.{suffix}")
    args = (file, "model") if kind == "XML" else (file,)
    getattr(model, f"saveTo{kind}")(*args)
    again = pin.Model()
    getattr(again, f"loadFrom{kind}")(*args)
    print(
        kind,
        os.path.getsize(file) > 0,
        again == model,
        again.name,
        again.nq,
        again.names.tolist() == model.names.tolist(),
    )
    args = (path(f"data.{suffix}"), "data") if kind == "XML" else (path(f"data.{suffix}"),)
    getattr(data, f"saveTo{kind}")(*args)
    other = model.createData()
    getattr(other, f"loadFrom{kind}")(*args)
    print(other == data, np.allclose(other.M, data.M), other.oMi[3].isApprox(data.oMi[3]))
    args = (path(f"geometry.{suffix}"), "geometry") if kind == "XML" else (path(f"geometry.{suffix}"),)
    getattr(geometry, f"saveTo{kind}")(*args)
text = model.saveToString()
other = pin.Model()
other.loadFromString(text)
print(other == model, len(text) > 1000)
buffer = pin.serialization.StreamBuffer()
model.saveToBinary(buffer)
third = pin.Model()
third.loadFromBinary(buffer)
print(third == model)
static = pin.serialization.StaticBuffer(10**6)
model.saveToBinary(static)
fourth = pin.Model()
fourth.loadFromBinary(static)
print(fourth == model, static.size())
with open(path("all.pickle"), "wb") as file:
    pickle.dump(
        {
            "model": model,
            "poses": list(data.oMi),
            "q": q,
            "M": pin.SE3.Identity(),
            "I": model.inertias[2],
            "frames": list(model.frames),
        },
        file,
    )
with open(path("all.pickle"), "rb") as file:
    stored = pickle.load(file)
print(
    stored["model"] == model,
    stored["poses"][2] == data.oMi[2],
    stored["I"] == model.inertias[2],
    stored["frames"][4] == model.frames[4],
)
for thing in (
    pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.ones(3)),
    pin.Motion(np.arange(6.0)),
    pin.Force(np.arange(6.0)),
    pin.Inertia.FromSphere(1.0, 0.2),
):
    print(type(thing).__name__, pickle.loads(pickle.dumps(thing)) == thing, repr(thing)[:20])
    if hasattr(thing, "saveToString"):
        copy = type(thing).Identity() if hasattr(type(thing), "Identity") else type(thing)()
        copy.loadFromString(thing.saveToString())
        print(copy == thing)
poses = pin.StdVec_SE3()
poses.extend([data.oMi[i] for i in (1, 2, 3)])
print(len(pickle.loads(pickle.dumps(poses))))
print(model.referenceConfigurations["up"][:7], third.referenceConfigurations["up"][:7])
try:
    pin.Model().loadFromText(path("missing.txt"))
except Exception as error:
    print("error", isinstance(error, (ValueError, RuntimeError, OSError)))
