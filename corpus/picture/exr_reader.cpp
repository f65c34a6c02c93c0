#include "corpus/picture/exr_reader.h"

#include "corpus/exr_samples.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTileDescription.h>
#include <algorithm>

namespace tessera::corpus {
namespace {

// OpenEXR buffers up to 256 lines or a row of tiles for every thread. A picture that would need
// more than this for one of them is damaged or hostile.
constexpr std::uint64_t most_buffer_bytes = 1ull << 28;
constexpr std::int64_t most_display_side = 1 << 20; // of the display window, as of textures

// Whether a picture is stored as luminance and chroma, and if so, the resolution of chroma.
enum class Chroma { none, full, reduced };

Chroma chroma_of(const Imf::ChannelList& channels) {
    const Imf::Channel* red = channels.findChannel("RY");
    if (!red || !channels.findChannel("BY") || !channels.findChannel("Y") ||
        channels.findChannel("R"))
        return Chroma::none;
    return red->xSampling == 1 && red->ySampling == 1 ? Chroma::full : Chroma::reduced;
}

// The channel names in our order. Errors: invalid_file, with the names that there are.
Result<std::vector<std::string>> choose_channels(const Imf::ChannelList& channels) {
    std::string present;
    for (auto i = channels.begin(); i != channels.end(); ++i)
        present += std::string(present.empty() ? "" : ",") + std::string(i.name()).substr(0, 40);
    if (present.empty())
        return Status(ErrorCode::invalid_file, "the picture has no channels");
    const Chroma chroma = chroma_of(channels);
    std::vector<std::string> names{"R", "G", "B"};
    if (chroma == Chroma::full)
        names = {"RY", "Y", "BY"};
    else if (chroma == Chroma::none && channels.findChannel("Y") && !channels.findChannel("R"))
        names = {"Y"};
    if (channels.findChannel("A"))
        names.push_back("A");
    if (chroma == Chroma::reduced) // which OpenEXR converts
        return names;
    for (const std::string& name : names) {
        const Imf::Channel* channel = channels.findChannel(name.c_str());
        if (!channel)
            return Status(ErrorCode::invalid_file,
                          "channel " + name +
                              " is missing; needed are R,G,B[,A] or Y[,A], present "
                              "are " +
                              present.substr(0, 200));
        if (channel->xSampling != 1 || channel->ySampling != 1)
            return Status(ErrorCode::unsupported, "channel " + name + " is subsampled");
    }
    return names;
}

// In pixels.
Imath::Vec2<std::int64_t> sides_of(const Imath::Box2i& window) {
    return {std::int64_t{window.max.x} - window.min.x + 1,
            std::int64_t{window.max.y} - window.min.y + 1};
}

Status check_header(const Imf::Header& header) {
    if (header.hasType() && !Imf::isImage(header.type()))
        return {ErrorCode::unsupported, "a deep picture"};
    const auto &window = header.dataWindow(), &display = header.displayWindow();
    std::uint64_t texel = 0; // bytes
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        texel += 4;
    const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
    const std::uint64_t lines = header.hasTileDescription() ? header.tileDescription().ySize : 32;
    if (texel * width > most_buffer_bytes / std::max<std::uint64_t>(lines, 1))
        return {ErrorCode::unsupported,
                "lines of " + std::to_string(width) + " pixels are too long"};
    if (!display.intersects(window))
        return {ErrorCode::invalid_file, "the data window lies outside the display window"};
    if (sides_of(display).x > most_display_side || sides_of(display).y > most_display_side)
        return {ErrorCode::unsupported, "the display window has a side of more than " +
                                            std::to_string(most_display_side) + " pixels"};
    return {};
}

// From and to `Sample`, which is float or holds a half's bits.
float load(float sample) {
    return sample;
}
float load(std::uint16_t sample) {
    return half_to_float(sample);
}
void store(float value, float& sample) {
    sample = value;
}
void store(float value, std::uint16_t& sample) {
    sample = float_to_half(value);
}

// From (R - Y) / Y, Y, (B - Y) / Y.
template <class Sample> void chroma_to_rgb(Sample* pixel, const Imath::V3f& weights) {
    const float luma = load(pixel[1]);
    const float red = (load(pixel[0]) + 1) * luma, blue = (load(pixel[2]) + 1) * luma;
    store(red, pixel[0]);
    store((luma - red * weights.x - blue * weights.z) / weights.y, pixel[1]);
    store(blue, pixel[2]);
}

} // namespace

Status ExrReader::open() {
    return guard_exr([&]() -> Status {
        if (threads_ > 0)
            Imf::setGlobalThreadCount(static_cast<int>(threads_));
        file_.emplace(stream_, static_cast<int>(threads_), false);
        const Imf::Header& header = file_->header(0);
        TESSERA_TRY(check_header(header));
        TESSERA_TRY_ASSIGN(names_, choose_channels(header.channels()));
        window_ = header.dataWindow();
        display_ = header.displayWindow();
        shape_ = {.kind = PictureKind::exr,
                  .width = static_cast<std::uint32_t>(sides_of(display_).x),
                  .height = static_cast<std::uint32_t>(sides_of(display_).y),
                  .channels = static_cast<std::uint8_t>(names_.size()),
                  .bits = 16};
        if (chroma_of(header.channels()) == Chroma::reduced)
            converted_.emplace(converted_stream_, static_cast<int>(threads_));
        else
            part_.emplace(*file_, 0);
        luma_weights_ = Imf::RgbaYca::computeYw(
            Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities());
        return {};
    });
}

std::string ExrReader::attribute(const std::string& name) const {
    const auto* found = file_->header(0).findTypedAttribute<Imf::StringAttribute>(name.c_str());
    return found ? found->value() : std::string();
}

template <class Sample>
void ExrReader::read_chunk(int first, int last, std::vector<Sample>& samples) {
    const auto width = static_cast<std::size_t>(sides_of(window_).x);
    const std::size_t channels = names_.size();
    if (converted_) {
        std::vector<Imf::Rgba> pixels(width * static_cast<std::size_t>(last - first + 1));
        const auto pitch = static_cast<std::ptrdiff_t>(width);
        converted_->setFrameBuffer(pixels.data() - window_.min.x - first * pitch, 1, width);
        converted_->readPixels(first, last);
        for (std::size_t i = 0; i < pixels.size(); ++i)
            for (std::size_t c = 0; c < channels; ++c) // r, g, b, a follow each other
                store((&pixels[i].r)[c], samples[i * channels + c]);
        return;
    }
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels; ++c)
        frame.insert(names_[c], Imf::Slice::Make(
                                    sizeof(Sample) == 2 ? Imf::HALF : Imf::FLOAT,
                                    samples.data() + c, Imath::V2i(window_.min.x, first),
                                    static_cast<int>(width), last - first + 1,
                                    channels * sizeof(Sample), width * channels * sizeof(Sample)));
    part_->setFrameBuffer(frame);
    part_->readPixels(first, last);
    if (names_[0] == "RY")
        for (std::size_t i = 0; i < samples.size(); i += channels)
            chroma_to_rgb(&samples[i], luma_weights_);
}

