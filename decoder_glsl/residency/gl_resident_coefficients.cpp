// On sample: the coefficients of all tiles, sorted, and the trees that lead to their blocks.
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/residency/gl_residency.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/container/tiles_ahead.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace layout;

constexpr std::uint64_t largest_buffer = 128ull << 20; // bytes
constexpr std::uint64_t most_rounds = 16384;           // loop rounds of an invocation

class CoefficientTexture final : public Resident {
public:
    explicit CoefficientTexture(TextureFile& file) : file_(file) {}

    void bind() const override {
        file_.decoder.bind_tables();
        coefficients_.bind_storage(3);
        parameters_.bind_storage(4);
        directory_.bind_storage(6);
    }
    std::uint64_t bytes() const override {
        return coefficients_.bytes() + directory_.bytes() + parameters_.bytes() +
               file_.decoder.bytes();
    }
    std::uint64_t damaged_tiles() const override { return damaged_; }

    Status load() {
        if (file_.tables.has_corrections())
            return {ErrorCode::unsupported,
                    file_.reader.name() + ": it has corrections (--max-error), which only decoded "
                                          "texels can take; use on load or on feedback"};
        if (file_.tables.predicts())
            return {ErrorCode::unsupported,
                    file_.reader.name() + ": its blocks copy from other views, which only decoded "
                                          "texels can follow; use on load or on feedback"};
        if (file_.tables.filters())
            return {ErrorCode::unsupported,
                    file_.reader.name() + ": it has a filter, which only decoded texels can take; use "
                                          "on load or on feedback"};
        TESSERA_TRY(count_all());
        TESSERA_TRY(allocate());
        TESSERA_TRY(keep_all());
        file_.decoder.free_work();
        return take_gl_errors("loading coefficients");
    }

private:
    struct Share { // of one tile, in the directory and among the coefficients
        std::uint32_t nodes = 1, blocks = 1, coefficients = 0;
    };

    Status for_batches(const BatchFeed::Flush& flush) {
        const std::uint64_t used = bytes();
        const std::uint64_t left = file_.budget > used ? file_.budget - used : 0;
        BatchFeed feed(file_, {}, limits_within(std::min(left, std::uint64_t{256} << 20), false),
                       true, flush);
        TilesAhead ahead = all_tiles_ahead(file_.reader);
        for (std::uint64_t tile = 0; tile < file_.reader.grid().tiles(); ++tile) {
            TESSERA_TRY(ahead.ready(tile).status());
            TESSERA_TRY(feed.add(tile, {}));
        }
        return feed.finish();
    }

    // The entropy decoding of all tiles, to see how much there is.
    Status count_all() {
        shares_.resize(file_.reader.grid().tiles());
        std::uint32_t largest = 0;
        TESSERA_TRY(for_batches([&](DecodeBatch& batch) -> Status {
            TESSERA_TRY(file_.decoder.decode_levels(batch));
            const auto counts = file_.decoder.counts(batch);
            if (!counts.ok())
                return counts.status();
            damaged_ += batch.damaged.size();
            for (std::size_t i = 0; i < counts->size(); ++i) {
                const TileCounts& tile = (*counts)[i];
                damaged_ += tile.damaged != 0;
                if (tile.damaged == 0)
                    shares_[batch.tiles[i]] = {tile.nodes, tile.blocks, tile.coefficients};
                largest = std::max(largest, tile.largest);
            }
            return {};
        }));
        // Up to 16 blocks for the 16 texels of a sample, two coefficients a round.
        if (16 * (std::uint64_t{largest} / 2 + 16) > most_rounds)
            return {ErrorCode::unsupported,
                    file_.reader.name() + ": a block has " + std::to_string(largest) +
                        " coefficients, too many to evaluate at every sample; use on load or on "
                        "feedback"};
        return {};
    }

