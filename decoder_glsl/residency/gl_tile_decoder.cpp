#include "decoder_glsl/residency/gl_tile_decoder.h"

#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/shaders/shader_layout.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace layout;

// Bindings of shaders/buffers.glsl.
constexpr GLuint tables_binding = 0, batch_binding = 1, work_binding = 2, coefficients_binding = 3;

constexpr GLbitfield after_texels = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                                    GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                                    GL_TEXTURE_UPDATE_BARRIER_BIT;

std::uint32_t groups_of(std::uint64_t items, std::uint32_t size) {
    return static_cast<std::uint32_t>((items + size - 1) / size);
}

std::span<const std::byte> bytes_of(const std::vector<std::uint32_t>& words) {
    return std::as_bytes(std::span(words));
}

Status make_program(GlProgram& program, const char* file,
                    std::span<const ShaderDefine> defines = {}) {
    TESSERA_TRY_ASSIGN(program, compute_program(file, defines));
    return {};
}

} // namespace

Result<GlProgram> compute_program(const std::string& file, std::span<const ShaderDefine> defines) {
    TESSERA_TRY_ASSIGN(const auto source, shader_source(file, ShaderDialect::gl450, defines));
    return GlProgram::compute(source, file);
}

Status grow_buffer(GlBuffer& buffer, std::uint64_t bytes, BufferUse use, const std::string& name) {
    if (buffer.bytes() >= bytes)
        return {};
    buffer = GlBuffer(); // frees the smaller one first
    TESSERA_TRY_ASSIGN(buffer, GlBuffer::create(bytes, use, name));
    return {};
}

Result<GlTileDecoder> GlTileDecoder::create(const DecodeTables& tables, bool half) {
    GlTileDecoder d;
    d.half_ = half;
    TESSERA_TRY_ASSIGN(
        d.tables_, GlBuffer::create(tables.most_words() * 4, BufferUse::upload, "decoder tables"));
    TESSERA_TRY(d.tables_.upload(0, std::as_bytes(tables.words())));
    d.table_words_ = tables.words().size();
    d.table_generation_ = tables.generation();
    TESSERA_TRY(make_program(d.tree_, "tree.comp.glsl"));
    TESSERA_TRY(make_program(d.levels_, "levels.comp.glsl"));
    TESSERA_TRY(make_program(d.corrections_, "corrections.comp.glsl"));
    TESSERA_TRY(make_program(d.order_, "order.comp.glsl"));
    TESSERA_TRY(make_program(d.items_, "items.comp.glsl"));
    TESSERA_TRY(make_program(d.groups_, "groups.comp.glsl"));
    std::vector<ShaderDefine> defines;
    if (half)
        defines.emplace_back("TSR_OUTPUT_HALF", "1");
    TESSERA_TRY(make_program(d.texels_, "texels.comp.glsl", defines));
    defines.emplace_back("TSR_PREDICTED_TILES", "1");
    if (tables.keeps_values())
        TESSERA_TRY(make_program(d.predicted_texels_, "texels.comp.glsl", defines));
    defines.pop_back();
    if (tables.predicts())
        TESSERA_TRY(make_program(d.border_, "border.comp.glsl", defines));
    d.filters_ = tables.filters();
    if (d.filters_)
        TESSERA_TRY(make_program(d.filter_, "filter.comp.glsl", defines));
    return d;
}

std::uint64_t GlTileDecoder::bytes() const {
    return tables_.bytes() + batch_.bytes() + work_.bytes() + coefficients_.bytes();
}

void GlTileDecoder::free_work() {
    batch_ = GlBuffer();
    work_ = GlBuffer();
    coefficients_ = GlBuffer();
}

Status GlTileDecoder::upload_tables(const DecodeTables& tables) {
    const std::span<const std::uint32_t> words = tables.words();
    if (words.size() == table_words_ && tables.generation() == table_generation_)
        return {};
    const std::size_t scans_at = tables.words_before_scans();
    const std::size_t from = tables.generation() == table_generation_ ? table_words_ : scans_at;
    TESSERA_TRY(tables_.upload(tsr_t_end * 4,
                               std::as_bytes(words.subspan(tsr_t_end, scans_at - tsr_t_end))));
    TESSERA_TRY(tables_.upload(from * 4, std::as_bytes(words.subspan(from))));
    table_words_ = words.size();
    table_generation_ = tables.generation();
    return {};
}

