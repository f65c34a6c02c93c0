#include "codec/tile_encoder/coded_blocks.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>

namespace tessera {
namespace {

// So that they take some MB; beyond, all are forgotten.
constexpr std::size_t most_kept_levels = std::size_t{1} << 19;
constexpr std::size_t most_kept_coefficients = std::size_t{1} << 20;

} // namespace

std::size_t CodedBlocks::Hash::operator()(const Key& key) const {
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(key.data()), key.size()});
}

void CodedBlocks::begin(bool keep) {
    keep_ = keep;
    known_.clear();
    coefficients_ = 0;
    levels_.clear();
}

CodedBlock& CodedBlocks::at(const Block& block, const BlockPrediction& prediction) {
    if (!keep_) {
        levels_.clear();
        last_.ways.clear();
        last_.moments.reset();
        return last_;
    }
    if (levels_.nonzeros.size() > most_kept_levels || coefficients_ > most_kept_coefficients)
        begin(keep_);
    const auto& o = block.origin;
    const auto& n = block.shape.n;
    return known_[{o[0], o[1], o[2], o[3], n[0], n[1], n[2], n[3],
                   static_cast<std::uint8_t>(prediction.from),
                   static_cast<std::uint8_t>(prediction.displacement.u),
                   static_cast<std::uint8_t>(prediction.displacement.v)}];
}

void CodedBlocks::check(CodedBlock& coded, const BlockCoefficients& coefficients, int planes) {
    if (!keep_ || !coefficients.copies)
        return;
    const auto count = static_cast<std::size_t>(coefficients.shape.texels());
    const std::size_t all = count * static_cast<std::size_t>(planes);
    const auto plane = [&](std::size_t p) { return coefficients.plane[p].data(); };
    bool same = coded.coefficients.size() == all;
    for (std::size_t p = 0; same && p < static_cast<std::size_t>(planes); ++p)
        same = std::memcmp(coded.coefficients.data() + p * count, plane(p),
                           count * sizeof(float)) == 0;
    if (same)
        return;
    coefficients_ += all - coded.coefficients.size();
    coded.coefficients.resize(all);
    for (std::size_t p = 0; p < static_cast<std::size_t>(planes); ++p)
        std::copy_n(plane(p), count, coded.coefficients.data() + p * count);
    coded.ways.clear();
    coded.moments.reset();
}

bool CodedBlocks::is_zero(const CodedBlock::Way& way, int planes) const {
    return std::all_of(&levels_.planes[way.planes], &levels_.planes[way.planes] + planes,
                       [](const PlaneLevels& plane) { return plane.count == 0; });
}

void CodedBlocks::append(const CodedBlock::Way& way, int planes, TileLevels& out) const {
    out.colours.push_back(static_cast<std::uint8_t>(way.colour));
    for (std::size_t p = 0; p < static_cast<std::size_t>(planes); ++p) {
        PlaneLevels plane = levels_.planes[way.planes + p];
        const auto levels = levels_.levels(plane);
        plane.first = static_cast<std::uint32_t>(out.nonzeros.size());
        out.planes.push_back(plane);
        out.nonzeros.insert(out.nonzeros.end(), levels.begin(), levels.end());
    }
}

} // namespace tessera
