#include "tools/texture_io/exr_picture.h"

#include "tools/texture_io/exr_samples.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <algorithm>
#include <cstring>

namespace tessera {
namespace {

// OpenEXR buffers up to 256 lines or a row of tiles for every thread. A picture that would need
// more than this for one of them is damaged or hostile.
constexpr std::uint64_t max_line_buffer = 1ull << 28;

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

} // namespace

Status ExrPicture::open(unsigned threads) {
    return guard_exr(path_, [&] { return open_unguarded(threads); });
}

Status ExrPicture::open_unguarded(unsigned threads) {
    file_.emplace(stream_, static_cast<int>(threads), false);
    TESSERA_TRY(check_kind(*file_).with_context(path_));
    const Imf::Header& header = file_->header(0);
    TESSERA_TRY_ASSIGN(names_, choose_channels(header.channels()).with_context(path_));
    const auto& window = header.dataWindow();
    width_ = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
    height_ = static_cast<std::uint64_t>(std::int64_t{window.max.y} - window.min.y + 1);
    left_ = window.min.x;
    top_ = window.min.y;
    part_.emplace(*file_, 0);
    return {};
}

std::string ExrPicture::attribute(const std::string& name) const {
    const auto* found = file_->header(0).findTypedAttribute<Imf::StringAttribute>(name.c_str());
    return found ? found->value() : std::string();
}

Status ExrPicture::read_lines(std::uint64_t y0, std::uint64_t y1, std::span<std::uint16_t> halves) {
    return guard_exr(path_, [&] {
        const std::size_t texel = names_.size() * 2, line = width_ * texel;
        const int first = top_ + static_cast<int>(y0), last = top_ + static_cast<int>(y1) - 1;
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < names_.size(); ++c)
            frame.insert(names_[c],
                         Imf::Slice::Make(Imf::HALF, halves.data() + c, Imath::V2i(left_, first),
                                          static_cast<std::int64_t>(width_),
                                          static_cast<std::int64_t>(y1 - y0), texel, line));
        part_->setFrameBuffer(frame);
        part_->readPixels(first, last);
        return Status();
    });
}

Result<std::vector<std::byte>> encode_exr(std::uint32_t width, std::uint32_t height,
                                          std::uint8_t channels,
                                          std::span<const std::uint16_t> halves) {
    ExrBytes out;
    TESSERA_TRY(guard_exr("EXR", [&] {
        Imf::Header header(static_cast<int>(width), static_cast<int>(height));
        header.compression() = Imf::ZIP_COMPRESSION;
        const auto names = exr_channel_names(channels);
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < names.size(); ++c) {
            header.channels().insert(names[c], Imf::Channel(Imf::HALF));
            frame.insert(names[c], Imf::Slice::Make(Imf::HALF, halves.data() + c, Imath::V2i(0, 0),
                                                    width, height, std::size_t{channels} * 2,
                                                    std::size_t{width} * channels * 2));
        }
        Imf::OutputFile picture(out, header, 0);
        picture.setFrameBuffer(frame);
        picture.writePixels(static_cast<int>(height));
        return Status();
    }));
    return std::move(out.bytes);
}

} // namespace tessera
