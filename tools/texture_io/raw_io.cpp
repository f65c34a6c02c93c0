#include "tools/texture_io/raw_io.h"

#include "format/output_file.h"
#include "tools/support/slab_buffer.h"
#include "tools/support/standard_streams.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <shared_mutex>

namespace tessera {
namespace {

// Wanted texels are picked out of a longer read while it is at most this many times longer: one
// call to the system costs as much as copying some kB.
constexpr std::uint32_t max_read_excess = 32;

std::uint64_t file_offset(const TextureDesc& desc, std::uint32_t u, std::uint32_t v,
                          std::uint32_t s, std::uint32_t t) {
    const Extent4& n = desc.size;
    const std::uint64_t place = std::uint64_t{v} * n[axis_u] + u;
    return ((place * n[axis_t] + t) * n[axis_s] + s) * desc.texel_bytes();
}

// The views of the places that tiles read one after the other, all of them or, where those are many, whole rows
// of views: a pread for every place of every tile would take up to a sixth of an encode. Thread-safe.
class RecentPlaces {
public:
    RecentPlaces(ByteSource& file, const TextureDesc& desc) : file_(file), desc_(desc) {}

    // False where a few texels had better be read alone: places that are asked for now and then. Who begins with the
    // first views of places goes on with the others.
    Result<bool> read(const Box4& box, std::span<std::byte> out) {
        const Box4 wanted = views_around(box);
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
        if (kept_ == wanted) // since then
            return copy();
        const Box4 places = with_all(axis_t, wanted);
        asked_ = places == latest_ ? asked_ + 1 : 1;
        latest_ = places;
        const bool begins = wanted == places && box.begin[axis_s] == 0 && box.begin[axis_t] == 0;
        if ((!begins && asked_ < worth_keeping) || desc_.box_bytes(wanted) > most_bytes)
            return false;
        kept_ = {};
        texels_.resize(desc_.box_bytes(wanted));
        TESSERA_TRY(fill(wanted));
        kept_ = wanted;
        return copy();
    }

private:
    static constexpr int worth_keeping = 3; // times in a row
    static constexpr std::uint64_t most_bytes = 4u << 20;

    Box4 with_all(Axis axis, Box4 box) const {
        box.begin[axis] = 0;
        box.end[axis] = desc_.size[axis];
        return box;
    }
    Box4 views_around(const Box4& box) const {
        const Box4 rows = with_all(axis_s, box), all = with_all(axis_t, rows);
        return desc_.box_bytes(all) <= most_bytes ? all : rows;
    }

    Status fill(const Box4& wanted) {
        const bool all = spans(wanted, desc_.size, axis_s, axis_t);
        const std::uint32_t step = all ? wanted.extent()[axis_u] : 1;
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
    Box4 latest_{}; // all views of the places that were asked for
    int asked_ = 0;
};

class RawSource : public TexelSource {
public:
    RawSource(std::unique_ptr<ByteSource> file, const TextureDesc& desc)
        : file_(std::move(file)), desc_(desc), recent_(*file_, desc_) {}

    const TextureDesc& desc() const override { return desc_; }

    Status read(const Box4& box, std::span<std::byte> out) override {
        TESSERA_TRY(check_box(desc_, box, out.size()));
        if (!spans(box, desc_.size, axis_s, axis_t)) {
            TESSERA_TRY_ASSIGN(const bool done, recent_.read(box, out));
            if (done)
                return {};
        }
        const Extent4 e = box.extent();
        const bool angular_whole = spans(box, desc_.size, axis_s, axis_t);
        const std::uint32_t step = angular_whole ? e[axis_u] : places_per_read(e);
        const std::size_t bytes = desc_.texel_bytes() * e[axis_s] * e[axis_t]; // of a place
        std::byte* to = out.data();
        std::vector<std::byte> scratch;
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v) {
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; u += step) {
                const std::uint32_t places = std::min(step, box.end[axis_u] - u);
                if (angular_whole)
                    TESSERA_TRY(file_->read(file_offset(desc_, u, v, 0, 0), {to, places * bytes}));
                else
                    TESSERA_TRY(read_angular_parts(box, u, v, places, to, scratch));
                to += places * bytes;
            }
        }
        return {};
    }

private:
    // Bytes of a place from the first wanted row to the end of the last.
    std::size_t span_of_rows(const Extent4& e) const {
        return (std::size_t{e[axis_t] - 1} * desc_.size[axis_s] + e[axis_s]) * desc_.texel_bytes();
    }
    std::size_t place_bytes() const {
        return std::size_t{desc_.size[axis_s]} * desc_.size[axis_t] * desc_.texel_bytes();
    }

