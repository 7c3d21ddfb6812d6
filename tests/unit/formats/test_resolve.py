"""Where mesh URIs are looked for."""

from __future__ import annotations

import pytest

from ulna.formats.resolve import Resolver


@pytest.fixture
def tree(tmp_path):
    """Two packages beside each other, a third under another name, a fourth in a ROS 2 prefix."""
    for file in (
        "ws/arm/urdf/arm.urdf",
        "ws/arm/meshes/a.stl",
        "ws/arm/meshes/with blank.stl",
        "ws/hand/meshes/h.stl",
        "ws/checkout-main/urdf/x.urdf",
        "ws/checkout-main/meshes/x.stl",
        "ws/renamed/package.xml",
        "ws/renamed/meshes/r.stl",
        "ros/tool/t.stl",
        "prefix/share/cell/c.stl",
    ):
        path = tmp_path / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("<package><name>official</name></package>" if path.name == "package.xml" else "")
    return tmp_path


def resolve(tree, uri, file="ws/arm/urdf/arm.urdf", package_dirs=(), **environ):
    found = Resolver(tree / file, package_dirs, environ).resolve(uri).path
    return None if found is None else found.removeprefix(str(tree) + "/")


@pytest.mark.parametrize(
    "uri",
    [
        "package://arm/meshes/a.stl",
        "package:///arm/meshes/a.stl",
        "package://arm//meshes/a.stl",
        "model://arm/meshes/a.stl",
        "package://some_other_name/meshes/a.stl",
        "../meshes/a.stl",
        "./../meshes/a.stl",
        "meshes/a.stl",
        "arm/meshes/a.stl",
        "file://../meshes/a.stl",
        "..\\meshes\\a.stl",
        " package://arm/meshes/a.stl ",
        "package://arm/meshes\\a.stl",
    ],
)
def test_spellings_of_one_file(tree, uri):
    assert resolve(tree, uri) == "ws/arm/meshes/a.stl"


def test_absolute_paths(tree):
    path = f"{tree}/ws/arm/meshes/with blank.stl"
    for uri in (
        path,
        f"file://{path}",
        f"file:{path}",
        f"file://localhost{path}",
        f"file://{path.replace(' ', '%20')}",
    ):
        assert resolve(tree, uri) == "ws/arm/meshes/with blank.stl"


def test_neighbours_and_environment(tree):
    assert resolve(tree, "package://hand/meshes/h.stl") == "ws/hand/meshes/h.stl"
    assert resolve(tree, "package://tool/t.stl") is None
    assert resolve(tree, "package://tool/t.stl", ROS_PACKAGE_PATH=f"/nowhere:{tree}/ros") == "ros/tool/t.stl"
    assert resolve(tree, "package://tool/t.stl", ROS_PACKAGE_PATH=f"{tree}/ros/tool") == "ros/tool/t.stl"
    assert (
        resolve(tree, "package://cell/c.stl", AMENT_PREFIX_PATH=f"{tree}/prefix") == "prefix/share/cell/c.stl"
    )
    assert resolve(tree, "package://tool/t.stl", package_dirs=[tree / "ros"]) == "ros/tool/t.stl"
    assert resolve(tree, "package://tool/t.stl", package_dirs=[tree / "ros" / "tool"]) == "ros/tool/t.stl"
    assert resolve(tree, "t.stl", package_dirs=[tree / "ros" / "tool"]) == "ros/tool/t.stl"


def test_a_checkout_under_another_name(tree):
    uri = "package://my_robot/meshes/x.stl"
    assert resolve(tree, uri, "ws/checkout-main/urdf/x.urdf") == "ws/checkout-main/meshes/x.stl"


def test_the_name_in_package_xml(tree):
    resolver = Resolver(tree / "ws/renamed/urdf/r.urdf", (), {})
    assert resolver.find_package("official") == str(tree / "ws/renamed")
    assert resolver.find_package("hand") == str(tree / "ws/hand")
    assert resolver.find_package("nothing") is None


def test_what_is_not_there(tree):
    resolution = Resolver(tree / "ws/arm/urdf/arm.urdf", (), {}).resolve("package://gone/g.stl")
    assert resolution.path is None
    assert str(tree / "ws/arm/gone/g.stl") in resolution.tried
    assert len(set(resolution.tried)) == len(resolution.tried)
    for uri in (
        "",
        "http://example.org/a.stl",
        "package://",
        "package://arm",
        "file://",
        "x" * 10000,
        "a\0b",
    ):
        assert Resolver(tree / "a.urdf", (), {}).resolve(uri).path is None


def test_explicit_folders_come_first(tree):
    (tree / "ws/override/arm/meshes").mkdir(parents=True)
    (tree / "ws/override/arm/meshes/a.stl").write_text("")
    found = resolve(tree, "package://arm/meshes/a.stl", package_dirs=[tree / "ws/override"])
    assert found == "ws/override/arm/meshes/a.stl"
