// On feedback: a tile cache that holds the tiles which frames have marked.
#include "decoder_glsl/cache/cache_plan.h"
#include "decoder_glsl/cache/coarse_cells.h"
#include "decoder_glsl/cache/tile_cache.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/residency/gl_coarse_means.h"
#include "decoder_glsl/residency/gl_mips.h"
#include "decoder_glsl/residency/gl_residency.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/container/tiles_ahead.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace layout;

// A tile's share of the job lists of coarse.comp and mips.comp.
constexpr std::uint64_t job_bytes = tsr_job_words * 4;

// A sixth of a budget is for decoding, within these bounds. The least is twice as much for tiles
// that keep their values.
constexpr std::uint64_t least_work_plain = 2ull << 20, most_work = 96ull << 20;

class CachedTexture final : public Resident {
public:
    CachedTexture(TextureFile& file, const SampledTextureOptions& options,
                  std::vector<std::uint32_t> words)
        : file_(file), grid_(file.reader.grid()), jobs_per_update_(options.jobs_per_update),
          filter_(options.hardware_filter), coarse_(options.coarse),
          coarse_from_(options.coarse_from), words_(std::move(words)) {}

    Status load(std::shared_ptr<GlMarksBuffer> marks, std::uint64_t first_mark) {
        TESSERA_TRY_ASSIGN(marks_, GlMarks::create(std::move(marks), first_mark, grid_.tiles()));
        TESSERA_TRY(find_background());
        TESSERA_TRY(plan_memory());
        TESSERA_TRY(create_objects());
        if (coarse_)
            TESSERA_TRY(coarse_from_.texels != nullptr ? take_coarse() : make_coarse());
        coarse_from_.texels = nullptr; // the caller lends it for this call only
        file_.decoder.free_work();     // a frame needs far less than a whole file
        return drop_cache();
    }

    void bind(GLuint number) const override {
        bind_sampler(parameters_, texels_, number);
        marks_.bind();
    }
    std::uint64_t bytes() const override {
        return texels_.bytes() + parameters_.bytes() + marks_.bytes() + mips_.bytes() +
               file_.decoder.bytes();
    }
    std::uint64_t damaged_tiles() const override { return damaged_; }
    std::uint64_t slots() const override { return cache_->slots(); }
    // The inverse of plan_memory(), which may lose a line of slots to rounding.
    std::uint64_t budget_for(std::uint64_t tiles) const override {
        const std::uint64_t bytes = fixed_bytes_ + (tiles + slots_across(plan_.slot)) * slot_bytes_;
        return std::max(std::min(bytes + bytes / 5, bytes + most_work),
                        bytes + least_cache_work(file_)) +
               4096;
    }

    Status drop_cache() override {
        TESSERA_TRY_ASSIGN(auto cache, TileCache::create(plan_.slots(), grid_.tiles()));
        cache_.emplace(std::move(cache));
        std::copy(empty_pages_.begin(), empty_pages_.end(),
                  words_.begin() + static_cast<std::ptrdiff_t>(pages_at_));
        TESSERA_TRY(parameters_.upload(pages_at_ * 4, std::as_bytes(std::span(empty_pages_))));
        return marks_.clear();
    }

    Result<UpdateReport> update(bool wait) override {
        UpdateReport report;
        TESSERA_TRY(marks_.send());
        TESSERA_TRY_ASSIGN(report.current, marks_.receive(wait));
        list_touched();
        if (touched_.empty())
            return report;
        report.touched = static_cast<std::uint32_t>(touched_.size());
        report.missing = static_cast<std::uint32_t>(std::ranges::count_if(
            touched_, [&](std::uint32_t tile) { return cache_->slot_of(tile) == no_slot; }));
        cache_->begin_frame();
        TESSERA_TRY_ASSIGN(
            const auto jobs,
            cache_->touch(touched_, jobs_per_update_ == 0 ? UINT32_MAX : jobs_per_update_));
        std::vector<DecodeJob> list(jobs.begin(), jobs.end());
        Unread unread;
        const Status decoded = decode_readable(list, wait, unread);
        if (!decoded.ok()) // slots that were not filled must not be shown
            for (const DecodeJob& job : list)
                TESSERA_TRY(cache_->mark_failed(job.tile));
        report.decoded = static_cast<std::uint32_t>(list.size());
        report.waiting = static_cast<std::uint32_t>(cache_->waiting().size());
        report.trouble = unread.trouble;
        TESSERA_TRY(upload_pages());
        TESSERA_TRY(decoded);
        TESSERA_TRY(compute_mips(list));
        TESSERA_TRY(take_gl_errors("filling the tile cache"));
        TESSERA_TRY(unread.damaged);
        return report;
    }

private:
    // Finds the tiles without bytes. They are background and are never decoded.
    Status find_background() {
        empty_pages_.assign(grid_.tiles(), tsr_page_missing);
        // Index groups are fetched together, also those of coarse levels, whose tiles are needed
        // next.
        std::uint32_t brought = 0; // groups
        for (std::uint64_t tile = 0; tile < grid_.tiles(); ++tile) {
            if (file_.reader.level_table().group_of(tile) >= brought) {
                TESSERA_TRY_ASSIGN(brought, file_.reader.prefetch_groups(brought));
            }
            TESSERA_TRY_ASSIGN(const auto location, file_.reader.locate(tile));
            if (location.length == 0)
                empty_pages_[tile] = tsr_page_background;
            else
                ++full_tiles_;
        }
        return {};
    }

