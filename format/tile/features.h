// The features that a decoder must support to read a file: bits of the header field
// required_features (FORMAT.md 1.6).
#pragma once

#include <cstdint>

namespace tessera {

inline constexpr std::uint64_t feature_levels = 1u << 0;
inline constexpr std::uint64_t feature_corrections = 1u << 1;
inline constexpr std::uint64_t feature_prediction = 1u << 4;
inline constexpr std::uint64_t feature_stored = 1u << 5;
inline constexpr std::uint64_t feature_aligned = 1u << 6;
inline constexpr std::uint64_t feature_layers = 1u << 7;
inline constexpr std::uint64_t feature_no_transform = 1u << 8;
inline constexpr std::uint64_t feature_any_plane = 1u << 9;
inline constexpr std::uint64_t feature_plane_trees = 1u << 10;
inline constexpr std::uint64_t known_features =
    feature_levels | feature_corrections | feature_prediction | feature_stored | feature_aligned |
    feature_layers | feature_no_transform | feature_any_plane | feature_plane_trees;

} // namespace tessera
