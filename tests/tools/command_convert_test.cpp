#include "tests/support/cli_fixture.h"
#include "tests/support/model_files.h"
#include "tests/support/pictures.h"
#include "tools/http/glb_payload.h"

namespace tessera::test {
namespace {

class CommandConvert : public CliFixture {
protected:
    // Makes the files once for all tests.
    void SetUp() override {
        static std::string tess, glb;
        CliFixture::SetUp();
        if (glb.empty()) {
            succeed("bake composed -o a.tess --proxy mesh --single --density 0.25 --directions 4x4 "
                    "--spp 1 "
                    "--effort 0 -q");
            succeed("convert a.tess -o a.glb -q");
            tess = slurp(at("a.tess"));
            glb = slurp(at("a.glb"));
        }
        write("a.tess", tess);
        write("a.glb", glb);
    }
    Json gltf(const std::string& name) const {
        const std::string bytes = slurp(at(name));
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, 4);
        return Json::parse(bytes.substr(20, length));
    }
    std::string view(const std::string& name, std::size_t number) const {
        const std::string bytes = slurp(at(name));
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, 4);
        const Json of = gltf(name)["bufferViews"][number];
        return bytes.substr(28 + length + of["byteOffset"].get<std::size_t>(),
                            of["byteLength"].get<std::size_t>());
    }
    // Without the bytes in the message.
    void expect_same(const std::string& one, const std::string& other) const {
        EXPECT_TRUE(slurp(at(one)) == slurp(at(other))) << one << " is not " << other;
    }
    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(at(name), std::ios::binary) << bytes;
    }
};

TEST_F(CommandConvert, WritesWhatGltfAndWeRead) {
    const Json json = gltf("a.glb");
    EXPECT_EQ(json["extensionsUsed"],
              Json::parse(R"(["KHR_materials_unlit","TESSERA_texture_light_field"])"));
    EXPECT_FALSE(json.contains("extensionsRequired"));
    const Json extension = json["textures"][0]["extensions"][glb_extension];
    EXPECT_EQ(extension["mimeType"], tess_mime_type);
    EXPECT_TRUE(view("a.glb", extension["bufferView"]) == slurp(at("a.tess")));
    const std::string png = view("a.glb", json["images"][0]["bufferView"]);
    EXPECT_EQ(png.substr(0, 4), "\x89PNG");
    EXPECT_EQ(slurp(at("a.glb")).size() % 4, 0u);

    succeed("convert a.glb -o b.tess -q");
    expect_same("b.tess", "a.tess");
    for (const std::string threads : {"1", "3"}) {
        succeed("convert a.tess -o again.glb -q --threads " + threads);
        expect_same("again.glb", "a.glb");
    }
    succeed("convert a.glb -o again.glb -q");
    expect_same("again.glb", "a.glb");
}

TEST_F(CommandConvert, AllReadersOfTessReadGlb) {
    const Json tess = json("info a.tess --json"), glb = json("info a.glb --json");
    for (const char* key : {"size", "file_bytes", "mesh", "kind"})
        EXPECT_EQ(tess[key], glb[key]) << key;
    succeed("validate a.glb -q");
    succeed("compare a.tess a.glb --max-error 0 -q");
    succeed("decode a.tess -o a.rgb -q");
    succeed("decode a.glb -o b.rgb -q");
    expect_same("b.rgb", "a.rgb");
    for (const std::string name : {"a.tess", "a.glb"})
        succeed("render " + name + " -o " + name + ".png --pixels 24x16 -q");
    expect_same("a.glb.png", "a.tess.png");
    succeed("encode a.glb -o c.tess --effort 0 -q");
    EXPECT_EQ(json("info c.tess --json")["size"], tess["size"]);
    EXPECT_EQ(run("info -", "cat a.glb |", "").code, 0);
    // By content, not by name.
    fs::copy_file(at("a.glb"), at("named.tess"));
    succeed("validate named.tess -q");
}

