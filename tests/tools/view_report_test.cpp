// The quality report of rendered views.
#include "tools/verbs/command.h"
#include "tools/view/view_report.h"

#include <cmath>
#include <gtest/gtest.h>
#include <optional>

namespace tessera {
namespace {

TEST(ViewReport, MeasuresAndFormatsViews) {
    Picture a = blank_picture(16, 16, 100), b = blank_picture(16, 16, 110);
    EXPECT_NEAR(likeness_of(a, b).psnr, 20 * std::log10(25.5), 1e-9);
    EXPECT_EQ(likeness_of(a, a).ssim, 1);
    EXPECT_TRUE(std::isinf(likeness_of(a, a).psnr));
    const ViewFigures figures = measure({"x", a, a, b});
    const std::string table = to_table({figures});
    EXPECT_NE(table.find("28.13"), std::string::npos) << table;
    EXPECT_NE(table.find("same"), std::string::npos) << table;
    EXPECT_EQ(to_panels({"x", a, a, b}).size(), 4u);
    EXPECT_EQ(to_panels({"x", std::nullopt, std::nullopt, b}).size(), 1u);
    EXPECT_TRUE(measure({"x", std::nullopt, std::nullopt, b}).empty());
}

} // namespace
} // namespace tessera
