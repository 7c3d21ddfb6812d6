"""Robots by name and by file."""

from __future__ import annotations

import subprocess
import sys
import textwrap

import numpy as np
import pytest

from ulna.errors import FormatError, InputError, MissingExtra, ModelError, ModelWarning, UnknownName
from ulna.geometry import Box, Mesh, Sphere
from ulna.loading import load, load_model
from ulna.robots import catalogue, example_robot_data, robot_descriptions

URDF = """<robot name="tiny"><link name="a"/><link name="b">
 <visual><geometry><sphere radius="1"/></geometry></visual>
 <collision><geometry><box size="1 1 1"/></geometry></collision></link>
 <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"""

needs_data = pytest.mark.skipif(example_robot_data.share_folder() is None, reason="example-robot-data")


def test_loading_a_robot_does_not_import_masked_arrays():
    code = "import sys, ulna; ulna.load('panda', visuals='simple'); sys.exit('numpy.ma' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tiny.urdf"
    path.write_text(URDF)
    return path


@pytest.fixture
def no_packages(monkeypatch):
    monkeypatch.setattr(example_robot_data, "share_folder", lambda: None)
    monkeypatch.setattr(robot_descriptions, "names", lambda: ())


def test_by_name():
    for name in ("panda", "Panda", " PANDA ", "panda-fingers", "Panda Fingers", "ulna:panda", "ur5", "UR5"):
        assert load_model(name, visuals="simple").name.startswith(("panda", "ur5"))
    robot = load("panda", visuals="simple")
    assert robot.model == load_model("panda", visuals="simple")


def test_by_file(file, monkeypatch):
    model = load_model(file)
    assert (model.name, model.source) == ("tiny", str(file))
    assert load_model(str(file)) == model
    monkeypatch.chdir(file.parent)
    assert load_model("tiny.urdf") == model
    assert load_model(URDF) == model
    assert load_model(URDF).source is None
    assert load_model(file, root="free_flyer").nq == 8
    assert load_model(file, root="auto").nq == 1
    assert load_model("\ufeff\n" + URDF) == model
    (file.parent / "panda").write_text("not a robot")  # a file without an ending does not hide a name
    assert load_model("panda", visuals="simple").nq == 7


def test_visuals_of_files(file):
    assert [g.shape for g in load_model(file).link("b").visuals] == [Sphere(1)]
    assert [g.shape for g in load_model(file, visuals="simple").link("b").visuals] == [Box((1, 1, 1))]
    with pytest.raises(UnknownName, match="Did you mean 'simple'"):
        load_model(file, visuals="simpl")


def test_srdf_beside_it(file, tmp_path):
    text = '<robot><group_state name="up"><joint name="j" value="0.5"/></group_state></robot>'
    (tmp_path / "tiny.srdf").write_text(text)
    for given in (tmp_path / "tiny.srdf", text, "\n  " + text):
        model = load_model(file, srdf=given)
        np.testing.assert_array_equal(model.configurations["up"], [0.5])


def test_xacro(tmp_path):
    pytest.importorskip("xacro")
    path = tmp_path / "r.urdf.xacro"
    path.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default="a"/>'
        '<link name="$(arg n)"/></robot>'
    )
    assert load_model(path).link_names == ("a",)
    assert load_model(path, xacro_args={"n": "b"}).link_names == ("b",)


def test_package_dirs(tmp_path):
    mesh = tmp_path / "elsewhere" / "arm" / "a.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes(b"")
    text = (
        '<robot name="r"><link name="a"><visual><geometry><mesh filename="package://arm/a.stl"/></geometry>'
        "</visual></link></robot>"
    )
    for folders in ([tmp_path / "elsewhere"], tmp_path / "elsewhere", str(tmp_path / "elsewhere")):
        shape = load_model(text, package_dirs=folders).link("a").visuals[0].shape
        assert shape == Mesh(str(mesh))
        assert shape.path == str(mesh)


@pytest.mark.parametrize(
    ("given", "said"), [(None, "None"), (3, "of type int"), (b"<robot/>", "of type bytes")]
)
def test_what_is_neither_a_name_nor_a_path_nor_text(given, said):
    with pytest.raises(InputError, match=f"`name_or_path` is {said}; expected a robot's name"):
        load(given)


def test_unknown_names(no_packages):
    with pytest.raises(UnknownName, match=r"No robot named 'pandaa'\. Did you mean 'panda'"):
        load_model("pandaa")
    with pytest.raises(MissingExtra, match=r"The robot 'talos' needs the package 'example-robot-data'"):
        load_model("talos")
    with pytest.raises(UnknownName, match="source of robots"):
        load_model("urdf:panda")
    with pytest.raises(MissingExtra):
        load_model("example-robot-data:panda")
    with pytest.raises(ModelError, match="pip install robot_descriptions"):
        load_model("robot_descriptions:panda")
    with pytest.raises(FormatError, match="no such file"):
        load_model("pandaa.urdf")
    with pytest.raises(FormatError, match="no such file"):
        load_model("robots/panda")
    assert [e.name for e in catalogue.entries()] == ["panda", "panda_fingers", "ur5"]


