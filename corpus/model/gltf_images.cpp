#include "corpus/model/gltf_images.h"

#include "format/byte_source.h"

#include <algorithm>
#include <string_view>

namespace tessera::corpus {
namespace {

constexpr std::string_view ktx2_begin("\xabKTX 20\xbb\r\n\x1a\n", 12);

bool is_ktx2(const std::vector<unsigned char>& bytes) {
    return bytes.size() >= ktx2_begin.size() &&
           std::equal(ktx2_begin.begin(), ktx2_begin.end(), bytes.begin(),
                      [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                  : -1;
}

// "a%20b.png" -> "a b.png".
std::string decoded_uri(std::string_view uri) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool is_code = uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 &&
                             hex_digit(uri[i + 2]) >= 0;
        text += is_code ? static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]))
                        : uri[i];
        i += is_code ? 2 : 0;
    }
    return text;
}

// The name of a readable picture beside a KTX2 file; "" if there is none.
std::string beside_ktx2(const std::string& folder, const std::string& uri) {
    std::string name = decoded_uri(uri);
    if (name.empty() || name.starts_with("data:"))
        return {};
    name = name.substr(0, name.find_last_of('.'));
    for (const char* ending : {".png", ".jpg", ".jpeg", ".webp"})
        if (open_file(folder + "/" + name + ending).ok())
            return name + ending;
    return {};
}

} // namespace

std::string image_name(const tinygltf::Image& image, std::size_t number) {
    return "image " + std::to_string(number) +
           (image.uri.empty() ? std::string() : " (" + image.uri.substr(0, longest_shown) + ")");
}

Result<Image> read_image(const tinygltf::Image& image, std::size_t number,
                         const std::string& folder, std::vector<std::string>& notes) {
    const std::string who = image_name(image, number);
    if (image.image.empty())
        return Status(ErrorCode::io, who + " is missing");
    if (!is_ktx2(image.image))
        return decode_image(image.image).with_context(who);
    const std::string name = beside_ktx2(folder, image.uri);
    if (name.empty())
        return Status(ErrorCode::unsupported,
                      who + " is KTX2, which is not read; put a PNG of the same name beside it");
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(folder + "/" + name, most_model_bytes));
    notes.push_back(who + " is KTX2, which is not read; " + name.substr(0, longest_shown) +
                    " beside it is taken");
    return decode_image(bytes).with_context(name.substr(0, longest_shown));
}

} // namespace tessera::corpus
