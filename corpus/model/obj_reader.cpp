// Wavefront .obj. The reader uses the statements v (also with colours), vt, vn, f, usemtl, mtllib, g
// and o.
#include "corpus/model/mtl_reader.h"
#include "corpus/model/obj_text.h"
#include "corpus/model/polygons.h"
#include "corpus/model/readers.h"
#include "format/output_file.h"

#include <cmath>
#include <map>
#include <optional>

namespace tessera::corpus {
namespace {

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
        if (const std::string whole = folder + with_slashes(names); is_there(whole))
            found.push_back(whole);
        else
            for (const std::string_view word : words_of(names))
                if (const std::string path = folder + with_slashes(word); is_there(path))
                    found.push_back(path);
        if (const std::string beside = path_.substr(0, path_.size() - 3) + "mtl";
            found.empty() && is_there(beside))
            found.push_back(beside);
        if (found.empty())
            builder_.model().notes.push_back("the material file " + in_quotes(names) +
                                             " is missing; its materials are grey");
        for (const std::string& path : found)
            if (libraries_.insert(std::filesystem::canonical(to_path(path)).string()).second)
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
    TESSERA_TRY_ASSIGN(auto raw, read_whole_file(path, most_model_bytes));
    const auto bytes = utf8_of(std::move(raw));
    TESSERA_TRY(check_is_model(bytes));
    return ObjReader(path, builder).read(text_of(bytes));
}

} // namespace tessera::corpus
