// The file of this instance of the module, for the functions that JavaScript calls.
#pragma once

#include "codec/decoder.h"
#include "tools/view/layer_files.h"
#include "tools/web/decoder/ranged_bytes.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#define WEB_EXPORT(result, name) extern "C" __attribute__((export_name(#name))) result name

namespace tessera {

enum Answer : int { done = 0, failed = 1, wants_bytes = 2 };

// Upper bound of the fetched bytes that are kept for later calls.
inline constexpr std::size_t most_kept_bytes = std::size_t{64} << 20;
struct OpenFile {
    std::optional<RangedBytes> bytes;
    DecodeOptions options;
    std::optional<Decoder> first;      // of the whole file: the layer 0
    std::vector<OpenLayerFile> layers; // the layers after it
    std::uint32_t selected = 0;
    std::vector<double> numbers; // returned by the last web_facts(), web_layers() or web_wanted()
    std::string text;            // returned by the last web_texts()
    std::string error;           // message of the last error
    std::unique_ptr<std::byte[]> result;
    std::size_t result_bytes = 0;
};
extern OpenFile file;

// Runs `body`, which returns a Status, and converts its result.
template <class Body> Answer answer(const Body& body) {
    file.bytes->forget_wanted();
    const Status status = body();
    if (status.ok()) {
        file.bytes->shrink(most_kept_bytes);
        return done;
    }
    file.error = status.message();
    return file.bytes->wanted().empty() ? failed : wants_bytes;
}

inline const Decoder& decoder() {
    return file.selected == 0 ? *file.first : *file.layers[file.selected - 1].decoder;
}
inline const ContainerReader& container() {
    return decoder().container();
}

// Replaces the number of a level: the box is in the grid of level 0's tiles (FORMAT.md part 2).
inline constexpr std::uint32_t of_grid = 0xFFFFFFFF;

// box: the 4 begins along u, v, s, t, then the 4 ends. Errors: bad_argument.
inline Result<Box4> checked_box(std::uint32_t level, const std::uint32_t* box) {
    if (level != of_grid && level >= container().levels().size())
        return Status(ErrorCode::bad_argument, "there is no level " + std::to_string(level));
    const Box4 checked{{box[0], box[1], box[2], box[3]}, {box[4], box[5], box[6], box[7]}};
    const Extent4 size =
        level == of_grid ? container().grid().size() : level_size(container(), level);
    if (!is_inside(checked, size))
        return Status(ErrorCode::bad_argument,
                      "box " + to_string(checked) + " does not lie inside " + to_string(size));
    return checked;
}

} // namespace tessera
