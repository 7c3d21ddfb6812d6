"""Exported C in projects of others: included in C++, built by CMake, in place and installed."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import ulna
from support.c_library import needs

USER = """
#include "panda.h"
#include <array>
#include <cstdio>
int main()
{
    std::array<double, 7> q = {0.1, 0.2, 0.3, -1.2, 0.5, 1.6, 0.7}, found;
    std::array<double, 16> T;
    panda_fk(q.data(), T.data());
    panda_ik_report report;
    const int code = panda_ik(T.data(), nullptr, nullptr, found.data(), &report);
    std::printf("%d %.17g\\n", code, T[3]);
    return code == PANDA_IK_MET ? 0 : 1;
}
"""

PROJECT = """
cmake_minimum_required(VERSION 3.13)
project(user LANGUAGES C CXX)
if(FOUND)
  find_package(panda REQUIRED)
else()
  add_subdirectory(${PANDA} panda)
endif()
add_executable(user main.cpp)
target_link_libraries(user PRIVATE panda::panda)
"""


def test_the_header_is_one_of_cpp_too(exported: Path, tmp_path: Path) -> None:
    needs("g++")
    (tmp_path / "main.cpp").write_text('#include "panda.h"\nint main() { return 0; }\n')
    for standard in ("c++98", "c++17"):
        words = ["g++", f"-std={standard}", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
        done = subprocess.run(
            [*words, f"-I{exported}", tmp_path / "main.cpp"], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_cmake_projects_use_the_folder(panda: ulna.Robot, tmp_path: Path) -> None:
    for program in ("cmake", "g++", "make"):
        needs(program)

    def run(*words: str | Path) -> str:
        done = subprocess.run([*words], capture_output=True, text=True, timeout=200, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    place = ulna.export(panda, ["fk", "ik"], to="c", path=tmp_path / "panda_c")
    run("cmake", "-S", place, "-B", tmp_path / "alone", f"-DCMAKE_INSTALL_PREFIX={tmp_path / 'prefix'}")
    run("cmake", "--build", tmp_path / "alone")
    assert "100% tests passed" in run("ctest", "--test-dir", tmp_path / "alone")
    run("cmake", "--install", tmp_path / "alone")
    (tmp_path / "user").mkdir()
    (tmp_path / "user" / "main.cpp").write_text(USER)
    (tmp_path / "user" / "CMakeLists.txt").write_text(PROJECT)
    q = [0.1, 0.2, 0.3, -1.2, 0.5, 1.6, 0.7]
    for build, option in (("inside", f"-DPANDA={place}"), ("found", "-DFOUND=1")):
        where = tmp_path / build
        run(
            "cmake",
            "-S",
            tmp_path / "user",
            "-B",
            where,
            option,
            f"-DCMAKE_PREFIX_PATH={tmp_path / 'prefix'}",
        )
        run("cmake", "--build", where)
        code, x = run(where / "user").split()
        assert code == "1" and float(x) == pytest.approx(panda.fk(q)[0, 3], abs=1e-15)
