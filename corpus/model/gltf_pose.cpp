#include "corpus/model/gltf_pose.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace tessera::corpus {
namespace {

// Adds weight * the accessor's vectors to `values`, unless the part has none.
template <class Vector>
Status add_displacements(const tinygltf::Model& file, const std::map<std::string, int>& target,
                         const char* name, double weight, std::vector<Vector>& values) {
    std::vector<glm::vec3> moves;
    TESSERA_TRY(read_attribute(file, target, name, moves, 3, 0.0f));
    if (moves.empty() || values.empty())
        return {};
    if (moves.size() != values.size())
        return invalid_gltf(std::string("a morph target has ") + std::to_string(moves.size()) +
                            " values of " + name + " for " + std::to_string(values.size()) +
                            " vertices");
    for (std::size_t i = 0; i < moves.size(); ++i)
        for (int c = 0; c < 3; ++c)
            values[i][c] += static_cast<float>(weight * static_cast<double>(moves[i][c]));
    return {};
}

// What turns normals as `linear` turns surfaces, up to a positive factor. It has no inverse to
// fail on, where joints flatten a surface.
glm::dmat3 cofactors(const glm::dmat3& linear) {
    const glm::dmat3 m(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                       glm::cross(linear[0], linear[1]));
    return glm::determinant(linear) < 0.0 ? -m : m;
}

glm::vec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? glm::vec3(v / length) : glm::vec3(0.0f);
}

// The mean of the joints by the vertex's weights, whose sum counts as 1. Without weights, as other
// readers have it, a vertex follows its first joint.
Result<glm::dmat4> blended(const ModelPart& part, std::size_t vertex,
                           const std::vector<glm::dmat4>& joints) {
    glm::dmat4 sum(0.0);
    double total = 0.0;
    for (const SkinUse& use : part.skin)
        for (int k = 0; k < 4; ++k) {
            const double weight = static_cast<double>(use.weights[vertex][k]);
            if (!(std::abs(weight) > 0.0 && std::abs(weight) < 1e6))
                continue;
            const auto joint = static_cast<double>(use.joints[vertex][k]);
            if (!(joint >= 0.0 && joint < static_cast<double>(joints.size())))
                return invalid_gltf("vertex " + std::to_string(vertex) + " has joint " +
                                    std::to_string(joint) + " of " + std::to_string(joints.size()));
            sum += weight * joints[static_cast<std::size_t>(joint)];
            total += weight;
        }
    return std::abs(total) > 1e-9 ? sum / total : joints[0];
}

} // namespace

glm::dmat4 transform_of(const tinygltf::Node& node) {
    if (node.matrix.size() == 16)
        return glm::make_mat4(node.matrix.data());
    glm::dmat4 m(1.0);
    if (node.translation.size() == 3)
        m[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
    if (node.rotation.size() == 4)
        m *= glm::mat4_cast(glm::normalize(
            glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
    if (node.scale.size() == 3)
        for (int c = 0; c < 3; ++c)
            m[c] *= node.scale[static_cast<std::size_t>(c)];
    return m;
}

std::vector<int> parents_of(const tinygltf::Model& file) {
    std::vector<int> parents(file.nodes.size(), -1);
    for (std::size_t i = 0; i < parents.size(); ++i)
        for (const int child : file.nodes[i].children)
            if (has(file.nodes, child))
                parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
    return parents;
}

Status add_targets(const tinygltf::Model& file, const tinygltf::Primitive& primitive,
                   const std::vector<double>& weights, ModelPart& part) {
    const std::size_t count = std::min(weights.size(), primitive.targets.size());
    for (std::size_t i = 0; i < count; ++i) {
        if (weights[i] == 0.0)
            continue;
        const auto add = [&](const char* name, auto& values) {
            return add_displacements(file, primitive.targets[i], name, weights[i], values);
        };
        TESSERA_TRY(add("POSITION", part.positions));
        TESSERA_TRY(add("NORMAL", part.normals));
        TESSERA_TRY(add("TANGENT", part.tangents));
    }
    return {};
}

GltfSkins::GltfSkins(const tinygltf::Model& file)
    : file_(file), parents_(parents_of(file)), places_(file.nodes.size()) {}

Result<glm::dmat4> GltfSkins::place_of(int node) {
    std::vector<std::size_t> unknown; // from the node upwards
    glm::dmat4 place(1.0);
    for (; node >= 0; node = at(parents_, node)) {
        if (!has(file_.nodes, node) || unknown.size() == deepest_node)
            return invalid_gltf("node " + std::to_string(node) +
                                ", a joint, does not exist or is below itself");
        if (at(places_, node)) {
            place = *at(places_, node);
            break;
        }
        unknown.push_back(static_cast<std::size_t>(node));
    }
    for (; !unknown.empty(); unknown.pop_back()) {
        place *= transform_of(file_.nodes[unknown.back()]);
        places_[unknown.back()] = place;
    }
    return place;
}

Result<const std::vector<glm::dmat4>*> GltfSkins::joints_of(int skin) {
    const std::string who = "skin " + std::to_string(skin);
    if (!has(file_.skins, skin) || at(file_.skins, skin).joints.empty())
        return invalid_gltf(who + " does not exist, or has no joints");
    const tinygltf::Skin& from = at(file_.skins, skin);
    const auto [it, is_new] = joints_.try_emplace(skin);
    if (!is_new)
        return &it->second;
    std::vector<glm::dmat4> inverse(from.joints.size(), glm::dmat4(1.0));
    if (from.inverseBindMatrices >= 0)
        TESSERA_TRY(read_accessor(file_, from.inverseBindMatrices, 16, 16,
                                  [&](std::size_t i, int c, double x) {
                                      if (i < inverse.size())
                                          inverse[i][c / 4][c % 4] = x;
                                  })
                        .status()
                        .with_context(who));
    for (std::size_t i = 0; i < inverse.size(); ++i) {
        TESSERA_TRY_ASSIGN(const glm::dmat4 place, place_of(from.joints[i]).with_context(who));
        it->second.push_back(place * inverse[i]);
    }
    return &it->second;
}

Status GltfSkins::apply(int skin, ModelPart& part) {
    TESSERA_TRY_ASSIGN(const std::vector<glm::dmat4>* const joints, joints_of(skin));
    std::vector<bool> is_mirrored(part.positions.size(), false);
    for (const SkinUse& use : part.skin)
        if (use.joints.size() != part.positions.size() ||
            use.weights.size() != part.positions.size())
            return invalid_gltf(part.name +
                                " has other numbers of joints or weights than vertices");
    for (std::size_t i = 0; i < part.positions.size(); ++i) {
        TESSERA_TRY_ASSIGN(const glm::dmat4 place,
                           blended(part, i, *joints).with_context(part.name));
        const glm::dmat3 linear(place);
        part.positions[i] = glm::vec3(glm::dvec3(place * glm::dvec4(part.positions[i], 1.0)));
        is_mirrored[i] = glm::determinant(linear) < 0.0;
        // The lengths of the file's vectors do not matter, so that no scale can make them 0.
        if (i < part.normals.size())
            part.normals[i] = unit_or_zero(cofactors(linear) * glm::dvec3(part.normals[i]));
        if (i < part.tangents.size())
            part.tangents[i] =
                glm::vec4(unit_or_zero(linear * glm::dvec3(part.tangents[i])), part.tangents[i].w);
    }
    for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3)
        if (part.indices[i] < is_mirrored.size() && is_mirrored[part.indices[i]])
            std::swap(part.indices[i + 1], part.indices[i + 2]);
    return {};
}

} // namespace tessera::corpus
