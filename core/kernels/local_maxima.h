#pragma once
// Local maxima among the 26 neighbours of a sample in three stacked response layers: the inner loop of SURF's
// non-maximum suppression (Bay et al. 2008, section 3.4). A maximum lies strictly above what comes later in the order
// (layer, row, column) and not below what came before, so that of two equals exactly one is a maximum. The vector path
// finds the same samples as the reference. Pure. O(count), no allocation.

#include <cstdint>

namespace pelorus {

// rows[layer][row]: layers below, of and above the samples, rows before, of and after; element [i] is sample i.
using LayerRows = const float* [3][3];

// Samples first..first + count - 1 over the threshold that are maxima, in ascending order; returns how many. Elements
// first - 1 .. first + count and 16 more are read. `found` has room for count.
int local_maxima(const LayerRows& rows, int first, int count, float threshold, std::int32_t* found);

namespace reference {
int local_maxima(const LayerRows& rows, int first, int count, float threshold, std::int32_t* found);
}

}  // namespace pelorus
