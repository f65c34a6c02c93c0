#include "codec/reconstruct/tile_decoder.h"

#include "format/samples.h"

namespace tessera {

BlockShape tile_shape(const Box4& box) {
    BlockShape shape;
    const Extent4 extent = box.extent();
    for (int axis = 0; axis < 4; ++axis)
        shape.n[axis] = static_cast<std::uint16_t>(extent[axis]);
    return shape;
}

void copy_stored(std::span<const std::byte> samples, SampleType type, std::span<std::byte> texels) {
    for (std::size_t at = 0; at < samples.size(); at += sample_bytes(type))
        store_sample(&texels[at],
                     code_sample(sample_code(load_sample(&samples[at], type), type), type), type);
}

Status TileDecoder::parse(std::span<const std::byte> payload, const BlockShape& shape) {
    is_stored_ = colour_->stored && payload.size() == static_cast<std::size_t>(shape.texels()) *
                                                          colour_->desc.texel_bytes();
    if (is_stored_)
        payload = {}; // stands for a tile of one block without levels
    TESSERA_TRY(split_payload(payload, shape.texels(), parts_));
    if (!parts_.corrections.empty() && !colour_->corrections)
        return {ErrorCode::invalid_file, "the tile has corrections, which the header excludes"};
    TESSERA_TRY(decode_levels(parts_, shape, *coding_, grid_, levels_));
    return decode_corrections(parts_, shape, coding_->planes, coding_->tables, corrections_);
}

void TileDecoder::render(const TileLevels& levels, const CorrectionMap& corrections,
                         std::span<std::byte> texels) {
    reconstruct(levels, *coding_, scratch_, planes_);
    filter_tile(*coding_, filter_scratch_, planes_);
    texels_from_planes(planes_, *colour_, texels);
    if (!corrections.empty())
        apply_corrections(corrections, colour_->desc, coding_->parameters.correction_error, texels);
}

Status TileDecoder::decode(std::span<const std::byte> payload, const BlockShape& shape,
                           std::span<std::byte> texels) {
    TESSERA_TRY(parse(payload, shape));
    if (is_stored_) {
        copy_stored(payload, colour_->desc.type, texels);
        return {};
    }
    render(levels_, corrections_, texels);
    return {};
}

} // namespace tessera
