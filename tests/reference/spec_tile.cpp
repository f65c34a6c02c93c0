#include "tests/reference/spec_tile.h"

#include <algorithm>
#include <bit>

namespace tessera_reference::spec {

namespace {

Payload read_payload(Bytes bytes, const Header& header, size_t texels) {
    const bool is_large = texels > 65536;
    const size_t chunk_count = (texels + 4095) / 4096;
    Payload payload;
    payload.corrections.resize(chunk_count);
    payload.segments.push_back({0, {}});
    std::vector<size_t> lengths;            // bytes of each segment after the first
    std::vector<size_t> correction_lengths; // bytes
    size_t at = 0;
    uint32_t mask = 0;
    if (bytes.size() % 2 == 1) {
        const int first = u8(bytes, 0);
        at = 1;
        for (int i = 0; i < (is_large ? first : first & 127); ++i) {
            const size_t first_block = u16(bytes, at);
            require(i == 0 || first_block > payload.segments.back().first_block,
                    "payload: first blocks must ascend");
            payload.segments.push_back({first_block, {}});
            lengths.push_back(size_t{2} * u16(bytes, at + 2));
            at += 4;
        }
        if (!is_large && first & 128) {
            require(header.has_corrections(), "payload: corrections without their feature");
            mask = u16(bytes, at);
            at += 2;
            require(mask >> chunk_count == 0, "payload: a chunk that the tile does not have");
            for (int i = 0; i < std::popcount(mask); ++i) {
                correction_lengths.push_back(size_t{2} * u16(bytes, at));
                require(correction_lengths.back() > 0, "payload: empty correction stream");
                at += 2;
            }
        }
    }
    size_t others = at;
    for (size_t length : lengths)
        others += length;
    for (size_t length : correction_lengths)
        others += length;
    require(others <= bytes.size(), "payload: lengths must fit");

    const auto take = [&](size_t length) {
        const Bytes part = bytes.subspan(at, length);
        at += length;
        return part;
    };
    payload.segments[0].bytes = take(bytes.size() - others);
    for (size_t i = 0; i < lengths.size(); ++i)
        payload.segments[i + 1].bytes = take(lengths[i]);
    size_t next = 0;
    for (size_t chunk = 0; chunk < chunk_count; ++chunk)
        if (mask >> chunk & 1)
            payload.corrections[chunk] = take(correction_lengths[next++]);
    return payload;
}

} // namespace

// ------------------------------------------------------------------------------- 3.6 corrections

void TileDecoder::add_corrections(const Payload& payload) {
    const size_t channels = static_cast<size_t>(header_.channels);
    const size_t texels = static_cast<size_t>(product(size_));
    const size_t S = static_cast<size_t>(size_[2]), T = static_cast<size_t>(size_[3]);
    for (size_t chunk = 0; chunk < payload.corrections.size(); ++chunk) {
        if (!payload.corrections[chunk])
            continue;
        Stream stream(*payload.corrections[chunk]);
        const size_t begin = chunk * 4096;
        const size_t count = std::min<size_t>(4096, texels - begin);
        std::vector<int> small(count * channels); // min(|multiplier|, 2)
        for (size_t i = 0; i < count; ++i)
            for (size_t c = 0; c < channels; ++c) {
                int n = 0;
                for (const size_t back : {size_t{1}, S, S * T})
                    if (back <= i)
                        n += small[(i - back) * channels + c];
                const int b = c == 0 ? 0 : small[i * channels + c - 1];
                const int token = stream.symbol(code_.correction[3 * n + b]);
                if (token == 0)
                    continue;
                int64_t multiplier = read_magnitude(stream, token - 1);
                small[i * channels + c] = static_cast<int>(std::min<int64_t>(multiplier, 2));
                if (stream.raw(1))
                    multiplier = -multiplier;
                int64_t& code = codes_[(begin + i) * channels + c];
                code = clamp_code(code + multiplier * (2 * code_.correction_error + 1),
                                  header_.sample_type);
            }
        require(stream.ends_well(), "corrections: the stream must end well");
    }
}

// ------------------------------------------------------------------------ parts 3 and 4 for a tile

std::vector<uint16_t> TileDecoder::decode(Bytes bytes, const Vector4& size) {
    const size_t channels = static_cast<size_t>(header_.channels);
    const size_t texels = static_cast<size_t>(product(size));
    std::vector<uint16_t> samples(texels * channels);
    if (bytes.empty()) { // 1.4; a background of -0 becomes +0 like every decoded sample (4.5)
        for (size_t i = 0; i < samples.size(); ++i) {
            const uint16_t sample = header_.background[i % channels];
            samples[i] = sample_of(code_of(sample, header_.sample_type), header_.sample_type);
        }
        return samples;
    }
    if (header_.has_stored_tiles() && bytes.size() == texels * header_.texel_bytes()) { // 3.2
        for (size_t i = 0; i < samples.size(); ++i) {
            const int sample = header_.sample_type ? static_cast<int>(u16(bytes, 2 * i))
                                                   : static_cast<int>(u8(bytes, i));
            samples[i] =
                sample_of(clamp_code(code_of(static_cast<uint16_t>(sample), header_.sample_type),
                                     header_.sample_type),
                          header_.sample_type);
        }
        return samples;
    }
    size_ = size;
    blocks_.clear();
    nodes_ = 0;
    last_block_copied_ = has_base_ = last_copied_base_ = false;
    last_base_displacement_ = 0;
    displacement_ = {};
    codes_.assign(texels * channels, 0);
    const Payload payload = read_payload(bytes, header_, texels);
    for (size_t i = 0; i < payload.segments.size(); ++i) {
        Stream stream(payload.segments[i].bytes);
        if (i == 0) {
            read_base_tree(stream);
            read_tile_trees(stream);
        }
        const size_t begin = payload.segments[i].first_block;
        const size_t end =
            i + 1 < payload.segments.size() ? payload.segments[i + 1].first_block : blocks_.size();
        require(begin <= end && end <= blocks_.size(), "payload: first block");
        require(i == 0 || begin < blocks_.size(), "payload: first block");
        read_segment(stream, begin, end, i == 0 ? nodes_ : 0);
        require(stream.ends_well(), "segment: the stream must end well");
    }
    predicted_tile_ =
        std::any_of(blocks_.begin(), blocks_.end(),
                    [](const Block& block) { return block.copies() || block.mode > 0; }) ||
        has_base_;
    std::array<std::vector<const Block*>, 16> at_depth;
    for (Block& block : blocks_)
        at_depth[static_cast<size_t>(depth_of(block))].push_back(&block);
    for (size_t p = 0; p < channels; ++p) {
        plane_values_[p].assign(texels, 0);
        base_values_[p].assign(static_cast<size_t>(has_base_ ? product(base_size_) : 0), 0);
    }
    // Blocks of pictures have depth 0, so they are reconstructed in their order. Those of the base
    // picture come first.
    for (const auto& blocks : at_depth)
        for (const Block* block : blocks)
            reconstruct(*block);
    if (code_.filter)
        filter();
    make_codes();
    add_corrections(payload);
    for (size_t i = 0; i < samples.size(); ++i)
        samples[i] = sample_of(codes_[i], header_.sample_type);
    return samples;
}

} // namespace tessera_reference::spec
