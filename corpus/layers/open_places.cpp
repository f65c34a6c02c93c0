#include "corpus/layers/open_places.h"

#include <algorithm>
#include <bit>

namespace tessera::corpus {

Result<OpenPlaces> OpenPlaces::make(const ModelPlaces& places, const BakeRun& run) {
    OpenPlaces made;
    made.size_ = places.texel_places().size();
    made.parts_.assign(places.texels(), hidden);
    TESSERA_TRY(for_rows("looking for hidden texels", made.size_[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < made.size_[0]; ++u)
            if (places.texel_places().matters(u, v) && !places.is_hidden(u, v))
                made.parts_[made.index(u, v)] = all;
    }));
    std::vector<std::uint16_t> parts = made.parts_;
    TESSERA_TRY(for_rows("looking for hidden parts", made.size_[1], run, [&](std::uint32_t v) {
        for (std::uint32_t u = 0; u < made.size_[0]; ++u) {
            if (!made.matters(u, v) || !made.is_near_hidden(u, v))
                continue;
            unsigned open = 0;
            for (std::uint32_t i = 0; i < side * side; ++i) {
                const glm::dvec2 middle((i % side + 0.5) / side - 0.5,
                                        (i / side + 0.5) / side - 0.5);
                open |= unsigned{!places.is_inside(u, v, middle)} << i;
            }
            if (open != 0)
                parts[made.index(u, v)] = static_cast<std::uint16_t>(open);
        }
    }));
    made.parts_ = std::move(parts);
    return made;
}

// Those around a hidden texel may be inside as well, because is_hidden() asks at their neighbours.
bool OpenPlaces::is_near_hidden(std::uint32_t u, std::uint32_t v) const {
    constexpr std::uint32_t reach = 2;
    for (std::uint32_t y = v - std::min(v, reach); y <= std::min(v + reach, size_[1] - 1); ++y)
        for (std::uint32_t x = u - std::min(u, reach); x <= std::min(u + reach, size_[0] - 1); ++x)
            if (!matters(x, y))
                return true;
    return false;
}

glm::dvec2 OpenPlaces::offset(std::uint32_t u, std::uint32_t v, const glm::dvec2& random) const {
    std::uint32_t parts = parts_[index(u, v)];
    if (parts == all)
        return random - 0.5;
    // The first coordinate selects a part, and what is left of it a place there.
    const double selected = random.x * std::popcount(parts);
    const double whole = std::min(std::floor(selected), std::popcount(parts) - 1.0);
    for (auto skip = static_cast<unsigned>(whole); skip > 0; --skip)
        parts &= parts - 1;
    const auto part = static_cast<std::uint32_t>(std::countr_zero(parts));
    return (glm::dvec2(part % side, part / side) + glm::dvec2(selected - whole, random.y)) /
               double{side} -
           0.5;
}

} // namespace tessera::corpus
