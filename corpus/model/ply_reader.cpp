// Stanford .ply, ASCII and binary. The reader uses vertices with normals, colours and texture
// coordinates, faces with their own texture coordinates, triangle strips, the first material, and
// the comment TextureFile. It skips other elements and properties.
#include "corpus/model/polygons.h"
#include "corpus/model/readers.h"
#include "corpus/model/text_lines.h"

#include <bit>

namespace tessera::corpus {
namespace {

struct NumberType {
    std::string_view name, other_name;
    std::size_t bytes;
    bool is_whole, has_sign;
    double one; // the value that stands for 1 in a colour
};
// Files with 32-bit colours usually store values of 0..255.
constexpr NumberType number_types[] = {
    {"char", "int8", 1, true, true, 127},      {"uchar", "uint8", 1, true, false, 255},
    {"short", "int16", 2, true, true, 32767},  {"ushort", "uint16", 2, true, false, 65535},
    {"int", "int32", 4, true, true, 255},      {"uint", "uint32", 4, true, false, 255},
    {"float", "float32", 4, false, true, 1.0}, {"double", "float64", 8, false, true, 1.0},
};

const NumberType* number_type(std::string_view name) {
    const auto* const found = std::ranges::find_if(number_types, [&](const NumberType& type) {
        return type.name == name || type.other_name == name;
    });
    return found == std::end(number_types) ? nullptr : found;
}

struct Property {
    std::string_view name;
    const NumberType* count = nullptr; // of a list's length; null: not a list
    const NumberType* value = nullptr;
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    // The index of the first property with one of these names; -1 without one.
    int find(std::initializer_list<std::string_view> names) const {
        for (std::size_t i = 0; i < properties.size(); ++i)
            if (std::ranges::find(names, properties[i].name) != names.end())
                return static_cast<int>(i);
        return -1;
    }
    // The value that stands for 1 in this property, a colour channel.
    double one(int property) const {
        return properties[static_cast<std::size_t>(property)].value->one;
    }
};

// The values of one vertex, face or other element.
class Row {
public:
    void clear() {
        values_.clear();
        ends_.clear();
    }
    void add(double value) { values_.push_back(value); }
    void end_property() { ends_.push_back(values_.size()); }

    std::span<const double> list(int property) const {
        const auto i = static_cast<std::size_t>(property);
        const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
        return std::span(values_).subspan(begin, ends_[i] - begin);
    }
    // The first value of a property; 0 if the property is absent or an empty list.
    double operator[](int property) const {
        return property < 0 || list(property).empty() ? 0.0 : list(property)[0];
    }

private:
    std::vector<double> values_;
    std::vector<std::size_t> ends_;
};

Status invalid_ply(const std::string& what) {
    return {ErrorCode::invalid_file, what};
}

// Parses the header, then the elements one by one.
class PlyFile {
public:
    explicit PlyFile(std::string_view file) : lines_(file), size_(file.size()) {}

    const std::vector<Element>& elements() const { return elements_; }
    std::string_view texture() const { return texture_; } // the comment TextureFile; may be empty

    Status read_header() {
        if (lines_.next() != "ply")
            return wrong_line();
        while (!lines_.at_end()) {
            const std::string_view line = lines_.next();
            const std::vector<std::string_view> words = words_of(line);
            if (words.size() > 2 && words[0] == "comment" && words[1] == "TextureFile")
                texture_ = trimmed(line.substr(line.find(words[1]) + words[1].size()));
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info")
                continue;
            if (words[0] == "end_header" && words.size() == 1) {
                rest_ = lines_.rest();
                return {};
            }
            // Blender 2.4 wrote its name without the word "comment". Other readers skip such lines.
            if (!(words[0] == "format"     ? read_format(words)
                  : words[0] == "element"  ? read_element(words)
                  : words[0] == "property" ? read_property(words)
                                           : elements_.empty()))
                return wrong_line();
        }
        return invalid_ply("its header has no end");
    }

    Status read_row(const Element& element, Row& row) {
        row.clear();
        return is_text_ ? read_text(element, row) : read_binary(element, row);
    }

private:
    Status wrong_line() const {
        return invalid_ply("line " + std::to_string(lines_.number()) + " is not PLY");
    }

    bool read_format(const std::vector<std::string_view>& words) {
        if (words.size() != 3)
            return false;
        is_text_ = words[1] == "ascii";
        is_big_ = words[1] == "binary_big_endian";
        return is_text_ || is_big_ || words[1] == "binary_little_endian";
    }

