"""C99: a folder with a header, sources, a test program and a CMakeLists.txt. Read `writer.py` first."""
