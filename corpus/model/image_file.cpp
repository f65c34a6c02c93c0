#include "corpus/model/image_file.h"

#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <memory>
#include <stb/stb_image.h>

namespace tessera::corpus {
namespace {

constexpr int most_side = 1 << 14;
constexpr std::int64_t most_texels = std::int64_t{1} << 26;

struct Freer {
    void operator()(void* p) const { stbi_image_free(p); }
};

Status damaged() {
    const char* why = stbi_failure_reason();
    return {ErrorCode::invalid_file,
            std::string("the picture cannot be read: ") + (why ? why : "unknown")};
}

// Before anything is reserved for it.
Status check_size(std::span<const unsigned char> bytes) {
    int w = 0, h = 0, n = 0;
    if (bytes.size() > INT_MAX ||
        stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &w, &h, &n) == 0)
        return damaged();
    if (w <= 0 || h <= 0 || w > most_side || h > most_side || std::int64_t{w} * h > most_texels)
        return {ErrorCode::unsupported,
                "a picture of " + std::to_string(w) + "x" + std::to_string(h) + " is too large"};
    return {};
}

} // namespace

Result<Image> decode_image(std::span<const unsigned char> bytes) {
    TESSERA_TRY(check_size(bytes));
    int w = 0, h = 0, n = 0;
    const std::unique_ptr<unsigned char, Freer> data(
        stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &w, &h, &n, 4));
    if (!data)
        return damaged();
    Image image{static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h), {}};
    image.texels.resize(std::size_t{image.width} * image.height);
    std::memcpy(image.texels.data(), data.get(), image.texels.size() * 4);
    return image;
}

Result<LightImage> decode_hdr(std::span<const unsigned char> bytes) {
    TESSERA_TRY(check_size(bytes));
    if (stbi_is_hdr_from_memory(bytes.data(), static_cast<int>(bytes.size())) == 0)
        return Status(ErrorCode::invalid_file, "is no .hdr picture");
    int w = 0, h = 0, n = 0;
    const std::unique_ptr<float, Freer> data(
        stbi_loadf_from_memory(bytes.data(), static_cast<int>(bytes.size()), &w, &h, &n, 3));
    if (!data)
        return damaged();
    LightImage image{static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h), {}};
    image.texels.resize(std::size_t{image.width} * image.height);
    std::memcpy(image.texels.data(), data.get(), image.texels.size() * sizeof(glm::vec3));
    return image;
}

Result<std::vector<unsigned char>> read_whole_file(const std::string& path, std::size_t most) {
    errno = 0;
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto failed = [&] {
        return Status(ErrorCode::io, path + ": " + std::strerror(errno != 0 ? errno : EIO));
    };
    if (!file)
        return failed();
    const std::streamoff size = file.tellg();
    if (size < 0)
        return failed();
    if (static_cast<std::uint64_t>(size) > most)
        return Status(ErrorCode::unsupported,
                      path + ": more than " + std::to_string(most) + " bytes");
    std::vector<unsigned char> bytes(static_cast<std::size_t>(size));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), size))
        return failed();
    return bytes;
}

} // namespace tessera::corpus
