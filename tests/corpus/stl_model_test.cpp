// Tests reading of STL files.
#include "tests/support/model_files.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace tessera::corpus {
namespace {

using namespace support;

class StlModels : public ModelFiles {};

using StlTriangle = std::array<glm::vec3, 3>;

// A tetrahedron.
const std::vector<StlTriangle> tetrahedron{{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}},
                                           {{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}},
                                           {{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}},
                                           {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};

std::string text_of(const std::vector<StlTriangle>& triangles) {
    std::string text = "solid by hand\r\n";
    for (const StlTriangle& triangle : triangles) {
        text += "  facet normal 0 0 0\r\n    OUTER LOOP\r\n";
        for (const glm::vec3& p : triangle)
            text += "      vertex " + std::to_string(p.x) + " +" + std::to_string(p.y) + " " +
                    std::to_string(p.z) + "\r\n";
        text += "    endloop\r\n  endfacet\r\n";
    }
    return text + "endsolid by hand\r\n";
}

void put(std::string& file, std::uint32_t x, int bytes = 4) {
    for (int i = 0; i < bytes; ++i)
        file.push_back(static_cast<char>(x >> 8 * i));
}

std::string binary_of(const std::vector<StlTriangle>& triangles, std::string header,
                      std::uint32_t attribute = 0) {
    header.resize(80);
    put(header, static_cast<std::uint32_t>(triangles.size()));
    for (const StlTriangle& triangle : triangles) {
        for (int i = 0; i < 3; ++i)
            put(header, 0);
        for (const glm::vec3& p : triangle)
            for (glm::length_t k = 0; k < 3; ++k)
                put(header, std::bit_cast<std::uint32_t>(p[k]));
        put(header, attribute, 2);
    }
    return header;
}

TEST_F(StlModels, TextAndBinaryAreTheSame) {
    const auto text = load("a.stl", text_of(tetrahedron));
    ASSERT_TRUE(text.ok()) << text.status().message();
    ASSERT_EQ(text->triangles.size(), 4u);
    EXPECT_EQ(text->vertices.size(), 12u); // its edges are sharp
    for (const std::string header : {"made by a scanner", "solid, says the exporter"}) {
        const auto binary = load("a.STL", binary_of(tetrahedron, header));
        ASSERT_TRUE(binary.ok()) << binary.status().message();
        ASSERT_EQ(binary->vertices.size(), text->vertices.size());
        for (std::size_t i = 0; i < text->vertices.size(); ++i) {
            EXPECT_EQ(binary->vertices[i].position, text->vertices[i].position);
            EXPECT_EQ(binary->vertices[i].normal, text->vertices[i].normal);
        }
    }
}

// Triangles that meet at equal positions share vertices, where the edge between them is smooth.
TEST_F(StlModels, SmoothSurfacesAreWelded) {
    const auto model = load("a.stl", binary_of({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                                {{{1, 0, 0}, {1, 1, 0.1f}, {-0.0f, 1, 0}}}},
                                               "two"));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_EQ(model->vertices.size(), 4u);
}

TEST_F(StlModels, ColoursThatAreNotReadAreSaid) {
    const auto notes_of = [&](std::uint32_t attribute) {
        const auto model = load("a.stl", binary_of(tetrahedron, "colours", attribute));
        EXPECT_TRUE(model.ok());
        return std::ranges::count_if(model->notes, [](const std::string& note) {
            return note.find("colours") != std::string::npos;
        });
    };
    EXPECT_EQ(notes_of(0), 0);
    EXPECT_EQ(notes_of(0x8123), 1);
}

TEST_F(StlModels, DamagedFilesAreRefused) {
    const std::string binary = binary_of(tetrahedron, "cut"), text = text_of(tetrahedron);
    const auto refuses = [&](const std::string& file, const char* what) {
        const auto found = load("a.stl", file);
        EXPECT_EQ(found.status().code(), ErrorCode::invalid_file) << what;
        EXPECT_NE(found.status().message().find(what), std::string::npos)
            << found.status().message();
    };
    refuses("", "an empty file");
    refuses("solid nothing\nendsolid\n", "has no triangles");
    refuses(binary.substr(0, 60), "line 1 is not STL");
    refuses(binary.substr(0, binary.size() - 1), "too short for its 4 triangles: there are 3");
    std::string many = binary;
    std::fill_n(many.begin() + 80, 4, '\xFF');
    refuses(many, "too short for its 4294967295 triangles");
    refuses(text.substr(0, text.find("endloop")), "ends within a triangle");
    std::string word = text;
    refuses(word.replace(word.find("vertex"), 6, "vortex"), "line 4 is not STL");
    std::string number = text;
    refuses(number.replace(number.find("vertex 0"), 8, "vertex x"), "line 4 is not STL");
    std::vector<StlTriangle> unsound = tetrahedron;
    unsound[1][1].x = std::numeric_limits<float>::quiet_NaN();
    const auto rest = load("a.stl", binary_of(unsound, ""));
    ASSERT_TRUE(rest.ok()) << rest.status().message();
    EXPECT_EQ(rest->triangles.size(), 3u);
    EXPECT_TRUE(load("a.stl", binary + "bytes of a tool").ok());
}

} // namespace
} // namespace tessera::corpus
