#include "format/metadata.h"

#include "format/container/syntax.h"
#include "format/io/bytes.h"

#ifndef TESSERA_WITHOUT_ZSTD
#include <zstd.h>
#endif

#include <algorithm>
#include <string_view>

namespace tessera {

namespace {

// The limits of FORMAT.md 1.3.
constexpr std::size_t max_entries = 65536;
constexpr std::size_t max_key_bytes = 255;
constexpr std::size_t max_value_bytes = 1u << 20;
constexpr std::size_t max_text_bytes = 1u << 24;
constexpr std::size_t packing_header_bytes = 5;
constexpr std::size_t entry_lengths_bytes = 6; // lengths of the key and the value
[[maybe_unused]] constexpr int zstd_level = 9;
// A Zstandard block is at least 4 bytes and yields at most 128 KiB.
constexpr std::uint64_t max_zstd_ratio = 32768;

enum Packing : std::uint8_t { packing_stored = 0, packing_zstd = 1 };

// Length of the UTF-8 sequence at the start of `text`; 0 if it is invalid or NUL.
std::size_t sequence_length(std::string_view text) {
    const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    if (lead < 0x80)
        return lead != 0 ? 1 : 0;
    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < length)
        return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0) != 0x80)
            return 0;
    // Refuse overlong forms, surrogates, and code points beyond U+10FFFF.
    const unsigned second = byte(1);
    if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
        (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F))
        return 0;
    return length;
}

bool is_text(std::string_view text) {
    while (!text.empty()) {
        const std::size_t length = sequence_length(text);
        if (length == 0)
            return false;
        text.remove_prefix(length);
    }
    return true;
}

// The reason why an entry is not allowed, or "".
std::string entry_problem(const std::string& key, std::size_t value_bytes) {
    if (key.empty() || key.size() > max_key_bytes)
        return "a metadata key has " + std::to_string(key.size()) + " bytes, outside 1..255";
    if (!is_text(key))
        return "a metadata key is not UTF-8 without NUL";
    if (value_bytes > max_value_bytes)
        return "metadata \"" + key + "\" has " + std::to_string(value_bytes) +
               " bytes, more than 2^20";
    return "";
}

std::string value_problem(const std::string& key, const std::string& value) {
    return is_text(value) ? "" : "metadata \"" + key + "\" is not UTF-8 without NUL";
}

std::string to_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<Metadata> parse_text(std::span<const std::byte> text) {
    ByteReader reader(text);
    std::uint32_t count = 0;
    if (!reader.take(count) || count > max_entries)
        return invalid("metadata claims " + std::to_string(count) +
                       " entries; at most 65536 are allowed");
    Metadata metadata;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint16_t key_bytes = 0;
        std::uint32_t value_bytes = 0;
        std::span<const std::byte> key_span, value_span;
        if (!reader.take(key_bytes) || !reader.take(value_bytes) ||
            !reader.take(key_bytes, key_span))
            return invalid("metadata entry " + std::to_string(i) + " is cut off");
        const std::string key = to_text(key_span);
        if (const std::string problem = entry_problem(key, value_bytes); !problem.empty())
            return invalid(problem);
        if (!reader.take(value_bytes, value_span))
            return invalid("metadata \"" + key + "\" is cut off");
        std::string value = to_text(value_span);
        if (const std::string problem = value_problem(key, value); !problem.empty())
            return invalid(problem);
        if (!metadata.empty() && metadata.rbegin()->first >= key)
            return invalid("metadata \"" + key + "\" is out of order");
        metadata.emplace_hint(metadata.end(), key, std::move(value));
    }
    if (reader.remaining() > 0)
        return invalid("metadata continues after its last entry");
    return metadata;
}

// Empty if the text cannot be packed.
std::vector<std::byte> pack_zstd([[maybe_unused]] std::span<const std::byte> text) {
    std::vector<std::byte> packed;
#ifndef TESSERA_WITHOUT_ZSTD
    packed.resize(ZSTD_compressBound(text.size()));
    const std::size_t bytes =
        ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), zstd_level);
    packed.resize(ZSTD_isError(bytes) == 0 ? bytes : 0);
#endif
    return packed;
}

