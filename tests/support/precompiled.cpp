// Only its precompiled headers are wanted (tests/CMakeLists.txt); CMake needs a source to hang them on.
