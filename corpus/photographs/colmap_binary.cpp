#include "corpus/photographs/colmap_files.h"
#include "format/byte_source.h"

#include <algorithm>
#include <bit>

namespace tessera::corpus {
namespace {

constexpr std::size_t longest_image_name = 4096;
constexpr std::uint64_t bytes_of_point = 24; // two coordinates and the number of a 3D point

// Little-endian numbers from front to back. Reads the file in pieces, because the points of a large
// model have gigabytes.
class ColmapBytes {
public:
    static Result<ColmapBytes> open(const std::string& path) {
        TESSERA_TRY_ASSIGN(auto file, open_file(path));
        return ColmapBytes(std::move(file));
    }

    std::uint64_t left() const { return file_->size() - at_; }
    Status error(const std::string& what) const {
        return {ErrorCode::invalid_file,
                file_->name() + ": byte " + std::to_string(at_) + ": " + what};
    }

    template <class Number> Status take(Number& out) {
        std::array<std::byte, sizeof(Number)> bytes;
        TESSERA_TRY(read(bytes));
        if constexpr (std::endian::native == std::endian::big)
            std::ranges::reverse(bytes);
        out = std::bit_cast<Number>(bytes);
        return {};
    }
    // Text that ends with a zero byte.
    Status take_text(std::string& out) {
        for (std::array<std::byte, 1> c;;) {
            TESSERA_TRY(read(c));
            if (c[0] == std::byte{0})
                return {};
            if (out.size() == longest_image_name)
                return error("the name of an image has no end");
            out += std::to_integer<char>(c[0]);
        }
    }
    Status skip(std::uint64_t count, std::uint64_t size) {
        if (count > left() / size)
            return error("states " + std::to_string(count) + " points, more than the file has");
        at_ += count * size;
        return {};
    }

private:
    explicit ColmapBytes(std::unique_ptr<ByteSource> file) : file_(std::move(file)) {}

    Status read(std::span<std::byte> out) {
        if (out.size() > left())
            return error("the file is cut short");
        if (at_ < begin_ || at_ + out.size() > begin_ + piece_.size()) {
            piece_.resize(std::min<std::uint64_t>(std::uint64_t{1} << 16, left()));
            begin_ = at_;
            TESSERA_TRY(file_->read(begin_, piece_));
        }
        const auto from = piece_.begin() + static_cast<std::ptrdiff_t>(at_ - begin_);
        std::copy_n(from, out.size(), out.begin());
        at_ += out.size();
        return {};
    }

    std::unique_ptr<ByteSource> file_;
    std::uint64_t at_ = 0, begin_ = 0; // of the file; of the piece
    std::vector<std::byte> piece_;
};

Status check_end(const ColmapBytes& bytes) {
    return bytes.left() == 0 ? Status() : bytes.error("more bytes than the file's count needs");
}

} // namespace

Result<ColmapCameras> read_colmap_cameras_binary(const std::string& path) {
    TESSERA_TRY_ASSIGN(auto bytes, ColmapBytes::open(path));
    std::uint64_t count = 0;
    TESSERA_TRY(bytes.take(count));
    TESSERA_TRY(check_frame_count(count).with_context(path));
    ColmapCameras cameras;
    for (std::uint64_t i = 0; i < count; ++i) {
        std::uint32_t id = 0;
        std::int32_t model = 0;
        ColmapCamera camera;
        TESSERA_TRY(bytes.take(id));
        TESSERA_TRY(bytes.take(model));
        TESSERA_TRY_ASSIGN(camera.lens, colmap_lens(model).with_context(path));
        TESSERA_TRY(bytes.take(camera.width));
        TESSERA_TRY(bytes.take(camera.height));
        camera.parameters.resize(camera.lens.parameters);
        for (double& parameter : camera.parameters)
            TESSERA_TRY(bytes.take(parameter));
        if (!cameras.emplace(id, std::move(camera)).second)
            return bytes.error("camera " + std::to_string(id) + " exists twice");
    }
    TESSERA_TRY(check_end(bytes));
    return cameras;
}

Result<std::vector<ColmapImage>> read_colmap_images_binary(const std::string& path) {
    TESSERA_TRY_ASSIGN(auto bytes, ColmapBytes::open(path));
    std::uint64_t count = 0;
    TESSERA_TRY(bytes.take(count));
    TESSERA_TRY(check_frame_count(count).with_context(path));
    std::vector<ColmapImage> images;
    for (std::uint64_t i = 0; i < count; ++i) {
        std::uint32_t id = 0;
        std::uint64_t points = 0;
        ColmapImage image;
        TESSERA_TRY(bytes.take(id));
        for (double& part : image.rotation)
            TESSERA_TRY(bytes.take(part));
        for (glm::length_t axis = 0; axis < 3; ++axis)
            TESSERA_TRY(bytes.take(image.shift[axis]));
        TESSERA_TRY(bytes.take(image.camera));
        TESSERA_TRY(bytes.take_text(image.name));
        if (image.name.empty())
            return bytes.error("image " + std::to_string(i) + " has no name");
        TESSERA_TRY(bytes.take(points));
        TESSERA_TRY(bytes.skip(points, bytes_of_point));
        images.push_back(std::move(image));
    }
    TESSERA_TRY(check_end(bytes));
    return images;
}

} // namespace tessera::corpus
