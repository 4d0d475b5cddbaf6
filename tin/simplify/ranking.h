// Which of two findings of a scan is the worse.
#pragma once

#include "tin/simplify/samples.h"

namespace tin::simplify {

/// A sample over the tolerance is worse than any within; then the larger error counts, then the smaller
/// index.
inline bool is_worse(const Scan& a, const Scan& b) {
  if (a.over != b.over) return a.over;
  if (a.error != b.error) return a.error > b.error;
  return a.sample < b.sample;
}

inline void keep_worse(Scan& kept, const Scan& other) {
  if (is_worse(other, kept)) kept = other;
}

}  // namespace tin::simplify