TEST_F(CommandConvert, OptionsOfThePictureAndTheMesh) {
    succeed("convert a.tess -o d.glb --mesh-compression draco --jpeg 80 --picture-side 16 -q");
    const Json json = gltf("d.glb");
    EXPECT_EQ(json["extensionsRequired"], Json::parse(R"(["KHR_draco_mesh_compression"])"));
    EXPECT_EQ(json["images"][0]["mimeType"], "image/jpeg");
    EXPECT_EQ(view("d.glb", json["images"][0]["bufferView"]).substr(0, 2), "\xff\xd8");
    EXPECT_LT(fs::file_size(at("d.glb")), fs::file_size(at("a.glb")));
    const Json report = this->json("convert a.tess -o d.glb --picture-side 16 --json");
    EXPECT_EQ(report["picture"], "PNG");
    EXPECT_EQ(report["texture_bytes"], fs::file_size(at("a.tess")));
    EXPECT_EQ(report["bytes"], fs::file_size(at("d.glb")));
    succeed("convert a.tess -o m.glb --mesh-compression meshopt --picture-side 16 -q");
    EXPECT_EQ(gltf("m.glb")["extensionsRequired"],
              Json::parse(R"(["KHR_mesh_quantization","EXT_meshopt_compression"])"));
    EXPECT_LT(fs::file_size(at("m.glb")), fs::file_size(at("a.glb")));
    succeed("compare a.tess m.glb --max-error 0 -q");
    // The model reader reads all kinds, and says that it leaves out the texture.
    for (const std::string name : {"a.glb", "d.glb", "m.glb"}) {
        const Outcome o = run("bake " + name +
                              " -o m.tess --single --density 0.5 --directions 2x2 "
                              "--spp 1 --effort 0 -q");
        EXPECT_EQ(o.code, 0) << o.err;
        EXPECT_NE(o.err.find("TESSERA_texture_light_field"), std::string::npos) << o.err;
    }
}

TEST_F(CommandConvert, BakesAModelIntoAGlb) {
    succeed("bake composed -o b.glb --proxy mesh --single --density 0.25 --directions 4x4 --spp 1 "
            "--effort 0 -q");
    expect_same("b.glb", "a.glb");
    const std::vector<std::string> before = names();
    fail(1, "bake composed -o c.glb --spp 1", {"c.glb", "--proxy mesh"});
    fail(1, "bake composed -o c.glb --proxy mesh --resume", {"--resume"});
    fail(1, "bake composed -o c.tess --proxy mesh --mesh-compression draco",
         {"--mesh-compression: needs a .glb output"});
    fail(1, "encode a.tess -o c.glb", {"c.glb", "tessera convert"});
    fail(1, "decode a.tess -o c.glb", {"c.glb", "convert"});
    EXPECT_EQ(names(), before);
}

