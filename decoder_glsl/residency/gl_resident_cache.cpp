// On feedback: a tile cache with a page table, filled by what frames mark.
#include "decoder_glsl/cache/cache_slot.h"
#include "decoder_glsl/cache/coarse_cells.h"
#include "decoder_glsl/cache/tile_cache.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/residency/gl_mips.h"
#include "decoder_glsl/residency/gl_residency.h"
#include "decoder_glsl/shaders/shader_layout.h"
#include "format/container/tiles_ahead.h"

#include <algorithm>

namespace tessera {
namespace {

using namespace layout;

// A tile's share of the lists for small passes: 8 words.
constexpr std::uint64_t job_bytes = 8 * 4;

// Of a budget a sixth is for decoding, within these bounds; twice the least where tiles are predicted.
constexpr std::uint64_t least_work_plain = 2ull << 20, most_work = 96ull << 20;

// Marks on their way back: the copy of a frame's marks and the fence behind it.
struct MarksInFlight {
    GlBuffer copy;
    std::optional<GlFence> fence;
};

class CachedTexture final : public Resident {
public:
    CachedTexture(TextureFile& file, const SampledTextureOptions& options)
        : file_(file), grid_(file.reader.grid()), jobs_per_update_(options.jobs_per_update),
          filter_(options.hardware_filter), coarse_(options.coarse),
          coarse_from_(options.coarse_from) {}

    Status load() {
        words_ = sampler_words(file_);
        TESSERA_TRY(find_background());
        TESSERA_TRY(plan_memory());
        TESSERA_TRY(create_objects());
        if (coarse_)
            TESSERA_TRY(coarse_from_.texels != nullptr ? take_coarse() : make_coarse());
        coarse_from_.texels = nullptr; // lent until here
        file_.decoder.free_work();     // frames need far less at a time
        return drop_cache();
    }

    void bind() const override {
        parameters_.bind_storage(4);
        parameters_.bind_uniforms(2, tsr_sampler_words * 4);
        marks_.bind_storage(5);
        texels_.bind_texture(0);
    }
    std::uint64_t bytes() const override {
        std::uint64_t sum = texels_.bytes() + parameters_.bytes() + marks_.bytes() +
                            coarse_jobs_.bytes() + mips_.bytes() + file_.decoder.bytes();
        for (const MarksInFlight& m : in_flight_)
            sum += m.copy.bytes();
        return sum;
    }
    std::uint64_t damaged_tiles() const override { return damaged_; }
    std::uint64_t slots() const override { return cache_->slots(); }
    const TileCacheStats* stats() const override { return &cache_->stats(); }
    // plan_memory() backwards; a line of slots may be lost to rounding.
    std::uint64_t budget_for(std::uint64_t tiles) const override {
        const std::uint64_t bytes = fixed_bytes_ + (tiles + slots_across()) * slot_bytes_;
        return std::max(std::min(bytes + bytes / 5, bytes + most_work), bytes + least_work()) +
               4096;
    }

    Status drop_cache() override {
        TESSERA_TRY_ASSIGN(auto cache, TileCache::create(slots_, grid_.tiles()));
        cache_.emplace(std::move(cache));
        std::copy(empty_pages_.begin(), empty_pages_.end(),
                  words_.begin() + static_cast<std::ptrdiff_t>(pages_at_));
        TESSERA_TRY(parameters_.upload(pages_at_ * 4, std::as_bytes(std::span(empty_pages_))));
        for (MarksInFlight& m : in_flight_)
            m.fence.reset();
        return marks_.clear(0);
    }

