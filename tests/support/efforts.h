// Efforts by what a test needs of them: a decoder cannot tell which effort made its file, and the
// default takes fifteen times as long as the quick one.
#pragma once

namespace tessera::test {

constexpr int quick_effort = 3;  // every tool but copies, trials and refinement
constexpr int copies_effort = 4; // copies, smoothed or not, and the filter, too

} // namespace tessera::test
