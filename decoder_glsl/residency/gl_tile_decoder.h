// Decodes batches of tiles on the device: runs the passes of decoder_glsl/shaders in order.
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

// The program of an embedded compute shader. Errors: those of shader_source() and GlProgram.
Result<GlProgram> compute_program(const std::string& file,
                                  std::span<const ShaderDefine> defines = {});

// What the device counted in a decoded tile.
struct TileCounts {
    std::uint32_t blocks = 0;
    std::uint32_t coefficients = 0; // that are not 0
    std::uint32_t damaged = 0;      // 0: sound; else the sum of tsr_damage_* (shaders/layout.glsl)
};

// Every call and the destructor need a current OpenGL 4.5 context. Buffers grow to the size that
// batches need and keep it.
class GlTileDecoder {
public:
    // Uploads the tables and compiles the programs. `half`: texels are halves (rgba16f), else bytes
    // (rgba8).
    static Result<GlTileDecoder> create(const DecodeTables& tables, bool half);

    void set_stage_hook(StageHook hook) { hook_ = std::move(hook); }

    // Issues the work that decodes a batch into `target` and returns. OpenGL calls that follow see
    // the texels. `tables`: those of create(), with what the batch has added to them. Errors:
    // runtime (no memory), bad_argument (`target` has another format).
    Status decode(const DecodeTables& tables, const DecodeBatch& batch, const GlTexture& target);

    // The counts of `batch`, which was decoded last. Waits for the device.
    Result<std::vector<TileCounts>> counts(const DecodeBatch& batch) const;

    std::uint64_t bytes() const; // on the device
    // Frees the buffers of batches. The next batch allocates them again.
    void free_work();

private:
    GlTileDecoder() = default;
    Status upload_tables(const DecodeTables& tables);
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
    std::size_t table_words_ = 0;   // on the device
    unsigned table_generation_ = 0; // likewise
    GlProgram predicted_texels_;    // for files that predict or filter
    GlProgram border_;              // for files that predict
    GlProgram filter_;              // for files that filter
    bool filters_ = false;
    StageHook hook_;
};

// Makes `buffer` at least `bytes` long. A buffer that grows loses its content.
Status grow_buffer(GlBuffer& buffer, std::uint64_t bytes, BufferUse use, const std::string& name);

} // namespace tessera
