// Efforts named by the tools that a test needs. A decoder cannot tell which effort wrote its file,
// and the default effort takes fifteen times as long as the quick one.
#pragma once

namespace tessera::test {

constexpr int quick_effort = 1;  // all tools except copies, trials, refinement and trellis
constexpr int copies_effort = 2; // adds copies, smoothed copies and the filter

} // namespace tessera::test
