// Descriptions of photographs by transforms.json: what they say, and what is refused.
#include "tests/support/photographs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tiffio.h>

namespace tessera::corpus {
namespace {

using test::frame_json;
using test::matrix_at;
using test::plain_ppm;
using test::spit;
using test::transforms_json;

class Photographs : public testing::Test {
protected:
    void SetUp() override { folder_ = test::make_test_folder("photographs"); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string at(const std::string& name) const { return (folder_ / name).string(); }
    void write_picture(const std::string& name, unsigned width = 4, unsigned height = 2) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        spit(folder_ / name, plain_ppm(width, height, "abc"));
    }
    std::string write_json(const std::string& head, const std::vector<std::string>& frames) const {
        spit(folder_ / "transforms.json", transforms_json(head, frames));
        return at("transforms.json");
    }
    PhotographSet read(const std::string& path, const PhotographOptions& options = {}) const {
        auto set = read_photographs(path, options);
        EXPECT_TRUE(set.ok()) << set.status().message();
        return set.ok() ? std::move(*set) : PhotographSet{};
    }
    void expect_refused(const std::string& path, ErrorCode code,
                        const std::vector<std::string>& words,
                        const PhotographOptions& options = {}) const {
        const auto set = read_photographs(path, options);
        ASSERT_FALSE(set.ok()) << words.front();
        EXPECT_EQ(set.status().code(), code) << set.status().message();
        for (const std::string& word : words)
            EXPECT_NE(set.status().message().find(word), std::string::npos)
                << word << " in: " << set.status().message();
    }
    // A file with one frame that has this matrix is refused.
    void expect_matrix_refused(const std::string& matrix, const std::string& words) const {
        expect_refused(write_json(R"("fl_x":5,)", {frame_json("a.png", matrix)}),
                       ErrorCode::invalid_file, {at("transforms.json"), "frame 'a.png'", words});
    }
    // A file with these values for all frames is refused.
    void expect_head_refused(const std::string& head, const std::string& words,
                             ErrorCode code = ErrorCode::invalid_file) const {
        expect_refused(write_json(head, {frame_json("a.png", matrix_at("0", "0", "0"))}), code,
                       {at("transforms.json"), "frame 'a.png'", words});
    }
    static std::uint64_t count_of(const PhotographSet& set, const std::string& words,
                                  const std::string& place) {
        for (const PhotographNote& note : set.notes)
            if (note.kind.find(words) != std::string::npos && note.place == place)
                return note.count;
        return 0;
    }

