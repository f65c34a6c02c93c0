// COLMAP models as text and binary.
#include "tests/support/photographs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tessera::corpus {
namespace {

using test::append_number;
using test::spit;

// Of two images by two cameras. The second image has two points.
constexpr const char* cameras_text = "# cameras\n"
                                     "1 OPENCV 8 6 9 10 4.5 3.25 0.1 0.02 0.001 0.002\n"
                                     "7 SIMPLE_RADIAL 8 6 11 4 3 0.05\n";
constexpr const char* images_text = "# images\n"
                                    "1 0.7071067811865476 0 0 0.7071067811865476 1 2 3 1 a b.jpg\n"
                                    "\n"
                                    "2 1 0 0 0 0 0 5 7 sub/c.jpg\n"
                                    "1.5 2.5 -1 3.5 4.5 12\n";

std::string binary_cameras() {
    std::string file;
    append_number(file, std::uint64_t{2});
    const auto add = [&](std::uint32_t id, std::int32_t model, const std::vector<double>& numbers) {
        append_number(file, id);
        append_number(file, model);
        append_number(file, std::uint64_t{8});
        append_number(file, std::uint64_t{6});
        for (const double number : numbers)
            append_number(file, number);
    };
    add(1, 4, {9, 10, 4.5, 3.25, 0.1, 0.02, 0.001, 0.002});
    add(7, 2, {11, 4, 3, 0.05});
    return file;
}

std::string binary_images() {
    std::string file;
    append_number(file, std::uint64_t{2});
    const auto add = [&](std::uint32_t id, const std::vector<double>& pose, std::uint32_t camera,
                         const std::string& name, std::uint64_t points) {
        append_number(file, id);
        for (const double number : pose)
            append_number(file, number);
        append_number(file, camera);
        file.append(name.c_str(), name.size() + 1);
        append_number(file, points);
        file.append(24 * points, 'p');
    };
    add(1, {std::sqrt(0.5), 0, 0, std::sqrt(0.5), 1, 2, 3}, 1, "a b.jpg", 0);
    add(2, {1, 0, 0, 0, 0, 0, 5}, 7, "sub/c.jpg", 2);
    return file;
}

class Colmap : public testing::Test {
protected:
    void SetUp() override {
        folder_ = test::make_test_folder("colmap");
        std::filesystem::create_directories(folder_ / "sparse" / "0");
        std::filesystem::create_directories(folder_ / "images" / "sub");
        for (const char* name : {"images/a b.jpg", "images/sub/c.jpg"})
            spit(folder_ / name, test::plain_ppm(8, 6, "abc"));
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string model(const std::string& name) const {
        return (folder_ / "sparse" / "0" / name).string();
    }
    void write(const std::string& cameras, const std::string& images, const char* suffix) const {
        spit(model(std::string("cameras") + suffix), cameras);
        spit(model(std::string("images") + suffix), images);
    }
    void expect_refused(ErrorCode code, const std::vector<std::string>& words) const {
        const auto set = read_photographs(folder_.string());
        ASSERT_FALSE(set.ok()) << words.front();
        EXPECT_EQ(set.status().code(), code) << set.status().message();
        for (const std::string& word : words)
            EXPECT_NE(set.status().message().find(word), std::string::npos)
                << word << " in: " << set.status().message();
    }
    void expect_both_images(const std::string& path) const {
        const auto set = read_photographs(path);
        ASSERT_TRUE(set.ok()) << set.status().message();
        EXPECT_TRUE(set->notes.empty());
        ASSERT_EQ(set->photographs.size(), 2u);
        const PosedPhotograph &first = set->photographs[0], &second = set->photographs[1];
        EXPECT_EQ(first.name, "a b.jpg");
        EXPECT_EQ(first.path, (folder_ / "images" / "a b.jpg").string());
        EXPECT_EQ(second.path, (folder_ / "images" / "sub" / "c.jpg").string());
        const PhotoCamera& a = first.camera;
        EXPECT_EQ(a.fx, 9);
        EXPECT_EQ(a.fy, 10);
        EXPECT_EQ(a.cx, 4.5);
        EXPECT_EQ(a.cy, 3.25);
        EXPECT_EQ(a.distortion, (LensDistortion{.k1 = 0.1, .k2 = 0.02, .p1 = 0.001, .p2 = 0.002}));
        // A quarter turn about z takes the world's x to the camera's y (down).
        for (glm::length_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(a.axes[1][i], i == 0 ? 1 : 0, 1e-15);
            EXPECT_NEAR(a.axes[0][i], i == 1 ? -1 : 0, 1e-15);
            EXPECT_NEAR(a.axes[2][i], i == 2 ? 1 : 0, 1e-15);
        }
        // The centre of the camera's frame: R c + t = 0.
        EXPECT_NEAR(a.eye.x, -2, 1e-15);
        EXPECT_NEAR(a.eye.y, 1, 1e-15);
        EXPECT_NEAR(a.eye.z, -3, 1e-15);
        EXPECT_EQ(second.camera.fx, 11);
        EXPECT_EQ(second.camera.fy, 11);
        EXPECT_EQ(second.camera.distortion, (LensDistortion{.k1 = 0.05}));
        EXPECT_EQ(second.camera.eye, glm::dvec3(0, 0, -5));
    }

    std::filesystem::path folder_;
};

TEST_F(Colmap, ReadsText) {
    write(cameras_text, images_text, ".txt");
    expect_both_images(folder_.string());
    expect_both_images(model(""));
}

TEST_F(Colmap, ReadsBinaryBeforeText) {
    write(binary_cameras(), binary_images(), ".bin");
    write("nonsense", "nonsense", ".txt");
    expect_both_images(folder_.string());
}

TEST_F(Colmap, FindsMasks) {
    write(cameras_text, images_text, ".txt");
    const std::string masks = (folder_ / "masks").string();
    const auto none = read_photographs(folder_.string(), {.masks = masks});
    ASSERT_FALSE(none.ok());
    EXPECT_EQ(none.status().message(),
              masks + ": has no mask of any photograph, such as " + masks + "/a b.jpg.png");

    std::filesystem::create_directories(folder_ / "masks" / "sub");
    spit(folder_ / "masks" / "sub" / "c.jpg.png", test::plain_ppm(8, 6, "abc"));
    const auto one = read_photographs(folder_.string(), {.masks = masks});
    ASSERT_TRUE(one.ok()) << one.status().message();
    EXPECT_EQ(one->photographs[0].mask_path, "");
    EXPECT_EQ(one->photographs[1].mask_path, masks + "/sub/c.jpg.png");
    ASSERT_EQ(one->notes.size(), 1u);
    EXPECT_EQ(one->notes[0].kind, "a photograph has no mask, so all of its pixels count");
    EXPECT_EQ(one->notes[0].place, masks + "/a b.jpg.png");
    EXPECT_EQ(one->notes[0].count, 1u);
}

TEST_F(Colmap, RefusesDamagedText) {
    const std::string image = "1 1 0 0 0 0 0 0 1 a b.jpg\n\n";
    const auto expect_camera = [&](const std::string& line, const std::vector<std::string>& words,
                                   ErrorCode code = ErrorCode::invalid_file) {
        write("# cameras\n" + line, image, ".txt");
        expect_refused(code, words);
    };
    expect_camera("1 PINHOLE 8 6 9 10 4 x\n", {"cameras.txt: line 2", "'x'"});
    expect_camera("1 PINHOLE 8 6 9 10 4 3 2\n", {"line 2", "has only 4 parameters"});
    expect_camera("1 PINHOLE 8 6 9 10\n", {"line 2", "a parameter of the camera"});
    expect_camera("1 TELESCOPE 8 6 9 10 4 3\n", {"line 2", "'TELESCOPE' is no camera model"});
    expect_camera("2 PINHOLE 8 6 9 10 4 3\n", {"frame 'a b.jpg'", "camera 1 is not in"});
    expect_camera("1 PINHOLE 8 6 9 10 4 3\n1 PINHOLE 8 6 9 10 4 3\n", {"camera 1 exists twice"});
    expect_camera("1 PINHOLE 8 6 nan 10 4 3\n", {"frame 'a b.jpg'", "focal length is nan"});
    expect_camera("1 PINHOLE 12 6 9 10 4 3\n", {"12x6", "8x6", "a b.jpg"});
    expect_camera("1 FOV 8 6 9 10 4 3 1\n", {"camera 1", "FOV is not supported"},
                  ErrorCode::unsupported);
    const auto expect_image = [&](const std::string& line, const std::vector<std::string>& words) {
        write(cameras_text, line, ".txt");
        expect_refused(ErrorCode::invalid_file, words);
    };
    expect_image("", {"images.txt", "has no frames"});
    expect_image("1 1 0 0 0 0 0 0 1\n\n", {"images.txt: line 1", "no name"});
    expect_image("1 1 0 0 0 0 zero 0 1 a b.jpg\n\n", {"line 1", "'zero'"});
    expect_image("1 0 0 0 0 0 0 0 1 a b.jpg\n\n", {"'a b.jpg'", "not a quaternion"});
    expect_image("1 nan 0 0 0 0 0 0 1 a b.jpg\n\n", {"'a b.jpg'", "not a quaternion"});
    expect_image("1 1 0 0 0 0 0 inf 1 a b.jpg\n\n", {"'a b.jpg'", "not finite"});
}

TEST_F(Colmap, RefusesDamagedBinaries) {
    const std::string cameras = binary_cameras(), images = binary_images();
    const auto expect_cut = [&](const std::string& whole, bool is_images) {
        for (std::size_t i = 0; i < 64; ++i) {
            const std::string part = whole.substr(0, i * whole.size() / 64);
            write(is_images ? cameras : part, is_images ? part : images, ".bin");
            expect_refused(ErrorCode::invalid_file, {is_images ? "images.bin" : "cameras.bin"});
        }
    };
    expect_cut(cameras, false);
    expect_cut(images, true);
    const auto with_bytes = [](std::string file, std::size_t place, auto number) {
        std::string bytes;
        append_number(bytes, number);
        return file.replace(place, bytes.size(), bytes);
    };
    write(cameras + "x", images, ".bin");
    expect_refused(ErrorCode::invalid_file, {"cameras.bin", "more bytes"});
    write(with_bytes(cameras, 0, std::uint64_t{1} << 60), images, ".bin");
    expect_refused(ErrorCode::unsupported, {"cameras.bin", "1152921504606846976"});
    write(with_bytes(cameras, 12, std::int32_t{-1}), images, ".bin");
    expect_refused(ErrorCode::invalid_file, {"cameras.bin", "number -1"});
    write(with_bytes(cameras, 12, std::int32_t{11}), images, ".bin");
    expect_refused(ErrorCode::invalid_file, {"cameras.bin", "number 11"});
    write(with_bytes(cameras, 12, std::int32_t{5}), images, ".bin"); // as many parameters
    expect_refused(ErrorCode::unsupported, {"OPENCV_FISHEYE"});
    write(with_bytes(cameras, 16, ~std::uint64_t{0}), images, ".bin");
    expect_refused(ErrorCode::unsupported, {"'a b.jpg'"});
    write(cameras, with_bytes(images, 0, std::uint64_t{99'999}), ".bin");
    expect_refused(ErrorCode::invalid_file, {"images.bin", "cut short"});
    // The number of points of the first image, behind its name.
    write(cameras, with_bytes(images, 8 + 4 + 56 + 4 + 8, ~std::uint64_t{0}), ".bin");
    expect_refused(ErrorCode::invalid_file, {"images.bin", "18446744073709551615 points"});
    write(cameras, images.substr(0, 72) + std::string(5000, 'x'), ".bin");
    expect_refused(ErrorCode::invalid_file, {"images.bin", "has no end"});
}

} // namespace
} // namespace tessera::corpus
