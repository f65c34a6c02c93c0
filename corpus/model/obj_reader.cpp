// Wavefront .obj and .mtl. The reader uses the statements v (also with colours), vt, vn, f, usemtl,
// mtllib, g and o of .obj files, and newmtl, Kd, Ke, Ns, Pr, Pm, map_Kd, map_Ke and norm of .mtl
// files. It notes other maps.
#include "corpus/model/polygons.h"
#include "corpus/model/readers.h"
#include "corpus/model/text_lines.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

namespace tessera::corpus {
namespace {

Status wrong_line(const LineReader& lines, const std::string& what) {
    return {ErrorCode::invalid_file, "line " + std::to_string(lines.number()) + ": " + what};
}

std::string_view text_of(const std::vector<unsigned char>& bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0); // a byte order mark
}

// The next line, joined with the lines below it as long as it ends with a backslash. `joined` holds
// the text of joined lines.
std::string_view next_statement(LineReader& lines, std::string& joined) {
    std::string_view line = lines.next();
    if (!line.ends_with('\\'))
        return line;
    joined.clear();
    for (; line.ends_with('\\'); line = lines.next())
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
    return joined.append(line);
}

// Some exporters write a decimal comma.
bool parse_real(std::string_view word, double& number) {
    std::string text(word);
    std::replace(text.begin(), text.end(), ',', '.');
    return parse_word(text, number);
}

// Exporters on Windows write backslashes.
std::string with_slashes(std::string_view path) {
    std::string text(path);
    std::replace(text.begin(), text.end(), '\\', '/');
    return text;
}

bool exists(const std::string& path) {
    std::error_code error;
    return std::filesystem::exists(path, error);
}

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
    return !exists(usual) && exists(beside) ? beside : usual;
}

// The statements of one material in a .mtl file. Colours are display-referred.
struct MtlMaterial {
    glm::dvec3 diffuse{0.6}, emission{0.0};
    double exponent = 0.0;
    std::optional<double> roughness, metal;
    std::string picture, emission_picture, normal_picture;
    std::set<std::string> ignored_maps;

    // Returns false if `rest` is not a value of the keyword, which is in lower case.
    bool read(const std::string& keyword, std::string_view rest, const std::string& folder) {
        if (keyword == "kd" || keyword == "ke")
            return read_colour(rest, keyword == "kd" ? diffuse : emission);
        double number = 0;
        if (keyword == "ns" || keyword == "pr" || keyword == "pm") {
            if (!parse_real(take_word(rest), number))
                return false;
            if (keyword == "ns")
                exponent = number;
            else
                (keyword == "pr" ? roughness : metal) = number;
        }
        const auto path = [&] { return picture_path(folder, texture_name(rest)); };
        if (keyword == "map_kd")
            picture = path();
        else if (keyword == "map_ke")
            emission_picture = path();
        else if (keyword == "norm")
            normal_picture = path();
        else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "disp" ||
                 keyword == "refl")
            ignored_maps.insert(keyword.substr(0, longest_shown));
        return true;
    }

private:
    // A single number is a grey.
    static bool read_colour(std::string_view rest, glm::dvec3& colour) {
        const std::vector<std::string_view> words = words_of(rest);
        for (std::size_t c = 0; c < 3; ++c)
            if (words.empty() ||
                !parse_real(words[words.size() < 3 ? 0 : c], colour[static_cast<glm::length_t>(c)]))
                return false;
        return true;
    }
};

// The materials of all .mtl files of one .obj file.
class MtlReader {
public:
    Status read(const std::string& path) {
        TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
        const std::string folder = folder_of(path);
        LineReader lines(text_of(bytes));
        std::string joined;
        std::size_t current = materials_.size(); // no material yet
        while (!lines.at_end()) {
            std::string_view rest = next_statement(lines, joined);
            std::string keyword(take_word(rest));
            std::transform(keyword.begin(), keyword.end(), keyword.begin(), [](char c) {
                return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
            });
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

    // The index of the material in the model; 0 if no material has this name.
    std::uint32_t find(std::string_view name) const {
        const auto it = numbers_.find(name);
        return it == numbers_.end() ? 0 : static_cast<std::uint32_t>(it->second) + 1;
    }

    // Adds a grey material, for faces without a known one, and the materials of the files.
    void finish(ModelBuilder& builder) const {
        builder.model().materials.push_back(plain_material(MtlMaterial().diffuse));
        std::map<std::string, std::size_t> ignored; // maps, with the number of their materials
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
            builder.model().materials.push_back(m);
            for (const std::string& map : from.ignored_maps)
                ++ignored[map];
        }
        for (const auto& [map, count] : ignored)
            builder.model().notes.push_back(map + " (" + std::to_string(count) +
                                            (count == 1 ? " material" : " materials") +
                                            ") is not supported and is ignored");
    }

private:
    std::vector<MtlMaterial> materials_;
    std::map<std::string, std::size_t, std::less<>> numbers_;
};

class ObjReader {
public:
    ObjReader(const std::string& path, ModelBuilder& builder) : path_(path), builder_(builder) {}

