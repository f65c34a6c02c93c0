#include "format/byte_source.h"

#include <algorithm>
#include <string_view>

namespace tessera {
namespace {

struct KnownKind {
    std::string_view begin; // in small letters
    const char* words;
};
using namespace std::string_view_literals;
constexpr KnownKind known_kinds[] = {
    {"version https://git-lfs"sv, "a Git LFS pointer; fetch the file itself by git lfs pull"},
    {"<!doctype html"sv, "an HTML page, perhaps the error message of a server"},
    {"<html"sv, "an HTML page, perhaps the error message of a server"},
    {"<?xml"sv, "XML text"},
    {"pk\3\4"sv, "a ZIP archive; unpack it first"},
    {"\x1f\x8b"sv, "a gzip archive; unpack it first"},
    {"\x28\xb5\x2f\xfd"sv, "a Zstandard archive; unpack it first"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7z archive; unpack it first"},
    {"\x89tessera\r\n"sv, "a Tessera file"},
    {"\x89png\r\n"sv, "a PNG picture"},
    {"\xff\xd8\xff"sv, "a JPEG picture"},
    {"\x76\x2f\x31\x01"sv, "an EXR picture"},
    {"gif8"sv, "a GIF picture"},
    {"gltf"sv, "a binary glTF model"},
    {"kaydara fbx"sv, "an FBX model"},
    {"%pdf"sv, "a PDF document"}};
constexpr std::size_t longest_mark = 64;

} // namespace

std::string known_kind(std::span<const std::byte> begin) {
    std::string text;
    for (const std::byte byte : begin.first(std::min(begin.size(), longest_mark))) {
        const auto c = static_cast<char>(byte);
        text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    if (text.empty())
        return "an empty file";
    const std::string_view after_space =
        std::string_view(text).substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    for (const auto& [mark, words] : known_kinds)
        if (text.starts_with(mark) || (mark.starts_with('<') && after_space.starts_with(mark)))
            return words;
    return {};
}

} // namespace tessera
