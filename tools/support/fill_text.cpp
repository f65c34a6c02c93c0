#include "tools/support/fill_text.h"

#include "tools/support/parse.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t most_causes_named = 8;

std::uint64_t received_bytes(const ContainerReader& container) {
    return std::min(container.source_bytes(), container.file_bytes());
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
    return format_number(100.0 * static_cast<double>(part) /
                             static_cast<double>(std::max<std::uint64_t>(1, whole)),
                         1) +
           " %";
}

} // namespace

std::string fill_text(const Decoder& decoder, const std::string& indent) {
    const ContainerReader& container = decoder.container();
    const FillReport report = decoder.fill_report();
    const std::uint64_t tiles = container.grid().tiles();
    const char* instead =
        container.levels().size() > 1 ? "shown from coarser levels" : "shown as the background";
    std::string text;
    if (container.is_partial())
        text += indent + "part   " + percent(received_bytes(container), container.file_bytes()) +
                " of the bytes of the file are present\n";
    if (report.missing_tiles > 0)
        text += indent + "filled " + std::to_string(report.missing_tiles) + " of " +
                std::to_string(tiles) + " tiles (" + percent(report.missing_tiles, tiles) +
                ") are missing and are " + instead + "\n";
    if (report.damaged_tiles == 0)
        return text;
    text += indent + "filled " + std::to_string(report.damaged_tiles) + " of " +
            std::to_string(tiles) + " tiles are damaged and " + instead + "\n";
    for (std::size_t i = 0; i < std::min(most_causes_named, report.damaged.size()); ++i)
        text += indent + "       tile " + std::to_string(report.damaged[i]) + " has the texels " +
                to_string(container.grid().box(report.damaged[i])) +
                (container.alignment().any() ? " in the grid of aligned views" : "") + "\n";
    if (report.damaged_tiles > most_causes_named)
        text += indent + "       and more; tessera validate lists them all\n";
    return text;
}

Status with_partial_hint(const Status& status, ByteSource& file, const DecodeOptions& options) {
    if (status.code() != ErrorCode::invalid_file || options.allow_partial ||
        ContainerReader::open(file).ok() || !ContainerReader::open(file, OpenOptions{true}).ok())
        return status;
    return {status.code(), status.message() + "; --allow-partial reads the part that is present"};
}

Json fill_json(const Decoder& decoder) {
    const ContainerReader& container = decoder.container();
    const FillReport report = decoder.fill_report();
    Json json = {{"received_bytes", received_bytes(container)},
                 {"file_bytes", container.file_bytes()},
                 {"tiles", container.grid().tiles()},
                 {"missing_tiles", report.missing_tiles},
                 {"damaged_tiles", report.damaged_tiles},
                 {"filled_texels", report.texels},
                 {"damaged", Json::array()}};
    const char* where = container.alignment().any() ? "grid" : "texels";
    for (const std::uint64_t tile : report.damaged)
        json["damaged"].push_back({{"tile", tile}, {where, to_string(container.grid().box(tile))}});
    return json;
}

} // namespace tessera
