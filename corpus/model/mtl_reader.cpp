// The reader uses the statements newmtl, Kd, Ke, Ns, d, Tr, Pr, Pm, Pc, Pcr, map_Kd, map_Ke, map_d,
// map_Pr, map_Pm, norm and map_Bump. It notes other maps, sheen and anisotropy.
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

// The path of a picture that a .mtl file in `folder` names. Absolute paths are often those of
// another computer, on which the picture lay beside the model.
std::string picture_path(const std::string& folder, std::string_view name) {
    const std::string text = with_slashes(name);
    const std::string usual = folder + "/" + text,
                      beside = folder + "/" + text.substr(text.rfind('/') + 1);
    return !is_there(usual) && is_there(beside) ? beside : usual;
}

// Where the options of map_Kd put the picture: its place is scale * uv + offset, with v upwards.
TextureUse placed_by(std::string_view rest) {
    TextureUse use;
    glm::dvec2 scale(1.0), offset(0.0);
    const std::vector<std::string_view> words = words_of(rest);
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
        if (words[i] == "-clamp" && words[i + 1] == "on")
            use.wrap_u = use.wrap_v = Wrap::clamp;
        if (words[i] != "-s" && words[i] != "-o")
            continue;
        glm::dvec2& pair = words[i] == "-s" ? scale : offset;
        for (std::size_t k = 0; k < 2 && i + 1 + k < words.size(); ++k)
            if (double number = 0; parse_real(words[i + 1 + k], number) && std::abs(number) < 1e6)
                pair[static_cast<glm::length_t>(k)] = number;
            else
                break;
    }
    use.turn = glm::dmat2(scale.x, 0.0, 0.0, scale.y);
    use.offset = {offset.x, 1.0 - scale.y - offset.y}; // v downwards
    return use;
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
        {"ps", 0.0}, {"aniso", 0.0}, {"anisor", 0.0}};
    glm::dvec3 filter(1.0);
    if (keyword == "tf") // all of it, or none
        return read_colour(rest, filter) && filter != glm::dvec3(1.0) && filter != glm::dvec3(0.0);
    const auto it = usual.find(keyword);
    double number = 0;
    return it != usual.end() && parse_real(take_word(rest), number) && number != it->second;
}

bool lies_plainly(const TextureUse& use) {
    return use.turn == glm::dmat2(1.0) && use.offset == glm::dvec2(0.0) &&
           use.wrap_u == Wrap::repeat && use.wrap_v == Wrap::repeat;
}

// Pictures that were joined, by a channel and the indices of both: many materials may share them.
using JoinedPictures = std::map<std::array<int, 3>, int>;

// The texel of `image` at the place of texel (x, y) of another one.
const std::array<std::uint8_t, 4>& texel_of(const Image& image, std::size_t x, std::size_t y,
                                            const Image& other) {
    return image
        .texels[y * image.height / other.height * image.width + x * image.width / other.width];
}

// The first picture, in the size of the one with more texels.
Image larger_of(const Image& picture, const Image& other) {
    if (picture.texels.size() >= other.texels.size())
        return picture;
    Image larger = other;
    for (std::size_t y = 0; y < larger.height; ++y)
        for (std::size_t x = 0; x < larger.width; ++x)
            larger.texels[y * larger.width + x] = texel_of(picture, x, y, larger);
    return larger;
}

// Joins both maps into one, as glTF has them: roughness is green, metal blue.
int joined_roughness(int roughness, int metal, std::vector<Image>& images) {
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
                joined.texels[y * joined.width + x][channel] = texel_of(one, x, y, joined)[0];
    }
    images.push_back(std::move(joined));
    return static_cast<int>(images.size()) - 1;
}

void take_roughness(const MtlMaterial& from, ModelBuilder& builder, JoinedPictures& known,
                    ModelMaterial& m) {
    const auto add = [&](const std::string& path) {
        return path.empty() ? -1 : builder.add_image_or_note(path);
    };
    const int roughness = add(from.roughness_picture), metal = add(from.metal_picture);
    if (roughness < 0 && metal < 0)
        return;
    // Exporters write any number beside a map.
    m.roughness = roughness >= 0 ? 1.0 : m.roughness;
    m.metal = metal >= 0 ? 1.0 : m.metal;
    const auto [at, is_new] = known.try_emplace({1, roughness, metal}, -1);
    if (is_new)
        at->second = joined_roughness(roughness, metal, builder.model().images);
    m.metal_roughness_texture.image = at->second;
}

