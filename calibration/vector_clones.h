#pragma once

/// Loops that are compiled once for any x86-64 and once for AVX2, and chosen by what the processor has. Not the
/// compiler's own target_clones: their resolvers run before a sanitizer's start-up does. On another architecture there
/// is one version.
#define GONIO_INLINE [[gnu::always_inline]] static inline

#if defined(__x86_64__)
/// Defines `name` PARAMETERS as a call of the always inlined `body` with ARGUMENTS, in both versions.
#define GONIO_CLONE(name, body, PARAMETERS, ARGUMENTS)                \
  [[gnu::target("avx2")]] void name##_avx2 PARAMETERS {               \
    body ARGUMENTS;                                                   \
  }                                                                   \
  void name##_plain PARAMETERS {                                      \
    body ARGUMENTS;                                                   \
  }                                                                   \
  void name PARAMETERS {                                              \
    static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0; \
    has_avx2 ? name##_avx2 ARGUMENTS : name##_plain ARGUMENTS;        \
  }
#else
#define GONIO_CLONE(name, body, PARAMETERS, ARGUMENTS) \
  void name PARAMETERS {                               \
    body ARGUMENTS;                                    \
  }
#endif
