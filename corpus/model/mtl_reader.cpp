// The reader uses the statements newmtl, Kd, Ke, Ns, Pr, Pm, Pc, Pcr, map_Kd, map_Ke, map_Pr, map_Pm,
// norm and map_Bump. It notes other maps, transparency, sheen and anisotropy.
#include "corpus/model/mtl_reader.h"

#include "corpus/model/bump_map.h"
#include "corpus/model/obj_text.h"
#include "corpus/model/polygons.h"
#include "corpus/model/readers.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

std::string_view without_quotes(std::string_view name) {
    const bool is_quoted = name.size() >= 2 && name.front() == '"' && name.back() == '"';
    return is_quoted ? name.substr(1, name.size() - 2) : name;
}

// The file name that follows the options of a statement such as map_Kd.
std::string_view texture_name(std::string_view rest) {
    static const std::map<std::string_view, int> most_values = {
        {"-blendu", 1}, {"-blendv", 1},  {"-boost", 1},  {"-bm", 1},   {"-cc", 1},
        {"-clamp", 1},  {"-imfchan", 1}, {"-texres", 1}, {"-type", 1}, {"-mm", 2},
        {"-o", 3},      {"-s", 3},       {"-t", 3}};
    for (;;) {
        std::string_view after = rest;
        const auto option = most_values.find(take_word(after));
        if (option == most_values.end())
            return without_quotes(trimmed(rest));
        take_word(after);
        for (int i = 1; i < option->second; ++i) { // the last numbers may be missing
            std::string_view next = after;
            if (double number = 0; !parse_real(take_word(next), number))
                break;
            after = next;
        }
        rest = after;
    }
}

// The path of a picture that a .mtl file in `folder` names. Absolute paths are often those of another
// computer, on which the picture lay beside the model.
std::string picture_path(const std::string& folder, std::string_view name) {
    const std::string text = with_slashes(name);
    const std::string usual = folder + "/" + text,
                      beside = folder + "/" + text.substr(text.rfind('/') + 1);
    return !is_there(usual) && is_there(beside) ? beside : usual;
}

bool read_bump(std::string_view rest, const std::string& path, MtlMaterial& m) {
    m.bump_picture = path;
    const std::vector<std::string_view> words = words_of(rest);
    const auto option = std::find(words.begin(), words.end(), "-bm");
    return words.end() - option < 2 ||
           (parse_real(option[1], m.bump_scale) && std::abs(m.bump_scale) <= 10.0);
}

// A single number is a grey.
bool read_colour(std::string_view rest, glm::dvec3& colour) {
    const std::vector<std::string_view> words = words_of(rest);
    for (std::size_t c = 0; c < 3; ++c)
        if (words.empty() ||
            !parse_real(words[words.size() < 3 ? 0 : c], colour[static_cast<glm::length_t>(c)]))
            return false;
    return true;
}

// Statements without an effect here. Exporters write all of them; few values change anything.
bool is_ignored(const std::string& keyword, std::string_view rest) {
    static const std::map<std::string_view, double> usual = {
        {"d", 1.0}, {"tr", 0.0}, {"ps", 0.0}, {"aniso", 0.0}, {"anisor", 0.0}};
    glm::dvec3 filter(1.0);
    if (keyword == "tf") // all of it, or none
        return read_colour(rest, filter) && filter != glm::dvec3(1.0) && filter != glm::dvec3(0.0);
    const auto it = usual.find(keyword);
    double number = 0;
    return it != usual.end() && parse_real(take_word(rest), number) && number != it->second;
}

// Joins both maps into one, as glTF has them: roughness is green, metal blue.
void take_roughness(const MtlMaterial& from, ModelBuilder& builder, ModelMaterial& m) {
    const auto add = [&](const std::string& path) {
        return path.empty() ? -1 : builder.add_image_or_note(path);
    };
    const int roughness = add(from.roughness_picture), metal = add(from.metal_picture);
    if (roughness < 0 && metal < 0)
        return;
    auto& images = builder.model().images;
    Image joined;
    for (const int image : {roughness, metal})
        if (image >= 0) { // the size of the larger one
            const Image& one = images[static_cast<std::size_t>(image)];
            if (one.texels.size() <= std::size_t{joined.width} * joined.height)
                continue;
            joined.width = one.width;
            joined.height = one.height;
        }
    joined.texels.assign(std::size_t{joined.width} * joined.height, {255, 255, 255, 255});
    for (const auto& [image, channel] : {std::pair(roughness, 1u), std::pair(metal, 2u)}) {
        if (image < 0)
            continue;
        const Image& one = images[static_cast<std::size_t>(image)];
        for (std::size_t y = 0; y < joined.height; ++y)
            for (std::size_t x = 0; x < joined.width; ++x)
                joined.texels[y * joined.width + x][channel] =
                    one.texels[y * one.height / joined.height * one.width +
                               x * one.width / joined.width][0];
    }
    m.metal_roughness_texture.image = static_cast<int>(images.size());
    images.push_back(std::move(joined));
    // Exporters write any number beside a map.
    m.roughness = roughness >= 0 ? 1.0 : m.roughness;
    m.metal = metal >= 0 ? 1.0 : m.metal;
}

} // namespace