    // A file cannot hold more elements than bytes. Names do not begin with a digit.
    bool read_element(const std::vector<std::string_view>& words) {
        Element element;
        if (words.size() != 3 || (words[1][0] >= '0' && words[1][0] <= '9') ||
            !parse_word(words[2], element.count) || element.count > size_)
            return false;
        element.name = words[1];
        elements_.push_back(std::move(element));
        return true;
    }

    bool read_property(const std::vector<std::string_view>& words) {
        const bool is_list = words.size() == 5 && words[1] == "list";
        if (elements_.empty() || (!is_list && words.size() != 3))
            return false;
        const Property property{.name = words.back(),
                                .count = is_list ? number_type(words[2]) : nullptr,
                                .value = number_type(words[words.size() - 2])};
        elements_.back().properties.push_back(property);
        return property.value != nullptr &&
               (!is_list || (property.count != nullptr && property.count->is_whole));
    }

    // Each element is one line.
    Status read_text(const Element& element, Row& row) {
        std::string_view line;
        do {
            if (lines_.at_end())
                return invalid_ply("the file ends before it does");
            line = trimmed(lines_.next());
        } while (line.empty() || line.starts_with("comment"));
        for (const Property& property : element.properties) {
            std::uint64_t values = 1;
            if (property.count != nullptr && !parse_word(take_word(line), values))
                return wrong_line();
            for (; values > 0; --values) {
                double value = 0;
                std::int64_t whole = 0;
                const std::string_view word = take_word(line);
                if (property.value->is_whole ? !parse_word(word, whole) : !parse_word(word, value))
                    return wrong_line();
                row.add(property.value->is_whole ? static_cast<double>(whole) : value);
            }
            row.end_property();
        }
        return trimmed(line).empty() ? Status() : wrong_line();
    }

    Status read_binary(const Element& element, Row& row) {
        for (const Property& property : element.properties) {
            double values = 1;
            if (property.count != nullptr && !take_number(*property.count, values))
                return too_short();
            if (values < 0)
                return invalid_ply("a list's length is below 0");
            for (; values > 0; --values) {
                double value = 0;
                if (!take_number(*property.value, value))
                    return too_short();
                row.add(value);
            }
            row.end_property();
        }
        return {};
    }
    static Status too_short() { return invalid_ply("the file is too short for it"); }

    bool take_number(const NumberType& type, double& number) {
        if (rest_.size() < type.bytes)
            return false;
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < type.bytes; ++i)
            bits = bits << 8 | static_cast<unsigned char>(rest_[is_big_ ? i : type.bytes - 1 - i]);
        rest_.remove_prefix(type.bytes);
        if (type.is_whole) {
            const auto shift = static_cast<int>(64 - 8 * type.bytes);
            number = type.has_sign
                         ? static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift)
                         : static_cast<double>(bits);
        } else if (type.bytes == 4) {
            number = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
        } else {
            number = std::bit_cast<double>(bits);
        }
        return true;
    }

    LineReader lines_;      // the header, and the data of an ASCII file
    std::string_view rest_; // the data of a binary file
    std::size_t size_;
    std::vector<Element> elements_;
    std::string_view texture_;
    bool is_text_ = false, is_big_ = false;
};

std::uint32_t to_index(double x) {
    return x >= 0.0 && x < absent ? static_cast<std::uint32_t>(x) : absent;
}

class PlyReader {
public:
    PlyReader(PlyFile& file, ModelBuilder& builder) : file_(file), builder_(builder) {}

    Status read(const std::string& folder) {
        for (const Element& element : file_.elements())
            TESSERA_TRY(read_element(element).with_context("element " + std::string(element.name)));
        finish_corners();
        if (!file_.texture().empty()) {
            material_.base_texture.image =
                builder_.add_image_or_note(folder + "/" + std::string(file_.texture()));
            if (material_.base_texture.image >= 0)
                material_.base = glm::dvec4(1.0);
        }
        builder_.model().materials.push_back(material_);
        return add_polygons(model_, builder_);
    }

private:
    Status read_element(const Element& e) {
        if (e.properties.empty())
            return {};
        if (e.name == "vertex")
            return read_vertices(e);
        if (e.name == "material")
            return read_material(e);
        const bool is_face = e.name == "face", is_strip = e.name == "tristrips";
        const int indices = e.find({"vertex_indices", "vertex_index"}), uv = e.find({"texcoord"});
        if ((is_face || is_strip) && indices < 0)
            return invalid_ply("has no vertex_indices");
        return for_each_row(e, [&](const Row& row) {
            if (is_face)
                add_face(row.list(indices), uv < 0 ? std::span<const double>() : row.list(uv));
            if (is_strip)
                add_strip(row.list(indices));
        });
    }

