// Tests that validation detects damage and names what is damaged.
#include "format/container/container_writer.h"
#include "format/container/index.h"
#include "format/container/syntax.h"
#include "format/container_reader.h"
#include "tests/support/container_samples.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test;

using Bytes = std::vector<std::byte>;

std::uint64_t index_offset(const Bytes& file) {
    const auto reader = ContainerReader::open(*wrap_memory(file));
    return std::ranges::find(reader->sections(), "INDX", &SectionInfo::type)->offset;
}

TEST(Damage, EveryTruncationIsRefused) {
    const Bytes file = rich_sample()->write();
    for (std::size_t length = 0; length < file.size(); ++length) {
        const Status status =
            open_status(Bytes(file.begin(), file.begin() + std::ptrdiff_t(length)));
        ASSERT_EQ(status.code(), ErrorCode::invalid_file) << length;
        ASSERT_NE(status.message().find("<memory>"), std::string::npos);
    }
    Bytes longer = file;
    longer.push_back(std::byte{0});
    EXPECT_EQ(open_status(longer).code(), ErrorCode::invalid_file);
}

TEST(Damage, EveryFlippedBitIsDetected) {
    Bytes file = rich_sample()->write();
    ASSERT_FALSE(found_by_reading(file));
    for (std::size_t i = 0; i < file.size(); ++i)
        for (const unsigned flip : {1u << (i % 8), 0xFFu}) {
            file[i] ^= static_cast<std::byte>(flip);
            ASSERT_TRUE(found_by_reading(file)) << i;
            ASSERT_TRUE(any_fatal(validate_container(*wrap_memory(file)))) << i;
            file[i] ^= static_cast<std::byte>(flip);
        }
}

TEST(Damage, PageFindingNamesTheTiles) {
    auto sample = rich_sample();
    Bytes file = sample->write();
    file.back() ^= std::byte{1};
    const std::vector<Finding> findings = validate_container(*wrap_memory(file));
    ASSERT_EQ(findings.size(), 2u); // one of them is the note about section xtra
    EXPECT_EQ(findings[0].number, static_cast<int>(ContainerRule::unknown_optional));
    EXPECT_FALSE(findings[0].fatal);
    EXPECT_EQ(findings[0].tile_count, 0u) << "the note names tiles";
    EXPECT_EQ(findings[1].number, static_cast<int>(ContainerRule::page_crc));
    EXPECT_EQ(findings[1].first_tile, 257u);
    EXPECT_EQ(findings[1].tile_count, 1u);
    for (const char* words :
         {"page 0 of group 1", "tiles 257..257", "257:258,0:1,0:1,0:1", "at offset"})
        EXPECT_NE(findings[1].text.find(words), std::string::npos) << findings[1].text;
}

TEST(Damage, TilesThatAreNotReceivedAreCounted) {
    constexpr std::size_t tiles = 300, received = 280; // in two groups
    Sample sample(std::vector<Bytes>(tiles, Bytes(1)));
    sample.contents.page_bytes = 0;
    Bytes file = sample.write();
    file.resize(file.size() - tiles + received);
    const auto source = wrap_memory(file);
    const auto reader = ContainerReader::open(*source, {.allow_partial = true});
    ASSERT_TRUE(reader) << reader.status().message();
    const std::vector<Finding> findings = reader->validate();
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].number, static_cast<int>(ContainerRule::not_received));
    EXPECT_FALSE(findings[0].fatal);
    EXPECT_NE(findings[0].text.find("20 of 300 tiles"), std::string::npos) << findings[0].text;
}

TEST(Damage, ProgressAdvancesWithEachGroup) {
    const Bytes file = rich_sample()->write();
    double last = 0, all = 0;
    int steps = 0;
    EXPECT_FALSE(any_fatal(validate_container(*wrap_memory(file), [&](double done, double total) {
        EXPECT_GE(done, last);
        last = done;
        all = total;
        ++steps;
    })));
    EXPECT_GT(steps, 1);
    EXPECT_GT(all, 0);
    EXPECT_EQ(last, all);
}