Status GlTileDecoder::upload(const DecodeBatch& batch) {
    note(DecodeStage::upload, true);
    TESSERA_TRY(grow_buffer(batch_, batch.words.size() * 4, BufferUse::upload, "decoder batch"));
    TESSERA_TRY(batch_.upload(0, bytes_of(batch.words)));
    note(DecodeStage::upload, false);
    return {};
}

void GlTileDecoder::run_entropy(const DecodeBatch& batch) {
    const auto tiles = static_cast<std::uint32_t>(batch.tiles.size());
    note(DecodeStage::entropy, true);
    tree_.use();
    glDispatchCompute(groups_of(tiles, TSR_STREAM_GROUP), 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    levels_.use();
    glDispatchCompute(groups_of(tiles, TSR_LEVELS_GROUP), batch.most_segments, 1);
    if (batch.corrections > 0) {
        corrections_.use();
        glDispatchCompute(groups_of(batch.corrections, TSR_STREAM_GROUP), 1, 1);
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    note(DecodeStage::entropy, false);
}

void GlTileDecoder::run_order(const DecodeBatch& batch) {
    note(DecodeStage::order, true);
    if (batch.raw_chunks > 0) {
        order_.use();
        static_assert(tsr_raw_chunk == TSR_TEXEL_GROUP); // one group per chunk
        glDispatchCompute(std::min(batch.raw_chunks, std::uint32_t{tsr_row_groups}),
                          groups_of(batch.raw_chunks, tsr_row_groups), 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
    note(DecodeStage::order, false);
}

Status GlTileDecoder::run_transform(const DecodeBatch& batch, const GlTexture& target) {
    note(DecodeStage::transform, true);
    TESSERA_TRY(
        target.bind_image(0, GL_WRITE_ONLY, half_ ? TexelFormat::rgba16ui : TexelFormat::r32ui));
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, work_.id());
    for (std::uint32_t wave = 0; wave < batch.waves; ++wave) { // the shaders count waves themselves
        items_.use();
        glDispatchCompute(static_cast<std::uint32_t>(batch.tiles.size()), 1, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        groups_.use();
        glDispatchCompute(1, 1, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
        (batch.predicted || filters_ ? predicted_texels_ : texels_).use();
        glDispatchComputeIndirect(tsr_w_groups * 4);
        glMemoryBarrier(after_texels);
        if (wave == 0 && batch.borders) { // the waves after it copy base pictures
            border_.use();
            glDispatchCompute(static_cast<std::uint32_t>(batch.tiles.size()), 1, 1);
            glMemoryBarrier(after_texels);
        }
    }
    if (filters_) {
        filter_.use();
        glDispatchCompute(groups_of(batch.most_texels, TSR_TEXEL_GROUP),
                          static_cast<std::uint32_t>(batch.tiles.size()), 1);
        glMemoryBarrier(after_texels);
    }
    note(DecodeStage::transform, false);
    return {};
}

Status GlTileDecoder::decode(const DecodeTables& tables, const DecodeBatch& batch,
                             const GlTexture& target) {
    if (batch.tiles.empty())
        return {};
    TESSERA_TRY(upload_tables(tables));
    TESSERA_TRY(upload(batch));
    TESSERA_TRY(grow_buffer(work_, batch.work_words * 4, BufferUse::device, "decoder work"));
    TESSERA_TRY(grow_buffer(coefficients_, std::max<std::uint64_t>(batch.coefficients, 1) * 16,
                            BufferUse::device, "decoder coefficients"));
    TESSERA_TRY(work_.clear(0, 0, tsr_w_state * 4));
    tables_.bind_storage(tables_binding);
    batch_.bind_storage(batch_binding);
    work_.bind_storage(work_binding);
    coefficients_.bind_storage(coefficients_binding);
    run_entropy(batch);
    run_order(batch);
    TESSERA_TRY(run_transform(batch, target));
    return take_gl_errors("decoding tiles");
}

Result<std::vector<TileCounts>> GlTileDecoder::counts(const DecodeBatch& batch) const {
    std::vector<std::uint32_t> words(batch.tiles.size() * tsr_state_words);
    TESSERA_TRY(work_.read(tsr_w_state * 4, std::as_writable_bytes(std::span(words))));
    std::vector<TileCounts> counts(batch.tiles.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const std::uint32_t* state = words.data() + i * tsr_state_words;
        counts[i] = {.blocks = state[tsr_st_blocks],
                     .coefficients = state[tsr_st_levels],
                     .damaged = state[tsr_st_damaged]};
    }
    return counts;
}

} // namespace tessera
