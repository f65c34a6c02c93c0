// The texels that a pass's payloads decode to, and their means for coarser levels.
#pragma once

#include "codec/pass/encode_pass.h"
#include "codec/reconstruct/tile_decoder.h"
#include "format/container/level_table.h"

#include <memory>
#include <mutex>
#include <vector>

namespace tessera {

// Thread-safe; plan and pass outlive it.
class DecodedPass {
public:
    DecodedPass(const EncodePlan& plan, const PassResult& pass);
    const TileGrid& grid() const { return plan_.grid; }
    const TextureDesc& desc() const { return plan_.colour.desc; }
    // Replaces `texels`. Errors: io, invalid_file.
    Status tile(std::uint64_t number, std::vector<std::byte>& texels) const;

private:
    const EncodePlan& plan_;
    const PassResult& pass_;
    const TileCoding coding_;
    mutable std::mutex mutex_;
    mutable std::vector<std::unique_ptr<TileDecoder>> idle_; // decoders that no thread uses
};

// A coarse level of it as a source. Thread-safe.
class LevelSource final : public TexelSource {
public:
    LevelSource(const DecodedPass& texture, const LevelEntry& entry);
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override;

private:
    const DecodedPass& texture_;
    const LevelEntry full_, entry_;
    TextureDesc desc_;
};

} // namespace tessera
