"""The files that build the sources: CMakeLists.txt, and the file by which other CMake projects find the library."""

from __future__ import annotations

from collections.abc import Sequence


def cmake_lists(name: str, sources: Sequence[str], test: str) -> str:
    """The text of CMakeLists.txt.

    Args:
        name: The name of the library.
        sources: The files of the library.
        test: The file of the test program; empty for none.

    Returns:
        The text.
    """
    files = "\n".join(f"    {file}" for file in sources)
    tests = _TEST.replace("@test@", test) if test else ""
    text = _LISTS.replace("@sources@", files).replace("@tests@", tests)
    return text.replace("@name@", name).replace("@NAME@", name.upper())


_LISTS = """\
# Written by Ulna; do not edit. Alone:  cmake -B build && cmake --build build && ctest --test-dir build
# In a project: add_subdirectory(this folder), or find_package(@name@) after cmake --install build;
# then target_link_libraries(your_target PRIVATE @name@::@name@).
cmake_minimum_required(VERSION 3.13...3.31)
project(@name@ LANGUAGES C)
include(GNUInstallDirs)

set(@NAME@_ALONE OFF)
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  set(@NAME@_ALONE ON)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug or Release" FORCE)
  endif()
endif()

add_library(@name@
@sources@
)
add_library(@name@::@name@ ALIAS @name@)
set_target_properties(@name@ PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
target_include_directories(@name@ PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
)
if(NOT MSVC)
  # No function sets errno, so that a square root is one instruction.
  target_compile_options(@name@ PRIVATE -fno-math-errno)
  target_link_libraries(@name@ PUBLIC m)
endif()

install(TARGETS @name@ EXPORT @name@Config
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
)
install(FILES @name@.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT @name@Config NAMESPACE @name@:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/@name@)
@tests@"""

_TEST = """
option(@NAME@_TEST "Build the test program of @name@" ${@NAME@_ALONE})
if(@NAME@_TEST)
  enable_testing()
  add_executable(test_@name@ @test@)
  set_target_properties(test_@name@ PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
  target_link_libraries(test_@name@ PRIVATE @name@)
  add_test(NAME @name@ COMMAND test_@name@)
endif()
"""
