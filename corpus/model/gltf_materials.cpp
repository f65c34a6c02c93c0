#include "corpus/model/gltf_materials.h"

#include "corpus/model/gltf_coats.h"
#include "corpus/model/gltf_images.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>

namespace tessera::corpus {
namespace {

using Value = tinygltf::Value;

constexpr const char* basisu_name = "KHR_texture_basisu";

// The matrix and offset of KHR_texture_transform. Rotation is counter-clockwise as seen in the
// picture, whose v grows downwards.
void transform_uv(const Value& extension, TextureUse& use) {
    const glm::dvec2 scale = pair_or(extension, "scale", {1.0, 1.0});
    const double angle = number_or(extension, "rotation", 0.0);
    const double c = std::cos(angle), s = std::sin(angle);
    use.turn = glm::dmat2(c * scale.x, -s * scale.x, s * scale.y, c * scale.y);
    use.offset = pair_or(extension, "offset", {0.0, 0.0});
}

bool is_bounded(const TextureUse& use) {
    constexpr double most = 1e6; // texture places keep their fractions
    for (int column = 0; column < 2; ++column)
        for (int row = 0; row < 2; ++row)
            if (!(std::abs(use.turn[column][row]) <= most))
                return false;
    return std::abs(use.offset.x) <= most && std::abs(use.offset.y) <= most;
}

// The image of a texture: WebP, which Tessera reads, before the fallback, and that before KTX2, beside
// which may lie another picture; -1: none.
int image_of(const tinygltf::Model& file, const tinygltf::Texture& texture) {
    const auto extended = [&](const char* name) {
        const Value* extension = extension_of(texture.extensions, name);
        const double source = extension ? number_or(*extension, "source", -1.0) : -1.0;
        return source >= 0 && source < static_cast<double>(file.images.size())
                   ? static_cast<int>(source)
                   : -1;
    };
    if (const int webp = extended("EXT_texture_webp"); webp >= 0)
        return webp;
    return has(file.images, texture.source) ? texture.source : extended(basisu_name);
}

Result<TextureUse> texture_use(const tinygltf::Model& file, int texture, int uv,
                               const tinygltf::ExtensionMap& extensions, const std::string& who,
                               std::vector<std::string>& notes) {
    TextureUse use;
    if (texture < 0)
        return use;
    if (!has(file.textures, texture))
        return invalid_gltf(who + " has texture " + std::to_string(texture) + " of " +
                            std::to_string(file.textures.size()));
    const tinygltf::Texture& t = at(file.textures, texture);
    use.image = image_of(file, t);
    if (use.image < 0)
        notes.push_back("texture " + std::to_string(texture) + " has no image that can be read; " +
                        who + " is read without it");
    if (const Value* extension = extension_of(extensions, "KHR_texture_transform")) {
        transform_uv(*extension, use);
        if (!is_bounded(use))
            return invalid_gltf(who + ": KHR_texture_transform is not a number, or too large");
        uv = static_cast<int>(number_or(*extension, "texCoord", uv));
    }
    if (uv < 0)
        return invalid_gltf(who + " uses TEXCOORD_" + std::to_string(uv));
    use.uv = static_cast<unsigned>(uv); // choose_sets() makes it an index into ModelVertex::uv
    if (has(file.samplers, t.sampler)) {
        const auto wrap_of = [](int mode) {
            return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::clamp
                   : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror
                                                                   : Wrap::repeat;
        };
        use.wrap_u = wrap_of(at(file.samplers, t.sampler).wrapS);
        use.wrap_v = wrap_of(at(file.samplers, t.sampler).wrapT);
    }
    return use;
}

double fourth_or(const Value& object, const char* key, double otherwise) {
    return object.Has(key) && object.Get(key).IsArray() && object.Get(key).ArrayLen() == 4
               ? listed_number(object.Get(key), 3, otherwise)
               : otherwise;
}

Result<ModelMaterial> read_material(const tinygltf::Model& file, std::size_t number,
                                    std::vector<std::string>& notes) {
    const tinygltf::Material& from = file.materials[number];
    const std::string who = "material " + std::to_string(number);
    ModelMaterial m;
    const auto& pbr = from.pbrMetallicRoughness;
    if (pbr.baseColorFactor.size() == 4)
        m.base = glm::make_vec4(pbr.baseColorFactor.data());
    m.base = glm::clamp(m.base, 0.0, 1.0);
    m.metal = std::clamp(pbr.metallicFactor, 0.0, 1.0);
    m.roughness = std::clamp(pbr.roughnessFactor, 0.0, 1.0);
    if (from.emissiveFactor.size() == 3)
        m.emission = glm::clamp(glm::dvec3(glm::make_vec3(from.emissiveFactor.data())), 0.0, 1e4);
    if (const Value* strength = extension_of(from.extensions, "KHR_materials_emissive_strength"))
        m.emission *= std::clamp(number_or(*strength, "emissiveStrength", 1.0), 0.0, 1e4);
    m.normal_scale = std::clamp(from.normalTexture.scale, -10.0, 10.0);
    m.cutoff = from.alphaMode == "MASK" ? std::clamp(from.alphaCutoff, 0.0, 1.0) : 0.0;
    m.blends = from.alphaMode == "BLEND";
    m.double_sided = from.doubleSided;
    const auto use = [&](const auto& texture) {
        return texture_use(file, texture.index, texture.texCoord, texture.extensions, who, notes);
    };
    TESSERA_TRY_ASSIGN(m.base_texture, use(pbr.baseColorTexture));
    TESSERA_TRY_ASSIGN(m.metal_roughness_texture, use(pbr.metallicRoughnessTexture));
    TESSERA_TRY_ASSIGN(m.normal_texture, use(from.normalTexture));
    TESSERA_TRY_ASSIGN(m.emission_texture, use(from.emissiveTexture));
    m.is_unlit = from.extensions.contains("KHR_materials_unlit");
    if (const Value* ior = extension_of(from.extensions, "KHR_materials_ior")) {
        // 0 stands for an infinite index.
        const double index = std::clamp(number_or(*ior, "ior", 1.5), 0.0, 1e6);
        const double root = index == 0.0 ? 1.0 : (index - 1.0) / (index + 1.0);
        m.reflectance = index == 1.5 ? usual_reflectance : root * root;
        m.ior = std::max(index, 1.0);
    }
    const auto extended_use = [&](const Value& extension, const char* key) {
        return extension_texture(file, extension, key, who, notes);
    };
    if (const Value* specular = extension_of(from.extensions, "KHR_materials_specular")) {
        m.specular = std::clamp(number_or(*specular, "specularFactor", 1.0), 0.0, 1.0);
        m.specular_colour = colour_or(*specular, "specularColorFactor", glm::dvec3(1.0));
        TESSERA_TRY_ASSIGN(m.specular_texture, extended_use(*specular, "specularTexture"));
        TESSERA_TRY_ASSIGN(m.specular_colour_texture,
                           extended_use(*specular, "specularColorTexture"));
    }
    if (const Value* gloss = extension_of(from.extensions, "KHR_materials_pbrSpecularGlossiness")) {
        m.has_glossiness = true;
        m.base = glm::clamp(glm::dvec4(colour_or(*gloss, "diffuseFactor", glm::dvec3(1.0)),
                                       fourth_or(*gloss, "diffuseFactor", 1.0)),
                            0.0, 1.0);
        m.specular_colour = colour_or(*gloss, "specularFactor", glm::dvec3(1.0));
        m.roughness = 1.0 - std::clamp(number_or(*gloss, "glossinessFactor", 1.0), 0.0, 1.0);
        TESSERA_TRY_ASSIGN(m.base_texture, extended_use(*gloss, "diffuseTexture"));
        TESSERA_TRY_ASSIGN(m.metal_roughness_texture,
                           extended_use(*gloss, "specularGlossinessTexture"));
    }
    TESSERA_TRY_ASSIGN(m.coats, read_coats(file, from, who, notes));
    return m;
}

std::vector<TextureUse*> textures_of(ModelMaterial& m) {
    std::vector<TextureUse*> all{&m.base_texture,     &m.metal_roughness_texture,
                                 &m.normal_texture,   &m.emission_texture,
                                 &m.specular_texture, &m.specular_colour_texture};
    if (m.coats)
        for (const auto texture : coat_textures)
            all.push_back(&((*m.coats).*texture));
    return all;
}

// Vertices have two sets of texture coordinates: the first two, unless pictures of the material use
// others; then those of its first pictures. Pictures with further sets are left out.
UvSets choose_sets(ModelMaterial& m, const std::string& who, std::vector<std::string>& notes) {
    const auto textures = textures_of(m);
    UvSets chosen{0, 1};
    if (std::ranges::all_of(textures, [](auto* use) { return use->image < 0 || use->uv < 2; }))
        return chosen;
    std::vector<unsigned> sets;
    for (TextureUse* use : textures) {
        if (use->image < 0)
            continue;
        const std::size_t slot =
            static_cast<std::size_t>(std::ranges::find(sets, use->uv) - sets.begin());
        if (slot == sets.size() && slot < UvSets().size())
            sets.push_back(use->uv);
        if (slot == UvSets().size()) {
            notes.push_back(who +
                            " uses more than two sets of texture coordinates; its picture in "
                            "TEXCOORD_" +
                            std::to_string(use->uv) + " is left out");
            *use = {};
        } else {
            use->uv = static_cast<unsigned>(slot);
        }
    }
    std::ranges::copy(sets, chosen.begin());
    return chosen;
}

} // namespace

Result<TextureUse> extension_texture(const tinygltf::Model& file, const tinygltf::Value& extension,
                                     const char* key, const std::string& who,
                                     std::vector<std::string>& notes) {
    if (!extension.Has(key) || !extension.Get(key).IsObject())
        return TextureUse();
    const tinygltf::Value& info = extension.Get(key);
    tinygltf::ExtensionMap extensions;
    if (info.Has("extensions") && info.Get("extensions").IsObject())
        for (const std::string& name : info.Get("extensions").Keys())
            extensions[name] = info.Get("extensions").Get(name);
    const double index = number_or(info, "index", -1.0), uv = number_or(info, "texCoord", 0.0);
    const auto whole = [](double x) { return x >= 0.0 && x < 1e6 ? static_cast<int>(x) : -1; };
    return texture_use(file, whole(index), whole(uv), extensions, who, notes);
}

Result<std::vector<UvSets>> read_materials(const tinygltf::Model& file, const std::string& folder,
                                           Model& model) {
    model.materials.emplace_back(); // glTF's default
    std::vector<UvSets> sets{{0, 1}};
    for (std::size_t i = 0; i < file.materials.size(); ++i) {
        TESSERA_TRY_ASSIGN(ModelMaterial material, read_material(file, i, model.notes));
        sets.push_back(choose_sets(material, "material " + std::to_string(i), model.notes));
        model.materials.push_back(material);
    }
    std::vector<bool> is_used(file.images.size(), false);
    for (ModelMaterial& material : model.materials)
        for (const TextureUse* use : textures_of(material))
            if (use->image >= 0)
                is_used[static_cast<std::size_t>(use->image)] = true;
    const auto fallbacks = std::ranges::count_if(file.textures, [&](const tinygltf::Texture& t) {
        return has(file.images, t.source) && t.extensions.contains(basisu_name);
    });
    if (fallbacks > 0)
        model.notes.push_back("KTX2 is not read: " + std::to_string(fallbacks) +
                              (fallbacks == 1 ? " texture has its" : " textures have their") +
                              " fallback picture");
    model.images.resize(file.images.size());
    for (std::size_t i = 0; i < file.images.size(); ++i) {
        if (!is_used[i]) {
            if (file.images[i].image.empty())
                model.notes.push_back(image_name(file.images[i], i) +
                                      " is missing, and nothing uses it");
            continue;
        }
        Result<Image> image = read_image(file.images[i], i, folder, model.notes);
        if (image.ok()) {
            model.images[i] = std::move(*image);
            continue;
        }
        model.notes.push_back(image.status().message() + "; materials are read without it");
        for (ModelMaterial& material : model.materials)
            for (TextureUse* use : textures_of(material))
                if (use->image == static_cast<int>(i))
                    use->image = -1;
    }
    return sets;
}

} // namespace tessera::corpus
