# What every target of ours is compiled with; foreign headers are SYSTEM and stay outside of it.
add_library(gonio_options INTERFACE)
target_include_directories(gonio_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(gonio_options INTERFACE
  -Wall -Wextra -Wpedantic -Werror
  -Wshadow               # a shadowed name is read wrongly sooner or later
  -Wconversion           # counts, angles and registers change width only where it is written
  -Wsign-conversion      # encoder counts are signed, registers are not
  -Wold-style-cast       # a C cast hides which of the three casts was meant
  -Wnon-virtual-dtor     # contracts are deleted through their base
  -Woverloaded-virtual
  -Wno-missing-field-initializers  # a designated initialiser leaves the rest at its default on purpose
  -ffp-contract=off)     # a*b+c gives the same bits whatever the compiler fuses: recomputing is bit-equal
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(gonio_options INTERFACE -Wthread-safety)
else()
  # g++ 12 sees dangling and uninitialised storage inside inlined std::variant and std::optional where there is none.
  target_compile_options(gonio_options INTERFACE -Wno-maybe-uninitialized)
  # ... and overlapping copies in "text" + std::string where it inlines more (GCC bug 105651).
  target_compile_options(gonio_options INTERFACE $<$<CONFIG:Release>:-Wno-restrict>)
endif()
if(GONIO_SANITIZE)
  target_compile_options(gonio_options INTERFACE -fsanitize=${GONIO_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(gonio_options INTERFACE -fsanitize=${GONIO_SANITIZE})
  if(NOT GONIO_SANITIZE MATCHES "thread")
    target_compile_options(gonio_options INTERFACE -fno-sanitize-recover=all)
  endif()
endif()
if(GONIO_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "GONIO_FUZZ needs clang: libFuzzer comes with it (preset fuzz)")
  endif()
  # float-cast-overflow: a number of a file or a wire that is cast to an integer it does not fit is what fuzzers find.
  target_compile_options(gonio_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(gonio_options INTERFACE -fsanitize=address,undefined)
endif()
