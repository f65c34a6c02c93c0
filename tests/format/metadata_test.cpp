// Tests the metadata section.
#include "format/container/syntax.h"
#include "format/io/bit_reader.h"
#include "format/levels.h"
#include "tests/support/format_bytes.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

TEST(Metadata, RoundTripStoredAndPacked) {
    for (const Metadata& metadata :
         {Metadata{}, Metadata{{"a", ""}}, Metadata{{"Author", "J\xC3\xA4ger"}, {"Software", "x"}},
          Metadata{{"long", std::string(100000, 'x')}}}) {
        const auto packed = pack_metadata(metadata);
        ASSERT_TRUE(packed);
        const auto unpacked = unpack_metadata(*packed);
        ASSERT_TRUE(unpacked) << unpacked.status().message();
        EXPECT_EQ(*unpacked, metadata);
        EXPECT_LT(packed->size(), 1000u);
        for (std::size_t length = 0; length < packed->size(); ++length)
            ASSERT_FALSE(unpack_metadata(std::span(*packed).first(length)));
    }
}

TEST(Metadata, LimitsOfTheWriter) {
    const auto fits = [](const Metadata& m) { return pack_metadata(m).ok(); };
    EXPECT_TRUE(fits({{std::string(255, 'k'), std::string(1u << 20, 'v')}}));
    EXPECT_FALSE(fits({{std::string(256, 'k'), ""}}));
    EXPECT_FALSE(fits({{"", "v"}}));
    EXPECT_FALSE(fits({{"k", std::string((1u << 20) + 1, 'v')}}));
    EXPECT_FALSE(fits({{"k", std::string(1, '\0')}}));
    Metadata many;
    for (int i = 0; i < 65536; ++i)
        many[std::to_string(i)] = "";
    EXPECT_TRUE(fits(many));
    many["one more"] = "";
    EXPECT_FALSE(fits(many));
    Metadata large;
    for (char c = 'a'; c < 'a' + 16; ++c)
        large[std::string(1, c)] = std::string(1u << 20, c);
    EXPECT_FALSE(fits(large));
}

TEST(Metadata, RefusesTextThatIsNotUtf8) {
    const auto fits = [](const std::string& value) { return pack_metadata({{"k", value}}).ok(); };
    for (const char* good : {"", "a", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xED\x9F\xBF",
                             "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"})
        EXPECT_TRUE(fits(good)) << good;
    for (const char* bad :
         {"\x80", "\xC1\xBF", "\xC2", "\xC2\x41", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xE2\x82",
          "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"})
        EXPECT_FALSE(fits(bad)) << bad;
}

std::vector<std::byte> stored(const std::vector<std::pair<std::string, std::string>>& entries,
                              std::int64_t count = -1, const std::string& tail = "") {
    std::vector<std::byte> text;
    append_le(text, static_cast<std::uint32_t>(count < 0 ? std::ssize(entries) : count));
    for (const auto& [key, value] : entries) {
        append_le(text, static_cast<std::uint16_t>(key.size()));
        append_le(text, static_cast<std::uint32_t>(value.size()));
        append_bytes(text, bytes_of(key));
        append_bytes(text, bytes_of(value));
    }
    append_bytes(text, bytes_of(tail));
    std::vector<std::byte> section;
    append_le(section, std::uint8_t{0});
    append_le(section, static_cast<std::uint32_t>(text.size()));
    append_bytes(section, text);
    return section;
}

TEST(Metadata, HostileSections) {
    EXPECT_TRUE(unpack_metadata(stored({{"a", "1"}, {"b", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"b", "1"}, {"a", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}, {"a", "2"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 2)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 0)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 0xFFFFFFFF)));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "1"}}, 1, "x")));
    EXPECT_FALSE(unpack_metadata(stored({{"", "1"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"\xFF", "1"}})));
    EXPECT_FALSE(unpack_metadata(stored({{"a", "\xFF"}})));
    std::vector<std::byte> section = stored({{"a", "1"}});
    section[0] = std::byte{2};
    EXPECT_FALSE(unpack_metadata(section)) << "an unknown packing is accepted";

    std::vector<std::byte> packed = *pack_metadata({{"k", std::string(1000, 'v')}});
    ASSERT_EQ(packed[0], std::byte{1});
    std::vector<std::byte> longer = packed;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(unpack_metadata(longer)) << "bytes after the frame are accepted";
    for (const std::uint32_t size : {0u, 1u, 1010u, 1012u, 1u << 24, (1u << 24) + 1, 0xFFFFFFFFu}) {
        store_le(packed.data() + 1, size);
        EXPECT_FALSE(unpack_metadata(packed)) << size;
    }
}

template <class Enum> void check_value_names() {
    for (std::size_t i = 0; i < value_names<Enum>.size(); ++i) {
        const auto value = static_cast<Enum>(i);
        const std::string name = name_of(value);
        EXPECT_TRUE(is_known(value));
        EXPECT_EQ(name, value_names<Enum>[i]);
        EXPECT_EQ(parse_value<Enum>(name), value) << name;
        EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), name.npos);
    }
    const auto next = static_cast<Enum>(value_names<Enum>.size());
    EXPECT_FALSE(is_known(next));
    EXPECT_STREQ(name_of(next), "unknown");
    for (const char* wrong : {"", "-", "unknown", "nonesuch"})
        EXPECT_EQ(parse_value<Enum>(wrong), std::nullopt) << wrong;
}

TEST(Metadata, ValuesAreParsedByTheirNames) {
    check_value_names<Proxy>();
    check_value_names<SurfaceMap>();
    check_value_names<AngularMap>();
    check_value_names<Transfer>();
    check_value_names<Primaries>();
    check_value_names<AlphaMode>();
    EXPECT_STREQ(name_of(Proxy::sphere_inside), "sphere-inside");
    EXPECT_STREQ(name_of(SurfaceMap::mesh_uv), "mesh-uv");
    EXPECT_STREQ(name_of(AngularMap::octahedral_mirrored), "octahedral-mirrored");
    EXPECT_STREQ(name_of(Transfer::linear), "linear");
    EXPECT_STREQ(name_of(Primaries::bt709), "bt709");
    EXPECT_STREQ(name_of(AlphaMode::premultiplied), "premultiplied");
    // Accepts the spellings of other programs.
    EXPECT_EQ(parse_value<Transfer>("sRGB"), Transfer::srgb);
    EXPECT_EQ(parse_value<Primaries>("BT.709"), Primaries::bt709);
    EXPECT_EQ(parse_value<SurfaceMap>("sphere longitude/latitude"),
              SurfaceMap::sphere_longitude_latitude);
    EXPECT_EQ(parse_value<AngularMap>("octahedral mirrored"), AngularMap::octahedral_mirrored);
}

} // namespace
} // namespace tessera
