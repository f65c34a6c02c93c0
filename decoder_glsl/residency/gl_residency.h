// The two residencies behind SampledTexture, and what they share.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/surface_mesh.h"

#include <array>
#include <memory>

namespace tessera {

// What decoding batches may take of the device, so that it stays within `bytes` in all. In a file that
// predicts, half of them are for the values of predicted tiles.
BatchLimits limits_within(std::uint64_t bytes, bool predicts);

// "12.5 MiB".
std::string mebibytes(std::uint64_t bytes);

// What every residency starts from.
struct TextureFile {
    const ContainerReader& reader;
    DecodeTables tables;
    bool half;
    std::uint64_t budget; // bytes
    GlTileDecoder decoder;
    AtlasMips mips; // none, but of a mesh's atlas

    TexelFormat format() const { return half ? TexelFormat::rgba16f : TexelFormat::rgba8; }
    std::vector<ShaderDefine> output_defines() const {
        return half ? std::vector<ShaderDefine>{{"TSR_OUTPUT_HALF", "1"}}
                    : std::vector<ShaderDefine>{};
    }
};

// The words of shaders/sampler_layout.glsl for a file: header, axes and mips; what a residency does not use
// stays 0. The page table goes behind them.
std::vector<std::uint32_t> sampler_words(const TextureFile& file);

// Feeds the payloads of tiles to a builder and hands each full batch to `flush`.
class BatchFeed {
public:
    using Flush = std::function<Status(DecodeBatch&)>;
    BatchFeed(const TextureFile& file, const TexelPlan& plan, const BatchLimits& limits,
              Flush flush);
    // Errors: io, invalid_file; runtime, when a tile alone is larger than the limits; of `flush`.
    Status add(std::uint64_t tile, const TexelPlace& place);
    Status finish();

private:
    const TextureFile& file_;
    const BatchLimits limits_;
    BatchBuilder builder_;
    Flush flush_;
};

class Resident {
public:
    virtual ~Resident() = default;
    virtual void bind() const = 0;
    virtual std::uint64_t bytes() const = 0;
    virtual std::uint64_t damaged_tiles() const = 0;
    virtual Result<UpdateReport> update(bool) { return UpdateReport{}; }
    virtual Status drop_cache() { return {}; }
    virtual std::uint64_t slots() const { return 0; }
    virtual std::uint64_t budget_for(std::uint64_t) const { return 0; }
    virtual const TileCacheStats* stats() const { return nullptr; }
};

Result<std::unique_ptr<Resident>> make_plain_texture(TextureFile& file, bool hardware_filter);
Result<std::unique_ptr<Resident>> make_uploaded_texture(const TextureFile& file,
                                                        TexelSource& source, bool hardware_filter);
Result<std::unique_ptr<Resident>> make_cached_texture(TextureFile& file,
                                                      const SampledTextureOptions& options);

// Layout of an ordinary texture: angular images side by side, folded over layers. The images are those of
// `size`, the texture's or, with mips beside it, that of AtlasMips::kept_size().
struct PlainLayout {
    TexelPlan plan;
    TextureShape shape;
};
PlainLayout plain_layout(const Extent4& size);

} // namespace tessera
