#pragma once

/// Cutting a shirt takes most of a minute without optimisation and under sanitizers: there one shirt is enough, and the
/// release build runs the rest.
#ifdef NDEBUG
#define TOILE_SKIP_IN_SLOW_BUILD() static_cast<void>(0)
#else
#define TOILE_SKIP_IN_SLOW_BUILD() GTEST_SKIP() << "takes minutes without optimisation; the release build runs it"
#endif
