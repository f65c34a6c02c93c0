// Tests that work is bounded by the bytes of a file, not by the sizes that it claims. A system
// limit on CPU time applies.
#include "format/container/syntax.h"
#include "format/tile/coding_parameters.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/forged_alignment.h"
#include "tests/support/vector_sink.h"

namespace {

using namespace tessera::test;
using tessera::ContainerContents;

class ValidateVerb : public CliFixture {
protected:
    static constexpr const char* two_seconds = "ulimit -t 2;";

    // Writes a texture of `size` whose tiles of 64x64x4x4 are all empty.
    void write_empty(const std::string& name, const tessera::Extent4& size,
                     const tessera::Metadata& metadata = {},
                     std::span<const std::byte> mesh = {}) const {
        const auto code = tessera::write_coding_parameters({}, 3, false);
        ContainerContents contents;
        contents.desc.size = size;
        contents.tile_extent = {64, 64, 4, 4};
        contents.codec_parameters = code;
        contents.metadata = metadata;
        contents.proxy_mesh = mesh;
        if (!mesh.empty()) {
            contents.description.proxy = tessera::Proxy::mesh;
            contents.description.surface_map = tessera::SurfaceMap::mesh_uv;
            contents.description.angular_map = tessera::AngularMap::octahedral_hemisphere;
        }
        contents.tile = [](std::uint64_t) { return std::span<const std::byte>(); };
        std::vector<std::byte> file;
        VectorSink sink(file);
        const auto written = write_container(contents, sink);
        ASSERT_TRUE(written.ok()) << written.status().message();
        spit(at(name), std::string(reinterpret_cast<const char*>(file.data()), file.size()));
    }
};

TEST_F(ValidateVerb, EmptyTilesTakeNoTime) {
    write_empty("empty.tess", {64 * 512, 64 * 512, 4, 4}); // 51 GB of texels
    EXPECT_LT(fs::file_size(at("empty.tess")), 60'000u);
    const Outcome o = run("validate empty.tess", two_seconds);
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(run("info empty.tess", two_seconds).code, 0);
}

// Aligned views of 13 MB, in an empty tile grid of 49 GB.
TEST_F(ValidateVerb, EmptyTilesOfAlignedViewsTakeNoTime) {
    write_empty("plain.tess", {64 + 31 * 127, 64 + 31 * 127, 32, 32});
    const std::string plain = slurp(at("plain.tess"));
    const auto bytes = std::as_bytes(std::span(plain));
    const std::vector<std::byte> file = with_alignment({bytes.begin(), bytes.end()}, {127, -127});
    spit(at("x.tess"), std::string(reinterpret_cast<const char*>(file.data()), file.size()));
    EXPECT_LT(file.size(), 60'000u);
    EXPECT_EQ(run("validate x.tess", two_seconds).code, 0);
    EXPECT_EQ(run("decode x.tess -o x.rgb -q", two_seconds).code, 0);
    EXPECT_EQ(fs::file_size(at("x.rgb")), 64u * 64 * 32 * 32 * 3);
    EXPECT_EQ(run("compare x.tess x.tess --no-ssim -q", two_seconds).code, 0);
}

TEST_F(ValidateVerb, ManyKeysOfMetadataAreListedInTheirOrder) {
    tessera::Metadata metadata;
    for (int i = 0; i < 65536; ++i)
        metadata[std::to_string(100000 + i)] = "";
    write_empty("keys.tess", {64, 64, 4, 4}, metadata);
    const Outcome o = run("info keys.tess --json", two_seconds);
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_LT(o.out.find("\"100000\""), o.out.find("\"100001\""));
    EXPECT_NE(o.out.find("\"165535\""), std::string::npos);
}

// The whole head is held in memory, so --memory bounds it, too.
TEST_F(ValidateVerb, LongHeadsAreRefusedWhereMemoryIsShort) {
    write_empty("head.tess", {64, 64, 4, 4}, {}, std::vector<std::byte>(4 << 20));
    const std::string memory = " --threads 1 --memory 109M -q";
    for (const std::string& command :
         {std::string("decode head.tess -o x.rgb"), std::string("encode head.tess -o x.tess"),
          std::string("compare head.tess head.tess"),
          std::string("compare head.tess head.tess --beginnings 2")})
        fail(5, command + memory, {"head.tess", "held in memory", "--memory"});
    EXPECT_EQ(names(), std::vector<std::string>{"head.tess"});
    succeed("decode head.tess -o x.rgb --threads 1 --memory 120M -q");
}

// Tiles that do not decode are detected in any order of groups.
TEST_F(ValidateVerb, TilesThatDoNotDecodeAreNamed) {
    const auto code = tessera::write_coding_parameters({}, 3, false);
    const std::vector<std::byte> noise(9, std::byte{0xA5});
    ContainerContents contents;
    contents.desc.size = {300, 1, 1, 1};
    contents.tile_extent = {1, 1, 1, 1};
    contents.codec_parameters = code;
    contents.tile = [&](std::uint64_t tile) {
        return std::span<const std::byte>(noise).first(tile == 7 || tile == 299 ? 9 : 0);
    };
    std::vector<std::byte> file;
    VectorSink sink(file);
    ASSERT_TRUE(write_container(contents, sink).ok());
    spit(at("x.tess"), std::string(reinterpret_cast<const char*>(file.data()), file.size()));
    const Outcome o = run("validate x.tess --json");
    EXPECT_EQ(o.code, 3);
    const Json json = Json::parse(o.out);
    ASSERT_EQ(json["findings"].size(), 2u) << o.out;
    EXPECT_EQ(json["findings"][0]["first_tile"], 7);
    EXPECT_EQ(json["findings"][1]["first_tile"], 299);
}

} // namespace