TEST_F(CommandConvert, JoinsSeveralTextures) {
    succeed("bake composed -o b.tess --proxy mesh --density 0.25 --directions 2x2 --spp 1 "
            "--effort 0 -q");
    succeed("convert a.tess b.tess -o two.glb --picture-side 16 -q");
    const Json gltf = this->gltf("two.glb");
    EXPECT_EQ(gltf["scenes"][0]["nodes"], Json::parse("[0,1]"));
    for (std::size_t i = 0; i < 2; ++i) {
        const std::string name = i == 0 ? "a" : "b";
        EXPECT_EQ(gltf["nodes"][i]["name"], name);
        const Json material =
            gltf["materials"][gltf["meshes"][gltf["nodes"][i]["mesh"].get<std::size_t>()]
                                  ["primitives"][0]["material"]
                                      .get<std::size_t>()];
        const Json texture =
            gltf["textures"]
                [material["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>()];
        EXPECT_TRUE(view("two.glb", texture["extensions"][glb_extension]["bufferView"]) ==
                    slurp(at(name + ".tess")));
        succeed("convert two.glb#" + std::to_string(i) + " -o back.tess -q");
        expect_same("back.tess", name + ".tess");
        succeed("validate two.glb#" + std::to_string(i) + " -q");
    }
    succeed("render two.glb#1 -o one.png --pixels 24x16 -q");
    succeed("render b.tess -o other.png --pixels 24x16 -q");
    expect_same("one.png", "other.png");
    succeed("convert two.glb#1 two.glb#0 -o swapped.glb --picture-side 16 -q");
    EXPECT_EQ(fs::file_size(at("swapped.glb")) / 1000, fs::file_size(at("two.glb")) / 1000);

    const Json about = json("info two.glb --json");
    ASSERT_EQ(about["textures"].size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(about["textures"][i], json("info two.glb#" + std::to_string(i) + " --json"));
    const Json report = json("convert a.tess b.tess -o two.glb --picture-side 16 --json");
    EXPECT_EQ(report["textures"], 2);
    EXPECT_EQ(report["texture_bytes"], fs::file_size(at("a.tess")) + fs::file_size(at("b.tess")));

    const std::vector<std::string> before = names();
    fail(1, "render two.glb -o x.png", {"two.glb: has 2 Tessera textures", "two.glb#0 to #1"});
    fail(1, "info two.glb#2", {"two.glb#2: there is no such texture"});
    fail(1, "convert a.tess b.tess -o x.tess", {"x.tess", "one input"});
    fail(2, "convert a.tess missing.tess -o x.glb", {"missing.tess"});
    EXPECT_EQ(names(), before);
}

// What hides and what blends are primitives of one texture.
TEST_F(CommandConvert, SplitsTheTrianglesThatBlend) {
    tessera::corpus::support::GltfText text;
    text.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    text.indices = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    Json model = Json::parse(text.text());
    model["accessors"][1]["count"] = 6;
    model["accessors"][2] = model["accessors"][1];
    model["accessors"][2]["byteOffset"] = 24;
    Json& parts = model["meshes"][0]["primitives"];
    parts[0]["material"] = 0;
    parts[1] = parts[0];
    parts[1]["indices"] = 2;
    parts[1]["material"] = 1;
    model["materials"][0] = Json::object();
    model["materials"][1] = Json::parse(
        R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.2,0.5,0.8,0.5]}})");
    write("glass.gltf", model.dump());
    succeed("bake glass.gltf -o glass.glb --layered --texels 1100 --spp 1 -q");
    const Json json = gltf("glass.glb");
    ASSERT_EQ(json["textures"].size(), 1u);
    ASSERT_EQ(json["materials"].size(), 2u);
    EXPECT_FALSE(json["materials"][0].contains("alphaMode"));
    EXPECT_EQ(json["materials"][1]["alphaMode"], "BLEND");
    const Json& primitives = json["meshes"][0]["primitives"];
    ASSERT_EQ(primitives.size(), 2u);
    for (const Json& primitive : primitives) {
        EXPECT_EQ(json["accessors"][primitive["indices"].get<std::size_t>()]["count"], 6);
        EXPECT_EQ(
            json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"], 4);
    }
}

TEST_F(CommandConvert, RefusesWhatItCannotConvert) {
    succeed("bake composed -o s.tess --size 16x8x4x4 --spp 1 --effort 0 -q");
    write("text.glb", "glTF but no glTF at all, only text that says so");
    std::string plain = slurp(at("a.glb"));
    plain.replace(plain.find("TESSERA_texture_light_field"), 7, "UNKNOWN");
    plain.replace(plain.rfind("TESSERA_texture_light_field"), 7, "UNKNOWN");
    write("plain.glb", plain);
    std::string damaged = slurp(at("a.glb"));
    damaged[damaged.size() - 20] ^= 1;
    write("damaged.glb", damaged);
    std::string cut = slurp(at("a.glb"));
    cut.resize(cut.size() - 100);
    write("cut.glb", cut);
    const std::vector<std::string> before = names();
    fail(5, "convert s.tess -o x.glb", {"s.tess", "does not lie on a mesh", "--proxy mesh"});
    fail(1, "convert a.tess -o x.png", {"x.png", ".glb and .tess"});
    fail(1, "convert a.glb -o x.tess --jpeg 80", {"--jpeg: needs a .glb output"});
    fail(1, "convert plain.glb -o x.tess", {"plain.glb", "without a Tessera texture"});
    fail(1, "info plain.glb", {"plain.glb", "without a Tessera texture"});
    fail(5, "info text.glb", {"text.glb", "glTF version"});
    fail(3, "convert damaged.glb -o x.glb", {"damaged.glb"});
    fail(3, "decode damaged.glb -o x.rgb", {"damaged.glb"});
    fail(3, "validate damaged.glb -q", {"damaged.glb: not valid"});
    fail(3, "convert cut.glb -o x.tess", {"cut.glb"});
    fail(2, "convert missing.tess -o x.glb", {"missing.tess"});
    EXPECT_EQ(names(), before);
    // What has arrived of a .glb is what has arrived of the texture.
    EXPECT_EQ(run("decode cut.glb -o x.rgb --allow-partial -q").code, 0);
}

} // namespace
} // namespace tessera::test
