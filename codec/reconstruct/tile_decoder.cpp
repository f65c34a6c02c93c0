#include "codec/reconstruct/tile_decoder.h"

namespace tessera {

BlockShape tile_shape(const Box4& box) {
    BlockShape shape;
    const Extent4 extent = box.extent();
    for (int axis = 0; axis < 4; ++axis)
        shape.n[axis] = static_cast<std::uint8_t>(extent[axis]);
    return shape;
}

Status TileDecoder::parse(std::span<const std::byte> payload, const BlockShape& shape) {
    TESSERA_TRY(split_payload(payload, shape.texels(), parts_));
    if (!parts_.corrections.empty() && !colour_->corrections)
        return {ErrorCode::invalid_file, "corrections in a file whose header has none"};
    TESSERA_TRY(decode_levels(parts_, shape, *coding_, levels_));
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
    render(levels_, corrections_, texels);
    return {};
}

} // namespace tessera