    Status read(std::string_view text) {
        LineReader lines(text);
        std::string joined;
        while (!lines.at_end()) {
            std::string_view rest = next_statement(lines, joined);
            const std::string_view keyword = take_word(rest);
            rest = trimmed(rest);
            if (keyword == "v" || keyword == "vt" || keyword == "vn") {
                TESSERA_TRY(read_numbers(lines, keyword, rest));
            } else if (keyword == "f") {
                TESSERA_TRY(read_face(lines, rest));
            } else if (keyword == "mtllib") {
                TESSERA_TRY(read_library(rest));
            } else if (keyword == "usemtl") {
                part_ends_ = part_ends_ || material_ != rest;
                material_ = rest;
            } else if (keyword == "g" || keyword == "o") {
                part_ends_ = true;
            }
        }
        for (std::size_t i = 0; i < model_.meshes.size(); ++i)
            model_.meshes[i].material = library_.find(names_[i]);
        if (!model_.colours.empty())
            model_.colours.resize(model_.positions.size(), glm::vec4(1.0f));
        library_.finish(builder_);
        return add_polygons(model_, builder_);
    }

private:
    Status read_numbers(const LineReader& lines, std::string_view keyword, std::string_view rest) {
        std::array<double, 6> x{};
        std::size_t count = 0;
        for (; count < x.size() && !(rest = trimmed(rest)).empty() && rest[0] != '#'; ++count)
            if (const std::string_view word = take_word(rest); !parse_real(word, x[count]))
                return wrong_line(lines, in_quotes(word) + " is not a number");
        if (count < (keyword == "vt" ? 1 : 3))
            return wrong_line(lines, in_quotes(keyword) + " has too few numbers");
        if (keyword == "vt") {
            const auto finite = [](double value) { return std::isfinite(value) ? value : 0.0; };
            model_.uv.emplace_back(finite(x[0]), 1.0 - finite(x[1])); // v grows upwards in files
        } else if (keyword == "vn") {
            model_.normals.emplace_back(x[0], x[1], x[2]);
        } else {
            if (count == 4) // homogeneous coordinates
                x = {x[0] / x[3], x[1] / x[3], x[2] / x[3]};
            model_.positions.emplace_back(x[0], x[1], x[2]);
            if (count == 6) {
                model_.colours.resize(model_.positions.size() - 1, glm::vec4(1.0f));
                model_.colours.emplace_back(linear_colour({x[3], x[4], x[5]}), 1.0f);
            }
        }
        return {};
    }

    Status read_face(const LineReader& lines, std::string_view rest) {
        corners_.clear();
        while (!(rest = trimmed(rest)).empty() && rest[0] != '#') {
            const std::string_view word = take_word(rest);
            PolygonCorner corner;
            if (!read_corner(word, corner))
                return wrong_line(lines, in_quotes(word) + " is not the corner of a face");
            corners_.push_back(corner);
        }
        if (part_ends_ || model_.meshes.empty()) {
            model_.meshes.emplace_back();
            names_.push_back(material_);
            part_ends_ = false;
        }
        model_.meshes.back().add(corners_);
        return {};
    }

    // `word` is position, position/uv, position//normal or position/uv/normal. Numbers count from
    // 1; negative numbers count backwards from the last value read.
    bool read_corner(std::string_view word, PolygonCorner& corner) const {
        const std::pair<std::uint32_t*, std::size_t> parts[] = {
            {&corner.position, model_.positions.size()},
            {&corner.uv, model_.uv.size()},
            {&corner.normal, model_.normals.size()}};
        for (const auto& [index, count] : parts) {
            const std::string_view part = word.substr(0, word.find('/'));
            word.remove_prefix(std::min(part.size() + 1, word.size()));
            std::int64_t number = 0;
            if (part.empty() && index != &corner.position)
                continue;
            if (!parse_word(part, number) || number == 0)
                return false;
            number += number > 0 ? -1 : static_cast<std::int64_t>(count);
            if (number >= 0 && number < absent)
                *index = static_cast<std::uint32_t>(number);
        }
        return word.empty();
    }

    // `names` is one name with spaces or several names. If no such file exists, the .mtl file with
    // the name of the .obj file is read.
    Status read_library(std::string_view names) {
        if (!libraries_.emplace(names).second)
            return {};
        const std::string folder = folder_of(path_) + "/";
        std::vector<std::string> found;
        if (const std::string whole = folder + with_slashes(names); exists(whole))
            found.push_back(whole);
        else
            for (const std::string_view word : words_of(names))
                if (const std::string path = folder + with_slashes(word); exists(path))
                    found.push_back(path);
        if (const std::string beside = path_.substr(0, path_.size() - 3) + "mtl";
            found.empty() && exists(beside))
            found.push_back(beside);
        if (found.empty())
            builder_.model().notes.push_back("the material file " + in_quotes(names) +
                                             " is missing; its materials are grey");
        for (const std::string& path : found)
            if (libraries_.insert(std::filesystem::canonical(path)).second)
                TESSERA_TRY(library_.read(path));
        return {};
    }

    const std::string& path_;
    ModelBuilder& builder_;
    MtlReader library_;
    std::set<std::string> libraries_; // names and paths that have been read
    PolygonModel model_;
    std::vector<std::string> names_;     // of the material of each mesh
    std::string material_;               // of the next faces
    bool part_ends_ = false;             // the next face begins a new mesh
    std::vector<PolygonCorner> corners_; // of one face
};

} // namespace

Status read_obj(const std::string& path, ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY(check_is_model(bytes));
    return ObjReader(path, builder).read(text_of(bytes));
}

} // namespace tessera::corpus
