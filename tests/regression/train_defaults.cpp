// Prints format/tile/default_parameters.cpp for the symbols of some .tess files, each file weighing the
// same. Used when the contexts change:
//   train_defaults a.tess b.tess ... > format/tile/default_parameters.cpp
#include "codec/decoder.h"
#include "codec/fit/table_fit.h"
#include "codec/reconstruct/tile_decoder.h"

#include <cmath>
#include <cstdio>

using namespace tessera;

namespace {

// Symbol counts of one file.
Result<Statistics> statistics_of(const char* path) {
    Result<std::unique_ptr<ByteSource>> source = open_file(path);
    if (!source)
        return source.status();
    const Result<ContainerReader> file = ContainerReader::open(**source);
    if (!file)
        return file.status();
    const Result<CodingParameters> parameters = read_coding_parameters(file->codec_parameters());
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
    std::array<double, parameter_count> stops{}, goes{};
    for (int i = 1; i < argc; ++i) {
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
    std::printf("// Made by tests/regression/train_defaults from files of the corpus.\n"
                "#include \"format/tile/code_tables.h\"\n\nnamespace tessera {\n\n"
                "const Parameters& default_parameters() {\n"
                "    static const Parameters parameters = {\n");
    for (std::size_t p = 0; p < parameter_count; ++p) {
        // A few imagined counts at the old value keep rare contexts sensible.
        const double old = 1.0 / (1.0 + std::exp2((default_parameters()[p] - 32) / 3.0));
        const double stop = stops[p] + 4 * old, go = goes[p] + 4 * (1 - old);
        const long fitted = std::lround(32 + 3 * std::log2(go / stop));
        std::printf("%s%ld,%s", p % 20 == 0 ? "        " : " ", std::clamp(fitted, 0L, 63L),
                    p % 20 == 19 || p + 1 == parameter_count ? "\n" : "");
    }
    std::printf("    };\n    return parameters;\n}\n\n} // namespace tessera\n");
}