    // Plans as many slots as the budget leaves after everything else, but no more than tiles to
    // decode.
    Status plan_memory() {
        const CacheSlot slot = cache_slot(grid_, file_.mips.count() > 0);
        slot_bytes_ =
            std::uint64_t{slot.width} * slot.height * texel_bytes(file_.format()) + job_bytes;
        const std::uint64_t budget = file_.share.of(file_.budget);
        work_bytes_ = std::clamp(budget / 6, least_cache_work(file_), most_work);
        fixed_bytes_ = fixed_cache_bytes(file_, words_.size(), coarse_);
        const std::uint64_t fixed = fixed_bytes_ + work_bytes_;
        if (budget < fixed + slot_bytes_)
            return {ErrorCode::unsupported,
                    file_.reader.name() + ": a tile cache of one tile takes " +
                        mebibytes(file_.share.budget_for(fixed + slot_bytes_)) +
                        ", the budget is " + mebibytes(file_.budget)};
        const std::uint64_t most = (budget - fixed) / slot_bytes_;
        const auto plan =
            plan_cache(slot, std::min(most, std::max<std::uint64_t>(full_tiles_, 1)), most);
        if (!plan)
            return {ErrorCode::unsupported,
                    file_.reader.name() +
                        ": more tiles than a texture array takes; lower the budget"};
        plan_ = *plan;
        return {};
    }

    Status create_objects() {
        const CacheSlot& slot = plan_.slot;
        const TextureShape shape{
            .width = plan_.width(), .height = plan_.height(), .layers = plan_.layers};
        TESSERA_TRY_ASSIGN(texels_, GlTexture::create(file_.format(), shape, "tile cache"));
        // The hardware filter reads pixels beside a tile's texels with weight 0. They must be
        // numbers.
        texels_.clear();
        TESSERA_TRY(texels_.interpolate(filter_));

        words_[tsr_p_slot_width] = slot.width;
        words_[tsr_p_slot_height] = slot.height;
        words_[tsr_p_stride_s] = slot.stride_s;
        words_[tsr_p_stride_t] = slot.stride_t;
        words_[tsr_p_width] = shape.width;
        words_[tsr_p_height] = shape.height;
        pages_at_ = words_.size();
        words_[tsr_p_page_at] = static_cast<std::uint32_t>(pages_at_);
        words_[tsr_p_marks_at] = marks_.first();
        words_[tsr_p_coarse_at] =
            coarse_ ? static_cast<std::uint32_t>(pages_at_ + grid_.tiles()) : 0;
        words_.insert(words_.end(), empty_pages_.begin(), empty_pages_.end());
        const std::uint64_t coarse_words = coarse_ ? grid_.tiles() * tsr_coarse_words : 0;
        TESSERA_TRY(grow_buffer(parameters_, (words_.size() + coarse_words) * 4, BufferUse::upload,
                                "sampler parameters"));
        TESSERA_TRY(parameters_.clear(0));
        TESSERA_TRY(parameters_.upload(0, std::as_bytes(std::span(words_))));
        if (file_.mips.count() > 0) {
            TESSERA_TRY_ASSIGN(mips_, GlMips::create(file_, true));
        }
        return {};
    }

