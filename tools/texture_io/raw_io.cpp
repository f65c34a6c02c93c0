#include "tools/texture_io/raw_io.h"

#include "format/output_file.h"
#include "tools/support/slab_buffer.h"
#include "tools/support/standard_streams.h"
#include "tools/texture_io/row_sink.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <shared_mutex>

namespace tessera {
namespace {

// A system call costs as much as copying some kB. One read therefore takes all wanted rows of a
// place, unless whole rows are more than this many times as long as their wanted parts.
constexpr std::uint32_t max_read_excess = 32;

// Texels are stored place by place; a place is the angular image of one (u, v).
std::uint64_t file_offset(const TextureDesc& desc, std::uint32_t u, std::uint32_t v,
                          std::uint32_t s, std::uint32_t t) {
    return Box4::whole(desc.size).index_of({u, v, s, t}) * desc.texel_bytes();
}

// Keeps the places that were read last, as the encoder reads all tiles at the same places one after
// the other; a system call per place and tile would take up to a sixth of its time. Keeps whole
// places or, where these exceed 4 MiB, all of s in the rows of t that a box spans. Thread-safe.
class RecentPlaces {
public:
    RecentPlaces(ByteSource& file, const TextureDesc& desc) : file_(file), desc_(desc) {}

    // False where the box should be read alone, as its places are not used repeatedly. A box at the
    // beginning of s and t is likely to be the first of many at its places.
    Result<bool> read(const Box4& box, std::span<std::byte> out) {
        const Box4 wanted = region_around(box);
        const auto copy = [&] {
            copy_box(box, kept_, texels_, box, out, desc_.texel_bytes());
            return true;
        };
        {
            const std::shared_lock lock(mutex_);
            if (kept_ == wanted)
                return copy();
        }
        const std::lock_guard lock(mutex_);
        if (kept_ == wanted) // another thread has read it
            return copy();
        const Box4 places = with_all(axis_t, wanted);
        uses_ = places == latest_ ? uses_ + 1 : 1;
        latest_ = places;
        const bool begins = wanted == places && box.begin[axis_s] == 0 && box.begin[axis_t] == 0;
        if ((!begins && uses_ < worth_keeping) || desc_.box_bytes(wanted) > most_bytes)
            return false;
        kept_ = {};
        texels_.resize(desc_.box_bytes(wanted));
        TESSERA_TRY(fill(wanted));
        kept_ = wanted;
        return copy();
    }

private:
    static constexpr int worth_keeping = 3; // uses in a row
    static constexpr std::uint64_t most_bytes = 4u << 20;

    Box4 with_all(Axis axis, Box4 box) const {
        box.begin[axis] = 0;
        box.end[axis] = desc_.size[axis];
        return box;
    }
    Box4 region_around(const Box4& box) const {
        const Box4 rows = with_all(axis_s, box), all = with_all(axis_t, rows);
        return desc_.box_bytes(all) <= most_bytes ? all : rows;
    }

    Status fill(const Box4& wanted) {
        const bool all = spans(wanted, desc_.size, axis_s, axis_t);
        const std::uint32_t step = all ? wanted.extent()[axis_u] : 1; // places per read
        const std::uint64_t run =
            desc_.texel_bytes() * wanted.extent()[axis_s] * wanted.extent()[axis_t] * step;
        std::span<std::byte> to(texels_);
        for (std::uint32_t v = wanted.begin[axis_v]; v < wanted.end[axis_v]; ++v)
            for (std::uint32_t u = wanted.begin[axis_u]; u < wanted.end[axis_u]; u += step) {
                TESSERA_TRY(file_.read(file_offset(desc_, u, v, 0, wanted.begin[axis_t]),
                                       to.subspan(0, run)));
                to = to.subspan(run);
            }
        return {};
    }

    ByteSource& file_;
    const TextureDesc& desc_;
    std::shared_mutex mutex_;
    Box4 kept_{}; // of texels_; empty: nothing
    std::vector<std::byte> texels_;
    Box4 latest_{}; // the places of the last box that was not kept
    int uses_ = 0;  // of latest_ in a row
};

class RawSource : public TexelSource {
public:
    RawSource(std::unique_ptr<ByteSource> file, const TextureDesc& desc)
        : file_(std::move(file)), desc_(desc), recent_(*file_, desc_) {}

