// Loads small glTF files in a folder of the test.
#pragma once

#include "corpus/trace/tracer.h"
#include "tests/support/model_files.h"

#include <algorithm>

namespace tessera::corpus {

using namespace support;

class GltfFixture : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& bytes) const {
        return write_text((folder_ / name).string(), bytes);
    }
    Result<Model> load(const GltfText& text) const {
        return load_model(file("a.gltf", text.text()));
    }
    // Expects that the model is read with exactly one note, which contains `words`.
    Model load_with_note(const GltfText& text, const std::string& words) const {
        auto model = load(text);
        EXPECT_TRUE(model.ok()) << model.status().message();
        if (!model.ok())
            return {};
        EXPECT_EQ(model->notes.size(), 1u) << words;
        if (!model->notes.empty())
            EXPECT_NE(model->notes[0].find(words), std::string::npos) << model->notes[0];
        return std::move(*model);
    }
    void refuse(const GltfText& text, const std::string& words) const {
        const auto model = load(text);
        ASSERT_FALSE(model.ok()) << words;
        EXPECT_EQ(model.status().code(), ErrorCode::invalid_file);
        EXPECT_NE(model.status().message().find(words), std::string::npos)
            << model.status().message();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_ = test::make_test_folder("gltf");
};

// A triangle with a base colour texture; `images` is the list of the file's images.
inline GltfText textured(const std::string& images, const std::string& texture = R"("source":0)",
                         const std::string& use = "") {
    GltfText text;
    text.primitive = R"(,"material":0)";
    text.more = R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0)" + use +
                R"(}}}],"textures":[{)" + texture + R"(}],"images":[)" + images + "]";
    return text;
}

inline const ModelMaterial& material_of(const Model& model) {
    return model.materials[model.triangles[0].material];
}

// The first triangle's material at its middle.
inline LitPoint middle_of(const Model& model) {
    const auto rays = RayModel::make(model);
    EXPECT_TRUE(rays.ok());
    return (*rays)->point({0, {1 / 3.0, 1 / 3.0}});
}

inline GltfText with_material(const std::string& material) {
    GltfText text;
    text.primitive = R"(,"material":0)";
    text.more = R"(,"materials":[)" + material + "]";
    return text;
}

} // namespace tessera::corpus