    // `look`: waits for the device and finds out which tiles are damaged. They decode to the
    // background and count as background from then on.
    BatchFeed make_feed(bool look) {
        return BatchFeed(file_, plan_.texel_plan(),
                         limits_within(work_bytes_, file_.tables.keeps_values()),
                         [this, look](DecodeBatch& batch) -> Status {
                             TESSERA_TRY(file_.decoder.decode(file_.tables, batch, texels_));
                             if (!look)
                                 return {};
                             TESSERA_TRY_ASSIGN(const auto counts, file_.decoder.counts(batch));
                             for (std::size_t i = 0; i < counts.size(); ++i)
                                 if (counts[i].damaged != 0)
                                     batch.damaged.push_back(batch.tiles[i]);
                             for (const std::uint64_t tile : batch.damaged)
                                 note_damage(static_cast<std::uint32_t>(tile));
                             return {};
                         });
    }

    Status decode(const std::vector<DecodeJob>& jobs, bool look) {
        BatchFeed feed = make_feed(look);
        TilesAhead ahead(file_.reader, tiles_of(jobs));
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            TESSERA_TRY(ahead.ready(i));
            TESSERA_TRY(feed.add(jobs[i].tile, plan_.place_of(jobs[i].slot)));
        }
        return feed.finish();
    }

    static std::vector<std::uint64_t> tiles_of(const std::vector<DecodeJob>& jobs) {
        std::vector<std::uint64_t> tiles;
        for (const DecodeJob& job : jobs)
            tiles.push_back(job.tile);
        return tiles;
    }

    // The first reason why tiles are never read, and the first reason why tiles were not read in
    // this frame.
    struct Unread {
        Status damaged, trouble;
    };

    // Decodes the tiles that can be read. The others leave the list and the cache: damaged ones for
    // ever, the rest until the next frame. An error means that the device failed and decoded none
    // of the list.
    Status decode_readable(std::vector<DecodeJob>& jobs, bool look, Unread& unread) {
        BatchFeed feed = make_feed(look);
        TilesAhead ahead(file_.reader, tiles_of(jobs));
        std::vector<DecodeJob> readable;
        std::vector<std::uint32_t> later;
        Status unreachable; // if set, no tile is tried: each would fail after its own time-out
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            const DecodeJob& job = jobs[i];
            if (file_.reader.is_partial() && !is_received(job.tile)) {
                TESSERA_TRY(cache_->mark_failed(job.tile)); // stays coarse without an error
                continue;
            }
            if (unreachable.ok())
                unreachable = ahead.ready(i).status();
            const Status read =
                unreachable.ok() ? file_.reader.load_tile(job.tile).status() : unreachable;
            if (read.ok()) { // the reader keeps the bytes for feed.add()
                TESSERA_TRY(feed.add(job.tile, plan_.place_of(job.slot)));
                readable.push_back(job);
                continue;
            }
            const bool damaged = read.code() == ErrorCode::invalid_file;
            Status& first = damaged ? unread.damaged : unread.trouble;
            if (first.ok())
                first = read;
            if (damaged)
                TESSERA_TRY(cache_->mark_failed(job.tile));
            else
                later.push_back(job.tile);
        }
        // In reverse, which restores the order of the free slots: the next frame puts every tile
        // into the slot that it would have had, and draws the same picture bit for bit.
        for (std::size_t i = later.size(); i-- > 0;)
            TESSERA_TRY(cache_->put_off(later[i]));
        TESSERA_TRY(feed.finish());
        jobs = std::move(readable);
        return {};
    }

    // True on an error too, because load_tile() reports it.
    bool is_received(std::uint32_t tile) const {
        const auto received = file_.reader.is_received(tile);
        return !received.ok() || *received;
    }

    void note_damage(std::uint32_t tile) {
        damaged_ += empty_pages_[tile] != tsr_page_background;
        empty_pages_[tile] = tsr_page_background;
    }

    // Takes the coarse texels from a coarse level, without decoding any tile.
    Status take_coarse() {
        const TextureDesc &desc = file_.reader.desc(), &from = coarse_from_.texels->desc();
        if (from.type != desc.type || from.channels != desc.channels)
            return {ErrorCode::bad_argument,
                    file_.reader.name() + ": the texels of its coarse level are of another type"};
        const std::uint64_t at = words_[tsr_p_coarse_at];
        return make_coarse_cells(grid_, coarse_from_.level, *coarse_from_.texels,
                                 [&](std::uint64_t tile, std::span<const std::uint32_t> words) {
                                     return parameters_.upload((at + tile * tsr_coarse_words) * 4,
                                                               std::as_bytes(words));
                                 });
    }

    // Computes the coarse texels by decoding every tile once, as many at a time as fit the cache.
    Status make_coarse() {
        TESSERA_TRY_ASSIGN(GlCoarseMeans means, GlCoarseMeans::create(file_));
        std::vector<DecodeJob> jobs;
        const auto flush = [&]() -> Status {
            if (jobs.empty())
                return {};
            TESSERA_TRY(decode(jobs, true));
            for (const DecodeJob& job : jobs)
                means.add(plan_.page_of(job.slot),
                          words_[tsr_p_coarse_at] +
                              job.tile * static_cast<std::uint32_t>(tsr_coarse_words),
                          grid_.box(job.tile).extent());
            jobs.clear();
            return means.compute(texels_, parameters_);
        };
        const std::uint64_t most = std::min<std::uint64_t>(plan_.slots(), 1024);
        for (std::uint64_t tile = 0; tile < grid_.tiles(); ++tile) {
            if (empty_pages_[tile] == tsr_page_background)
                continue;
            jobs.push_back({.tile = static_cast<std::uint32_t>(tile),
                            .slot = static_cast<std::uint32_t>(jobs.size())});
            if (jobs.size() == most)
                TESSERA_TRY(flush());
        }
        return flush();
    }

    // Lists the tiles that the newest known frame touched. Until newer marks arrive, the list
    // stays.
    void list_touched() {
        const auto marks = marks_.take_newest();
        if (!marks)
            return;
        touched_.clear();
        for (std::uint32_t tile = 0; tile < marks->size(); ++tile)
            if ((*marks)[tile] != 0 && empty_pages_[tile] != tsr_page_background)
                touched_.push_back(tile);
    }

    Status upload_pages() {
        std::size_t first = SIZE_MAX, last = 0;
        for (const PageChange& change : cache_->take_changes()) {
            const std::size_t at = pages_at_ + change.tile;
            words_[at] = change.slot == no_slot ? tsr_page_missing : plan_.page_of(change.slot);
            first = std::min(first, at);
            last = std::max(last, at);
        }
        if (first > last)
            return {};
        return parameters_.upload(
            first * 4, std::as_bytes(std::span(words_).subspan(first, last - first + 1)));
    }

    Status compute_mips(const std::vector<DecodeJob>& jobs) {
        if (file_.mips.count() == 0)
            return {};
        for (const DecodeJob& job : jobs) {
            const Box4 box = grid_.box(job.tile);
            mips_.add(plan_.page_of(job.slot), box, {0, 0}, {box.extent()[2], box.extent()[3]});
        }
        return mips_.compute(texels_, parameters_);
    }

    TextureFile& file_;
    const TileGrid grid_;
    const std::uint32_t jobs_per_update_;
    const bool filter_, coarse_;
    CoarseTexels coarse_from_;

    std::vector<std::uint32_t> empty_pages_; // page table of an empty cache: background or missing
    std::uint64_t full_tiles_ = 0;           // that are not background
    CachePlan plan_;
    std::uint64_t slot_bytes_ = 0, work_bytes_ = 0;
    std::uint64_t fixed_bytes_ = 0; // independent of the number of slots

    GlTexture texels_;
    GlBuffer parameters_; // the sampler's buffer
    GlMarks marks_;
    GlMips mips_;
    std::size_t pages_at_ = 0;           // word of the page table
    std::vector<std::uint32_t> words_;   // of parameters_, up to the coarse texels
    std::vector<std::uint32_t> touched_; // tiles of the newest known frame, ascending
    std::optional<TileCache> cache_;
    std::uint64_t damaged_ = 0;
};

} // namespace

std::uint64_t fixed_cache_bytes(const TextureFile& file, std::size_t words, bool coarse) {
    const std::uint64_t tiles = file.reader.grid().tiles();
    const std::uint64_t coarse_bytes = coarse ? tiles * tsr_coarse_words * 4 : 0;
    return file.decoder.bytes() + tiles * 4 + GlMarks::bytes_for(tiles) + coarse_bytes + words * 4;
}

std::uint64_t least_cache_work(const TextureFile& file) {
    return file.tables.keeps_values() ? 2 * least_work_plain : least_work_plain;
}

Result<std::unique_ptr<Resident>> make_cached_texture(TextureFile& file,
                                                      const SampledTextureOptions& options,
                                                      std::vector<std::uint32_t> words,
                                                      std::shared_ptr<GlMarksBuffer> marks,
                                                      std::uint64_t first_mark) {
    auto texture = std::make_unique<CachedTexture>(file, options, std::move(words));
    TESSERA_TRY(texture->load(std::move(marks), first_mark));
    return std::unique_ptr<Resident>(std::move(texture));
}

} // namespace tessera