    const TextureDesc& desc() const override { return desc_; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        const bool whole_places = spans(box, desc_.size, axis_s, axis_t);
        if (!whole_places) {
            TESSERA_TRY_ASSIGN(const bool done, recent_.read(box, out));
            if (done)
                return {};
        }
        const Extent4 e = box.extent();
        const std::uint32_t step = whole_places ? e[axis_u] : 1; // places per read
        const std::size_t bytes = desc_.texel_bytes() * e[axis_s] * e[axis_t] * step;
        std::vector<std::byte> scratch;
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; u += step) {
                TESSERA_TRY(whole_places
                                ? file_->read(file_offset(desc_, u, v, 0, 0), out.first(bytes))
                                : read_part(box, u, v, out.data(), scratch));
                out = out.subspan(bytes);
            }
        return {};
    }

private:
    // Reads the part of one place that lies in `box`.
    Status read_part(const Box4& box, std::uint32_t u, std::uint32_t v, std::byte* to,
                     std::vector<std::byte>& scratch) {
        const Extent4 e = box.extent();
        const std::uint32_t s = box.begin[axis_s], t = box.begin[axis_t];
        const std::size_t run = e[axis_s] * desc_.texel_bytes();
        const std::size_t row = desc_.size[axis_s] * desc_.texel_bytes();
        if (row / run > max_read_excess) {
            for (std::uint32_t i = 0; i < e[axis_t]; ++i)
                TESSERA_TRY(file_->read(file_offset(desc_, u, v, s, t + i), {to + i * run, run}));
            return {};
        }
        scratch.resize((e[axis_t] - 1) * row + run);
        TESSERA_TRY(file_->read(file_offset(desc_, u, v, s, t), scratch));
        for (std::uint32_t i = 0; i < e[axis_t]; ++i)
            std::memcpy(to + i * run, scratch.data() + i * row, run);
        return {};
    }

    std::unique_ptr<ByteSource> file_;
    TextureDesc desc_;
    RecentPlaces recent_;
};

class RawSink : public TexelSink {
public:
    RawSink(OutputFile file, const TextureDesc& desc) : file_(std::move(file)), desc_(desc) {}

    // Neighbouring places are one run of the file for each v.
    Locality locality() const override { return Locality::places; }

    Status begin_slab(const Box4& box) override {
        slab_.clear();
        gathering_ = spans(box, desc_.size, axis_s, axis_t);
        return gathering_ ? slab_.reset(desc_, box).with_context(file_.path()) : Status();
    }

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        if (gathering_)
            return slab_.copy_in(box, texels);
        TESSERA_TRY(check_box(desc_, box, texels.size()));
        return write_runs(box, texels.data());
    }

    Status end_slab() override {
        if (!gathering_)
            return {};
        gathering_ = false;
        const Box4& box = slab_.box();
        const std::size_t run = slab_.bytes().size() / box.extent()[axis_v];
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            TESSERA_TRY(file_.write_at(file_offset(desc_, box.begin[axis_u], v, 0, 0),
                                       slab_.bytes().subspan((v - box.begin[axis_v]) * run, run)));
        return {};
    }

    Status finish() override {
        slab_.clear();
        return file_.commit();
    }

private:
    Status write_runs(const Box4& box, const std::byte* from) {
        const bool rows_whole = box.extent()[axis_s] == desc_.size[axis_s];
        const std::uint32_t step = rows_whole ? box.extent()[axis_t] : 1; // rows per write
        const std::size_t bytes = box.extent()[axis_s] * step * desc_.texel_bytes();
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; t += step) {
                    TESSERA_TRY(file_.write_at(file_offset(desc_, u, v, box.begin[axis_s], t),
                                               {from, bytes}));
                    from += bytes;
                }
        return {};
    }

    OutputFile file_;
    TextureDesc desc_;
    SlabBuffer slab_;
    bool gathering_ = false;
};

class RawStreamSink : public RowSink {
public:
    explicit RawStreamSink(const TextureDesc& desc) : RowSink(desc, "standard output") {}

private:
    Status write_rows(SlabBuffer& slab) override { return write_standard_output(slab.bytes()); }
    Status close() override { return flush_standard_output(); }
};

} // namespace

Result<std::unique_ptr<TexelSource>> open_raw(std::unique_ptr<ByteSource> file,
                                              const TextureDesc& desc) {
    const std::string path = file->name();
    TESSERA_TRY(check_desc(desc).with_context(path));
    const std::uint64_t expected = desc.box_bytes(Box4::whole(desc.size));
    if (file->size() != expected)
        return Status(ErrorCode::invalid_file,
                      path + ": a raw texture of " + to_string(desc.size) + ", " +
                          std::to_string(desc.channels) + " channels of " +
                          std::to_string(sample_bytes(desc.type)) + " bytes, is " +
                          std::to_string(expected) + " bytes, but the file has " +
                          std::to_string(file->size()));
    return std::unique_ptr<TexelSource>(new RawSource(std::move(file), desc));
}

Result<std::unique_ptr<TexelSink>> raw_to_standard_output(const TextureDesc& desc) {
    TESSERA_TRY(check_desc(desc));
    return std::unique_ptr<TexelSink>(std::make_unique<RawStreamSink>(desc));
}

Result<std::unique_ptr<TexelSink>> create_raw(const std::string& path, const TextureDesc& desc) {
    TESSERA_TRY(check_desc(desc).with_context(path));
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    return std::unique_ptr<TexelSink>(new RawSink(std::move(file), desc));
}

} // namespace tessera
