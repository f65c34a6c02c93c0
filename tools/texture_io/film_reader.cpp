#include "corpus/exr_samples.h"
#include "corpus/exr_stream.h"
#include "tools/support/interrupt.h"
#include "tools/support/parse.h"
#include "tools/support/slab_buffer.h"
#include "tools/texture_io/film_io.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

namespace tessera {
namespace {

constexpr std::string_view film_mark = "YUV4MPEG2 ", frame_mark = "FRAME";
constexpr std::size_t longest_header = 1024, longest_frame_header = 256; // bytes
constexpr std::uint32_t most_film_side = 1 << 14;
constexpr std::uint32_t least_hd_lines = 720; // from which on films are BT.709

struct FilmHeader {
    std::uint32_t width = 0, height = 0;
    unsigned bits = 8;
    std::uint32_t step_x = 2, step_y = 2; // of chroma, in pixels; 0: there is none
    bool centred = true;                  // chroma lies between two columns
    bool full_range = false;
    YuvMatrix matrix = YuvMatrix::bt601;
    bool matrix_is_known = false;

    std::size_t sample_bytes() const { return bits > 8 ? 2 : 1; }
    std::uint32_t chroma_width() const { return (width + step_x - 1) / step_x; }
    std::uint32_t chroma_height() const { return (height + step_y - 1) / step_y; }
    std::uint64_t luma_bytes() const { return std::uint64_t{width} * height * sample_bytes(); }
    std::uint64_t chroma_bytes() const { // of one plane
        return step_x == 0 ? 0 : std::uint64_t{chroma_width()} * chroma_height() * sample_bytes();
    }
    std::uint64_t frame_bytes() const { return luma_bytes() + 2 * chroma_bytes(); }
};

// "420jpeg", "444p10", "mono16" and so on.
Status set_colour_space(const std::string& word, FilmHeader& header) {
    const auto other = [&] {
        return Status(ErrorCode::unsupported, "the colour space C" + word.substr(0, 40) +
                                                  "; read are 420, 422, 444 and mono of 8 to 16 "
                                                  "bits");
    };
    std::string rest = word;
    const auto take = [&](std::string_view begin) {
        const bool fits = rest.starts_with(begin);
        rest.erase(0, fits ? begin.size() : 0);
        return fits;
    };
    if (take("420"))
        header.step_x = header.step_y = 2;
    else if (take("422"))
        header.step_x = 2, header.step_y = 1;
    else if (take("444"))
        header.step_x = header.step_y = 1;
    else if (take("mono"))
        header.step_x = header.step_y = 0;
    else
        return other();
    header.centred = word != "420mpeg2" && word != "420paldv";
    if (rest.empty() || rest == "jpeg" || rest == "mpeg2" || rest == "paldv")
        return {};
    take("p"); // mono has none
    std::uint64_t bits = 0;
    if (!parse_number(rest, bits) || bits < 9 || bits > 16)
        return other();
    header.bits = static_cast<unsigned>(bits);
    return {};
}

Status set_extension(const std::string& word, FilmHeader& header) {
    if (word == "COLORRANGE=FULL")
        header.full_range = true;
    for (const auto& [name, matrix] :
         {std::pair("BT601", YuvMatrix::bt601), std::pair("BT709", YuvMatrix::bt709),
          std::pair("SMPTE170M", YuvMatrix::bt601), std::pair("BT470BG", YuvMatrix::bt601)})
        if (word == std::string("COLORMATRIX=") + name) {
            header.matrix = matrix;
            header.matrix_is_known = true;
        }
    return {};
}

// The first line without its mark.
Result<FilmHeader> parse_film_header(const std::string& line) {
    FilmHeader header;
    std::istringstream in(line);
    for (std::string word; in >> word;) {
        const std::string value = word.substr(1);
        std::uint64_t number = 0;
        switch (word[0]) {
        case 'W':
        case 'H':
            if (!parse_number(value, number) || number == 0)
                return Status(ErrorCode::invalid_file,
                              "'" + word.substr(0, 40) + "' is not its width or height");
            if (number > most_film_side)
                return Status(ErrorCode::unsupported, "frames of more than " +
                                                          std::to_string(most_film_side) +
                                                          " pixels a side");
            (word[0] == 'W' ? header.width : header.height) = static_cast<std::uint32_t>(number);
            break;
        case 'I':
            if (value != "p" && value != "?")
                return Status(ErrorCode::unsupported, "interlaced frames");
            break;
        case 'C':
            TESSERA_TRY(set_colour_space(value, header));
            break;
        case 'X':
            TESSERA_TRY(set_extension(value, header));
            break;
        default: // the rate, the shape of pixels
            break;
        }
    }
    if (header.width == 0 || header.height == 0)
        return Status(ErrorCode::invalid_file, "its header has no width or height");
    return header;
}

// A line of text at `position`, without its end; "" where none ends there.
Result<std::string> text_line(ByteSource& file, std::uint64_t position, std::size_t longest) {
    std::string text(std::min<std::uint64_t>(longest, file.size() - position), '\0');
    TESSERA_TRY(file.read(position, std::as_writable_bytes(std::span(text))));
    const std::size_t end = text.find('\n');
    return end == std::string::npos ? std::string() : text.substr(0, end);
}

// One frame as RGB or grey.
class FilmColours {
public:
    explicit FilmColours(const FilmHeader& header) : h_(header) {
        const bool hd = header.matrix == YuvMatrix::bt709;
        red_ = hd ? 0.2126f : 0.299f;
        blue_ = hd ? 0.0722f : 0.114f;
        const float unit = static_cast<float>(1u << (header.bits - 8)),
                    most = static_cast<float>((1u << header.bits) - 1);
        black_ = header.full_range ? 0 : 16 * unit;
        luma_range_ = header.full_range ? most : 219 * unit;
        chroma_range_ = header.full_range ? most : 224 * unit;
        grey_ = 128 * unit;
    }

