#include "tools/texture_io/exr_writer.h"

#include "corpus/exr_samples.h"
#include "corpus/exr_stream.h"
#include "format/work.h"
#include "tools/support/description_text.h"
#include "tools/support/parse.h"
#include "tools/texture_io/row_sink.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <algorithm>
#include <cstring>
#include <optional>

namespace tessera {
namespace {

constexpr std::uint64_t max_pixels = 1ull << 30; // along one side; OpenEXR counts in int

// Of a picture of this size.
Imf::Header make_header(std::uint64_t width, std::uint64_t height, unsigned channels) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (unsigned c = 0; c < channels; ++c)
        header.channels().insert(channel_name(channels, c), Imf::Channel(Imf::HALF));
    return header;
}

// Of `halves`, whole lines from line `top`, channels adjacent.
Imf::FrameBuffer make_frame(std::span<const std::uint16_t> halves, std::size_t width, int top,
                            unsigned channels) {
    const std::size_t texel = channels * sizeof(std::uint16_t),
                      lines = halves.size() / (width * channels);
    Imf::FrameBuffer frame;
    for (unsigned c = 0; c < channels; ++c)
        frame.insert(channel_name(channels, c),
                     Imf::Slice::Make(Imf::HALF, halves.data() + c, Imath::V2i(0, top),
                                      static_cast<std::int64_t>(width),
                                      static_cast<std::int64_t>(lines), texel, texel * width));
    return frame;
}

// A file in memory.
class ExrBytes : public Imf::OStream {
public:
    ExrBytes() : OStream("picture") {}
    void write(const char c[], int n) override {
        const auto count = static_cast<std::size_t>(n);
        bytes.resize(std::max(bytes.size(), position_ + count));
        std::memcpy(bytes.data() + position_, c, count);
        position_ += count;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    std::vector<std::byte> bytes;

private:
    std::size_t position_ = 0;
};

class ExrSink : public RowSink {
public:
    ExrSink(OutputFile file, const TextureDesc& desc)
        : RowSink(desc, file.path()), file_(std::move(file)), stream_(file_) {}

    Status open(const Description& description, unsigned threads) {
        return guard_exr(name(), [&] {
            const int workers = static_cast<int>(thread_count(threads));
            Imf::setGlobalThreadCount(workers);
            picture_.emplace(stream_, header(description), workers);
            return Status();
        });
    }

private:
    std::size_t width() const { return std::size_t{desc().size[axis_u]} * desc().size[axis_s]; }

    Imf::Header header(const Description& description) const {
        const Extent4& size = desc().size;
        Imf::Header header =
            make_header(width(), std::uint64_t{size[axis_v]} * size[axis_t], desc().channels);
        const auto set = [&](const std::string& field, const std::string& value) {
            header.insert("tessera:" + field, Imf::StringAttribute(value));
        };
        set("layout", "angular-mosaic");
        set("size", to_string(size));
        set("type", name_of(desc().type));
        for (const auto& [field, text] : description_to_text(description))
            set(field, text);
        return header;
    }

    Status write_rows(SlabBuffer& slab) override {
        const std::size_t line = width() * desc().channels;
        const std::uint64_t step = std::max<std::uint64_t>(1, max_chunk_bytes / (2 * line));
        const Box4& box = slab.box();
        const std::uint64_t first = std::uint64_t{box.begin[axis_v]} * desc().size[axis_t];
        const std::uint64_t last = std::uint64_t{box.end[axis_v]} * desc().size[axis_t];
        std::vector<std::uint16_t> lines;
        for (std::uint64_t y = first; y < last; y += step) {
            const std::uint64_t end = std::min(y + step, last);
            lines.resize((end - y) * line);
            for (std::uint64_t i = y; i < end; ++i)
                load_line(slab, i, lines.data() + (i - y) * line);
            TESSERA_TRY(guard_exr(name(), [&] {
                picture_->setFrameBuffer(
                    make_frame(lines, width(), static_cast<int>(y), desc().channels));
                picture_->writePixels(static_cast<int>(end - y));
                return Status();
            }));
        }
        return {};
    }

    void load_line(SlabBuffer& slab, std::uint64_t y, std::uint16_t* line) const {
        const Extent4& size = desc().size;
        const auto v = static_cast<std::uint32_t>(y / size[axis_t]);
        const auto t = static_cast<std::uint32_t>(y % size[axis_t]);
        const std::size_t run = std::size_t{size[axis_s]} * desc().channels;
        for (std::uint32_t u = 0; u < size[axis_u]; ++u)
            samples_to_halves(desc().type, slab.texel(u, v, 0, t), {line + u * run, run});
    }

    Status close() override {
        picture_.reset(); // writes the table of offsets
        TESSERA_TRY(stream_.status());
        return file_.commit();
    }

    OutputFile file_;
    ExrOutput stream_;
    std::optional<Imf::OutputFile> picture_;
};

} // namespace

Result<std::vector<std::byte>> encode_exr(const PixelSize& size, SampleType type,
                                          std::span<const std::byte> samples) {
    std::vector<std::uint16_t> halves(size.row_bytes() * size.height);
    samples_to_halves(type, samples.data(), halves);
    ExrBytes out;
    TESSERA_TRY(guard_exr("EXR", [&] {
        Imf::OutputFile picture(out, make_header(size.width, size.height, size.channels), 0);
        picture.setFrameBuffer(make_frame(halves, size.width, 0, size.channels));
        picture.writePixels(static_cast<int>(size.height));
        return Status();
    }));
    return std::move(out.bytes);
}

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
