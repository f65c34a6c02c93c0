// Small models as text of model files.
#pragma once

#include "corpus/model_surface/lit_model.h"
#include "tests/support/test_folder.h"

#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tessera::corpus::support {

// A PNG of one texel.
inline const std::string one_texel_png(
    "\211PNG\015\012\032\012\000\000\000\015IHDR\000\000\000\001\000\000\000\001\010\002"
    "\000\000\000\220wS\336\000\000\000\014IDATx\332c\370\337\300\000\000\004\001\001\200\373"
    "\327\313\361\000\000\000\000IEND\256B`\202",
    69);

inline std::string write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return path;
}

template <class Number> std::string base64_of(const std::vector<Number>& numbers) {
    static const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes(numbers.size() * sizeof(Number), '\0'), text;
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three =
                three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? letters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

// Text of a glTF file with one mesh: positions (three numbers each) and indices, in buffers, views
// and accessors 0 and 1. The other members are appended: `more` to the root object, `primitive` to
// the primitive, `attributes` to its attributes, `position` to the accessor of positions, `buffers`,
// `views` and `accessors` to these lists, each after a comma. `nodes` is the list of nodes.
struct GltfText {
    std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::vector<std::uint32_t> indices{0, 1, 2};
    std::string primitive, nodes = R"({"mesh":0})", more, attributes, position, buffers, views,
                           accessors;
    std::string position_view = R"("bufferView":0,)"; // empty: positions have no bytes

    std::string text() const {
        const std::string p = std::to_string(positions.size() * 4),
                          i = std::to_string(indices.size() * 4);
        const auto uri = [](const std::string& data) {
            return R"("uri":"data:application/octet-stream;base64,)" + data + R"(")";
        };
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" +
               nodes + R"(],"buffers":[{"byteLength":)" + p + "," + uri(base64_of(positions)) +
               R"(},{"byteLength":)" + i + "," + uri(base64_of(indices)) + "}" + buffers +
               R"(],"bufferViews":[{"buffer":0,"byteLength":)" + p +
               R"(},{"buffer":1,"byteLength":)" + i + "}" + views + R"(],"accessors":[{)" +
               position_view + R"("componentType":5126,"type":"VEC3","count":)" +
               std::to_string(positions.size() / 3) + position +
               R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
               std::to_string(indices.size()) + "}" + accessors +
               R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0)" + attributes +
               R"(},"indices":1)" + primitive + "}]}]" + more + "}";
    }
};

// A cube from -2 to 2 with flat normals and one material.
inline corpus::Model cube_model() {
    corpus::Model model;
    model.materials.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {1.0f, -1.0f}) {
            const auto first = static_cast<std::uint32_t>(model.vertices.size());
            for (int i = 0; i < 4; ++i) {
                corpus::ModelVertex v;
                v.position[axis] = 2.0f * sign;
                v.position[(axis + 1) % 3] = i % 2 ? 2.0f : -2.0f;
                v.position[(axis + 2) % 3] = i / 2 ? 2.0f : -2.0f;
                v.normal[axis] = sign;
                model.vertices.push_back(v);
            }
            const bool up = sign > 0;
            model.triangles.push_back({{first, first + (up ? 1u : 2u), first + (up ? 2u : 1u)}, 0});
            model.triangles.push_back(
                {{first + 1, first + (up ? 3u : 2u), first + (up ? 2u : 3u)}, 0});
        }
    return model;
}

// A sphere of radius 3 with smooth normals.
inline corpus::Model ball_model(int rings) {
    corpus::Model model;
    model.materials.emplace_back();
    const int columns = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double polar = 3.14159265358979 * j / rings,
                         round = 6.28318530717959 * (i % columns) / columns;
            corpus::ModelVertex v;
            v.normal = glm::vec3(glm::dvec3(std::sin(polar) * std::cos(round), std::cos(polar),
                                            std::sin(polar) * std::sin(round)));
            v.position = 3.0f * v.normal;
            model.vertices.push_back(v);
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i);
            const std::uint32_t b = a + 1, c = a + static_cast<std::uint32_t>(columns) + 1,
                                d = c + 1;
            if (j != 0)
                model.triangles.push_back({{a, b, c}, 0});
            if (j + 1 != rings)
                model.triangles.push_back({{b, d, c}, 0});
        }
    return model;
}

inline std::shared_ptr<const corpus::Environment> uniform_environment(float light) {
    return std::make_shared<const corpus::Environment>(
        corpus::LightImage{1, 1, {glm::vec3(light)}});
}

inline corpus::ModelLight white_light() {
    return {uniform_environment(1.0f), {}};
}

// A folder for model files.
class ModelFiles : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& text) const {
        return write_text((folder_ / name).string(), text);
    }
    Result<Model> load(const std::string& name, const std::string& text) const {
        return load_model(file(name, text));
    }
    // Expects that the file is refused with this code and a message that contains its name and
    // `words`.
    void refuse(const std::string& name, const std::string& text, ErrorCode code,
                const std::string& words) const {
        const auto model = load(name, text);
        ASSERT_FALSE(model.ok()) << words;
        EXPECT_EQ(model.status().code(), code) << model.status().message();
        EXPECT_NE(model.status().message().find(words), std::string::npos)
            << model.status().message();
        EXPECT_NE(model.status().message().find(name), std::string::npos)
            << model.status().message();
    }

    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_ = test::make_test_folder("models");
};

} // namespace tessera::corpus::support