    template <class Visit> Status for_each_row(const Element& e, const Visit& visit) {
        for (std::uint64_t i = 0; i < e.count; ++i) {
            TESSERA_TRY(file_.read_row(e, row_));
            visit(row_);
        }
        return {};
    }

    Status read_vertices(const Element& e) {
        const int x = e.find({"x"}), y = e.find({"y"}), z = e.find({"z"});
        const int nx = e.find({"nx"}), ny = e.find({"ny"}), nz = e.find({"nz"});
        const int u = e.find({"u", "s", "tx", "texture_u"});
        const int v = e.find({"v", "t", "ty", "texture_v"});
        const std::array colour{e.find({"red", "r", "diffuse_red"}),
                                e.find({"green", "g", "diffuse_green"}),
                                e.find({"blue", "b", "diffuse_blue"})};
        const int alpha = e.find({"alpha"});
        if (x < 0 || y < 0 || z < 0)
            return invalid_ply("has no x, y and z");
        return for_each_row(e, [&](const Row& row) {
            model_.positions.emplace_back(row[x], row[y], row[z]);
            if (nx >= 0 && ny >= 0 && nz >= 0)
                model_.normals.emplace_back(row[nx], row[ny], row[nz]);
            if (u >= 0 && v >= 0)
                model_.uv.emplace_back(row[u], 1.0 - row[v]); // v grows upwards in files
            if (std::ranges::min(colour) >= 0)
                model_.colours.emplace_back(linear_colour(colour_of(e, row, colour)),
                                            alpha < 0 ? 1.0 : row[alpha] / e.one(alpha));
        });
    }

    // Absent channels are 1.
    static glm::dvec3 colour_of(const Element& e, const Row& row, const std::array<int, 3>& rgb) {
        glm::dvec3 colour{1.0};
        for (std::size_t c = 0; c < 3; ++c)
            if (rgb[c] >= 0)
                colour[static_cast<glm::length_t>(c)] = row[rgb[c]] / e.one(rgb[c]);
        return colour;
    }

    // All faces get the first material.
    Status read_material(const Element& e) {
        const std::array colour{e.find({"diffuse_red"}), e.find({"diffuse_green"}),
                                e.find({"diffuse_blue"})};
        const int power = e.find({"specular_power"});
        bool is_first = true;
        return for_each_row(e, [&](const Row& row) {
            if (is_first) // the factor of other readers
                material_ = plain_material(colour_of(e, row, colour), 15.0 * row[power]);
            is_first = false;
        });
    }

    // `uv` has two numbers per corner; other counts are ignored.
    void add_face(std::span<const double> indices, std::span<const double> uv) {
        corners_.clear();
        for (std::size_t i = 0; i < indices.size(); ++i) {
            corners_.push_back({.position = to_index(indices[i])});
            if (uv.size() == 2 * indices.size()) {
                corners_[i].uv = static_cast<std::uint32_t>(corner_uv_.size());
                corner_uv_.emplace_back(uv[2 * i], 1.0 - uv[2 * i + 1]);
            }
        }
        mesh_.add(corners_);
    }

    // From the third index on, each one forms a triangle with the two before it. -1 begins a new
    // strip.
    void add_strip(std::span<const double> indices) {
        std::size_t begin = 0;
        for (std::size_t i = 0; i < indices.size(); ++i) {
            if (indices[i] < 0.0)
                begin = i + 1;
            if (i < begin + 2)
                continue;
            const std::size_t odd = (i - begin) % 2;
            add_face(std::array{indices[i - 2], indices[i - 1 + odd], indices[i - odd]}, {});
        }
    }

    // Corners get the uv and normals of their vertices, unless the face has its own uv.
    void finish_corners() {
        const auto first = static_cast<std::uint32_t>(model_.uv.size());
        model_.uv.insert(model_.uv.end(), corner_uv_.begin(), corner_uv_.end());
        for (PolygonCorner& c : mesh_.corners) {
            c.uv = c.uv != absent ? first + c.uv : c.position < first ? c.position : absent;
            c.normal = c.position;
        }
        model_.meshes.push_back(std::move(mesh_));
    }

    PlyFile& file_;
    ModelBuilder& builder_;
    PolygonModel model_;
    PolygonMesh mesh_;
    ModelMaterial material_ = plain_material(glm::dvec3(1.0));
    std::vector<glm::vec2> corner_uv_;
    Row row_;
    std::vector<PolygonCorner> corners_; // of one face
};

} // namespace

Status read_ply(const std::string& path, ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY(check_is_model(bytes));
    PlyFile file({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    TESSERA_TRY(file.read_header());
    return PlyReader(file, builder).read(folder_of(path));
}

} // namespace tessera::corpus
