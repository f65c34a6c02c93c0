// Descriptions of photographs. The first byte says which kind: j: a transforms.json; b, t: a COLMAP
// model, binary or text, of which the second byte is the number of bytes of its cameras.
#include "corpus/photographs/photograph.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/photographs.h"

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <unistd.h>

namespace tessera::fuzz::photographs {
namespace {

namespace fs = std::filesystem;
using test::append_number;

std::string binary_model() {
    std::string cameras, images;
    append_number(cameras, std::uint64_t{1});
    append_number(cameras, std::uint32_t{1});
    append_number(cameras, std::int32_t{3});
    for (const std::uint64_t side : {8, 6})
        append_number(cameras, side);
    for (const double parameter : {9.0, 4.0, 3.0, -0.1, 0.01})
        append_number(cameras, parameter);
    append_number(images, std::uint64_t{1});
    append_number(images, std::uint32_t{1});
    for (const double number : {0.5, 0.5, -0.5, 0.5, 1.0, 2.0, 3.0})
        append_number(images, number);
    append_number(images, std::uint32_t{1});
    images.append("a.png", 6);
    append_number(images, std::uint64_t{1});
    images.append(24, 'p');
    return "b" + std::string(1, static_cast<char>(cameras.size())) + cameras + images;
}

std::string text_model() {
    const std::string cameras = "1 OPENCV 8 6 9 9 4 3 0.1 0 0.01 0\n";
    return "t" + std::string(1, static_cast<char>(cameras.size())) + cameras +
           "# images\n1 1 0 0 0 1 2 3 1 a b.png\n1 2 -1\n2 0 0 0 1 1 2 3 1 c.png\n\n";
}

void write_file(const fs::path& path, const std::uint8_t* data, std::size_t size) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
}

} // namespace

std::vector<Bytes> seeds() {
    const std::string pose = test::matrix_at("1", "2", "3");
    return {bytes_of("j" + test::transforms_json(R"("camera_angle_x":0.7,"w":8,"h":6,)",
                                                 {test::frame_json("./train/r_0", pose)})),
            bytes_of("j" + test::transforms_json(
                               R"("fl_x":9,"cx":4,"w":8,"h":6,"k1":-0.1,"p1":0.01,)"
                               R"("camera_model":"OPENCV","applied_scale":2,)"
                               R"("applied_transform":[[0,1,0,0],[1,0,0,0],[0,0,-1,0]],)",
                               {test::frame_json("a.png", pose, R"(,"fl_y":10,"mask_path":"m")"),
                                test::frame_json("../b.png", pose)})),
            bytes_of(binary_model()), bytes_of(text_model())};
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size < 2)
        return;
    const fs::path folder = "/tmp/tessera_fuzz_" + std::to_string(::getpid());
    fs::create_directories(folder);
    if (data[0] == 'j') {
        write_file(folder / "transforms.json", data + 1, size - 1);
    } else {
        const std::string suffix = data[0] == 't' ? ".txt" : ".bin";
        const std::size_t cameras = std::min<std::size_t>(data[1], size - 2);
        write_file(folder / ("cameras" + suffix), data + 2, cameras);
        write_file(folder / ("images" + suffix), data + 2 + cameras, size - 2 - cameras);
    }
    const auto set =
        corpus::read_photographs(folder.string(), {.images = "", .with_pictures = false});
    fs::remove_all(folder);
    if (!set.ok())
        return;
    require(!set->photographs.empty(), "a set without photographs");
    for (const corpus::PosedPhotograph& photograph : set->photographs) {
        const corpus::PhotoCamera& camera = photograph.camera;
        const double x = 0.25 * camera.width, y = 0.75 * camera.height;
        const glm::dvec3 direction = camera.direction(x, y);
        require(std::abs(glm::length(direction) - 1) < 1e-9, "a direction without unit length");
        require(glm::dot(direction, camera.axes[2]) > 0, "a direction that leads backwards");
    }
    require(corpus::names_of(set->photographs).size() == set->photographs.size(),
            "a photograph without a name");
}

const Registered
    registered({.name = "fuzz_photographs", .seeds = seeds, .run = run, .rounds = 400});

} // namespace tessera::fuzz::photographs
