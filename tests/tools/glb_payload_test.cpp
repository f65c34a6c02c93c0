#include "tools/http/glb_payload.h"

#include "tools/support/json_text.h"

#include <cstring>
#include <gtest/gtest.h>

namespace tessera {
namespace {

// A .glb whose binary chunk has 16 bytes of something else and then the payload "TESS".
struct SmallGlb {
    Json json = Json::parse(R"({"asset":{"version":"2.0"},
        "textures":[{"source":0},{"extensions":{"TESSERA_texture_light_field":
            {"bufferView":1,"mimeType":"application/vnd.tessera"}}}],
        "materials":[{},{"pbrMetallicRoughness":{"baseColorTexture":{"index":1}}}],
        "bufferViews":[{"buffer":0,"byteLength":16},
                       {"buffer":0,"byteOffset":16,"byteLength":4}],
        "buffers":[{"byteLength":20}]})");
    std::string chunk = "0123456789abcdefTESS";
    std::uint32_t version = 2;

    static std::string word(std::size_t x) {
        std::string text;
        for (int i = 0; i < 4; ++i)
            text += static_cast<char>(x >> 8 * i & 255);
        return text;
    }
    std::string bytes() const {
        std::string text = json.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        return "glTF" + word(version) + word(28 + text.size() + chunk.size()) + word(text.size()) +
               "JSON" + text + word(chunk.size()) + std::string("BIN\0", 4) + chunk;
    }
    Json& extension() { return json["textures"][1]["extensions"][glb_extension]; }
};

std::string payload_of(const std::string& bytes, std::optional<std::size_t> texture = {}) {
    auto opened = unpack_glb(wrap_memory(std::as_bytes(std::span(bytes))), texture);
    if (!opened.ok())
        return "error " + std::to_string(static_cast<int>(opened.status().code())) + ": " +
               opened.status().message();
    std::string text((*opened)->size(), '\0');
    EXPECT_TRUE((*opened)->read(0, std::as_writable_bytes(std::span(text))).ok());
    return text;
}

void expect_refused(const SmallGlb& glb, ErrorCode code, const std::string& words) {
    const std::string said = payload_of(glb.bytes());
    EXPECT_EQ(said.rfind("error " + std::to_string(static_cast<int>(code)) + ": <memory>: ", 0), 0u)
        << said;
    EXPECT_NE(said.find(words), std::string::npos) << said;
}

TEST(GlbPayload, IsTheBufferViewOfTheExtension) {
    EXPECT_EQ(payload_of(SmallGlb().bytes()), "TESS");
    EXPECT_EQ(payload_of("something else, which is not glTF"), "something else, which is not glTF");
    EXPECT_EQ(payload_of("glT"), "glT");
    SmallGlb first;
    first.extension()["bufferView"] = 0;
    EXPECT_EQ(payload_of(first.bytes()), "0123456789abcdef") << "byteOffset is 0 by default";
}

TEST(GlbPayload, ReadsOnlyWithinItself) {
    const std::string bytes = SmallGlb().bytes();
    const auto opened = unpack_glb(wrap_memory(std::as_bytes(std::span(bytes))), {});
    ASSERT_TRUE(opened.ok());
    EXPECT_EQ((*opened)->name(), "<memory>");
    EXPECT_EQ(whole_file(**opened).size(), bytes.size());
    std::array<std::byte, 2> two{}, more{};
    EXPECT_EQ((*opened)->read(3, two).code(), ErrorCode::io);
    EXPECT_EQ((*opened)->read(~0ull, two).code(), ErrorCode::io);
    const ReadRequest requests[] = {{1, two}, {2, more}};
    ASSERT_TRUE((*opened)->read_many(requests).ok());
    EXPECT_EQ(std::memcmp(two.data(), "ES", 2), 0);
    EXPECT_EQ(std::memcmp(more.data(), "SS", 2), 0);
}

TEST(GlbPayload, RefusesWhatPointsNowhere) {
    const auto invalid = ErrorCode::invalid_file, unsupported = ErrorCode::unsupported;
    SmallGlb glb;
    glb.extension()["bufferView"] = 2;
    expect_refused(glb, invalid,
                   "textures[1]: TESSERA_texture_light_field names entry 2 of "
                   "bufferViews, which has 2");
    glb.extension()["bufferView"] = -1;
    expect_refused(glb, invalid, "has no valid bufferView");
    glb.extension() = "text";
    expect_refused(glb, invalid, "has no valid bufferView");

    glb = {};
    glb.json["bufferViews"][1]["byteLength"] = 5;
    expect_refused(glb, invalid, "covers the bytes 16 to 16 + 5, but its buffer has 20");
    glb.json["bufferViews"][1]["byteLength"] = ~std::uint64_t{0};
    expect_refused(glb, invalid, "but its buffer has 20");
    glb.json["bufferViews"][1]["byteOffset"] = ~std::uint64_t{0} - 3;
    expect_refused(glb, invalid, "but its buffer has 20");
    glb.json["bufferViews"][1]["byteOffset"] = 21;
    expect_refused(glb, invalid, "but its buffer has 20");

    glb = {};
    glb.json["buffers"][0]["byteLength"] = 1000;
    glb.json["bufferViews"][1]["byteLength"] = 500;
    expect_refused(glb, invalid, "but its buffer has 20");

    glb = {};
    glb.json["bufferViews"][1]["buffer"] = 1;
    expect_refused(glb, invalid, "names entry 1 of buffers, which has 1");
    glb.json["buffers"][1] = glb.json["buffers"][0];
    expect_refused(glb, unsupported, "is not in the binary chunk");
    glb = {};
    glb.json["buffers"][0]["uri"] = "x.bin";
    expect_refused(glb, unsupported, "is not in the binary chunk");

    glb = {};
    glb.json["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 2;
    expect_refused(glb, invalid,
                   "the base colour of materials[1] names entry 2 of textures, "
                   "which has 2");
    glb = {};
    glb.extension()["mimeType"] = "image/png";
    expect_refused(glb, unsupported, "has a mimeType that is not application/vnd.tessera");
    glb = {};
    glb.json["textures"].erase(1);
    glb.json["materials"] = Json::array();
    expect_refused(glb, ErrorCode::bad_argument, "a binary glTF model without a Tessera texture");
    glb.json["textures"] = 7;
    expect_refused(glb, invalid, "textures is not a list");
    glb.json = Json::array();
    expect_refused(glb, invalid, "the JSON chunk is not a JSON object");
    glb = {};
    glb.version = 1;
    expect_refused(glb, unsupported, "is glTF version 1");
}

TEST(GlbPayload, OfSeveralTexturesIsTheChosenOne) {
    SmallGlb glb;
    glb.json["textures"][2] = glb.json["textures"][1];
    glb.json["textures"][2]["extensions"][glb_extension]["bufferView"] = 0;
    EXPECT_EQ(payload_of(glb.bytes(), 0), "TESS");
    EXPECT_EQ(payload_of(glb.bytes(), 1), "0123456789abcdef");
    expect_refused(glb, ErrorCode::bad_argument,
                   "has 2 Tessera textures; name one of them, <memory>#0 to #1");
    EXPECT_NE(payload_of(glb.bytes(), 2).find("<memory>#2: there is no such texture"),
              std::string::npos);
    EXPECT_NE(payload_of("no glTF", 0).find("is no .glb"), std::string::npos);
    EXPECT_EQ(payload_of(SmallGlb().bytes(), 0), "TESS");
    // Of a file that is cut short, the first texture may be there.
    const std::string bytes = glb.bytes();
    const std::string cut = bytes.substr(0, bytes.size() - 4);
    EXPECT_EQ(payload_of(cut, 1), "0123456789abcdef");
    EXPECT_NE(payload_of(cut, 0).find("the file ends before the Tessera texture"),
              std::string::npos);
    // All of them must be within the file.
    glb.json["textures"][2]["extensions"][glb_extension]["bufferView"] = 2;
    EXPECT_NE(payload_of(glb.bytes(), 0).find("textures[2]: TESSERA_texture_light_field names"),
              std::string::npos);
}

TEST(GlbPayload, NamesMayChooseATexture) {
    const auto split = [](const std::string& name) {
        const GlbName glb = split_glb_name(name);
        return glb.file + " " + (glb.texture ? std::to_string(*glb.texture) : "none");
    };
    EXPECT_EQ(split("a.glb"), "a.glb none");
    EXPECT_EQ(split("a.glb#0"), "a.glb 0");
    EXPECT_EQ(split("dir/a.glb#12"), "dir/a.glb 12");
    EXPECT_EQ(split("https://host/a.glb?x=1#3"), "https://host/a.glb?x=1 3");
    for (const std::string name : {"a.glb#", "a.glb#x", "a.glb#-1", "a.glb#1x", "a.glb#9999999999",
                                   "a.tess#1", "https://host/a.tess#1"})
        EXPECT_EQ(split(name), name + " none");
}

TEST(GlbPayload, LeavesOutWhatIsNestedDeeply) {
    SmallGlb glb;
    Json* inner = &glb.json["extras"];
    for (int i = 0; i < 1000; ++i, inner = &(*inner)[0])
        (*inner)[0] = Json::array();
    EXPECT_EQ(payload_of(glb.bytes()), "TESS");
    const std::string open(100000, '[');
    std::string bytes = "glTF" + SmallGlb::word(2) + SmallGlb::word(20 + open.size()) +
                        SmallGlb::word(open.size()) + "JSON" + open;
    EXPECT_NE(payload_of(bytes).find("the JSON chunk is not a JSON object"), std::string::npos);
}

// Up to the end of the JSON there is nothing to find. From then on there is what has arrived.
TEST(GlbPayload, OfAFileThatIsCutShort) {
    const std::string bytes = SmallGlb().bytes();
    for (std::size_t length = 4; length < bytes.size(); ++length) {
        const std::string said = payload_of(bytes.substr(0, length));
        if (length <= bytes.size() - 4)
            EXPECT_EQ(said.rfind("error 3: <memory>: the file ends ", 0), 0u) << said;
        else
            EXPECT_EQ(said, std::string("TESS").substr(0, length - (bytes.size() - 4)));
    }
    std::string shorter = bytes;
    shorter.replace(8, 4, SmallGlb::word(bytes.size() - 1)); // the header's length
    EXPECT_NE(payload_of(shorter).find("beyond the length in the header"), std::string::npos);
}

// No changed byte leads out of the file or stops the program.
TEST(GlbPayload, SurvivesEveryChangedByte) {
    const std::string bytes = SmallGlb().bytes();
    for (std::size_t at = 4; at < bytes.size(); ++at)
        for (const int mask : {1, 0x10, 0x80, 0xFF}) {
            std::string damaged = bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ mask);
            const std::string said = payload_of(damaged);
            EXPECT_TRUE(said.starts_with("error ") || said.size() <= 20) << said;
        }
}

} // namespace
} // namespace tessera