    // Row y of a frame, as channels between 0 and 1.
    void row(std::span<const std::byte> frame, std::uint32_t y, std::span<float> out) const {
        const std::size_t channels = h_.step_x == 0 ? 1 : 3;
        for (std::uint32_t x = 0; x < h_.width; ++x) {
            const float luma =
                (sample(frame, std::size_t{y} * h_.width + x) - black_) / luma_range_;
            float* pixel = &out[x * channels];
            pixel[0] = luma;
            if (channels == 1)
                continue;
            const auto first = static_cast<std::size_t>(h_.luma_bytes());
            const auto plane = static_cast<std::size_t>(h_.chroma_bytes());
            const float cb = chroma(frame.subspan(first, plane), x, y);
            const float cr = chroma(frame.subspan(first + plane, plane), x, y);
            pixel[0] = luma + 2 * (1 - red_) * cr;
            pixel[2] = luma + 2 * (1 - blue_) * cb;
            pixel[1] = (luma - red_ * pixel[0] - blue_ * pixel[2]) / (1 - red_ - blue_);
        }
    }

private:
    float sample(std::span<const std::byte> plane, std::size_t index) const {
        if (h_.sample_bytes() == 1)
            return std::to_integer<std::uint8_t>(plane[index]);
        return static_cast<float>(std::to_integer<unsigned>(plane[2 * index]) |
                                  std::to_integer<unsigned>(plane[2 * index + 1]) << 8);
    }

    // The two nearest samples along an axis, and how much the second weighs.
    struct Between {
        std::uint32_t first = 0, second = 0;
        float weight = 0;
    };
    static Between between(std::uint32_t at, std::uint32_t step, bool centred,
                           std::uint32_t count) {
        if (step == 1)
            return {at, at, 0};
        const float place =
            centred ? (static_cast<float>(at) - 0.5f) / 2.0f : static_cast<float>(at) / 2.0f;
        const float low = std::floor(place);
        const auto clamp = [&](float i) {
            return static_cast<std::uint32_t>(std::clamp(i, 0.0f, static_cast<float>(count - 1)));
        };
        return {clamp(low), clamp(low + 1), place - low};
    }