    std::filesystem::path folder_;
};

TEST_F(Photographs, ReadsNerfSynthetic) {
    write_picture("train/r_0.png");
    const double angle = 2 * std::atan(0.5);
    const PhotographSet set =
        read(write_json(R"("camera_angle_x":)" + std::to_string(angle) + ",",
                        {frame_json("./train/r_0", "[[1,0,0,5],[0,0,-1,6],[0,1,0,7],[0,0,0,1]]")}));
    ASSERT_EQ(set.photographs.size(), 1u);
    EXPECT_TRUE(set.notes.empty());
    const PosedPhotograph& photograph = set.photographs.front();
    EXPECT_EQ(photograph.name, "./train/r_0");
    EXPECT_EQ(photograph.path, at("train/r_0.png"));
    EXPECT_EQ(photograph.mask_path, "");
    const PhotoCamera& camera = photograph.camera;
    EXPECT_EQ(camera.width, 4u);
    EXPECT_EQ(camera.height, 2u);
    EXPECT_NEAR(camera.fx, 4, 1e-5);
    EXPECT_NEAR(camera.fy, 4, 1e-5) << "pixels are square";
    EXPECT_EQ(camera.cx, 2);
    EXPECT_EQ(camera.cy, 1);
    EXPECT_EQ(camera.eye, glm::dvec3(5, 6, 7));
    // The file's columns are right, up and back.
    EXPECT_EQ(camera.axes[0], glm::dvec3(1, 0, 0));
    EXPECT_EQ(camera.axes[1], glm::dvec3(0, 0, -1));
    EXPECT_EQ(camera.axes[2], glm::dvec3(0, 1, 0));
    EXPECT_EQ(camera.direction(2, 1), glm::dvec3(0, 1, 0));
}

TEST_F(Photographs, ReadsNerfstudio) {
    write_picture("images/a.jpg", 8, 6);
    write_picture("images/b.jpg", 8, 6);
    write_picture("masks/b.png", 8, 6);
    write_json(R"("w":8,"h":6,"fl_x":9,"fl_y":10,"cx":4.5,"cy":3.25,"k1":0.1,"k2":0.02,"p1":0.001,)"
               R"("p2":0.002,"camera_model":"OPENCV","applied_transform":)"
               R"([[0,1,0,0],[1,0,0,0],[0,0,-1,0]],)",
               {frame_json("images\\\\a.jpg", matrix_at("1", "2", "3")),
                frame_json("images/b.jpg", matrix_at("4", "5", "6"),
                           R"(,"mask_path":"masks/b.png","fl_x":11,"k1":0,"k3":0.03,"k4":0.004)")});
    const PhotographSet set = read(folder_.string());
    ASSERT_EQ(set.photographs.size(), 2u);
    const PhotoCamera &a = set.photographs[0].camera, &b = set.photographs[1].camera;
    EXPECT_EQ(set.photographs[0].path, at("images/a.jpg"));
    EXPECT_EQ(set.photographs[1].mask_path, at("masks/b.png"));
    EXPECT_EQ(a.fx, 9);
    EXPECT_EQ(a.fy, 10);
    EXPECT_EQ(a.cx, 4.5);
    EXPECT_EQ(a.cy, 3.25);
    EXPECT_EQ(a.distortion,
              (LensDistortion{.k1 = 0.1, .k2 = 0.02, .k3 = 0, .k4 = 0, .p1 = 0.001, .p2 = 0.002}));
    EXPECT_EQ(b.fx, 11);
    EXPECT_EQ(b.distortion.k1, 0);
    EXPECT_EQ(b.distortion.k3, 0.03);
    EXPECT_EQ(b.distortion.k4, 0.004);
    ASSERT_EQ(set.notes.size(), 1u);
    EXPECT_EQ(count_of(set, "applied_transform", at("transforms.json")), 1u);
}

TEST_F(Photographs, NamesMissingSurplusAndRepeatedPictures) {
    write_picture("p/b.png");
    write_picture("p/x.png");
    write_picture("p/y.png");
    spit(folder_ / "p" / "notes.txt", "no picture");
    const std::string path =
        write_json(R"("fl_x":5,)", {frame_json("p/a.png", matrix_at("0", "0", "0")),
                                    frame_json("p/b.png", matrix_at("0", "0", "0")),
                                    frame_json("./p/b.png", matrix_at("0", "0", "0")),
                                    frame_json("p/c.png", matrix_at("0", "0", "0"))});
    const PhotographSet set = read(path);
    ASSERT_EQ(set.photographs.size(), 1u);
    EXPECT_EQ(set.photographs.front().name, "p/b.png");
    EXPECT_EQ(set.notes.size(), 3u);
    EXPECT_EQ(count_of(set, "missing", at("p/a.png")), 2u);
    EXPECT_EQ(count_of(set, "repeats", at("p/b.png")), 1u);
    EXPECT_EQ(count_of(set, "belongs to no frame", at("p/x.png")), 2u);
}

TEST_F(Photographs, NeedsAPictureUnlessToldOtherwise) {
    const std::string frame = frame_json("p/a.png", matrix_at("0", "0", "0"));
    std::string path = write_json(R"("fl_x":5,"w":8,"h":6,)", {frame});
    expect_refused(path, ErrorCode::bad_argument,
                   {path, "none of its 1 pictures exists", at("p/a.png"), "--images"});
    const PhotographSet set = read(path, {.images = "", .with_pictures = false});
    ASSERT_EQ(set.photographs.size(), 1u);
    EXPECT_EQ(set.photographs.front().camera.width, 8u);
    path = write_json(R"("fl_x":5,)", {frame});
    expect_refused(path, ErrorCode::invalid_file, {"frame 'p/a.png'", "states no size"},
                   {.images = "", .with_pictures = false});
}

TEST_F(Photographs, ScalesCamerasWithTheirPictures) {
    write_picture("images_4/a.png", 2, 1); // 9 / 4 and 6 / 4, rounded down
    const std::string path = write_json(R"("w":9,"h":6,"fl_x":9,"fl_y":12,"cx":4.5,"cy":3,)",
                                        {frame_json("images/a.png", matrix_at("0", "0", "0"))});
    const PhotographSet set = read(path, {.images = at("images_4"), .with_pictures = true});
    ASSERT_EQ(set.photographs.size(), 1u);
    const PhotoCamera& camera = set.photographs.front().camera;
    EXPECT_EQ(camera.width, 2u);
    EXPECT_EQ(camera.height, 1u);
    EXPECT_DOUBLE_EQ(camera.fx, 2);
    EXPECT_DOUBLE_EQ(camera.fy, 2);
    EXPECT_DOUBLE_EQ(camera.cx, 1);
    EXPECT_DOUBLE_EQ(camera.cy, 0.5);
    EXPECT_EQ(count_of(set, "scaled", at("images_4/a.png")), 1u);
    write_picture("images_4/a.png", 5, 2);
    expect_refused(path, ErrorCode::invalid_file,
                   {path, "frame 'images/a.png'", "9x6", at("images_4/a.png"), "5x2"},
                   {.images = at("images_4"), .with_pictures = true});
}

// A picture of 4x2 pixels that should be turned by a right angle.
TEST_F(Photographs, LetsTheCameraDecideWhetherPicturesAreTurned) {
    const std::string picture = at("a.tif");
    TIFF* tiff = TIFFOpen(picture.c_str(), "w");
    ASSERT_NE(tiff, nullptr);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_RIGHTTOP);
    unsigned char rows[2][4] = {{0, 51, 102, 153}, {255, 204, 102, 51}};
    for (std::uint32_t y = 0; y < 2; ++y)
        TIFFWriteScanline(tiff, rows[y], y, 0);
    TIFFClose(tiff);

