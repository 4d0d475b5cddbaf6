// Heller's rule, which is wrong: of the ears of the hole, cut the one with the smallest circumcircle (Devillers 2002, section
// 2.1, on Heller 1990). Here to show that it is.
#pragma once

#include <span>
#include <vector>

#include "tin/removal/star.h"

namespace removal_tests {

/// Fills a hole by Heller's rule. Requires: no infinite vertex in the link.
std::vector<tin::removal::Ear> heller_fill(const tin::removal::Star& star);

}  // namespace removal_tests
