// The two residencies behind SampledTexture, and what they share.
#pragma once

#include "decoder_glsl/gl_sampled_texture.h"
#include "decoder_glsl/residency/gl_marks.h"
#include "decoder_glsl/residency/gl_tile_decoder.h"
#include "format/surface_mesh.h"

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera {

// Bindings of shaders/sample.glsl. coarse.comp and mips.comp read the sampler's buffer as well.
constexpr GLuint parameters_binding = 2; // uniform block
constexpr GLuint sampler_binding = 4, texels_unit = 0;
constexpr GLuint jobs_binding = 1; // of coarse.comp and mips.comp

// Limits for batches that keep the decoder's buffers within `bytes` in all. `keeps_values`: half of
// them are for the values of predicted or filtered tiles.
BatchLimits limits_within(std::uint64_t bytes, bool keeps_values);

// "12.5 MiB".
std::string mebibytes(std::uint64_t bytes);

// What one of several textures has of the budget of all: what it needs in any case, and a share of
// what is left.
struct BudgetShare {
    std::uint64_t fixed = 0, fixed_of_all = 0; // bytes
    double share = 1;

    std::uint64_t of(std::uint64_t budget) const {
        if (budget < fixed_of_all)
            return 0;
        const auto rest = static_cast<double>(budget - fixed_of_all);
        return fixed + static_cast<std::uint64_t>(rest * share);
    }
    // The budget of all of which that many bytes, at least `fixed`, are the part.
    std::uint64_t budget_for(std::uint64_t part) const {
        // of() rounds down.
        const double rest = part > fixed ? static_cast<double>(part - fixed) + 1 : 0;
        return fixed_of_all + static_cast<std::uint64_t>(rest / share) + 1;
    }
};

// A file and what every residency needs to decode and sample it.
struct TextureFile {
    const ContainerReader& reader;
    DecodeTables tables;
    bool half;
    std::uint64_t budget; // bytes, of all textures that were created together
    BudgetShare share;
    GlTileDecoder decoder;
    AtlasMips mips; // none without a mesh's atlas

    TexelFormat format() const { return half ? TexelFormat::rgba16f : TexelFormat::rgba8; }
    std::vector<ShaderDefine> output_defines() const {
        return half ? std::vector<ShaderDefine>{{"TSR_OUTPUT_HALF", "1"}}
                    : std::vector<ShaderDefine>{};
    }
};

// The words of the sampler's buffer (shaders/sampler_layout.glsl) for a file: header, axes and
// mips. Each residency sets the fields that it needs, which are 0 here, and appends its page table.
std::vector<std::uint32_t> sampler_words(const TextureFile& file);

// Binds the sampler's buffer, its header as uniforms, and the texels, of the texture with this
// number (see sample.glsl).
void bind_sampler(const GlBuffer& parameters, const GlTexture& texels, GLuint number);

// Loads the payloads of tiles, collects them in batches and passes each full batch to `flush`.
class BatchFeed {
public:
    using Flush = std::function<Status(DecodeBatch&)>;
    BatchFeed(TextureFile& file, const TexelPlan& plan, const BatchLimits& limits, Flush flush);
    // Errors: io, invalid_file; unsupported (one tile alone exceeds the limits); those of `flush`.
    Status add(std::uint64_t tile, const TexelPlace& place);
    Status finish();

private:
    TextureFile& file_;
    const BatchLimits limits_;
    BatchBuilder builder_;
    Flush flush_;
};

// How the texels of a texture are held on the device. Only a tile cache has anything to update.
class Resident {
public:
    virtual ~Resident() = default;
    virtual void bind(GLuint number) const = 0;
    virtual std::uint64_t bytes() const = 0;
    virtual std::uint64_t damaged_tiles() const = 0;
    virtual Result<UpdateReport> update(bool) { return UpdateReport{}; }
    virtual Status drop_cache() { return {}; }
    virtual std::uint64_t slots() const { return 0; }
    virtual std::uint64_t budget_for(std::uint64_t) const { return 0; }
};

// All tiles of the file, decoded into a plain texture.
Result<std::unique_ptr<Resident>> make_plain_texture(TextureFile& file, bool hardware_filter);
// The texels of `source` in a plain texture.
Result<std::unique_ptr<Resident>> make_uploaded_texture(const TextureFile& file,
                                                        TexelSource& source, bool hardware_filter);
// Bytes of a tile cache that do not depend on the number of its slots, besides buffers for decoding,
// and the least of those. `words` are those of sampler_words().
std::uint64_t fixed_cache_bytes(const TextureFile& file, std::size_t words, bool coarse);
std::uint64_t least_cache_work(const TextureFile& file);
// A tile cache, whose marks begin at word `first_mark` of `marks`. `file` must outlive it.
Result<std::unique_ptr<Resident>> make_cached_texture(TextureFile& file,
                                                      const SampledTextureOptions& options,
                                                      std::vector<std::uint32_t> words,
                                                      std::shared_ptr<GlMarksBuffer> marks,
                                                      std::uint64_t first_mark);

// Layout of a plain texture: angular images side by side, folded over layers. `size` is that of the
// texture or, with mips beside it, AtlasMips::kept_size().
struct PlainLayout {
    TexelPlan plan;
    TextureShape shape;
};
PlainLayout plain_layout(const Extent4& size);

} // namespace tessera