@needs_data
def test_every_description_has_a_name_and_every_name_a_file():
    folder = example_robot_data.share_folder() / "robots"
    named = {d.urdf for d in example_robot_data.DESCRIPTIONS.values()}
    assert named == {str(p.relative_to(folder)) for p in folder.rglob("*.urdf")}
    assert len(named) == len(example_robot_data.DESCRIPTIONS) == 69
    for name, description in example_robot_data.DESCRIPTIONS.items():
        urdf, srdf = example_robot_data.files(name)
        assert urdf.is_file()
        assert (srdf is not None) == (description.srdf is not None)
        assert catalogue.find(f"example-robot-data:{name}").source == "example-robot-data"


@needs_data
def test_order_of_sources():
    assert catalogue.find("panda").source == "ulna"
    assert catalogue.find("talos").source == "example-robot-data"
    assert load_model("example-robot-data:panda").tool != load_model("panda").tool
    assert "talos" in catalogue.names()


@needs_data
def test_floating_robots_and_their_postures():
    assert load_model("solo12").nq == 12
    solo = load_model("solo12", root="auto")
    assert solo.nq == 19
    assert solo.configurations["standing"][2] > 0.2
    assert load_model("panda", root="auto").nq == 7
    assert "FL_HAA" in solo.groups["lf_leg"]
    with pytest.raises(UnknownName, match="robot of example-robot-data"):
        load_model("example-robot-data:solo13")


@pytest.fixture
def descriptions(tmp_path, monkeypatch):
    """A package robot_descriptions that needs no network."""
    package = tmp_path / "robot_descriptions"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (tmp_path / "tiny.urdf").write_text(URDF)
    paths = f"PACKAGE_PATH = REPOSITORY_PATH = {str(tmp_path)!r}\n"
    (package / "tiny_description.py").write_text(paths + f"URDF_PATH = {str(tmp_path / 'tiny.urdf')!r}\n")
    (package / "odd_description.py").write_text(paths + "SDF_PATH = 'x'\n")
    (package / "far_description.py").write_text("raise OSError('a\\nno route to host')\n")
    (tmp_path / "some.xml").write_text("<mujoco model='some'/>")
    (package / "some_mj_description.py").write_text(paths + f"MJCF_PATH = {str(tmp_path / 'some.xml')!r}\n")
    for module in [m for m in sys.modules if m.split(".")[0] == "robot_descriptions"]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.syspath_prepend(str(tmp_path))
    robot_descriptions.names.cache_clear()
    yield
    for module in [m for m in sys.modules if m.split(".")[0] == "robot_descriptions"]:
        del sys.modules[module]
    robot_descriptions.names.cache_clear()


def test_robot_descriptions(descriptions):
    ending = "_description"
    assert [name.removesuffix(ending) for name in robot_descriptions.names()] == [
        "far",
        "odd",
        "some_mj",
        "tiny",
    ]
    for name in ("tiny_description", "tiny", "robot_descriptions:tiny"):
        assert load_model(name).name == "tiny"
    assert load_model("some_mj").name == "some"
    with pytest.raises(ModelError, match="neither a URDF, a xacro nor an MJCF file"):
        load_model("odd_description")
    with pytest.raises(ModelError, match="could not provide 'far_description': no route to host"):
        load_model("far")
    with pytest.raises(UnknownName, match="Did you mean 'tiny_description'"):
        load_model("robot_descriptions:tiny_descripton")


def test_loading_a_model_compiles_nothing():
    code = """
    import sys
    from ulna.loading import load_model
    load_model("panda", visuals="simple")
    heavy = {"viser", "trimesh", "collada", "xacro", "mujoco", "matplotlib", "robot_descriptions"}
    sys.exit(", ".join(sorted(heavy & set(sys.modules))) or 0)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_arguments_of_xacro_files_are_refused_elsewhere_and_misspelt_ones_are_named(file, tmp_path):
    pytest.importorskip("xacro")
    path = tmp_path / "named.xacro"
    path.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="name" default="a"/>'
        '<link name="$(arg name)"/></robot>'
    )
    with pytest.warns(ModelWarning, match=r"'nam', which the file does not ask for.* Did you mean 'name'\?"):
        assert load_model(path, xacro_args={"nam": "b"}).link_names == ("a",)
    for other in (file, URDF, "ur5"):
        with pytest.raises(InputError, match="is not read as xacro"):
            load_model(other, xacro_args={"name": "b"})
    for wrong in ("name:=b", ["name:=b"], {1: "b"}):
        with pytest.raises(InputError, match="expected a dictionary of values by name"):
            load_model(path, xacro_args=wrong)


def test_fingers_of_the_panda_move_each_on_its_own_where_asked():
    free = load("panda_fingers", visuals="simple", mimic=False)
    assert free.nq == load("panda_fingers", visuals="simple").nq + 1
    q = free.configurations["qr"]
    opening = [free.fk(q, f"panda_{side}finger")[:3, 3] for side in ("left", "right")]
    assert np.linalg.norm(opening[0] - opening[1]) == pytest.approx(2 * q[-1])
    assert q[-1] == q[-2] > 0.0
