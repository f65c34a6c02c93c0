// Efforts by what a test needs of them: a decoder cannot tell which effort made its file, and the
// default takes fifteen times as long as the quick one.
#pragma once

namespace tessera::test {

constexpr int quick_effort = 1;  // every tool but copies, trials, refinement and the trellis
constexpr int copies_effort = 2; // copies, smoothed or not, and the filter, too

} // namespace tessera::test
