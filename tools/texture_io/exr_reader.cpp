#include "format/work.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/exr_io.h"
#include "tools/texture_io/exr_picture.h"
#include "tools/texture_io/exr_samples.h"
#include "tools/texture_io/mosaic_size.h"

#include <ImfThreading.h>

namespace tessera {
namespace {

class ExrSource : public TexelSource {
public:
    explicit ExrSource(std::unique_ptr<ByteSource> bytes)
        : bytes_(std::move(bytes)), picture_(*bytes_), path_(picture_.path()) {}

    Status open(const TextureHints& hints, Description& description) {
        const unsigned threads = thread_count(hints.threads);
        Imf::setGlobalThreadCount(static_cast<int>(threads));
        TESSERA_TRY(picture_.open(threads));
        desc_.channels = picture_.channels();
        const std::string type = picture_.attribute("tessera:type");
        desc_.type =
            hints.type.value_or(type == "unorm8" ? SampleType::unorm8 : SampleType::half16);
        TESSERA_TRY(find_size(hints).with_context(path_));
        for (const char* field : description_fields)
            if (const std::string text = picture_.attribute(std::string("tessera:") + field);
                !text.empty())
                if (Status s = set_description_field(description, field, text); !s.ok())
                    return {ErrorCode::invalid_file, path_ + ": " + s.message()};
        return {};
    }

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override { return Locality::spatial_rows; }

    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(slab_.reset(desc_, box).with_context(path_));
        const auto line_of = [&](std::uint32_t v, std::uint32_t t) {
            return std::uint64_t{v} * desc_.size[axis_t] + t;
        };
        const std::uint32_t t0 = box.begin[axis_t], t1 = box.end[axis_t];
        if (t1 - t0 == desc_.size[axis_t])
            return load_all(line_of(box.begin[axis_v], 0), line_of(box.end[axis_v], 0));
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v)
            TESSERA_TRY(load_all(line_of(v, t0), line_of(v, t1)));
        return {};
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(path_);
    }

private:
    std::uint32_t width() const { return desc_.size[axis_u] * desc_.size[axis_s]; }

    Status find_size(const TextureHints& hints) {
        const std::string layout = picture_.attribute("tessera:layout");
        if (!layout.empty() && layout != "angular-mosaic")
            return {ErrorCode::unsupported, "layout '" + layout.substr(0, 100) + "'"};
        const std::string attribute = picture_.attribute("tessera:size");
        if (hints.size) {
            desc_.size = *hints.size;
        } else if (hints.views.mosaic) {
            TESSERA_TRY_ASSIGN(
                desc_.size, mosaic_size(*hints.views.mosaic, picture_.width(), picture_.height()));
        } else if (!attribute.empty()) {
            const auto size = parse_extent(attribute);
            if (!size.ok())
                return {ErrorCode::invalid_file,
                        "attribute tessera:size: " + size.status().message()};
            desc_.size = *size;
        } else {
            return {ErrorCode::bad_argument,
                    "has no attribute tessera:size; say --size UxVxSxT, or "
                    "--mosaic SxT or --quilt CxR"};
        }
        TESSERA_TRY(check_desc(desc_));
        return check_mosaic(desc_.size, picture_.width(), picture_.height());
    }

    // The same as load(), in pieces of bounded size.
    Status load_all(std::uint64_t y0, std::uint64_t y1) {
        const std::uint64_t line_bytes = std::uint64_t{width()} * desc_.channels * 2;
        const std::uint64_t step = std::max<std::uint64_t>(1, max_chunk_bytes / line_bytes);
        for (std::uint64_t y = y0; y < y1; y += step)
            TESSERA_TRY(load(y, std::min(y + step, y1)));
        return {};
    }

    // Reads lines y0..y1-1 and puts what belongs to the slab into it.
    Status load(std::uint64_t y0, std::uint64_t y1) {
        const std::size_t line = std::size_t{width()} * desc_.channels;
        lines_.resize((y1 - y0) * line);
        TESSERA_TRY(picture_.read_lines(y0, y1, lines_));
        for (std::uint64_t y = y0; y < y1; ++y)
            store_line(y, lines_.data() + (y - y0) * line);
        return {};
    }

    void store_line(std::uint64_t y, const std::uint16_t* line) {
        const Box4& box = slab_.box();
        const auto v = static_cast<std::uint32_t>(y / desc_.size[axis_t]);
        const auto t = static_cast<std::uint32_t>(y % desc_.size[axis_t]);
        if (t < box.begin[axis_t] || t >= box.end[axis_t])
            return;
        const std::uint32_t s = box.begin[axis_s];
        const std::size_t count = std::size_t{box.end[axis_s] - s} * desc_.channels;
        for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u) {
            const std::size_t x = std::size_t{u} * desc_.size[axis_s] + s;
            halves_to_samples(desc_.type, {line + x * desc_.channels, count},
                              slab_.texel(u, v, s, t));
        }
    }

    std::unique_ptr<ByteSource> bytes_;
    ExrPicture picture_;
    std::string path_;
    TextureDesc desc_;
    std::vector<std::uint16_t> lines_;
    SlabBuffer slab_;
};

} // namespace

Result<std::unique_ptr<TexelSource>> open_exr(std::unique_ptr<ByteSource> file,
                                              const TextureHints& hints, Description& description) {
    auto source = std::make_unique<ExrSource>(std::move(file));
    TESSERA_TRY(source->open(hints, description));
    return std::unique_ptr<TexelSource>(std::move(source));
}

} // namespace tessera