    // Places side by side whose parts one call reads: all where what lies between is less than what is
    // wanted, as copying that costs more than a further call.
    std::uint32_t places_per_read(const Extent4& e) const {
        constexpr std::size_t most_bytes = 1u << 20;
        const std::size_t place = place_bytes();
        if (place > 2 * span_of_rows(e))
            return 1;
        return std::max(1u, std::min(e[axis_u], static_cast<std::uint32_t>(most_bytes / place)));
    }

    // The parts of the angular images of some places that lie in `box`.
    Status read_angular_parts(const Box4& box, std::uint32_t u, std::uint32_t v,
                              std::uint32_t places, std::byte* to,
                              std::vector<std::byte>& scratch) {
        const Extent4 e = box.extent();
        const std::uint32_t s = box.begin[axis_s], t = box.begin[axis_t];
        const std::size_t run = e[axis_s] * desc_.texel_bytes();
        const std::size_t row = desc_.size[axis_s] * desc_.texel_bytes();
        if (places == 1 && row / run > max_read_excess) {
            for (std::uint32_t i = 0; i < e[axis_t]; ++i)
                TESSERA_TRY(file_->read(file_offset(desc_, u, v, s, t + i), {to + i * run, run}));
            return {};
        }
        scratch.resize((places - 1) * place_bytes() + span_of_rows(e));
        TESSERA_TRY(file_->read(file_offset(desc_, u, v, s, t), scratch));
        for (std::uint32_t place = 0; place < places; ++place)
            for (std::uint32_t i = 0; i < e[axis_t]; ++i, to += run)
                std::memcpy(to, scratch.data() + place * place_bytes() + i * row, run);
        return {};
    }

    std::unique_ptr<ByteSource> file_;
    TextureDesc desc_;
    RecentPlaces recent_;
};

class RawSink : public TexelSink {
public:
    RawSink(OutputFile file, const TextureDesc& desc) : file_(std::move(file)), desc_(desc) {}

    // Some places beside each other are one run of the file for each v.
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

// Nothing can be written twice there, so whole rows come one after the other.
class RawStreamSink : public TexelSink {
public:
    explicit RawStreamSink(const TextureDesc& desc) : desc_(desc) {}
    Locality locality() const override { return Locality::spatial_rows; }
    Status begin_slab(const Box4& box) override {
        if (!spans(box, desc_.size, axis_s, axis_t) || box.begin[axis_u] != 0 ||
            box.end[axis_u] != desc_.size[axis_u] || box.begin[axis_v] != next_v_)
            return {ErrorCode::runtime,
                    "standard output: slab " + to_string(box) + " is not the next rows of v"};
        return slab_.reset(desc_, box);
    }
    Status write(const Box4& box, std::span<const std::byte> texels) override {
        return slab_.copy_in(box, texels);
    }
    Status end_slab() override {
        next_v_ = slab_.box().end[axis_v];
        return write_standard_output(slab_.bytes());
    }
    Status finish() override {
        slab_.clear();
        return next_v_ == desc_.size[axis_v]
                   ? flush_standard_output()
                   : Status(ErrorCode::runtime, "standard output: rows are missing");
    }

private:
    TextureDesc desc_;
    SlabBuffer slab_;
    std::uint32_t next_v_ = 0;
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

Result<std::unique_ptr<TexelSource>> open_raw(const std::string& path, const TextureDesc& desc) {
    TESSERA_TRY_ASSIGN(auto file, open_file(path));
    return open_raw(std::move(file), desc);
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
