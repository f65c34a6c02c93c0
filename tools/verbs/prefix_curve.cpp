#include "tools/verbs/prefix_curve.h"

#include "codec/decoder.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tessera {
namespace {

// The first `size` bytes of another source.
class Beginning : public ByteSource {
public:
    Beginning(ByteSource& whole, std::uint64_t size) : whole_(whole), size_(size) {}
    std::uint64_t size() const override { return size_; }
    std::string name() const override { return whole_.name(); }
    Status read(std::uint64_t offset, std::span<std::byte> out) override {
        TESSERA_TRY(check_range(*this, offset, out.size()));
        return whole_.read(offset, out);
    }

private:
    ByteSource& whole_;
    std::uint64_t size_;
};

Result<std::vector<std::uint64_t>> lengths_of(ByteSource& file, unsigned count) {
    TESSERA_TRY_ASSIGN(const auto reader, ContainerReader::open(file));
    std::vector<std::uint64_t> lengths = {reader.sections().back().offset};
    // Level i ends where the first tile of the finer one begins.
    for (std::size_t i = reader.levels().size(); i-- > 1;) {
        TESSERA_TRY_ASSIGN(const auto place, reader.locate(reader.levels()[i - 1].first_tile));
        lengths.push_back(place.offset);
    }
    const std::uint64_t from = lengths.back(), to = reader.file_bytes();
    const std::size_t steps = std::max<std::size_t>(count, lengths.size() + 1) - lengths.size();
    for (std::size_t i = 1; i <= steps; ++i)
        lengths.push_back(from + (to - from) * i / steps);
    return lengths;
}

} // namespace

Result<std::vector<PrefixPoint>> prefix_curve(TexelSource& reference, ByteSource& file,
                                              unsigned count, const CompareOptions& options) {
    TESSERA_TRY_ASSIGN(const auto lengths, lengths_of(file, count));
    std::vector<PrefixPoint> points;
    for (const std::uint64_t length : lengths) {
        Beginning beginning(file, length);
        TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(beginning, {true, false}));
        const auto texels = decoded_source(decoder);
        TESSERA_TRY_ASSIGN(const auto compared, compare_textures(reference, *texels, options));
        points.push_back({length, compared.errors.psnr(), decoder.fill_report().missing_tiles,
                          decoder.container().grid().tiles()});
    }
    return points;
}

void print_points(const std::vector<PrefixPoint>& points) {
    std::printf("%12s %9s %9s %15s\n", "bytes", "share", "PSNR dB", "missing tiles");
    for (const PrefixPoint& p : points)
        std::printf("%12llu %7.2f %% %9s %7llu of %llu\n", static_cast<unsigned long long>(p.bytes),
                    100.0 * static_cast<double>(p.bytes) / static_cast<double>(points.back().bytes),
                    std::isfinite(p.psnr) ? format_number(p.psnr, 2).c_str() : "exact",
                    static_cast<unsigned long long>(p.missing_tiles),
                    static_cast<unsigned long long>(p.tiles));
}

} // namespace tessera
