// Draws textured meshes as triangles: first their depths, then the colours of visible fragments, and
// last those of surfaces that blend.
#include "decoder_glsl/draw/gl_picture.h"
#include "decoder_glsl/draw/gl_raster_state.h"
#include "decoder_glsl/draw/view_drawing.h"
#include "decoder_glsl/gl/gl_buffer.h"
#include "decoder_glsl/gl/gl_error.h"
#include "decoder_glsl/gl/gl_program.h"
#include "format/surface/mesh_check.h"

#include <algorithm>
#include <cfloat>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// A vertex in the buffer.
struct Vertex {
    glm::vec3 position, normal, tangent;
    glm::vec2 uv;
};
static_assert(sizeof(Vertex) == 44);

// The uniform block of shaders/mesh.vert.glsl in std140 layout.
struct MeshViewBlock {
    float projection[4][4]; // [column][row]
    float eye[4];
};

glm::dvec3 as_vec(const std::array<float, 3>& v) {
    return {v[0], v[1], v[2]};
}

// The distance along `forward` of depth 1. Depth is nearest / distance, in floats, whose relative
// precision is the same near and far. It is the distance of the bounding box's nearest corner, but
// at least a ten-thousandth of the box's size: observers inside or close to the box do not see what
// is nearer.
double nearest_depth(const MeshBounds& bounds, const glm::dvec3& eye, const glm::dvec3& forward) {
    double nearest = DBL_MAX;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at{corner & 1 ? bounds.high.x : bounds.low.x,
                            corner & 2 ? bounds.high.y : bounds.low.y,
                            corner & 4 ? bounds.high.z : bounds.low.z};
        nearest = std::min(nearest, glm::dot(at - eye, forward) / glm::dot(forward, forward));
    }
    const double least = bounds.diagonal() * 1e-4;
    return std::max({nearest * 0.999, least, double{FLT_MIN}});
}

MeshViewBlock block_of(const ViewCamera& camera, const MeshBounds& bounds) {
    const glm::dvec3 eye = as_vec(camera.eye), forward = as_vec(camera.forward);
    const glm::dvec3 rows[] = {as_vec(camera.right), as_vec(camera.up), glm::dvec3(0), forward};
    MeshViewBlock block{};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 3; ++column)
            if (row != 2)
                block.projection[column][row] = static_cast<float>(
                    rows[row][column] /
                    glm::dot(rows[row], rows[row])); // the inverse, as rows are orthogonal
    block.projection[3][2] = static_cast<float>(nearest_depth(bounds, eye, forward));
    for (std::size_t i = 0; i < 3; ++i)
        block.eye[i] = camera.eye[i];
    return block;
}

struct ReleaseVertexArray {
    void operator()(GLuint id) const { glDeleteVertexArrays(1, &id); }
};

class MeshDrawing final : public ViewDrawing {
public:
    explicit MeshDrawing(MeshLook look) : look_(std::move(look)) {}

    Status open(const SurfaceMesh& mesh) {
        TESSERA_TRY(check_mesh(mesh, true, true, ErrorCode::bad_argument));
        TESSERA_TRY(make_programs());
        TESSERA_TRY(upload(mesh));
        bounds_ = bounds_of(mesh);
        return {};
    }

    Status draw(const ViewCamera& camera) override {
        if (picture_.width() != camera.width || picture_.height() != camera.height) {
            picture_ = GlPicture();
            TESSERA_TRY_ASSIGN(picture_, GlPicture::create(camera.width, camera.height, blends()));
        }
        const MeshViewBlock block = block_of(camera, bounds_);
        TESSERA_TRY(view_.upload(0, std::as_bytes(std::span(&block, 1))));
        if (blends())
            TESSERA_TRY(sort(as_vec(camera.eye)));
        {
            GlRasterState state(picture_.framebuffer(), static_cast<GLsizei>(camera.width),
                                static_cast<GLsizei>(camera.height));
            picture_.clear(camera.outside);
            state.write_linear(blends());
            glBindBufferBase(GL_UNIFORM_BUFFER, 0, view_.id());
            glBindVertexArray(array_.get());
            look_.bind();
            state.write_depths();
            depths_.use();
            draw_triangles();
            state.write_colours();
            colours_.use();
            draw_triangles();
            if (blends()) {
                state.blend_colours();
                blended_.use();
                glVertexArrayElementBuffer(array_.get(), sorted_.id());
                draw_triangles();
                glVertexArrayElementBuffer(array_.get(), indices_.id());
                state.write_linear(false);
            }
            picture_.resolve();
        }
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
        return take_gl_errors("drawing a view");
    }

    Result<std::vector<float>> read() const override { return picture_.read(); }

    std::uint64_t bytes() const override {
        return picture_.bytes() + view_.bytes() + vertices_.bytes() + indices_.bytes() +
               sorted_.bytes() + look_.bytes;
    }

private:
    bool blends() const { return !look_.blended_fragment.empty(); }

