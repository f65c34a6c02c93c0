// .obj and .ply by Assimp.
#include "corpus/model/image_file.h"
#include "corpus/model/ply_check.h"
#include "corpus/model/readers.h"

#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <cmath>
#include <map>

namespace tessera::corpus {
namespace {

constexpr std::size_t most_file_bytes = std::size_t{1} << 31;
constexpr int deepest_node = 64;

double to_linear(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

class AssimpScene {
public:
    AssimpScene(const aiScene& scene, std::string folder, ModelBuilder& builder)
        : scene_(scene), folder_(std::move(folder)), builder_(builder) {}

    Status add() {
        for (unsigned i = 0; i < scene_.mNumMaterials; ++i)
            TESSERA_TRY(
                add_material(*scene_.mMaterials[i]).with_context("material " + std::to_string(i)));
        if (builder_.model().materials.empty())
            builder_.model().materials.push_back(plain());
        return scene_.mRootNode ? add_node(*scene_.mRootNode, glm::dmat4(1.0), 0) : Status();
    }

private:
    // These files know no metal; half rough is what their shininess looks like, mostly.
    static ModelMaterial plain() {
        ModelMaterial m;
        m.metal = 0.0;
        m.roughness = 0.5;
        return m;
    }

    Status add_material(const aiMaterial& from) {
        ModelMaterial m = plain();
        aiColor3D colour(1, 1, 1);
        if (from.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == AI_SUCCESS)
            m.base = {to_linear(colour.r), to_linear(colour.g), to_linear(colour.b), 1.0};
        if (from.Get(AI_MATKEY_COLOR_EMISSIVE, colour) == AI_SUCCESS)
            m.emission = {to_linear(colour.r), to_linear(colour.g), to_linear(colour.b)};
        float x = 0;
        if (from.Get(AI_MATKEY_ROUGHNESS_FACTOR, x) == AI_SUCCESS && x >= 0 && x <= 1)
            m.roughness = static_cast<double>(x);
        else if (from.Get(AI_MATKEY_SHININESS, x) == AI_SUCCESS && x > 0) // of Phong
            m.roughness =
                std::clamp(std::sqrt(std::sqrt(2.0 / (static_cast<double>(x) + 2.0))), 0.05, 1.0);
        if (from.Get(AI_MATKEY_METALLIC_FACTOR, x) == AI_SUCCESS && x >= 0 && x <= 1)
            m.metal = static_cast<double>(x);
        aiString name;
        if (from.GetTexture(aiTextureType_DIFFUSE, 0, &name) == AI_SUCCESS) {
            TESSERA_TRY_ASSIGN(m.base_texture.image, image_of(name.C_Str()));
            m.base = glm::dvec4(1.0); // exporters leave black beside a texture
        }
        builder_.model().materials.push_back(m);
        return {};
    }

    Result<int> image_of(const std::string& name) {
        if (const auto it = images_.find(name); it != images_.end())
            return it->second;
        const std::string path = folder_ + "/" + name;
        TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_file_bytes));
        TESSERA_TRY_ASSIGN(Image image, decode_image(bytes).with_context(path));
        builder_.model().images.push_back(std::move(image));
        return images_[name] = static_cast<int>(builder_.model().images.size()) - 1;
    }

    Status add_node(const aiNode& node, const glm::dmat4& parent, int depth) {
        if (depth >= deepest_node)
            return {ErrorCode::invalid_file,
                    "nodes lie more than " + std::to_string(deepest_node) + " deep"};
        const aiMatrix4x4& t = node.mTransformation; // rows
        const glm::dmat4 own(t.a1, t.b1, t.c1, t.d1, t.a2, t.b2, t.c2, t.d2, t.a3, t.b3, t.c3, t.d3,
                             t.a4, t.b4, t.c4, t.d4);
        const glm::dmat4 place = parent * own;
        for (unsigned i = 0; i < node.mNumMeshes; ++i)
            TESSERA_TRY(add_mesh(node.mMeshes[i], place));
        for (unsigned i = 0; i < node.mNumChildren; ++i)
            TESSERA_TRY(add_node(*node.mChildren[i], place, depth + 1));
        return {};
    }

    Status add_mesh(unsigned number, const glm::dmat4& place) {
        const aiMesh& mesh = *scene_.mMeshes[number];
        ModelPart part;
        part.name = "mesh " + std::to_string(number);
        part.material =
            mesh.mMaterialIndex < builder_.model().materials.size() ? mesh.mMaterialIndex : 0;
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            const aiVector3D& p = mesh.mVertices[i];
            part.positions.emplace_back(p.x, p.y, p.z);
            if (mesh.mNormals)
                part.normals.emplace_back(mesh.mNormals[i].x, mesh.mNormals[i].y,
                                          mesh.mNormals[i].z);
            if (mesh.mTextureCoords[0]) // from below, ours from above
                part.uv[0].emplace_back(mesh.mTextureCoords[0][i].x,
                                        1.0f - mesh.mTextureCoords[0][i].y);
            if (mesh.mColors[0]) {
                const aiColor4D& c = mesh.mColors[0][i];
                const auto linear = [](float x) {
                    return static_cast<float>(to_linear(static_cast<double>(x)));
                };
                part.colours.emplace_back(linear(c.r), linear(c.g), linear(c.b), c.a);
            }
        }
        for (unsigned i = 0; i < mesh.mNumFaces; ++i)
            if (mesh.mFaces[i].mNumIndices == 3)
                part.indices.insert(part.indices.end(), mesh.mFaces[i].mIndices,
                                    mesh.mFaces[i].mIndices + 3);
        return builder_.add(part, place);
    }

    const aiScene& scene_;
    std::string folder_;
    ModelBuilder& builder_;
    std::map<std::string, int> images_;
};

// Triangulation ends the process where a face has no corners.
Status check_faces(const aiScene& scene) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
        const aiMesh& mesh = *scene.mMeshes[i];
        for (unsigned k = 0; k < mesh.mNumFaces; ++k)
            if (mesh.mFaces[k].mNumIndices == 0)
                return {ErrorCode::invalid_file, "face " + std::to_string(k) + " of mesh " +
                                                     std::to_string(i) + " has no corners"};
    }
    return {};
}

} // namespace

Status read_with_assimp(const std::string& path, bool is_ply, ModelBuilder& builder) {
    // Says why a file cannot be read.
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_file_bytes));
    if (is_ply)
        TESSERA_TRY(check_ply(std::as_bytes(std::span(bytes))));
    Assimp::Importer importer;
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 45.0f);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
    if (scene) {
        TESSERA_TRY(check_faces(*scene));
        scene =
            importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals |
                                         aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
    }
    if (!scene)
        return {ErrorCode::invalid_file,
                std::string("cannot be read: ") + importer.GetErrorString()};
    const std::size_t slash = path.find_last_of('/');
    return AssimpScene(*scene, slash == std::string::npos ? "." : path.substr(0, slash), builder)
        .add();
}

} // namespace tessera::corpus