    Status allocate() {
        std::uint64_t coefficients = 0, words = tsr_d_words * shares_.size();
        for (const Share& share : shares_) {
            coefficients += share.coefficients;
            words += share.nodes + std::uint64_t{share.blocks} * tsr_block_words;
        }
        const std::uint64_t coefficient_bytes = std::max<std::uint64_t>(coefficients, 1) * 16;
        const std::uint64_t needed = coefficient_bytes + words * 4;
        if (coefficient_bytes > largest_buffer || words * 4 > largest_buffer ||
            needed + file_.decoder.bytes() > file_.budget)
            return {ErrorCode::unsupported, file_.reader.name() + ": its coefficients take " +
                                                mebibytes(needed) + ", the budget is " +
                                                mebibytes(file_.budget) +
                                                " (and a buffer at most 128 MiB); use on feedback"};
        auto coefficient_buffer =
            GlBuffer::create(coefficient_bytes, BufferUse::device, "coefficients");
        if (!coefficient_buffer.ok())
            return coefficient_buffer.status();
        coefficients_ = std::move(*coefficient_buffer);
        auto directory = GlBuffer::create(words * 4, BufferUse::upload, "directory");
        if (!directory.ok())
            return directory.status();
        directory_ = std::move(*directory);
        const auto words_of_file = sampler_words(file_.reader, file_.tables);
        auto parameters =
            GlBuffer::create(std::as_bytes(std::span(words_of_file)), "sampler parameters");
        if (!parameters.ok())
            return parameters.status();
        parameters_ = std::move(*parameters);
        return {};
    }

    // Once more, now that everything has its place.
    Status keep_all() {
        const auto program = compute_program("keep.comp.glsl");
        if (!program.ok())
            return program.status();
        std::vector<std::uint32_t> records;
        std::uint32_t word = static_cast<std::uint32_t>(tsr_d_words * shares_.size());
        for (const Share& share : shares_) {
            records.push_back(word);
            records.push_back(word + share.nodes);
            word += share.nodes + share.blocks * tsr_block_words;
        }
        TESSERA_TRY(directory_.upload(0, std::as_bytes(std::span(records))));
        std::uint32_t next = 0; // coefficient
        return for_batches([&](DecodeBatch& batch) -> Status {
            TESSERA_TRY(file_.decoder.decode_levels(batch));
            const auto levels = file_.decoder.segment_levels(batch);
            if (!levels.ok())
                return levels.status();
            place_segments(batch, *levels, next);
            TESSERA_TRY(file_.decoder.order_levels(batch, coefficients_));
            std::vector<std::uint32_t> jobs;
            for (const std::uint64_t tile : batch.tiles)
                jobs.insert(jobs.end(), {records[2 * tile], records[2 * tile + 1]});
            const auto job_buffer =
                GlBuffer::create(std::as_bytes(std::span(jobs)), "directory jobs");
            if (!job_buffer.ok())
                return job_buffer.status();
            job_buffer->bind_storage(5);
            directory_.bind_storage(6);
            program->use();
            glDispatchCompute(static_cast<GLuint>(batch.tiles.size()), 1, 1);
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
            return {};
        });
    }

    // Sorted coefficients of the segments go one behind the other; damaged tiles have none.
    void place_segments(DecodeBatch& batch, const std::vector<std::uint32_t>& levels,
                        std::uint32_t& next) const {
        for (std::uint32_t i = 0; i < batch.segments; ++i) {
            std::uint32_t* record = batch.words.data() + batch.words[tsr_b_segment_at] +
                                    std::size_t{i} * tsr_segment_words;
            record[tsr_seg_sorted] = next;
            if (shares_[batch.tiles[record[tsr_seg_tile]]].coefficients > 0)
                next += levels[i];
        }
    }

    TextureFile& file_;
    std::vector<Share> shares_;
    GlBuffer coefficients_, directory_, parameters_;
    std::uint64_t damaged_ = 0;
};

} // namespace

Result<std::unique_ptr<Resident>> make_coefficient_texture(TextureFile& file) {
    auto texture = std::make_unique<CoefficientTexture>(file);
    TESSERA_TRY(texture->load());
    return std::unique_ptr<Resident>(std::move(texture));
}

} // namespace tessera
