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
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

namespace tessera {
namespace {

constexpr std::uint64_t max_pixels = 1ull << 30; // along one side; OpenEXR counts in int

Imf::Header make_header(const TextureDesc& desc, const Description& description) {
    Imf::Header header(static_cast<int>(desc.size[axis_u] * desc.size[axis_s]),
                       static_cast<int>(desc.size[axis_v] * desc.size[axis_t]));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const std::string& name : exr_channel_names(desc.channels))
        header.channels().insert(name, Imf::Channel(Imf::HALF));
    const auto say = [&](const std::string& name, const std::string& value) {
        header.insert("tessera:" + name, Imf::StringAttribute(value));
    };
    say("layout", "angular-mosaic");
    say("size", to_string(desc.size));
    say("type", name_of(desc.type));
    for (const auto& [field, text] : description_to_text(description))
        say(field, text);
    return header;
}

class ExrSink : public TexelSink {
public:
    ExrSink(OutputFile file, const TextureDesc& desc)
        : file_(std::move(file)), stream_(file_), desc_(desc) {}

    Status open(const Description& description, unsigned threads) {
        return guard_exr(file_.path(), [&] {
            const int workers = static_cast<int>(thread_count(threads));
            Imf::setGlobalThreadCount(workers);
            picture_.emplace(stream_, make_header(desc_, description), workers);
            return Status();
        });
    }

    Locality locality() const override { return Locality::spatial_rows; }

    Status begin_slab(const Box4& box) override {
        if (!spans(box, desc_.size, axis_s, axis_t) || box.begin[axis_u] != 0 ||
            box.end[axis_u] != desc_.size[axis_u] || box.begin[axis_v] != next_v_)
            return {ErrorCode::runtime,
                    file_.path() + ": slab " + to_string(box) + " is not the next rows of v"};
        return slab_.reset(desc_, box).with_context(file_.path());
    }

    Status write(const Box4& box, std::span<const std::byte> texels) override {
        return slab_.copy_in(box, texels).with_context(file_.path());
    }

    Status end_slab() override {
        const std::uint64_t lines = std::uint64_t{slab_.box().end[axis_v]} * desc_.size[axis_t];
        const std::uint64_t step = std::max<std::uint64_t>(1, max_chunk_bytes / line_bytes());
        for (std::uint64_t y = std::uint64_t{next_v_} * desc_.size[axis_t]; y < lines; y += step)
            TESSERA_TRY(
                guard_exr(file_.path(), [&] { return store(y, std::min(y + step, lines)); }));
        next_v_ = slab_.box().end[axis_v];
        return {};
    }

    Status finish() override {
        if (next_v_ != desc_.size[axis_v])
            return {ErrorCode::runtime, file_.path() + ": rows are missing"};
        slab_.clear();
        picture_.reset(); // writes the table of offsets
        TESSERA_TRY(stream_.status());
        return file_.commit();
    }

private:
    std::size_t line_bytes() const {
        return std::size_t{desc_.size[axis_u]} * desc_.size[axis_s] * desc_.channels * 2;
    }

    // Writes lines y0..y1-1 of the picture from the slab.
    Status store(std::uint64_t y0, std::uint64_t y1) {
        const std::size_t line = line_bytes(), texel = std::size_t{desc_.channels} * 2;
        lines_.resize((y1 - y0) * (line / 2));
        for (std::uint64_t y = y0; y < y1; ++y)
            load_line(y, lines_.data() + (y - y0) * (line / 2));
        const int top = static_cast<int>(y0), rows = static_cast<int>(y1 - y0);
        Imf::FrameBuffer frame;
        const auto names = exr_channel_names(desc_.channels);
        for (std::size_t c = 0; c < names.size(); ++c)
            frame.insert(names[c], Imf::Slice::Make(
                                       Imf::HALF, lines_.data() + c, Imath::V2i(0, top),
                                       static_cast<std::int64_t>(line / texel), rows, texel, line));
        picture_->setFrameBuffer(frame);
        picture_->writePixels(rows);
        return {};
    }

    void load_line(std::uint64_t y, std::uint16_t* line) {
        const auto v = static_cast<std::uint32_t>(y / desc_.size[axis_t]);
        const auto t = static_cast<std::uint32_t>(y % desc_.size[axis_t]);
        const std::size_t run = std::size_t{desc_.size[axis_s]} * desc_.channels;
        for (std::uint32_t u = 0; u < desc_.size[axis_u]; ++u)
            samples_to_halves(desc_.type, slab_.texel(u, v, 0, t), {line + u * run, run});
    }

    OutputFile file_;
    ExrOutput stream_;
    std::optional<Imf::OutputFile> picture_;
    TextureDesc desc_;
    SlabBuffer slab_;
    std::vector<std::uint16_t> lines_;
    std::uint32_t next_v_ = 0;
};

} // namespace

Result<std::unique_ptr<TexelSink>> create_exr(const std::string& path, const TextureDesc& desc,
                                              const Description& description, unsigned threads) {
    TESSERA_TRY(check_desc(desc).with_context(path));
    const std::uint64_t width = std::uint64_t{desc.size[axis_u]} * desc.size[axis_s];
    const std::uint64_t height = std::uint64_t{desc.size[axis_v]} * desc.size[axis_t];
    if (width > max_pixels || height > max_pixels || width * desc.channels * 2 > max_chunk_bytes)
        return Status(ErrorCode::unsupported, path + ": a mosaic of " + std::to_string(width) +
                                                  "x" + std::to_string(height) +
                                                  " pixels is too large for EXR");
    TESSERA_TRY_ASSIGN(auto file, OutputFile::create(path));
    auto sink = std::make_unique<ExrSink>(std::move(file), desc);
    TESSERA_TRY(sink->open(description, threads));
    return std::unique_ptr<TexelSink>(std::move(sink));
}

} // namespace tessera
