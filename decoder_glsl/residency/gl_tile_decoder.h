// Decodes batches of tiles on the device: the passes of decoder_glsl/shaders in order.
#pragma once

#include "decoder_glsl/batch/decode_batch.h"
#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_program.h"
#include "decoder_glsl/gl/gl_sync.h"
#include "decoder_glsl/gl/gl_texture.h"
#include "decoder_glsl/gl_sampled_texture.h"
#include "decoder_glsl/shader_source.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace tessera {

// The program of an embedded compute shader for OpenGL 4.5. Errors as of shader_source and GlProgram.
Result<GlProgram> compute_program(const std::string& file,
                                  std::span<const ShaderDefine> defines = {});

// What a decoded tile came to, as the device counted.
struct TileCounts {
    std::uint32_t blocks = 0;
    std::uint32_t coefficients = 0; // not 0
    std::uint32_t damaged = 0;      // 0: sound; else tsr_damage_* of shaders/layout.glsl
};

// Needs a current OpenGL 4.5 context at every call. Buffers grow to what batches need and stay.
class GlTileDecoder {
public:
    // Uploads the tables. `half`: texels are halves (a texture of rgba16f), else bytes (rgba8).
    static Result<GlTileDecoder> create(const DecodeTables& tables, bool half);

    void set_stage_hook(StageHook hook) { hook_ = std::move(hook); }

    // Decodes the texels of a batch into `target`. Issues the work and returns; the texels are seen by
    // whatever is issued later. Errors: runtime (no memory; target of another format).
    Status decode(const DecodeBatch& batch, const GlTexture& target);

    // Of the last batch; waits for the device.
    Result<std::vector<TileCounts>> counts(const DecodeBatch& batch) const;

    std::uint64_t bytes() const; // on the device
    // Gives back what decoding needs; the next batch takes it anew.
    void free_work();

private:
    GlTileDecoder() = default;
    Status upload(const DecodeBatch& batch);
    void run_entropy(const DecodeBatch& batch);
    void run_order(const DecodeBatch& batch);
    Status run_transform(const DecodeBatch& batch, const GlTexture& target);
    void note(DecodeStage stage, bool begins) const {
        if (hook_)
            hook_(stage, begins);
    }

    bool half_ = false;
    GlBuffer tables_, batch_, work_, coefficients_;
    GlProgram tree_, levels_, corrections_, order_, items_, groups_, texels_;
    GlProgram predicted_texels_; // only of files that predict or filter
    GlProgram filter_;           // only of files that filter
    bool filters_ = false;
    StageHook hook_;
};

// Makes `buffer` at least `bytes` long, by a larger one in its place; content is lost then.
Status grow_buffer(GlBuffer& buffer, std::uint64_t bytes, BufferUse use, const std::string& name);

} // namespace tessera
