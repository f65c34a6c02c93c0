// Prints default parameters as fitted to the symbols of .tess files, all of equal weight. It is used
// when the contexts change:
//   train_defaults a.tess b.tess ... > format/tables/default_parameters.inc
//   train_defaults --pictures a.tess b.tess ... > format/tables/picture_parameters.inc
#include "codec/decoder.h"
#include "codec/fit/table_fit.h"
#include "codec/reconstruct/tile_decoder.h"
#include "format/container/file_coding.h"
#include "format/io/crc32c.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <vector>

using namespace tessera;

namespace {

struct ParameterArray {
    const char* name;
    int end;  // index after its last parameter
    int line; // length of its last dimension
};
constexpr ParameterArray arrays[] = {
    {"zero[2][2][7][6][16]", magnitude_offset, neighbour_classes},
    {"magnitude[2][2][66][9]", first_length_offset, magnitude_chain},
    {"first_length[18][13]", other_length_offset, length_tokens - 1},
    {"other_length[14][13]", split_offset, length_tokens - 1},
    {"split[6][6][4]", correction_offset, split_kinds - 1},
    {"correction[21][10]", colour_offset, correction_chain},
    {"colour[3][3]", share_offset, colour_kinds - 1},
    {"share[2][8]", prediction_offset, share_tokens - 1},
    {"prediction[6][2]", displacement_kind_offset, prediction_kinds - 1},
    {"displacement_kind[2][2]", displacement_offset, displacement_kinds - 1},
    {"displacement[2][8]", base_offset, displacement_tokens - 1},
    {"base[1]", from_base_offset, 1},
    {"from_base[2][1]", base_displacement_offset, 1},
    {"base_displacement[8]", mode_offset, displacement_tokens - 1},
    {"mode[9][5]", transform_offset, mode_symbols - 1},
    {"transform[12][3]", no_transform_offset, usual_transform_chain},
    {"no_transform[12][3]", parameter_count, no_transform_chain}};

// Counts the symbols of one file.
Result<Statistics> statistics_of(const char* path) {
    Result<std::unique_ptr<ByteSource>> source = open_file(path);
    if (!source)
        return source.status();
    const Result<ContainerReader> file = ContainerReader::open(**source);
    if (!file)
        return file.status();
    const Result<CodingParameters> parameters = coding_of(*file);
    if (!parameters)
        return parameters.status();
    const TextureDesc desc = file->desc();
    const TileCoding coding(*parameters, desc.type, desc.channels);
    const ColourCoding colour{desc, file->header().colour, file->header().background,
                              (file->header().required_features & feature_corrections) != 0,
                              (file->header().required_features & feature_stored) != 0};
    TileDecoder decoder(coding, colour);
    Statistics statistics;
    for (std::uint64_t tile = 0; tile < file->tile_count(); ++tile) {
        const Result<TileBytes> bytes = file->load_tile(tile);
        if (!bytes)
            return bytes.status();
        const BlockShape shape = tile_shape(file->grid().box(tile));
        TESSERA_TRY(decoder.parse(bytes->bytes, shape));
        if (decoder.is_stored())
            continue;
        count_symbols(decoder.levels(), coding, statistics);
        if (!decoder.corrections().empty())
            count_corrections(decoder.corrections(), shape, coding.planes, statistics);
    }
    return statistics;
}

} // namespace

int main(int argc, char** argv) {
    const bool for_pictures = argc > 1 && std::string_view(argv[1]) == "--pictures";
    const Parameters& before =
        default_parameters(for_pictures ? DefaultSet::pictures : DefaultSet::views);
    std::array<double, parameter_count> stops{}, goes{};
    for (int i = for_pictures ? 2 : 1; i < argc; ++i) {
        const Result<Statistics> file = statistics_of(argv[i]);
        if (!file) {
            std::fprintf(stderr, "train_defaults: error: %s\n", file.status().message().c_str());
            return static_cast<int>(file.status().code());
        }
        double total = 1;
        for (std::size_t p = 0; p < parameter_count; ++p)
            total += static_cast<double>(file->stops[p] + file->goes[p]);
        for (std::size_t p = 0; p < parameter_count; ++p) {
            stops[p] += 1e6 * static_cast<double>(file->stops[p]) / total;
            goes[p] += 1e6 * static_cast<double>(file->goes[p]) / total;
        }
    }
    std::vector<std::byte> fitted;
    for (std::size_t p = 0; p < parameter_count; ++p) {
        // A few additional counts at the old value keep rare contexts near it.
        const double old = 1.0 / (1.0 + std::exp2((before[p] - 32) / 3.0));
        const double stop = stops[p] + 4 * old, go = goes[p] + 4 * (1 - old);
        const long nearest = std::lround(32 + 3 * std::log2(go / stop));
        fitted.push_back(static_cast<std::byte>(std::clamp(nearest, 0L, 63L)));
    }
    std::printf(
        "// The default parameters for %s: normative, FORMAT.md 3.5.\n//\n"
        "// 6,019 numbers 0..63, separated by commas, in the order of FORMAT.md 3.5. A comment "
        "names each array;\n// its last index runs fastest, and a line holds the numbers of "
        "one last index.\n// CRC32C of the numbers as bytes: 0x%08X.\n",
        for_pictures ? "pictures" : "textures of many views",
        static_cast<unsigned>(crc32c(fitted)));
    std::size_t p = 0;
    for (const auto& [name, end, line] : arrays) {
        std::printf("// %s\n", name);
        for (const std::size_t first = p; p < static_cast<std::size_t>(end); ++p) {
            const bool is_last = (p - first + 1) % static_cast<std::size_t>(line) == 0;
            std::printf("%d,%s", std::to_integer<int>(fitted[p]), is_last ? "\n" : " ");
        }
    }
}
