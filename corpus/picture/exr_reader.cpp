#include "corpus/picture/exr_reader.h"

#include "corpus/exr_samples.h"
#include "corpus/picture/exr_colours.h"
#include "corpus/picture/picture_readers.h"

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

// From (R - Y) / Y, Y, (B - Y) / Y.
void chroma_to_rgb(float* pixel, const Imath::V3f& weights) {
    const float luma = pixel[1];
    const float red = (pixel[0] + 1) * luma, blue = (pixel[2] + 1) * luma;
    pixel[0] = red;
    pixel[1] = (luma - red * weights.x - blue * weights.z) / weights.y;
    pixel[2] = blue;
}

void apply(const glm::mat3& matrix, float* pixel) {
    const glm::vec3 colour = matrix * glm::vec3(pixel[0], pixel[1], pixel[2]);
    std::copy_n(&colour.x, 3, pixel);
}

bool all_halves(const Imf::ChannelList& channels, const std::vector<std::string>& names) {
    return std::ranges::all_of(names, [&](const std::string& name) {
        const Imf::Channel* channel = channels.findChannel(name.c_str());
        return channel != nullptr && channel->type == Imf::HALF;
    });
}

} // namespace

Status ExrReader::open(const std::string& wish) {
    return guard_exr([&]() -> Status {
        if (threads_ > 0)
            Imf::setGlobalThreadCount(static_cast<int>(threads_));
        file_.emplace(stream_, static_cast<int>(threads_), false);
        TESSERA_TRY_ASSIGN(layer_, choose_layer(*file_, wish));
        const Imf::Header& header = file_->header(layer_.part);
        TESSERA_TRY(check_header(header));
        window_ = header.dataWindow();
        display_ = header.displayWindow();
        shape_ = {.kind = PictureKind::exr,
                  .width = static_cast<std::uint32_t>(sides_of(display_).x),
                  .height = static_cast<std::uint32_t>(sides_of(display_).y),
                  .channels = static_cast<std::uint8_t>(layer_.channels.size()),
                  .bits = 16,
                  .is_float = true};
        if (layer_.colours != ExrColours::reduced_chroma) {
            part_.emplace(*file_, layer_.part);
        } else if (layer_.part > 0) {
            return {ErrorCode::unsupported,
                    "luminance and chroma in part " + std::to_string(layer_.part)};
        } else {
            const std::string& prefix = layer_.prefix;
            converted_.emplace(converted_stream_,
                               prefix.substr(0, prefix.empty() ? 0 : prefix.size() - 1),
                               static_cast<int>(threads_));
        }
        take_colours(header);
        is_half_ = layer_.colours == ExrColours::plain && !xyz_to_rgb_ &&
                   all_halves(header.channels(), layer_.channels);
        return {};
    });
}

void ExrReader::take_colours(const Imf::Header& header) {
    const bool states_colours = Imf::hasChromaticities(header);
    const Imf::Chromaticities colours =
        states_colours ? Imf::chromaticities(header) : Imf::Chromaticities();
    if (layer_.colours == ExrColours::chroma)
        luma_weights_ = Imf::RgbaYca::computeYw(colours);
    const Imf::Chromaticities xyz({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f});
    if (layer_.colours == ExrColours::xyz) {
        xyz_to_rgb_ = to_bt709(xyz);
        notes_.emplace_back("channels X,Y,Z are taken for CIE XYZ");
    } else if (layer_.channels.size() >= 3 && states_colours && are_xyz(colours)) {
        xyz_to_rgb_ = to_bt709(colours);
    } else if (layer_.channels.size() >= 3 && states_colours && !are_bt709(colours)) {
        light_to_bt709_ = to_bt709(colours);
        notes_.push_back("the colours keep the primaries of the file (" + words_for(colours) +
                         "), which are not those of BT.709");
    }
}

std::string ExrReader::attribute(const std::string& name) const {
    const Imf::Header& header = file_->header(layer_.part);
    const auto* found = header.findTypedAttribute<Imf::StringAttribute>(name.c_str());
    return found ? found->value() : std::string();
}

void ExrReader::read_converted(int first, int last, std::vector<float>& samples) {
    const auto width = static_cast<std::size_t>(sides_of(window_).x);
    const std::size_t channels = layer_.channels.size();
    std::vector<Imf::Rgba> pixels(width * static_cast<std::size_t>(last - first + 1));
    const auto pitch = static_cast<std::ptrdiff_t>(width);
    converted_->setFrameBuffer(pixels.data() - window_.min.x - first * pitch, 1, width);
    converted_->readPixels(first, last);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (std::size_t c = 0; c < channels; ++c) // r, g, b, a follow each other
            samples[i * channels + c] = half_to_float((&pixels[i].r)[c].bits());
}

template <class Sample>
void ExrReader::read_chunk(int first, int last, std::vector<Sample>& samples) {
    const auto width = static_cast<std::size_t>(sides_of(window_).x);
    const std::size_t channels = layer_.channels.size();
    if constexpr (sizeof(Sample) == sizeof(float))
        if (converted_)
            read_converted(first, last, samples);
    if (!converted_) {
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < channels; ++c)
            frame.insert(layer_.channels[c],
                         Imf::Slice::Make(sizeof(Sample) == 2 ? Imf::HALF : Imf::FLOAT,
                                          samples.data() + c, Imath::V2i(window_.min.x, first),
                                          static_cast<int>(width), last - first + 1,
                                          channels * sizeof(Sample),
                                          width * channels * sizeof(Sample)));
        part_->setFrameBuffer(frame);
        part_->readPixels(first, last);
    }
    if constexpr (sizeof(Sample) == sizeof(float))
        for (std::size_t i = 0; i < samples.size(); i += channels) {
            if (layer_.colours == ExrColours::chroma)
                chroma_to_rgb(&samples[i], luma_weights_);
            if (xyz_to_rgb_)
                apply(*xyz_to_rgb_, &samples[i]);
        }
}

template <class Sample, class Row>
Status ExrReader::read_as(std::uint32_t first, std::uint32_t last, const Row& row) {
    const std::size_t channels = shape_.channels;
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
            row(y, std::span<const Sample>(std::vector<Sample>(shown.size())));
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
    std::vector<std::byte> converted(std::size_t{shape_.width} * shape_.channels *
                                     sample_bytes(type));
    if (is_half_)
        return read_as<std::uint16_t>(first, last, [&](std::uint32_t y, auto halves) {
            halves_to_samples(type, halves, converted.data());
            row(y, converted);
        });
    return read_as<float>(first, last, [&](std::uint32_t y, auto floats) {
        clamped_in_row_ = floats_to_samples(type, floats, converted.data());
        row(y, converted);
    });
}

Status ExrReader::read_light(LightImage& image) {
    const std::size_t channels = shape_.channels;
    const bool is_rgb = channels >= 3, is_converted = light_to_bt709_ != glm::mat3(1);
    image = {shape_.width, shape_.height, {}};
    image.texels.reserve(std::size_t{shape_.width} * shape_.height);
    return read_as<float>(0, shape_.height, [&](std::uint32_t, auto samples) {
        for (std::size_t i = 0; i < samples.size(); i += channels) {
            const glm::vec3 texel(samples[i], samples[i + (is_rgb ? 1 : 0)],
                                  samples[i + (is_rgb ? 2 : 0)]);
            image.texels.push_back(is_converted ? light_to_bt709_ * texel : texel);
        }
    });
}

} // namespace tessera::corpus