bool MtlMaterial::read(const std::string& keyword, std::string_view rest,
                       const std::string& folder) {
    if (keyword == "kd" || keyword == "ke")
        return read_colour(rest, keyword == "kd" ? diffuse : emission);
    double number = 0;
    if (keyword == "ns" || keyword == "pr" || keyword == "pm" || keyword == "pc" ||
        keyword == "pcr") {
        if (!parse_real(take_word(rest), number))
            return false;
        if (keyword == "ns")
            exponent = number;
        else if (keyword == "pc" || keyword == "pcr")
            (keyword == "pc" ? clear : clear_roughness) = std::clamp(number, 0.0, 1.0);
        else
            (keyword == "pr" ? roughness : metal) = number;
    }
    if (is_ignored(keyword, rest))
        ignored.insert(keyword);
    const auto path = [&] { return picture_path(folder, texture_name(rest)); };
    if (keyword == "map_kd")
        picture = path();
    else if (keyword == "map_ke")
        emission_picture = path();
    else if (keyword == "map_pr")
        roughness_picture = path();
    else if (keyword == "map_pm")
        metal_picture = path();
    else if (keyword == "norm")
        normal_picture = path();
    else if (keyword == "map_bump" || keyword == "bump")
        return read_bump(rest, path(), *this);
    else if (keyword.starts_with("map_") || keyword == "disp" || keyword == "refl")
        ignored.insert(keyword.substr(0, longest_shown));
    return true;
}

Status MtlReader::read(const std::string& path) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
    const std::string folder = folder_of(path);
    LineReader lines(text_of(bytes));
    std::string joined;
    std::size_t current = materials_.size(); // no material yet
    while (!lines.at_end()) {
        std::string_view rest = next_statement(lines, joined);
        std::string keyword(take_word(rest));
        std::transform(keyword.begin(), keyword.end(), keyword.begin(),
                       [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
        rest = trimmed(rest);
        if (keyword == "newmtl") {
            current = numbers_.emplace(rest, materials_.size()).first->second;
            materials_.resize(std::max(materials_.size(), current + 1));
        } else if (current < materials_.size() &&
                   !materials_[current].read(keyword, rest, folder)) {
            return wrong_line(lines, in_quotes(rest) + " is no value of " + in_quotes(keyword))
                .with_context(path);
        }
    }
    return {};
}

std::uint32_t MtlReader::find(std::string_view name) const {
    const auto it = numbers_.find(name);
    return it == numbers_.end() ? 0 : static_cast<std::uint32_t>(it->second) + 1;
}

void MtlReader::finish(ModelBuilder& builder) const {
    builder.model().materials.push_back(plain_material(MtlMaterial().diffuse));
    std::map<std::string, std::size_t> ignored; // statements, with the number of their materials
    BumpMaps bumps;
    for (const MtlMaterial& from : materials_) {
        ModelMaterial m = plain_material(from.diffuse, from.exponent);
        m.emission = linear_colour(from.emission);
        const auto is_share = [](const auto& x) { return x && *x >= 0.0 && *x <= 1.0; };
        if (is_share(from.roughness))
            m.roughness = *from.roughness;
        if (is_share(from.metal))
            m.metal = *from.metal;
        if (!from.picture.empty()) {
            m.base_texture.image = builder.add_image_or_note(from.picture);
            if (m.base_texture.image >= 0)
                m.base = glm::dvec4(1.0); // exporters write black beside a texture
        }
        if (!from.emission_picture.empty()) {
            m.emission_texture.image = builder.add_image_or_note(from.emission_picture);
            if (m.emission_texture.image >= 0 && m.emission == glm::dvec3(0.0))
                m.emission = glm::dvec3(1.0);
        }
        if (!from.normal_picture.empty())
            m.normal_texture.image = builder.add_image_or_note(from.normal_picture);
        else if (!from.bump_picture.empty())
            bumps.take(from.bump_picture, from.bump_scale, builder, m);
        if (from.clear > 0.0) {
            m.coats = ModelCoats{};
            m.coats->clear = from.clear;
            m.coats->clear_roughness = from.clear_roughness;
        }
        take_roughness(from, builder, m);
        builder.model().materials.push_back(m);
        for (const std::string& statement : from.ignored)
            ++ignored[statement];
    }
    bumps.note(builder.model().notes);
    for (const auto& [statement, count] : ignored)
        builder.model().notes.push_back(statement + " (" + std::to_string(count) +
                                        (count == 1 ? " material" : " materials") +
                                        ") is not supported and is ignored");
}

} // namespace tessera::corpus