    // From -0.5 to 0.5.
    float chroma(std::span<const std::byte> plane, std::uint32_t x, std::uint32_t y) const {
        const std::uint32_t width = h_.chroma_width();
        const Between column = between(x, h_.step_x, h_.centred, width);
        const Between line = between(y, h_.step_y, true, h_.chroma_height());
        const auto along = [&](std::uint32_t row) {
            const std::size_t begin = std::size_t{row} * width;
            const float a = sample(plane, begin + column.first);
            return a + column.weight * (sample(plane, begin + column.second) - a);
        };
        const float a = along(line.first);
        return (a + line.weight * (along(line.second) - a) - grey_) / chroma_range_;
    }

    const FilmHeader& h_;
    float red_, blue_; // their shares of luma
    float black_, luma_range_, chroma_range_, grey_;
};

class FilmSource : public TexelSource {
public:
    explicit FilmSource(std::unique_ptr<ByteSource> file) : file_(std::move(file)) {}

    Status open(const TextureHints& hints, ViewsFacts& facts) {
        TESSERA_TRY_ASSIGN(const std::string line, text_line(*file_, 0, longest_header));
        if (!line.starts_with(film_mark))
            return {ErrorCode::invalid_file, "the header of the film does not end"};
        TESSERA_TRY_ASSIGN(header_, parse_film_header(line.substr(film_mark.size())));
        if (hints.views.yuv_matrix)
            header_.matrix = *hints.views.yuv_matrix;
        else if (!header_.matrix_is_known && header_.height >= least_hd_lines)
            header_.matrix = YuvMatrix::bt709;
        TESSERA_TRY(find_frames(line.size() + 1));
        order_ = hints.views.order.value_or(ViewOrder{});
        TESSERA_TRY(arrange(hints));
        desc_.channels = header_.step_x == 0 ? 1 : 3;
        desc_.type = hints.type.value_or(SampleType::unorm8);
        TESSERA_TRY(check_desc(desc_));
        if (hints.size && *hints.size != desc_.size)
            return {ErrorCode::bad_argument,
                    "is " + to_string(desc_.size) + ", not " + to_string(*hints.size)};
        facts.layout.order = order_;
        facts.told = summary();
        return {};
    }

    const TextureDesc& desc() const override { return desc_; }
    Locality locality() const override { return Locality::angular_cells; }

    Status begin_slab(const Box4& box) override {
        TESSERA_TRY(slab_.reset(desc_, box).with_context(file_->name()));
        for (std::uint32_t t = box.begin[axis_t]; t < box.end[axis_t]; ++t)
            for (std::uint32_t s = box.begin[axis_s]; s < box.end[axis_s]; ++s)
                TESSERA_TRY(load_view(s, t));
        return {};
    }

    Status read(const Box4& box, std::span<std::byte> out) override {
        return slab_.copy_out(box, out).with_context(file_->name());
    }

private:
    // Frames may have headers of different lengths.
    Status find_frames(std::uint64_t at) {
        while (at < file_->size()) {
            TESSERA_TRY(check_interrupt());
            const std::string name = "frame " + std::to_string(frames_.size());
            TESSERA_TRY_ASSIGN(const std::string line, text_line(*file_, at, longest_frame_header));
            if (!line.starts_with(frame_mark))
                return {ErrorCode::invalid_file, name + " does not begin with FRAME"};
            at += line.size() + 1;
            if (file_->size() - at < header_.frame_bytes())
                return {ErrorCode::invalid_file, name + " ends too early"};
            frames_.push_back(at);
            at += header_.frame_bytes();
        }
        if (frames_.empty())
            return {ErrorCode::invalid_file, "the film has no frames"};
        return {};
    }

