#include "corpus/model/gltf_coats.h"

namespace tessera::corpus {
namespace {

using CoatValue = tinygltf::Value;

double share_or(const CoatValue& object, const char* key, double otherwise) {
    return std::clamp(number_or(object, key, otherwise), 0.0, 1.0);
}

class CoatReader {
public:
    CoatReader(const tinygltf::Model& file, const tinygltf::Material& from, const std::string& who,
               std::vector<std::string>& notes)
        : file_(file), from_(from), who_(who), notes_(notes) {}

    Result<std::optional<ModelCoats>> read() {
        TESSERA_TRY(read_clear());
        TESSERA_TRY(read_sheen());
        TESSERA_TRY(read_anisotropy());
        TESSERA_TRY(read_film());
        TESSERA_TRY(read_through());
        return is_coated_ ? std::optional(coats_) : std::nullopt;
    }

private:
    const CoatValue* find(const char* name) {
        const CoatValue* extension = extension_of(from_.extensions, name);
        is_coated_ = is_coated_ || extension;
        return extension;
    }
    Status texture(const CoatValue& extension, const char* key, TextureUse& use) {
        TESSERA_TRY_ASSIGN(use, extension_texture(file_, extension, key, who_, notes_));
        return {};
    }

    Status read_clear() {
        const CoatValue* e = find("KHR_materials_clearcoat");
        if (!e)
            return {};
        coats_.clear = share_or(*e, "clearcoatFactor", 0.0);
        coats_.clear_roughness = share_or(*e, "clearcoatRoughnessFactor", 0.0);
        TESSERA_TRY(texture(*e, "clearcoatTexture", coats_.clear_texture));
        TESSERA_TRY(texture(*e, "clearcoatRoughnessTexture", coats_.clear_roughness_texture));
        TESSERA_TRY(texture(*e, "clearcoatNormalTexture", coats_.clear_normal_texture));
        if (coats_.clear_normal_texture.image >= 0)
            coats_.clear_normal_scale =
                std::clamp(number_or(e->Get("clearcoatNormalTexture"), "scale", 1.0), -10.0, 10.0);
        return {};
    }

    Status read_sheen() {
        const CoatValue* e = find("KHR_materials_sheen");
        if (!e)
            return {};
        coats_.sheen =
            glm::min(colour_or(*e, "sheenColorFactor", glm::dvec3(0.0)), glm::dvec3(1.0));
        coats_.sheen_roughness = share_or(*e, "sheenRoughnessFactor", 0.0);
        TESSERA_TRY(texture(*e, "sheenColorTexture", coats_.sheen_texture));
        return texture(*e, "sheenRoughnessTexture", coats_.sheen_roughness_texture);
    }

    Status read_anisotropy() {
        const CoatValue* e = find("KHR_materials_anisotropy");
        if (!e)
            return {};
        coats_.anisotropy = share_or(*e, "anisotropyStrength", 0.0);
        coats_.rotation = number_or(*e, "anisotropyRotation", 0.0);
        if (!(std::abs(coats_.rotation) <= 1e6))
            return invalid_gltf(who_ + ": anisotropyRotation is not an angle");
        return texture(*e, "anisotropyTexture", coats_.anisotropy_texture);
    }

    Status read_film() {
        const CoatValue* e = find("KHR_materials_iridescence");
        if (!e)
            return {};
        const auto nanometres = [&](const char* key, double otherwise) {
            return std::clamp(number_or(*e, key, otherwise), 0.0, 1e5);
        };
        coats_.film = share_or(*e, "iridescenceFactor", 0.0);
        coats_.film_ior = std::clamp(number_or(*e, "iridescenceIor", 1.3), 1.0, 10.0);
        coats_.film_least = nanometres("iridescenceThicknessMinimum", 100.0);
        coats_.film_most = nanometres("iridescenceThicknessMaximum", 400.0);
        TESSERA_TRY(texture(*e, "iridescenceTexture", coats_.film_texture));
        return texture(*e, "iridescenceThicknessTexture", coats_.film_thickness_texture);
    }

    // Rays find how thick a volume is, so its thickness only says whether it is one.
    Status read_through() {
        if (const CoatValue* e = find("KHR_materials_transmission")) {
            coats_.through = share_or(*e, "transmissionFactor", 0.0);
            TESSERA_TRY(texture(*e, "transmissionTexture", coats_.through_texture));
        }
        if (const CoatValue* e = find("KHR_materials_volume")) {
            coats_.is_volume = number_or(*e, "thicknessFactor", 0.0) > 0.0;
            coats_.attenuation =
                glm::min(colour_or(*e, "attenuationColor", glm::dvec3(1.0)), glm::dvec3(1.0));
            if (const double distance = number_or(*e, "attenuationDistance", 0.0); distance > 0.0)
                coats_.attenuation_distance = std::clamp(distance, 1e-9, 1e12);
        }
        return {};
    }

    const tinygltf::Model& file_;
    const tinygltf::Material& from_;
    const std::string& who_;
    std::vector<std::string>& notes_;
    ModelCoats coats_;
    bool is_coated_ = false;
};

} // namespace

Result<std::optional<ModelCoats>> read_coats(const tinygltf::Model& file,
                                             const tinygltf::Material& from, const std::string& who,
                                             std::vector<std::string>& notes) {
    return CoatReader(file, from, who, notes).read();
}

} // namespace tessera::corpus
