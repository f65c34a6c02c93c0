// EncodeOptions::reuse: keeps the tiles of an earlier file whose texels were not edited.
#pragma once

#include "codec/pass/encode_pass.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Gives `plan` the tile shape and the colour coding of `file`, whose tiles it shall keep, and returns
// the coding parameters of these tiles. Errors: invalid_file.
Result<CodingParameters> plan_reuse(const Decoder& file, EncodePlan& plan);

// Loads the payload of a tile of plan.reused. False: the new file would take these bytes for a stored
// tile. Errors: those of the reused file, with its name.
Result<bool> load_reusable_tile(const EncodePlan& plan, std::uint64_t number,
                                std::vector<std::byte>& payload);

// Whether most texels of an edited tile are still what the reused tile decodes to.
bool is_mostly_kept(std::span<const std::byte> texels, std::span<const std::byte> decoded,
                    std::size_t texel_bytes);

// Settings for such a tile. Its texels went through the quantiser before; an encoder that saves bits
// would lose quality again, so bits weigh little.
EffortSettings settings_of_edited_tiles(EffortSettings settings);

// "old.tess: tile 5", the prefix of errors about that tile.
std::string about_reused_tile(const EncodePlan& plan, std::uint64_t number);

// Counts the tiles of a pass whose payloads are the reused file's. Errors: io; those of the file.
Result<std::uint64_t> count_kept_tiles(const EncodePlan& plan, const PassResult& pass);

} // namespace tessera
