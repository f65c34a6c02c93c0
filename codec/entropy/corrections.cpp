#include "codec/entropy/corrections.h"

#include "codec/entropy/tile_syntax.h"
#include "codec/tile/tile_planes.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace tessera {
namespace {

std::int32_t load_code(const std::byte* at, SampleType type) {
    return sample_code(load_sample(at, type), type);
}

// The contexts of a chunk's multipliers: those one step back in s, t and u, and the channel before.
class ChunkContexts {
public:
    ChunkContexts(const CorrectionMap& map, const BlockShape& shape, int channels,
                  std::size_t first_texel)
        : map_(map), channels_(static_cast<std::size_t>(channels)),
          first_(first_texel), steps_{1, shape.n[2],
                                      static_cast<std::size_t>(shape.n[2] * shape.n[3])} {}

    std::size_t context(std::size_t texel, std::size_t channel) const {
        std::int32_t sum = 0;
        for (const std::size_t step : steps_)
            if (texel >= first_ + step)
                sum += std::min(std::abs(map_[(texel - step) * channels_ + channel]), 2);
        const std::int32_t before =
            channel > 0 ? std::min(std::abs(map_[texel * channels_ + channel - 1]), 2) : 0;
        return static_cast<std::size_t>(sum * 3 + before);
    }

private:
    const CorrectionMap& map_;
    const std::size_t channels_, first_;
    const std::array<std::size_t, 3> steps_;
};

struct Chunk {
    std::size_t begin, end; // texels
};

std::vector<Chunk> chunks_of(const BlockShape& shape) {
    std::vector<Chunk> chunks;
    const auto texels = static_cast<std::size_t>(shape.texels());
    for (std::size_t begin = 0; begin < texels; begin += correction_chunk)
        chunks.push_back({begin, std::min<std::size_t>(texels, begin + correction_chunk)});
    return chunks;
}

// Calls visit(context, multiplier) in coding order.
template <class Visit>
void walk_chunk(const CorrectionMap& map, const BlockShape& shape, int channels, const Chunk& chunk,
                Visit visit) {
    const ChunkContexts contexts(map, shape, channels, chunk.begin);
    const auto c = static_cast<std::size_t>(channels);
    for (std::size_t texel = chunk.begin; texel < chunk.end; ++texel)
        for (std::size_t channel = 0; channel < c; ++channel)
            visit(contexts.context(texel, channel), map[texel * c + channel]);
}

bool is_zero(const CorrectionMap& map, int channels, const Chunk& chunk) {
    const auto c = static_cast<std::size_t>(channels);
    return std::all_of(map.begin() + static_cast<std::ptrdiff_t>(chunk.begin * c),
                       map.begin() + static_cast<std::ptrdiff_t>(chunk.end * c),
                       [](std::int32_t k) { return k == 0; });
}

int correction_token(std::int32_t k) {
    return k == 0 ? 0 : 1 + magnitude_token(std::abs(k)).token;
}

} // namespace

bool find_corrections(std::span<const std::byte> original, std::span<const std::byte> decoded,
                      const TextureDesc& desc, int error, CorrectionMap& map) {
    const std::size_t bytes = sample_bytes(desc.type);
    const std::int32_t step = 2 * error + 1;
    map.resize(original.size() / bytes);
    bool any = false;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const std::int32_t difference = load_code(original.data() + i * bytes, desc.type) -
                                        load_code(decoded.data() + i * bytes, desc.type);
        const std::int32_t k = (std::abs(difference) + error) / step;
        map[i] = difference < 0 ? -k : k;
        any = any || k != 0;
    }
    return any;
}

void apply_corrections(const CorrectionMap& map, const TextureDesc& desc, int error,
                       std::span<std::byte> texels) {
    const std::size_t bytes = sample_bytes(desc.type);
    const std::int32_t step = 2 * error + 1;
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (map[i] == 0)
            continue;
        std::byte* at = texels.data() + i * bytes;
        // Larger multipliers, which a hostile file may have, give the same clamped result.
        const std::int32_t k = std::clamp(map[i], -65536, 65536);
        const std::int64_t code = load_code(at, desc.type) + std::int64_t{k} * step;
        store_sample(
            at,
            code_sample(static_cast<std::int32_t>(std::clamp<std::int64_t>(code, -65536, 65536)),
                        desc.type),
            desc.type);
    }
}

void count_corrections(const CorrectionMap& map, const BlockShape& shape, int channels,
                       Statistics& statistics) {
    for (const Chunk& chunk : chunks_of(shape)) {
        if (is_zero(map, channels, chunk))
            continue;
        walk_chunk(map, shape, channels, chunk, [&](std::size_t context, std::int32_t k) {
            statistics.chain(correction_offset + static_cast<int>(context) * correction_chain,
                             correction_chain, correction_tokens, correction_token(k));
        });
    }
}

std::vector<std::vector<std::byte>> encode_corrections(const CorrectionMap& map,
                                                       const BlockShape& shape, int channels,
                                                       const CodeTables& tables) {
    std::vector<std::vector<std::byte>> streams;
    RansEncoder coder;
    for (const Chunk& chunk : chunks_of(shape)) {
        streams.emplace_back();
        if (is_zero(map, channels, chunk))
            continue;
        walk_chunk(map, shape, channels, chunk, [&](std::size_t context, std::int32_t k) {
            tables.correction[context].encode(coder, correction_token(k));
            if (k == 0)
                return;
            const MagnitudeToken token = magnitude_token(std::abs(k));
            put_magnitude_raw(coder, token);
            coder.raw(k < 0, 1);
        });
        coder.finish(streams.back());
    }
    return streams;
}

Status decode_corrections(const PayloadParts& parts, const BlockShape& shape, int channels,
                          const CodeTables& tables, CorrectionMap& map) {
    map.clear();
    if (parts.corrections.empty())
        return {};
    const auto c = static_cast<std::size_t>(channels);
    map.assign(static_cast<std::size_t>(shape.texels()) * c, 0);
    const std::vector<Chunk> chunks = chunks_of(shape);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        if (parts.corrections[i].empty())
            continue;
        RansDecoder rans(parts.corrections[i]);
        const ChunkContexts contexts(map, shape, channels, chunks[i].begin);
        for (std::size_t texel = chunks[i].begin; texel < chunks[i].end; ++texel)
            for (std::size_t channel = 0; channel < c; ++channel) {
                const int token = tables.correction[contexts.context(texel, channel)].decode(rans);
                if (token == 0)
                    continue;
                const std::int32_t magnitude = take_magnitude(rans, token - 1);
                map[texel * c + channel] = rans.raw(1) != 0 ? -magnitude : magnitude;
            }
        if (!rans.ended_well())
            return {ErrorCode::invalid_file,
                    "correction stream " + std::to_string(i) + " does not end where it should"};
    }
    return {};
}

} // namespace tessera
