// Tests the selection of views and their file names.
#include "tests/support/rendering.h"
#include "tools/view/render_views.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace tessera::test::rendering;

TEST(RenderViews, NumbersFiles) {
    ViewRequest request;
    request.output = "folder.d/out.png";
    auto plan = plan_views(request);
    ASSERT_TRUE(plan.ok());
    EXPECT_EQ(plan->front().output, "folder.d/out.png");
    request.views = "paper";
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 5u);
    EXPECT_EQ(plan->back().output, "folder.d/out-5.png");
    request.views = "2";
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 1u);
    expect_near(plan->front().camera.eye, {10, 0, -3});
    request.views.clear();
    request.orbit = 12;
    plan = plan_views(request);
    ASSERT_EQ(plan->size(), 12u);
    EXPECT_EQ(plan->front().output, "folder.d/out-01.png");
    EXPECT_EQ(plan->back().output, "folder.d/out-12.png");
    for (const char* size : {"0x5", "5", "x", "5x", "99999x5", "5x5x5", "-5x5"}) {
        request.size = size;
        EXPECT_FALSE(plan_views(request).ok()) << size;
    }
    request.size.clear();
    for (const char* eye : {"1,2", "1,2,3,4", "a,b,c", "1,,3", ","}) {
        request.eye = eye;
        EXPECT_FALSE(plan_views(request).ok()) << eye;
    }
}

} // namespace
} // namespace tessera