template <class Sample, class Row>
Status ExrReader::read_as(std::uint32_t first, std::uint32_t last, const Row& row) {
    const std::size_t channels = names_.size();
    const std::size_t line = static_cast<std::size_t>(sides_of(window_).x) * channels;
    std::vector<Sample> shown(shape_.width * channels); // a line of the display window
    const int left = std::max(window_.min.x, display_.min.x);
    const int right = std::min(window_.max.x, display_.max.x);
    const auto from = static_cast<std::size_t>(left - window_.min.x) * channels;
    const auto to = static_cast<std::size_t>(left - display_.min.x) * channels;
    const std::size_t count = (static_cast<std::size_t>(right - left) + 1) * channels;
    // Whole lines of at most so many bytes at once; threads need several of OpenEXR's chunks.
    const std::uint64_t most_bytes = threads_ == 0 ? max_chunk_bytes / 4 : max_chunk_bytes;
    const auto step = static_cast<std::int64_t>(
        std::clamp<std::uint64_t>(most_bytes / (line * sizeof(Sample)), 1, 1u << 20));
    const auto line_of = [&](std::uint32_t y) { return std::int64_t{display_.min.y} + y; };
    std::vector<Sample> samples; // of the lines from `begin` to before `end`
    std::int64_t begin = 0, end = 0;
    for (std::uint32_t y = first; y < last; ++y) {
        const std::int64_t at = line_of(y);
        if (at < window_.min.y || at > window_.max.y) {
            row(y, std::vector<Sample>(shown.size()));
            continue;
        }
        if (at < begin || at >= end) {
            begin = at;
            end = std::min({at + step, std::int64_t{window_.max.y} + 1, line_of(last)});
            samples.resize(static_cast<std::size_t>(end - begin) * line);
            TESSERA_TRY(guard_exr([&] {
                read_chunk(static_cast<int>(begin), static_cast<int>(end - 1), samples);
                return Status();
            }));
        }
        std::copy_n(samples.data() + static_cast<std::size_t>(at - begin) * line + from, count,
                    shown.data() + to);
        row(y, std::span<const Sample>(shown));
    }
    return {};
}

Status ExrReader::read(SampleType type, std::uint32_t first, std::uint32_t last,
                       const PictureRow& row) {
    std::vector<std::byte> converted(std::size_t{shape_.width} * names_.size() *
                                     sample_bytes(type));
    return read_as<std::uint16_t>(first, last, [&](std::uint32_t y, auto halves) {
        halves_to_samples(type, halves, converted.data());
        row(y, converted);
    });
}

Status ExrReader::read_light(LightImage& image) {
    const std::size_t channels = names_.size();
    image = {shape_.width, shape_.height, {}};
    image.texels.reserve(std::size_t{shape_.width} * shape_.height);
    return read_as<float>(0, shape_.height, [&](std::uint32_t, auto samples) {
        for (std::size_t i = 0; i < samples.size(); i += channels)
            image.texels.emplace_back(samples[i], samples[i + (channels < 3 ? 0 : 1)],
                                      samples[i + (channels < 3 ? 0 : 2)]);
    });
}

} // namespace tessera::corpus