    const std::string frame = frame_json("a.tif", matrix_at("0", "0", "0"));
    const PhotographSet stored = read(write_json(R"("fl_x":5,"w":4,"h":2,)", {frame}));
    EXPECT_TRUE(stored.notes.empty());
    const auto as_stored = read_photograph(stored.photographs.front());
    ASSERT_TRUE(as_stored.ok()) << as_stored.status().message();
    EXPECT_FLOAT_EQ(as_stored->texels[1][0], 0.2f);

    const PhotographSet turned = read(write_json(R"("fl_x":5,"w":2,"h":4,)", {frame}));
    EXPECT_EQ(count_of(turned, "EXIF", picture), 1u);
    const auto as_turned = read_photograph(turned.photographs.front());
    ASSERT_TRUE(as_turned.ok()) << as_turned.status().message();
    EXPECT_FLOAT_EQ(as_turned->texels[0][0], 1.0f);
    EXPECT_FLOAT_EQ(as_turned->texels[3][0], 0.2f);

    expect_refused(write_json(R"("fl_x":5,"w":3,"h":3,)", {frame}), ErrorCode::invalid_file,
                   {"3x3", "4x2"});
}

TEST_F(Photographs, RefusesMatricesThatAreNoPoses) {
    write_picture("a.png");
    expect_matrix_refused("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,6,7,1]]", "is transposed");
    expect_matrix_refused("[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]", "is not 0 0 0 1");
    expect_matrix_refused("[[1,0,0,0],[0,-1,0,0],[0,0,1,0],[0,0,0,1]]", "mirrors");
    expect_matrix_refused("[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]", "scales by 2");
    expect_matrix_refused("[[1,0,0,0],[0,2,0,0],[0,0,1,0],[0,0,0,1]]", "skewed");
    expect_matrix_refused("[[1,0.1,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]", "skewed");
    expect_matrix_refused("[[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,1]]", "axes of length 0");
    expect_matrix_refused("[[1,0,0,0],[0,1,0,0]]", "not a matrix of 3x4 or 4x4");
    expect_matrix_refused("[[1,0,0,0],[0,1,0],[0,0,1,0]]", "row 2");
    expect_matrix_refused("[[1,0,0,0],[0,1,0,0],[0,0,1,null]]", "in row 3");
    expect_matrix_refused("[[1,0,0,1e300],[0,1,0,0],[0,0,1,0]]", "too far from the origin");
    expect_refused(write_json("", {R"({"file_path":"a.png"})"}), ErrorCode::invalid_file,
                   {"has no transform_matrix"});
}

// Rounded to float or to a few digits, matrices become rotations again.
TEST_F(Photographs, MakesRoundedMatricesRotations) {
    write_picture("a.png");
    const PhotographSet set = read(write_json(
        R"("fl_x":5,)", {frame_json("a.png", "[[0.866,-0.5,0,0],[0.5,0.866,0,0],[0,0,1,0]]")}));
    ASSERT_EQ(set.photographs.size(), 1u);
    const glm::dmat3& axes = set.photographs.front().camera.axes;
    EXPECT_NEAR(glm::dot(axes[0], axes[0]), 1, 1e-15);
    EXPECT_NEAR(glm::dot(axes[0], axes[1]), 0, 1e-15);
}

TEST_F(Photographs, RefusesLensesThatCannotBe) {
    write_picture("a.png");
    expect_head_refused("", "no focal length");
    expect_head_refused(R"("fl_x":0,)", "focal length is 0 pixels");
    expect_head_refused(R"("fl_x":5,"fl_y":-5,)", "focal length is -5 pixels");
    expect_head_refused(R"("fl_x":"5",)", "fl_x is not a number");
    expect_head_refused(R"("camera_angle_x":0,)", "camera_angle_x is 0");
    expect_head_refused(R"("camera_angle_x":3.2,)", "between 0 and pi");
    expect_head_refused(R"("fl_x":5,"w":4.5,)", "w is not a number of pixels");
    expect_head_refused(R"("fl_x":5,"w":0,)", "w is not a number of pixels");
    expect_head_refused(R"("fl_x":5,"w":100000,"h":9,)", "100000x9", ErrorCode::unsupported);
    expect_head_refused(R"("fl_x":5,"cx":1e300,)", "principal point");
    expect_head_refused(R"("fl_x":2,"k1":-2,)", "folds the picture");
    expect_head_refused(R"("fl_x":5,"camera_model":"OPENCV_FISHEYE",)", "'OPENCV_FISHEYE'",
                        ErrorCode::unsupported);
    expect_head_refused(R"("fl_x":5,"is_fisheye":true,)", "fisheye", ErrorCode::unsupported);
    expect_head_refused(R"("fl_x":5,"rolling_shutter":[0,0,1,0],)", "rolling shutter",
                        ErrorCode::unsupported);
    expect_head_refused(R"("fl_x":5,"k5":0.1,)", "rational", ErrorCode::unsupported);
}

TEST_F(Photographs, RefusesDamagedJson) {
    write_picture("a.png");
    const std::string path = at("transforms.json");
    const auto expect = [&](const std::string& text, const std::string& words,
                            ErrorCode code = ErrorCode::invalid_file) {
        spit(path, text);
        expect_refused(path, code, {path, words});
    };
    expect("", "line 1: not JSON");
    expect("{\n\"fl_x\": NaN}", "line 2: NaN is not a number");
    expect("{\n\n\"fl_x\": -Infinity}", "line 3: Infinity is not a number");
    expect("{\"fl_x\": 1e999}", "too large");
    expect("[]", "not a JSON object");
    expect("{}", "no list of frames");
    expect(R"({"frames":[]})", "has no frames");
    expect(R"({"frames":[5]})", "frames[0] is not an object");
    expect(R"({"frames":[{}]})", "frames[0]: has no file_path");
    expect(R"({"frames":[{"file_path":"a\u0000b"}]})", "file_path is not a path");
    expect(R"({"a":)" + std::string(100, '[') + std::string(100, ']') + "}", "nested");
    std::string many = R"({"frames":[0)";
    for (int i = 0; i < 100'000; ++i)
        many += ",0";
    expect(many + "]}", "100001 frames", ErrorCode::unsupported);
    std::string whole =
        transforms_json(R"("fl_x":5,)", {frame_json("a.png", matrix_at("0", "0", "0"))});
    for (std::size_t i = 0; i < 64; ++i)
        expect(whole.substr(0, i * whole.size() / 64), "not JSON");
}

TEST(PhotographNames, AreShortAndDiffer) {
    const auto names = [](const std::vector<std::string>& stated) {
        std::vector<PosedPhotograph> photographs;
        for (const std::string& name : stated)
            photographs.emplace_back().name = name;
        return names_of(photographs);
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names({"./train/r_0", "./train/r_1"}), (Names{"r_0", "r_1"}));
    EXPECT_EQ(names({"./train/r_0"}), (Names{"r_0"}));
    EXPECT_EQ(names({"p/left/1.JPG", "p/right/1.JPG"}), (Names{"left/1", "right/1"}));
    EXPECT_EQ(names({"train/a.png", "trainer/a.png"}), (Names{"train/a", "trainer/a"}));
    EXPECT_EQ(names({"a.png", "a.jpg"}), (Names{"a.png", "a.jpg"}));
    EXPECT_EQ(names({"frame.0001", "frame.0002"}), (Names{"frame.0001", "frame.0002"}));
    EXPECT_EQ(names({"../p/a.png", "../p/b.png"}), (Names{"a", "b"}));
    EXPECT_EQ(names({"../a.png", "b.png"}), (Names{"_/a", "b"}));
    EXPECT_EQ(names({"/abs/a.png", "/abs/b.png"}), (Names{"a", "b"}));
    EXPECT_EQ(names({"/", "a/"}), (Names{"_", "a"}));
    EXPECT_EQ(names({"a.png", "./a.png"}), (Names{"0", "1"}));
}

TEST_F(Photographs, SaysWhatAFolderLacks) {
    expect_refused(folder_.string(), ErrorCode::bad_argument,
                   {folder_.string(), "neither a transforms.json nor a COLMAP model"});
    spit(folder_ / "transforms_train.json", "{}");
    expect_refused(folder_.string(), ErrorCode::bad_argument,
                   {"name the file that you mean", at("transforms_train.json")});
    expect_refused(at("none.json"), ErrorCode::io, {at("none.json")});
    write_picture("a.png");
    expect_refused(write_json(R"("fl_x":5,)", {frame_json("a.png", matrix_at("0", "0", "0"),
                                                          R"(,"mask_path":"m.png")")}),
                   ErrorCode::io, {"frame 'a.png'", at("m.png"), "missing"});
}

} // namespace
} // namespace tessera::corpus