// Values that a later version may define are reported as notes, not as damage.
TEST(Damage, UnknownValuesAreNoted) {
    const auto noted = [](int beyond) {
        auto sample = rich_sample();
        Description& d = sample->contents.description;
        const auto after = [beyond]<class Field>(Field last) {
            return static_cast<Field>(static_cast<int>(last) + beyond);
        };
        d.angular_map = after(AngularMap{4});
        d.transfer = after(Transfer{2});
        d.primaries = after(Primaries{1});
        std::string all;
        for (const Finding& finding : validate_container(*wrap_memory(sample->write())))
            if (finding.number == static_cast<int>(ContainerRule::unknown_value))
                all += finding.text;
        return all;
    };
    EXPECT_EQ(noted(0), "");
    const std::string all = noted(1);
    for (const char* words : {"angular_map has unknown value 5", "transfer has unknown value 3",
                              "primaries has unknown value 2"})
        EXPECT_NE(all.find(words), std::string::npos) << all;
}

TEST(Damage, IndexFindingNamesTheGroup) {
    Bytes file = rich_sample()->write();
    const auto source = wrap_memory(file);
    const std::uint64_t index = index_offset(file);
    file[index] ^= std::byte{4};
    const std::vector<Finding> findings = validate_container(*source);
    ASSERT_EQ(findings.size(), 2u);
    EXPECT_EQ(findings[1].number, static_cast<int>(ContainerRule::index_crc));
    EXPECT_EQ(findings[1].tile_count, 256u);
    const auto reader = ContainerReader::open(*source);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->locate(3).status().code(), ErrorCode::invalid_file);
    EXPECT_TRUE(reader->locate(257)) << "the other group is damaged, too";
}

TEST(Damage, PagesOfAnotherFileAreRefused) {
    // DATA of one file under the head of another, with the same lengths and different bytes.
    auto a = rich_sample(), b = rich_sample();
    b->tiles[257] = Random(77).bytes(30);
    Bytes file = a->write();
    const Bytes other = b->write();
    ASSERT_EQ(file.size(), other.size());
    const std::uint64_t head = index_offset(file);
    std::copy(other.begin() + std::ptrdiff_t(head), other.end(),
              file.begin() + std::ptrdiff_t(head));
    const auto findings = validate_container(*wrap_memory(file));
    EXPECT_EQ(
        std::ranges::count(findings, static_cast<int>(ContainerRule::index_crc), &Finding::number),
        2);
}

TEST(Damage, FindingsAreLimited) {
    Sample sample(std::vector<Bytes>(3000, Bytes(200, std::byte{1})));
    sample.contents.page_bytes = 256;
    Bytes file = sample.write();
    for (std::size_t i = file.size() - 600000; i < file.size(); i += 100)
        file[i] ^= std::byte{1};
    const auto findings = validate_container(*wrap_memory(file));
    EXPECT_EQ(findings.size(), 1001u);
    EXPECT_EQ(findings.back().number, static_cast<int>(ContainerRule::more));
}

// Reaching the limit of findings does not stop validation before the last group.
TEST(Damage, OmittedFindingsAreReported) {
    constexpr std::size_t groups = 4, of_each = 250, tiles = 256 * groups + 1;
    Sample sample(std::vector<Bytes>(tiles, Bytes(1)));
    sample.contents.page_bytes = 0;
    Bytes file = sample.write();
    const auto damage = [&](std::size_t tile) { file[file.size() - tiles + tile] = std::byte{1}; };
    for (std::size_t group = 0; group < groups; ++group)
        for (std::size_t i = 0; i < of_each; ++i)
            damage(256 * group + i);
    const auto last = [&] { return validate_container(*wrap_memory(file)).back().number; };
    EXPECT_EQ(validate_container(*wrap_memory(file)).size(), groups * of_each);
    EXPECT_EQ(last(), static_cast<int>(ContainerRule::page_crc));
    damage(tiles - 1);
    EXPECT_EQ(last(), static_cast<int>(ContainerRule::more));
}

TEST(Damage, InvalidMeshesAreReported) {
    auto sample = rich_sample();
    const Bytes noise = Random(5).bytes(20);
    sample->contents.proxy_mesh = noise;
    const Bytes file = sample->write();
    const std::vector<Finding> findings = validate_container(*wrap_memory(file));
    ASSERT_TRUE(any_fatal(findings));
    EXPECT_EQ(findings.front().number, static_cast<int>(ContainerRule::proxy_mesh));
    EXPECT_NE(findings.front().text.find("prxy"), std::string::npos);
}

} // namespace
} // namespace tessera