    Result<UpdateReport> update(bool wait) override {
        UpdateReport report;
        TESSERA_TRY(send_marks());
        TESSERA_TRY(take_marks(wait, report.current));
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
        if (!decoded.ok()) // a slot that was not filled must not be shown
            for (const DecodeJob& job : list)
                TESSERA_TRY(cache_->mark_failed(job.tile));
        report.decoded = static_cast<std::uint32_t>(list.size());
        report.waiting = static_cast<std::uint32_t>(cache_->waiting().size());
        report.trouble = unread.trouble;
        TESSERA_TRY(upload_pages());
        TESSERA_TRY(decoded);
        TESSERA_TRY(make_mips(list));
        TESSERA_TRY(take_gl_errors("filling the tile cache"));
        TESSERA_TRY(unread.damaged);
        return report;
    }

private:
    // Tiles without bytes are all background: they are never decoded.
    Status find_background() {
        empty_pages_.assign(grid_.tiles(), tsr_page_missing);
        // Index records come together, those of coarse levels too, whose tiles are wanted next.
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

    std::uint64_t least_work() const {
        return file_.tables.keeps_values() ? 2 * least_work_plain : least_work_plain;
    }

    // How many slots the budget leaves after everything else.
    Status plan_memory() {
        slot_ = cache_slot(grid_, file_.mips.count() > 0);
        slot_bytes_ =
            std::uint64_t{slot_.width} * slot_.height * texel_bytes(file_.format()) + job_bytes;
        const std::uint64_t tile_bytes = grid_.tiles() * 4;
        const std::uint64_t coarse_bytes = coarse_ ? grid_.tiles() * tsr_coarse_texels * 8 : 0;
        work_bytes_ = std::clamp(file_.budget / 6, least_work(), most_work);
        fixed_bytes_ = file_.decoder.bytes() + (1 + 1 + std::size(in_flight_)) * tile_bytes +
                       coarse_bytes + words_.size() * 4;
        const std::uint64_t fixed = fixed_bytes_ + work_bytes_;
        if (file_.budget < fixed + slot_bytes_)
            return {ErrorCode::unsupported, file_.reader.name() +
                                                ": a tile cache of one tile takes " +
                                                mebibytes(fixed + slot_bytes_) +
                                                ", the budget is " + mebibytes(file_.budget)};
        // Slots stand in lines of equal length, a line or several a layer: round up to whole lines
        // where the budget allows, else down.
        const std::uint64_t most = (file_.budget - fixed) / slot_bytes_;
        const std::uint64_t wanted = std::min(most, std::max<std::uint64_t>(full_tiles_, 1));
        const std::uint64_t across = slots_across();
        std::uint64_t lines = (wanted + across - 1) / across;
        columns_ = static_cast<std::uint32_t>((wanted + lines - 1) / lines);
        if (lines * columns_ > most)
            lines = std::max<std::uint64_t>(most / columns_, 1);
        rows_ = static_cast<std::uint32_t>((lines + 2047) / 2048);
        const std::uint64_t layers = lines / rows_;
        if (slot_.width > most_slot_pixels ||
            slot_.height * std::uint64_t{rows_} > most_slot_pixels)
            return {ErrorCode::unsupported,
                    file_.reader.name() +
                        ": more tiles than a texture array takes; lower the budget"};
        slots_ = layers * rows_ * columns_;
        shape_ = {columns_ * slot_.width, rows_ * slot_.height, static_cast<std::uint32_t>(layers)};
        return {};
    }

    std::uint64_t slots_across() const {
        return std::clamp(most_slot_pixels / slot_.width, 1u, 1024u);
    }

    Status create_objects() {
        TESSERA_TRY_ASSIGN(texels_, GlTexture::create(file_.format(), shape_, "tile cache"));
        // What a filter may touch beside a tile's texels, with weight 0, must be numbers.
        texels_.clear();
        TESSERA_TRY(texels_.interpolate(filter_));

        words_[tsr_p_slot_width] = slot_.width;
        words_[tsr_p_slot_height] = slot_.height;
        words_[tsr_p_stride_s] = slot_.stride_s;
        words_[tsr_p_stride_t] = slot_.stride_t;
        words_[tsr_p_width] = shape_.width;
        words_[tsr_p_height] = shape_.height;
        words_[tsr_p_has_coarse] = coarse_;
        pages_at_ = words_.size();
        words_[tsr_p_page_at] = static_cast<std::uint32_t>(pages_at_);
        words_[tsr_p_coarse_at] = static_cast<std::uint32_t>(pages_at_ + grid_.tiles());
        words_.insert(words_.end(), empty_pages_.begin(), empty_pages_.end());
        const std::uint64_t coarse_words = coarse_ ? grid_.tiles() * tsr_coarse_texels * 2 : 0;
        TESSERA_TRY(grow_buffer(parameters_, (words_.size() + coarse_words) * 4, BufferUse::upload,
                                "sampler parameters"));
        TESSERA_TRY(parameters_.clear(0));
        TESSERA_TRY(parameters_.upload(0, std::as_bytes(std::span(words_))));
        TESSERA_TRY(grow_buffer(marks_, grid_.tiles() * 4, BufferUse::device, "marks"));
        for (MarksInFlight& m : in_flight_)
            TESSERA_TRY(grow_buffer(m.copy, grid_.tiles() * 4, BufferUse::device, "marks copy"));
        if (file_.mips.count() > 0) {
            TESSERA_TRY_ASSIGN(mips_, GlMips::create(file_, true));
        }
        return {};
    }

    TexelPlan plan() const {
        TexelPlan p;
        p.stride_s = slot_.stride_s;
        p.stride_t = slot_.stride_t;
        return p;
    }
    TexelPlace place_of(std::uint32_t slot) const {
        const std::uint32_t line = slot / columns_;
        return {slot % columns_ * slot_.width, line % rows_ * slot_.height, line / rows_, 0, 0};
    }

    // As the page table holds it.
    std::uint32_t page_of(std::uint32_t slot) const {
        const std::uint32_t line = slot / columns_;
        return slot % columns_ | (line % rows_ << 10) | (line / rows_ << 20);
    }

    // `look`: waits for the device to say which tiles were damaged. They decode to the background, so
    // from then on they are background.
    BatchFeed make_feed(bool look) {
        return BatchFeed(file_, plan(), limits_within(work_bytes_, file_.tables.keeps_values()),
                         [this, look](DecodeBatch& batch) -> Status {
                             TESSERA_TRY(file_.decoder.decode(batch, texels_));
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
            TESSERA_TRY(feed.add(jobs[i].tile, place_of(jobs[i].slot)));
        }
        return feed.finish();
    }

    static std::vector<std::uint64_t> tiles_of(const std::vector<DecodeJob>& jobs) {
        std::vector<std::uint64_t> tiles;
        for (const DecodeJob& job : jobs)
            tiles.push_back(job.tile);
        return tiles;
    }

    // The first reasons why tiles were not read: for good, and in this frame.
    struct Unread {
        Status damaged, trouble;
    };

    // Tiles that cannot be read leave the list and the cache: for good where they are damaged, else
    // until the next frame. An error means that the device failed, and nothing of the list is there.
    Status decode_readable(std::vector<DecodeJob>& jobs, bool look, Unread& unread) {
        BatchFeed feed = make_feed(look);
        TilesAhead ahead(file_.reader, tiles_of(jobs));
        std::vector<DecodeJob> readable;
        std::vector<std::uint32_t> later;
        Status unreachable; // then each tile alone would fail as well, each after its own time-out
        for (std::size_t i = 0; i < jobs.size(); ++i) {
            const DecodeJob& job = jobs[i];
            if (file_.reader.is_partial() && !is_received(job.tile)) {
                TESSERA_TRY(cache_->mark_failed(job.tile)); // to stay coarse, as was agreed to
                continue;
            }
            if (unreachable.ok())
                unreachable = ahead.ready(i).status();
            const Status read =
                unreachable.ok() ? file_.reader.load_tile(job.tile).status() : unreachable;
            if (read.ok()) { // and cached
                TESSERA_TRY(feed.add(job.tile, place_of(job.slot)));
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
        // Backwards, so that the free slots are in the order they were in: the next frame puts every
        // tile where it would have been, and the picture is the same to the last bit.
        for (std::size_t i = later.size(); i-- > 0;)
            TESSERA_TRY(cache_->put_off(later[i]));
        TESSERA_TRY(feed.finish());
        jobs = std::move(readable);
        return {};
    }

    // An error is met again by load_tile(), which says so.
    bool is_received(std::uint32_t tile) const {
        const auto received = file_.reader.is_received(tile);
        return !received.ok() || *received;
    }

    void note_damage(std::uint32_t tile) {
        damaged_ += empty_pages_[tile] != tsr_page_background;
        empty_pages_[tile] = tsr_page_background;
    }

    // From a coarse level: no tile is decoded.
    Status take_coarse() {
        const TextureDesc &desc = file_.reader.desc(), &from = coarse_from_.texels->desc();
        if (from.type != desc.type || from.channels != desc.channels)
            return {ErrorCode::bad_argument,
                    file_.reader.name() + ": the texels of its coarse level are of another type"};
        const std::uint64_t at = words_[tsr_p_coarse_at];
        return make_coarse_cells(grid_, coarse_from_.level, *coarse_from_.texels,
                                 [&](std::uint64_t tile, std::span<const std::uint32_t> words) {
                                     return parameters_.upload((at + tile * tsr_coarse_texels * 2) *
                                                                   4,
                                                               std::as_bytes(words));
                                 });
    }

    // Every tile once through the cache, a cache full at a time.
    Status make_coarse() {
        const auto defines = file_.output_defines();
        TESSERA_TRY_ASSIGN(const auto program, compute_program("coarse.comp.glsl", defines));
        std::vector<DecodeJob> jobs;
        const auto flush = [&]() -> Status {
            if (jobs.empty())
                return {};
            TESSERA_TRY(decode(jobs, true));
            TESSERA_TRY(average(jobs, program));
            jobs.clear();
            return {};
        };
        const std::uint64_t most = std::min<std::uint64_t>(slots_, 1024);
        for (std::uint64_t tile = 0; tile < grid_.tiles(); ++tile) {
            if (empty_pages_[tile] == tsr_page_background)
                continue;
            jobs.push_back(
                {static_cast<std::uint32_t>(tile), static_cast<std::uint32_t>(jobs.size())});
            if (jobs.size() == most)
                TESSERA_TRY(flush());
        }
        return flush();
    }

    Status average(const std::vector<DecodeJob>& jobs, const GlProgram& program) {
        std::vector<std::uint32_t> words;
        for (const DecodeJob& job : jobs) {
            const Extent4 n = grid_.box(job.tile).extent();
            const std::uint32_t at = words_[tsr_p_coarse_at] +
                                     job.tile * static_cast<std::uint32_t>(tsr_coarse_texels * 2);
            words.insert(words.end(), {page_of(job.slot), at, n[0], n[1], n[2], n[3], 0, 0});
        }
        TESSERA_TRY(grow_buffer(coarse_jobs_, words.size() * 4, BufferUse::upload, "coarse jobs"));
        TESSERA_TRY(coarse_jobs_.upload(0, std::as_bytes(std::span(words))));
        coarse_jobs_.bind_storage(1);
        parameters_.bind_storage(4);
        texels_.bind_texture(0);
        program.use();
        glDispatchCompute(static_cast<GLuint>(jobs.size()), 1, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
        return {};
    }

    // Sends this frame's marks on their way and clears them for the next one.
    Status send_marks() {
        MarksInFlight& next = in_flight_[send_];
        if (next.fence) // the oldest: a ring full of unfinished frames
            TESSERA_TRY(next.fence->wait(10000));
        if (next.fence)
            TESSERA_TRY(read_marks(next));
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glCopyNamedBufferSubData(marks_.id(), next.copy.id(), 0, 0,
                                 static_cast<GLsizeiptr>(marks_.bytes()));
        TESSERA_TRY(marks_.clear(0));
        TESSERA_TRY_ASSIGN(auto fence, GlFence::insert());
        next.fence.emplace(std::move(fence));
        send_ = (send_ + 1) % std::size(in_flight_);
        return {};
    }

    // The tiles that finished frames touched, ascending.
    Status take_marks(bool wait, bool& current) {
        for (std::size_t i = 0; i < std::size(in_flight_); ++i) {
            MarksInFlight& m = in_flight_[(send_ + i) % std::size(in_flight_)];
            if (!m.fence)
                continue;
            if (wait)
                TESSERA_TRY(m.fence->wait(60000));
            else if (!m.fence->passed())
                break;
            // Later marks replace earlier ones: the newest frame is what will be drawn next.
            TESSERA_TRY(read_marks(m));
            current = i + 1 == std::size(in_flight_);
        }
        return {};
    }

    Status read_marks(MarksInFlight& m) {
        m.fence.reset();
        std::vector<std::uint32_t> marks(grid_.tiles());
        TESSERA_TRY(m.copy.read(0, std::as_writable_bytes(std::span(marks))));
        touched_.clear();
        for (std::uint32_t tile = 0; tile < marks.size(); ++tile)
            if (marks[tile] != 0 && empty_pages_[tile] != tsr_page_background)
                touched_.push_back(tile);
        return {};
    }

    Status upload_pages() {
        std::size_t first = SIZE_MAX, last = 0;
        for (const PageChange& change : cache_->take_changes()) {
            const std::size_t at = pages_at_ + change.tile;
            words_[at] = change.slot == no_slot ? tsr_page_missing : page_of(change.slot);
            first = std::min(first, at);
            last = std::max(last, at);
        }
        if (first > last)
            return {};
        return parameters_.upload(
            first * 4, std::as_bytes(std::span(words_).subspan(first, last - first + 1)));
    }

    Status make_mips(const std::vector<DecodeJob>& jobs) {
        if (file_.mips.count() == 0)
            return {};
        for (const DecodeJob& job : jobs) {
            const Box4 box = grid_.box(job.tile);
            mips_.add(page_of(job.slot), box, {0, 0}, {box.extent()[2], box.extent()[3]});
        }
        return mips_.make(texels_, parameters_);
    }

    TextureFile& file_;
    const TileGrid grid_;
    const std::uint32_t jobs_per_update_;
    const bool filter_, coarse_;
    CoarseTexels coarse_from_;

    std::vector<std::uint32_t> empty_pages_; // background or missing
    std::uint64_t full_tiles_ = 0;
    CacheSlot slot_{};
    std::uint32_t columns_ = 0, rows_ = 0;
    std::uint64_t slots_ = 0, slot_bytes_ = 0, work_bytes_ = 0;
    std::uint64_t fixed_bytes_ = 0; // whatever the number of slots
    TextureShape shape_;

    GlTexture texels_;
    GlBuffer parameters_, marks_, coarse_jobs_;
    GlMips mips_;
    std::array<MarksInFlight, 3> in_flight_;
    std::size_t send_ = 0;               // the next one to send, which is the oldest
    std::size_t pages_at_ = 0;           // word of the page table
    std::vector<std::uint32_t> words_;   // of parameters_, up to the coarse texels
    std::vector<std::uint32_t> touched_; // tiles of the newest frame known
    std::optional<TileCache> cache_;
    std::uint64_t damaged_ = 0;
};

} // namespace

Result<std::unique_ptr<Resident>> make_cached_texture(TextureFile& file,
                                                      const SampledTextureOptions& options) {
    auto texture = std::make_unique<CachedTexture>(file, options);
    TESSERA_TRY(texture->load());
    return std::unique_ptr<Resident>(std::move(texture));
}

} // namespace tessera
