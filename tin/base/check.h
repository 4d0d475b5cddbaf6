// Checks of our own invariants. User input can never make one fail: what a caller may get wrong is a Result.
#pragma once

namespace tin::base {
/// Prints the broken expression with its place and aborts.
[[noreturn]] void check_failed(const char* expression, const char* file, int line) noexcept;
}  // namespace tin::base

/// Always on; use where it costs O(1).
#define TIN_CHECK(expression) \
  (static_cast<bool>(expression) ? void(0) : ::tin::base::check_failed(#expression, __FILE__, __LINE__))

/// On in debug and sanitizer builds only.
#ifdef NDEBUG
#define TIN_DCHECK(expression) void(0)
#else
#define TIN_DCHECK(expression) TIN_CHECK(expression)
#endif