Result<std::vector<std::byte>> unpack_zstd(std::span<const std::byte> packed, std::size_t size) {
    if (size > max_zstd_ratio * packed.size())
        return invalid("metadata claims " + std::to_string(size) + " bytes in " +
                       std::to_string(packed.size()) + ", more than Zstandard can hold");
#ifdef TESSERA_WITHOUT_ZSTD
    // The build for browsers has no Zstandard. Texels do not need metadata, so the file opens with
    // none.
    return std::vector<std::byte>(sizeof(std::uint32_t)); // a count of 0 entries
#else
    if (ZSTD_findFrameCompressedSize(packed.data(), packed.size()) != packed.size())
        return invalid("metadata is not one Zstandard frame");
    std::vector<std::byte> text(size);
    if (ZSTD_decompress(text.data(), size, packed.data(), packed.size()) != size)
        return invalid("metadata does not unpack to " + std::to_string(size) + " bytes");
    return text;
#endif
}

// The letters and digits of `text` in lower case.
std::string letters_and_digits(std::string_view text) {
    std::string out;
    for (const char c : text)
        if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
            out += c;
        else if (c >= 'A' && c <= 'Z')
            out += static_cast<char>(c - 'A' + 'a');
    return out;
}

} // namespace

Status check_metadata(const Metadata& metadata) {
    const auto refuse = [](const std::string& text) {
        return Status(ErrorCode::bad_argument, text);
    };
    if (metadata.size() > max_entries)
        return refuse("more than 65536 metadata entries");
    std::size_t bytes = sizeof(std::uint32_t);
    for (const auto& [key, value] : metadata) {
        std::string problem = entry_problem(key, value.size());
        if (problem.empty())
            problem = value_problem(key, value);
        if (!problem.empty())
            return refuse(problem);
        bytes += entry_lengths_bytes + key.size() + value.size();
        if (bytes > max_text_bytes)
            return refuse("metadata has more than 2^24 bytes");
    }
    return {};
}

Result<std::vector<std::byte>> pack_metadata(const Metadata& metadata) {
    TESSERA_TRY(check_metadata(metadata));
    std::vector<std::byte> text;
    append_le(text, static_cast<std::uint32_t>(metadata.size()));
    for (const auto& [key, value] : metadata) {
        append_le(text, static_cast<std::uint16_t>(key.size()));
        append_le(text, static_cast<std::uint32_t>(value.size()));
        append_bytes(text, std::as_bytes(std::span(key)));
        append_bytes(text, std::as_bytes(std::span(value)));
    }

    const std::vector<std::byte> packed = pack_zstd(text);
    const bool smaller = !packed.empty() && packed.size() < text.size();

    std::vector<std::byte> section;
    append_le(section, static_cast<std::uint8_t>(smaller ? packing_zstd : packing_stored));
    append_le(section, static_cast<std::uint32_t>(text.size()));
    append_bytes(section, smaller ? packed : text);
    return section;
}

Result<Metadata> unpack_metadata(std::span<const std::byte> section) {
    if (section.size() < packing_header_bytes)
        return invalid("metadata is cut off");
    const auto packing = load_le<std::uint8_t>(section.data());
    const auto size = load_le<std::uint32_t>(section.data() + 1);
    const std::span<const std::byte> body = section.subspan(packing_header_bytes);
    if (size > max_text_bytes)
        return invalid("metadata claims " + std::to_string(size) + " bytes, more than 2^24");
    if (packing == packing_stored)
        return body.size() == size ? parse_text(body)
                                   : invalid("metadata claims " + std::to_string(size) +
                                             " bytes and has " + std::to_string(body.size()));
    if (packing != packing_zstd)
        return invalid("metadata has unknown packing " + std::to_string(packing));
    TESSERA_TRY_ASSIGN(const std::vector<std::byte> text, unpack_zstd(body, size));
    return parse_text(text);
}

std::optional<std::size_t> find_name(std::span<const char* const> names, std::string_view text) {
    const std::string wanted = letters_and_digits(text);
    for (std::size_t i = 0; i < names.size(); ++i)
        if (letters_and_digits(names[i]) == wanted)
            return i;
    return std::nullopt;
}

} // namespace tessera