// The colours of one picture with the opacity of another, which is in its alpha if it has any.
int joined_opacity(int colours, int opacity, std::vector<Image>& images) {
    const Image& one = images[static_cast<std::size_t>(opacity)];
    const bool has_alpha =
        std::ranges::any_of(one.texels, [](const auto& texel) { return texel[3] != 255; });
    if (has_alpha && opacity == colours) // exporters name the same picture twice
        return colours;
    Image joined = colours >= 0 ? larger_of(images[static_cast<std::size_t>(colours)], one) : one;
    for (std::size_t y = 0; y < joined.height; ++y)
        for (std::size_t x = 0; x < joined.width; ++x) {
            auto& texel = joined.texels[y * joined.width + x];
            const std::uint8_t share = texel_of(one, x, y, joined)[has_alpha ? 3 : 0];
            if (colours < 0)
                texel = {255, 255, 255, 255};
            texel[3] = share;
        }
    images.push_back(std::move(joined));
    return static_cast<int>(images.size()) - 1;
}

void take_opacity(const MtlMaterial& from, ModelBuilder& builder, JoinedPictures& known,
                  ModelMaterial& m) {
    m.base.a = from.opacity;
    m.blends = from.opacity < 1.0;
    const int opacity =
        from.opacity_picture.empty() ? -1 : builder.add_image_or_note(from.opacity_picture);
    if (opacity < 0)
        return;
    m.blends = true;
    const int colours = m.base_texture.image;
    const auto [at, is_new] = known.try_emplace({3, colours, opacity}, -1);
    if (is_new)
        at->second = joined_opacity(colours, opacity, builder.model().images);
    m.base_texture = from.placed;
    m.base_texture.image = at->second;
}

} // namespace

bool MtlMaterial::read(const std::string& keyword, std::string_view rest,
                       const std::string& folder) {
    if (keyword == "kd" || keyword == "ke")
        return read_colour(rest, keyword == "kd" ? diffuse : emission);
    double number = 0;
    if (keyword == "ns" || keyword == "pr" || keyword == "pm" || keyword == "pc" ||
        keyword == "pcr" || keyword == "d" || keyword == "tr") {
        std::string_view words = rest;
        std::string_view first = take_word(words);
        if (keyword == "d" && first == "-halo")
            first = take_word(words);
        if (!parse_real(first, number))
            return false;
        if (keyword == "d" || keyword == "tr") {
            // Some exporters write 0 for opaque and for transparent. Nobody models what nobody
            // sees.
            const double share = std::clamp(keyword == "d" ? number : 1.0 - number, 0.0, 1.0);
            if (share > 0.0)
                opacity = share;
            else
                ignored.insert(keyword);
        } else if (keyword == "ns")
            exponent = number;
        else if (keyword == "pc" || keyword == "pcr")
            (keyword == "pc" ? clear : clear_roughness) = std::clamp(number, 0.0, 1.0);
        else
            (keyword == "pr" ? roughness : metal) = number;
    }
    if (is_ignored(keyword, rest))
        ignored.insert(keyword);
    if (keyword != "map_kd" && keyword != "map_d" && !lies_plainly(placed_by(rest)))
        ignored.insert("-s, -o or -clamp of " + keyword.substr(0, longest_shown));
    const auto path = [&] { return picture_path(folder, texture_name(rest)); };
    if (keyword == "map_kd") {
        picture = path();
        placed = placed_by(rest);
    } else if (keyword == "map_d") {
        opacity_picture = path();
        if (picture.empty())
            placed = placed_by(rest);
    } else if (keyword == "map_ke")
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
    TESSERA_TRY_ASSIGN(auto raw, read_whole_file(path, most_model_bytes));
    const auto bytes = utf8_of(std::move(raw));
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
    JoinedPictures joined;
    for (const MtlMaterial& from : materials_) {
        ModelMaterial m = plain_material(from.diffuse, from.exponent);
        m.emission = linear_colour(from.emission);
        const auto is_share = [](const auto& x) { return x && *x >= 0.0 && *x <= 1.0; };
        if (is_share(from.roughness))
            m.roughness = *from.roughness;
        if (is_share(from.metal))
            m.metal = *from.metal;
        if (!from.picture.empty()) {
            m.base_texture = from.placed;
            m.base_texture.image = builder.add_image_or_note(from.picture);
            if (m.base_texture.image >= 0)
                m.base = glm::dvec4(1.0); // exporters write black beside a texture
        }
        take_opacity(from, builder, joined, m);
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
        take_roughness(from, builder, joined, m);
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
