#include "format/work.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/exr_io.h"
#include "tools/texture_io/exr_samples.h"
#include "tools/texture_io/exr_stream.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTileDescription.h>

namespace tessera {
namespace {

// OpenEXR buffers up to 256 lines or a row of tiles for every thread. A picture that would need
// more than this for one of them is damaged or hostile.
constexpr std::uint64_t max_line_buffer = 1ull << 28;

std::string string_attribute(const Imf::Header& header, const std::string& name) {
    const auto* found = header.findTypedAttribute<Imf::StringAttribute>(name.c_str());
    return found ? found->value() : std::string();
}

// The channel names in our order. Errors: what is missing, and what there is.
Result<std::vector<std::string>> choose_channels(const Imf::ChannelList& channels) {
    std::string present;
    for (auto i = channels.begin(); i != channels.end(); ++i)
        present += std::string(present.empty() ? "" : ",") + std::string(i.name()).substr(0, 40);
    if (present.empty())
        return Status(ErrorCode::invalid_file, "the picture has no channels");
    std::vector<std::string> names;
    if (channels.findChannel("Y") && !channels.findChannel("R"))
        names = {"Y"};
    else
        names = {"R", "G", "B"};
    for (const std::string& name : names)
        if (!channels.findChannel(name.c_str()))
            return Status(ErrorCode::invalid_file, "channel " + name +
                                                       " is missing; needed are R,G,B[,A] or "
                                                       "Y[,A], present are " +
                                                       present.substr(0, 200));
    if (channels.findChannel("A"))
        names.push_back("A");
    for (const std::string& name : names) {
        const Imf::Channel* c = channels.findChannel(name.c_str());
        if (c->xSampling != 1 || c->ySampling != 1)
            return Status(ErrorCode::unsupported, "channel " + name + " is subsampled");
    }
    return names;
}

Status check_kind(const Imf::MultiPartInputFile& file) {
    if (file.parts() != 1)
        return {ErrorCode::unsupported,
                "a picture of " + std::to_string(file.parts()) + " parts; a mosaic has one"};
    const Imf::Header& header = file.header(0);
    if (header.hasType() && !Imf::isImage(header.type()))
        return {ErrorCode::unsupported, "a deep picture"};
    const auto& window = header.dataWindow();
    std::uint64_t texel = 0;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        texel += 4;
    const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
    const std::uint64_t lines = header.hasTileDescription() ? header.tileDescription().ySize : 32;
    if (texel * width > max_line_buffer / std::max<std::uint64_t>(lines, 1))
        return {ErrorCode::unsupported,
                "lines of " + std::to_string(width) + " pixels are too long to be a mosaic"};
    return {};
}

class ExrSource : public TexelSource {
public:
    explicit ExrSource(std::unique_ptr<ByteSource> bytes)
        : bytes_(std::move(bytes)), path_(bytes_->name()), stream_(*bytes_) {}

    Status open(const TextureHints& hints, Description& description) {
        return guard_exr(path_, [&] { return open_unguarded(hints, description); });
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

    Status open_unguarded(const TextureHints& hints, Description& description) {
        Imf::setGlobalThreadCount(static_cast<int>(thread_count(hints.threads)));
        file_.emplace(stream_, static_cast<int>(thread_count(hints.threads)), false);
        TESSERA_TRY(check_kind(*file_).with_context(path_));
        const Imf::Header& header = file_->header(0);
        TESSERA_TRY_ASSIGN(names_, choose_channels(header.channels()).with_context(path_));
        desc_.channels = static_cast<std::uint8_t>(names_.size());
        const std::string type = string_attribute(header, "tessera:type");
        desc_.type =
            hints.type.value_or(type == "unorm8" ? SampleType::unorm8 : SampleType::half16);
        TESSERA_TRY(find_size(header, hints).with_context(path_));
        for (const char* field : description_fields)
            if (const std::string text = string_attribute(header, std::string("tessera:") + field);
                !text.empty())
                if (Status s = set_description_field(description, field, text); !s.ok())
                    return {ErrorCode::invalid_file, path_ + ": " + s.message()};
        part_.emplace(*file_, 0);
        return {};
    }

    Status find_size(const Imf::Header& header, const TextureHints& hints) {
        const std::string layout = string_attribute(header, "tessera:layout");
        if (!layout.empty() && layout != "angular-mosaic")
            return {ErrorCode::unsupported, "layout '" + layout.substr(0, 100) + "'"};
        const std::string attribute = string_attribute(header, "tessera:size");
        if (hints.size) {
            desc_.size = *hints.size;
        } else if (!attribute.empty()) {
            const auto size = parse_extent(attribute);
            if (!size.ok())
                return {ErrorCode::invalid_file,
                        "attribute tessera:size: " + size.status().message()};
            desc_.size = *size;
        } else {
            return {ErrorCode::bad_argument, "has no attribute tessera:size; say --size UxVxSxT"};
        }
        TESSERA_TRY(check_desc(desc_));
        const auto& window = header.dataWindow();
        const std::int64_t w = std::int64_t{window.max.x} - window.min.x + 1;
        const std::int64_t h = std::int64_t{window.max.y} - window.min.y + 1;
        const std::int64_t want_w = std::int64_t{desc_.size[axis_u]} * desc_.size[axis_s];
        const std::int64_t want_h = std::int64_t{desc_.size[axis_v]} * desc_.size[axis_t];
        if (w != want_w || h != want_h)
            return {ErrorCode::invalid_file, "a mosaic of " + to_string(desc_.size) + " has " +
                                                 std::to_string(want_w) + "x" +
                                                 std::to_string(want_h) + " pixels, the picture " +
                                                 std::to_string(w) + "x" + std::to_string(h)};
        left_ = window.min.x;
        top_ = window.min.y;
        return {};
    }

    // The same as load(), in pieces of bounded size.
    Status load_all(std::uint64_t y0, std::uint64_t y1) {
        const std::uint64_t line_bytes = std::uint64_t{width()} * desc_.channels * 2;
        const std::uint64_t step = std::max<std::uint64_t>(1, max_chunk_bytes / line_bytes);
        for (std::uint64_t y = y0; y < y1; y += step)
            TESSERA_TRY(guard_exr(path_, [&] { return load(y, std::min(y + step, y1)); }));
        return {};
    }

    // Reads lines y0..y1-1 and puts what belongs to the slab into it.
    Status load(std::uint64_t y0, std::uint64_t y1) {
        const std::size_t texel = std::size_t{desc_.channels} * 2;
        const std::size_t line = width() * texel;
        lines_.resize((y1 - y0) * (line / 2));
        const int first = top_ + static_cast<int>(y0), last = top_ + static_cast<int>(y1) - 1;
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < names_.size(); ++c)
            frame.insert(names_[c], Imf::Slice::Make(
                                        Imf::HALF, lines_.data() + c, Imath::V2i(left_, first),
                                        width(), static_cast<std::int64_t>(y1 - y0), texel, line));
        part_->setFrameBuffer(frame);
        part_->readPixels(first, last);
        for (std::uint64_t y = y0; y < y1; ++y)
            store_line(y, lines_.data() + (y - y0) * (line / 2));
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
    std::string path_;
    ExrInput stream_;
    std::optional<Imf::MultiPartInputFile> file_;
    std::optional<Imf::InputPart> part_;
    std::vector<std::string> names_;
    TextureDesc desc_;
    int left_ = 0, top_ = 0;
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
