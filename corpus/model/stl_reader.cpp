// STL, ASCII and binary: triangles without normals that meet at equal positions. The normals of the
// file are those of the triangles, and are computed again.
#include "corpus/model/polygons.h"
#include "corpus/model/readers.h"
#include "corpus/model/text_lines.h"
#include "corpus/pattern.h"

#include <bit>
#include <cstring>
#include <unordered_map>

namespace tessera::corpus {
namespace {

constexpr std::size_t stl_header_bytes = 80, stl_facet_bytes = 50;

class StlReader {
public:
    explicit StlReader(ModelBuilder& builder) : builder_(builder) {}

    Status read(std::span<const unsigned char> file) {
        const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
        TESSERA_TRY(is_binary(file) ? read_binary(file) : read_text(text));
        if (mesh_.sizes.empty())
            return {ErrorCode::invalid_file, "has no triangles"};
        model_.meshes.push_back(std::move(mesh_));
        builder_.model().materials.push_back(plain_material(glm::dvec3(0.8)));
        return add_polygons(model_, builder_);
    }

private:
    static std::uint32_t number_at(std::span<const unsigned char> file, std::size_t at) {
        std::uint32_t x = 0;
        for (std::size_t i = 4; i-- > 0;)
            x = x << 8 | file[at + i];
        return x;
    }

    // Binary files may begin with the word of ASCII ones, and may have bytes behind the triangles.
    static bool is_binary(std::span<const unsigned char> file) {
        if (file.size() < stl_header_bytes + 4)
            return false;
        const std::uint64_t whole =
            stl_header_bytes + 4 +
            std::uint64_t{number_at(file, stl_header_bytes)} * stl_facet_bytes;
        const bool has_zero =
            std::memchr(file.data(), 0, stl_header_bytes + 4) != nullptr; // no text has one
        return file.size() == whole || has_zero || !is_text(file);
    }
    static bool is_text(std::span<const unsigned char> file) {
        std::string_view start(reinterpret_cast<const char*>(file.data()), stl_header_bytes);
        start.remove_prefix(std::min(start.find_first_not_of(" \t\r\n"), start.size()));
        return is_word(start.substr(0, 5), "solid");
    }
    // `lower_case` has no capital letters.
    static bool is_word(std::string_view word, std::string_view lower_case) {
        return std::ranges::equal(word, lower_case, [](char a, char b) {
            return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
        });
    }

    Status read_binary(std::span<const unsigned char> file) {
        const std::uint64_t count = number_at(file, stl_header_bytes);
        const std::size_t there = (file.size() - stl_header_bytes - 4) / stl_facet_bytes;
        if (count > there)
            return {ErrorCode::invalid_file, "is too short for its " + std::to_string(count) +
                                                 " triangles: there are " + std::to_string(there)};
        TESSERA_TRY(check_count(count));
        bool has_colours = false;
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::size_t facet = stl_header_bytes + 4 + i * stl_facet_bytes;
            for (std::size_t corner = 1; corner <= 3; ++corner) {
                glm::vec3 p;
                for (glm::length_t k = 0; k < 3; ++k)
                    p[k] = std::bit_cast<float>(
                        number_at(file, facet + 12 * corner + 4 * static_cast<std::size_t>(k)));
                add_corner(p);
            }
            has_colours = has_colours || file[facet + 48] != 0 || file[facet + 49] != 0;
            end_facet();
        }
        if (has_colours)
            builder_.model().notes.push_back("the colours of its triangles are not read");
        return {};
    }

    Status read_text(std::string_view text) {
        LineReader lines(text);
        while (!lines.at_end()) {
            std::string_view rest = lines.next();
            const std::string_view word = take_word(rest);
            const auto is = [&](std::string_view other) { return is_word(word, other); };
            if (is("vertex")) {
                glm::vec3 p;
                for (glm::length_t k = 0; k < 3; ++k)
                    if (!parse_word(take_word(rest), p[k]))
                        return wrong_line(lines);
                add_corner(p);
            } else if (is("endloop")) {
                if (corners_.size() < 3)
                    return wrong_line(lines);
                end_facet();
                TESSERA_TRY(check_count(mesh_.sizes.size()));
            } else if (!(word.empty() || is("solid") || is("endsolid") || is("facet") ||
                         is("endfacet") || is("outer") || is("color"))) {
                return wrong_line(lines);
            }
        }
        if (!corners_.empty())
            return {ErrorCode::invalid_file, "ends within a triangle"};
        return {};
    }
    static Status wrong_line(const LineReader& lines) {
        return {ErrorCode::invalid_file, "line " + std::to_string(lines.number()) + " is not STL"};
    }

    static Status check_count(std::uint64_t triangles) {
        if (triangles <= most_triangles)
            return {};
        return {ErrorCode::unsupported,
                "more than " + std::to_string(most_triangles) + " triangles"};
    }

    void add_corner(const glm::vec3& position) {
        // Bits, because NaN equals nothing. Adding 0 turns -0 into 0.
        const auto key = std::bit_cast<Key>(position + 0.0f);
        const auto [at, is_new] =
            positions_.emplace(key, static_cast<std::uint32_t>(model_.positions.size()));
        if (is_new)
            model_.positions.push_back(position);
        corners_.push_back({.position = at->second});
    }
    void end_facet() {
        mesh_.add(corners_);
        corners_.clear();
    }

    using Key = std::array<std::uint32_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const {
            return mix_bits(mix_bits(std::uint64_t{key[0]} << 32 | key[1]) + key[2]);
        }
    };

    ModelBuilder& builder_;
    PolygonModel model_;
    PolygonMesh mesh_;
    std::vector<PolygonCorner> corners_; // of one triangle
    std::unordered_map<Key, std::uint32_t, Hash> positions_;
};

} // namespace

Status read_stl(const std::string& path, ModelBuilder& builder) {
    TESSERA_TRY_ASSIGN(const auto bytes, read_whole_file(path, most_model_bytes));
    TESSERA_TRY(check_is_model(bytes));
    return StlReader(builder).read(bytes);
}

} // namespace tessera::corpus