    Status arrange(const TextureHints& hints) {
        const auto side =
            static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(frames_.size()))));
        ViewGrid grid{side, side};
        if (hints.views.grid)
            grid = *hints.views.grid;
        else if (hints.size)
            grid = {(*hints.size)[axis_s], (*hints.size)[axis_t]};
        if (grid.count() != frames_.size())
            return {ErrorCode::bad_argument, "has " + std::to_string(frames_.size()) + " frames, " +
                                                 (hints.views.grid || hints.size
                                                      ? "not " + to_string(grid)
                                                      : "which is no square of views; say "
                                                        "--grid, such as --grid " +
                                                            std::to_string(frames_.size()) + "x1")};
        desc_.size = {header_.width, header_.height, grid.s, grid.t};
        return {};
    }

    std::string summary() const {
        const std::string order = to_string(order_);
        const ViewGrid grid{desc_.size[axis_s], desc_.size[axis_t]};
        std::string text = std::to_string(frames_.size()) + " frames of " +
                           std::to_string(header_.bits) + " bits, " + to_string(grid) +
                           " cameras from the " + (order_.bottom_up ? "bottom " : "top ") +
                           (order_.right_left ? "right" : "left") +
                           (order.empty() ? "" : " (" + order + ")");
        if (header_.step_x != 0)
            text += std::string(", colours of ") +
                    (header_.matrix == YuvMatrix::bt709 ? "BT.709" : "BT.601");
        text += header_.full_range ? ", full range" : ", limited range";
        if (header_.bits > 8 && sample_bytes(desc_.type) == 1)
            text += "; samples are rounded to 8 bits (--type half keeps 11)";
        return text;
    }

    Status load_view(std::uint32_t s, std::uint32_t t) {
        TESSERA_TRY(check_interrupt());
        const ViewGrid grid{desc_.size[axis_s], desc_.size[axis_t]};
        const ViewStep at = step_of(grid, order_, {s, t});
        std::vector<std::byte> frame(header_.frame_bytes());
        TESSERA_TRY(file_->read(frames_[std::size_t{at.line} * line_length(grid, order_) + at.step],
                                frame));
        const FilmColours colours(header_);
        const Box4 box = slab_.box();
        const std::size_t texel = desc_.texel_bytes(), channels = desc_.channels;
        std::vector<float> row(header_.width * channels);
        std::vector<std::byte> samples(header_.width * texel);
        for (std::uint32_t v = box.begin[axis_v]; v < box.end[axis_v]; ++v) {
            colours.row(frame, v, row);
            convert(row, samples);
            for (std::uint32_t u = box.begin[axis_u]; u < box.end[axis_u]; ++u)
                std::memcpy(slab_.texel(u, v, s, t), samples.data() + u * texel, texel);
        }
        return {};
    }

    // Colours that limited range holds beyond black and white are clamped, as in every picture.
    void convert(std::span<const float> row, std::span<std::byte> samples) const {
        for (std::size_t i = 0; i < row.size(); ++i) {
            const float value = std::clamp(row[i], 0.0f, 1.0f);
            if (traits_of(desc_.type).is_float) {
                const std::uint16_t half = float_to_half(value);
                std::memcpy(&samples[2 * i], &half, 2);
            } else {
                samples[i] = static_cast<std::byte>(255 * value + 0.5f);
            }
        }
    }

    std::unique_ptr<ByteSource> file_;
    FilmHeader header_;
    ViewOrder order_;
    std::vector<std::uint64_t> frames_; // where their samples begin
    TextureDesc desc_;
    SlabBuffer slab_;
};

} // namespace

bool is_film(ByteSource& file) {
    std::string begin(film_mark.size(), '\0');
    return file.size() >= begin.size() &&
           file.read(0, std::as_writable_bytes(std::span(begin))).ok() && begin == film_mark;
}

Result<std::unique_ptr<TexelSource>> open_film(std::unique_ptr<ByteSource> file,
                                               const TextureHints& hints, ViewsFacts& facts) {
    const std::string name = file->name();
    auto source = std::make_unique<FilmSource>(std::move(file));
    TESSERA_TRY(named(source->open(hints, facts), name));
    return std::unique_ptr<TexelSource>(std::move(source));
}

} // namespace tessera
