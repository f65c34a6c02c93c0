#include "codec/pass/decoded_pass.h"

#include "codec/texels/level_texels.h"

namespace tessera {

DecodedPass::DecodedPass(const EncodePlan& plan, const PassResult& pass)
    : plan_(plan), pass_(pass),
      coding_(pass.parameters, plan.colour.desc.type, plan.colour.desc.channels) {}

Status DecodedPass::tile(std::uint64_t number, std::vector<std::byte>& texels) const {
    std::unique_ptr<TileDecoder> decoder;
    {
        const std::lock_guard lock(mutex_);
        if (!idle_.empty()) {
            decoder = std::move(idle_.back());
            idle_.pop_back();
        }
    }
    if (decoder == nullptr)
        decoder = std::make_unique<TileDecoder>(coding_, plan_.colour);
    const Box4 box = plan_.grid.box(number);
    std::vector<std::byte> payload;
    TESSERA_TRY(pass_.payloads->get(number, payload));
    texels.resize(static_cast<std::size_t>(desc().box_bytes(box)));
    TESSERA_TRY(decoder->decode(payload, tile_shape(box), texels));
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(decoder));
    return {};
}

LevelSource::LevelSource(const DecodedPass& texture, const LevelEntry& entry)
    : texture_(texture), full_{texture.grid().size(), 0, 0, 0}, entry_(entry),
      desc_(texture.desc()) {
    desc_.size = entry.size;
}

Status LevelSource::read(const Box4& box, std::span<std::byte> out) {
    LevelMeans means(desc_, full_, entry_, box);
    const TileGrid& grid = texture_.grid();
    std::vector<std::byte> texels;
    for (const std::uint64_t tile : grid.tiles_touched(covered_by(box, entry_, full_))) {
        TESSERA_TRY(texture_.tile(tile, texels));
        means.add(grid.box(tile), texels);
    }
    means.finish(out);
    return {};
}

} // namespace tessera