    Status make_programs() {
        TESSERA_TRY_ASSIGN(const auto vertex,
                           shader_source("mesh.vert.glsl", ShaderDialect::gl450));
        const std::string nothing = "#version 450 core\nvoid main() {}\n";
        TESSERA_TRY_ASSIGN(
            depths_, GlProgram::graphics(
                         vertex, look_.depth_fragment.empty() ? nothing : look_.depth_fragment,
                         "mesh depths"));
        TESSERA_TRY_ASSIGN(colours_, GlProgram::graphics(vertex, look_.fragment, "mesh colours"));
        if (blends()) {
            TESSERA_TRY_ASSIGN(
                blended_, GlProgram::graphics(vertex, look_.blended_fragment, "blended colours"));
        }
        return {};
    }

    // Uploads the triangles in the order of their middles' distances from the eye, the farthest first.
    Status sort(const glm::dvec3& eye) {
        std::vector<std::pair<double, std::size_t>> order;
        order.reserve(middles_.size());
        for (std::size_t i = 0; i < middles_.size(); ++i) {
            const glm::dvec3 way = glm::dvec3(middles_[i]) - eye;
            order.emplace_back(-glm::dot(way, way), i);
        }
        std::ranges::sort(order);
        std::vector<std::array<std::uint32_t, 3>> sorted;
        sorted.reserve(order.size());
        for (const auto& [distance, triangle] : order)
            sorted.push_back(triangles_[triangle]);
        return sorted_.upload(0, std::as_bytes(std::span(sorted)));
    }

    Status upload(const SurfaceMesh& mesh) {
        const std::vector<glm::vec3> tangents = mesh_tangents(mesh);
        std::vector<Vertex> vertices;
        vertices.reserve(tangents.size());
        for (std::size_t i = 0; i < tangents.size(); ++i)
            vertices.push_back({mesh.positions[i], mesh.normals[i], tangents[i], mesh.uv[i]});
        TESSERA_TRY_ASSIGN(vertices_,
                           GlBuffer::create(std::as_bytes(std::span(vertices)), "vertices"));
        TESSERA_TRY_ASSIGN(indices_,
                           GlBuffer::create(std::as_bytes(std::span(mesh.triangles)), "triangles"));
        TESSERA_TRY_ASSIGN(view_,
                           GlBuffer::create(sizeof(MeshViewBlock), BufferUse::upload, "mesh view"));
        if (blends()) {
            triangles_ = mesh.triangles;
            for (const auto& [a, b, c] : triangles_)
                middles_.push_back((mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) /
                                   3.0f);
            TESSERA_TRY_ASSIGN(
                sorted_, GlBuffer::create(indices_.bytes(), BufferUse::upload, "sorted triangles"));
        }
        count_ = static_cast<GLsizei>(mesh.triangles.size() * 3);
        GLuint id = 0;
        glCreateVertexArrays(1, &id);
        array_ = GlHandle<ReleaseVertexArray>(id);
        glVertexArrayVertexBuffer(id, 0, vertices_.id(), 0, sizeof(Vertex));
        glVertexArrayElementBuffer(id, indices_.id());
        constexpr GLint sizes[] = {3, 3, 3, 2}; // floats of each attribute of a Vertex
        GLuint offset = 0;
        for (GLuint i = 0; i < std::size(sizes); ++i) {
            glEnableVertexArrayAttrib(id, i);
            glVertexArrayAttribFormat(id, i, sizes[i], GL_FLOAT, GL_FALSE, offset);
            glVertexArrayAttribBinding(id, i, 0);
            offset += static_cast<GLuint>(sizes[i]) * 4;
        }
        return take_gl_errors("a mesh's vertices");
    }

    void draw_triangles() const { glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr); }

    MeshLook look_;
    GlProgram depths_, colours_, blended_;
    GlBuffer vertices_, indices_, view_;
    // Of surfaces that blend: the triangles, their middles, and the indices sorted for a view.
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::vector<glm::vec3> middles_;
    GlBuffer sorted_;
    GlHandle<ReleaseVertexArray> array_;
    GLsizei count_ = 0;
    MeshBounds bounds_{};
    GlPicture picture_;
};

} // namespace

Result<MeshLook> textured_look(const SampledTexture& texture) {
    TESSERA_TRY_ASSIGN(auto fragment,
                       shader_source("mesh.frag.glsl", ShaderDialect::gl450, texture.defines()));
    MeshLook look;
    look.fragment = std::move(fragment);
    look.bind = [&texture] { texture.bind(); };
    return look;
}

Result<std::unique_ptr<ViewDrawing>> make_mesh_drawing(MeshLook look, const SurfaceMesh& mesh) {
    auto drawing = std::make_unique<MeshDrawing>(std::move(look));
    TESSERA_TRY(drawing->open(mesh));
    return std::unique_ptr<ViewDrawing>(std::move(drawing));
}

} // namespace tessera
