#include "codec/tile_encoder/dont_care.h"

#include <algorithm>

namespace tessera {
namespace {

// `count` values of a plane, `stride` apart.
struct Line {
    std::size_t begin, stride, count;
    std::size_t at(std::size_t i) const { return begin + i * stride; }
};

// Fills values first..end-1 of a line, which lie between two known ones or, at an end, beside one.
void fill_run(std::vector<std::int32_t>& plane, const Line& line, std::size_t first,
              std::size_t end) {
    const std::int32_t before = plane[line.at(first > 0 ? first - 1 : end)];
    const std::int32_t after = plane[line.at(end < line.count ? end : first - 1)];
    const auto steps = static_cast<std::int64_t>(end - first + 1);
    for (std::size_t i = first; i < end; ++i) {
        const auto step = static_cast<std::int64_t>(i - first + 1);
        plane[line.at(i)] =
            before + static_cast<std::int32_t>((std::int64_t{after} - before) * step / steps);
    }
}

} // namespace

void DontCare::set(std::span<const std::byte> matters, const BlockShape& shape) {
    ColourCoding one_plane;
    one_plane.desc.channels = 1;
    planes_from_texels(matters, one_plane, shape, matters_);
}

bool DontCare::is_all() const {
    return std::ranges::all_of(matters_.plane[0], [](std::int32_t m) { return m == 0; });
}

bool DontCare::are_alike(const TilePlanes& planes, int plane_count) const {
    const std::vector<std::int32_t>& matters = matters_.plane[0];
    const auto first = static_cast<std::size_t>(std::ranges::find(matters, 0) - matters.begin());
    for (int p = 0; p < plane_count; ++p)
        for (std::size_t i = first; i < matters.size(); ++i)
            if (matters[i] == 0 && planes.plane[p][i] != planes.plane[p][first])
                return false;
    return true;
}

void DontCare::fill(TilePlanes& planes, int plane_count) {
    const std::vector<std::int32_t>& matters = matters_.plane[0];
    is_known_.resize(matters.size());
    std::ranges::transform(matters, is_known_.begin(), [](std::int32_t m) { return m != 0; });
    if (is_all()) {
        for (int p = 0; p < plane_count; ++p)
            std::ranges::fill(planes.plane[p], 0);
        return;
    }
    for (const std::size_t axis : {axis_t, axis_s, axis_v, axis_u})
        fill_along(axis, planes, plane_count);
}

void DontCare::fill_along(std::size_t axis, TilePlanes& planes, int plane_count) {
    const auto& n = planes.shape.n;
    std::size_t stride = 1; // u is fastest
    for (std::size_t before = 0; before < axis; ++before)
        stride *= n[before];
    const std::size_t count = n[axis], texels = is_known_.size();
    for (std::size_t block = 0; block < texels; block += stride * count)
        for (std::size_t inner = 0; inner < stride; ++inner) {
            const Line line{block + inner, stride, count};
            const auto is_known = [&](std::size_t i) { return is_known_[line.at(i)] != 0; };
            for (std::size_t first = 0, end; first < count; first = end + 1) {
                for (end = first; end < count && !is_known(end);)
                    ++end;
                if (end == first || (first == 0 && end == count))
                    continue;
                for (int p = 0; p < plane_count; ++p)
                    fill_run(planes.plane[p], line, first, end);
                for (std::size_t i = first; i < end; ++i)
                    is_known_[line.at(i)] = 1;
            }
        }
}

void DontCare::project(const TilePlanes& decoded, TilePlanes& planes, int plane_count) const {
    const std::vector<std::int32_t>& matters = matters_.plane[0];
    for (int p = 0; p < plane_count; ++p)
        for (std::size_t i = 0; i < matters.size(); ++i)
            if (matters[i] == 0)
                planes.plane[p][i] = decoded.plane[p][i];
}

} // namespace tessera
