// Tiles of an earlier file that stay as they are in the one that is made of its edited texels.
#pragma once

#include "codec/pass/encode_pass.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// Makes `plan`, of a texture of the file's size, sample type and channels, one that keeps the tiles of
// `file`: their shape and colour are the file's from now on. Returns the parameters of its tiles. Errors:
// invalid_file.
Result<CodingParameters> plan_reuse(const Decoder& file, EncodePlan& plan);

// The payload of a tile of plan.reused. False where it means something else in the file that is made. Errors:
// those of the reused file, which name it.
Result<bool> load_reusable_tile(const EncodePlan& plan, std::uint64_t number,
                                std::vector<std::byte>& payload);

// Of a tile that was edited: whether most of its texels are still what it decodes to.
bool is_mostly_kept(std::span<const std::byte> texels, std::span<const std::byte> decoded,
                    std::size_t texel_bytes);

// Settings for such a tile. What the quantiser made would lose again where bits can be saved, so they
// count for little.
EffortSettings settings_of_edited_tiles(EffortSettings settings);

// "old.tess: tile 5": what an error about it begins with.
std::string about_reused_tile(const EncodePlan& plan, std::uint64_t number);

// The tiles of a pass whose payloads are the reused file's. Errors: those of both.
Result<std::uint64_t> count_kept_tiles(const EncodePlan& plan, const PassResult& pass);

} // namespace tessera
