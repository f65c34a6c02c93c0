#include "format/status.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>

namespace tessera {
namespace {

Result<int> half_of(int number) {
    if (number % 2 != 0)
        return Status(ErrorCode::bad_argument, std::to_string(number) + " is odd");
    return number / 2;
}

TEST(Result, SuccessWithoutAValueIsAnError) {
    const Result<int> made = Status();
    EXPECT_FALSE(made.ok());
    EXPECT_FALSE(made.status().ok());
    EXPECT_EQ(made.status().code(), ErrorCode::runtime);
    EXPECT_EQ(made.status().message(), "internal error: a result without a value");
}

TEST(Result, HasAValueOrAnError) {
    EXPECT_TRUE(half_of(6).status().ok());
    EXPECT_EQ(*half_of(6), 3);
    EXPECT_FALSE(half_of(7).ok());
    EXPECT_EQ(half_of(7).status().message(), "7 is odd");
}

// Returns the status of a successful result instead of its value. This easy mistake must give an
// error.
Result<int> forgets_the_value() {
    return half_of(6).status();
}

TEST(Result, SuccessStatusOfAnotherResultIsAnError) {
    EXPECT_EQ(forgets_the_value().status().code(), ErrorCode::runtime);
}

TEST(Result, AcceptsAContextLikeAStatus) {
    EXPECT_EQ(*half_of(6).with_context("six"), 3);
    EXPECT_TRUE(half_of(6).with_context("six").status().message().empty());
    const Result<int> bad = half_of(7).with_context("seven");
    EXPECT_EQ(bad.status().message(), "seven: 7 is odd");
    EXPECT_EQ(bad.status().code(), ErrorCode::bad_argument);
    Result<std::unique_ptr<int>> owned = std::make_unique<int>(5);
    EXPECT_EQ(**std::move(owned).with_context("five"), 5);
}

Status check_all(int a, int b, int& seen) {
    TESSERA_TRY(half_of(a));
    ++seen;
    TESSERA_TRY(half_of(b).status());
    ++seen;
    TESSERA_TRY(Status());
    ++seen;
    return {};
}

TEST(Try, AcceptsAStatusOrAResult) {
    int seen = 0;
    EXPECT_EQ(check_all(1, 2, seen).message(), "1 is odd");
    EXPECT_EQ(seen, 0);
    EXPECT_EQ(check_all(2, 1, seen).message(), "1 is odd");
    EXPECT_EQ(seen, 1);
    EXPECT_TRUE(check_all(2, 2, seen));
    EXPECT_EQ(seen, 4);
}

TEST(Try, EvaluatesOnce) {
    int calls = 0;
    const auto call = [&calls]() -> Result<int> {
        ++calls;
        return 1;
    };
    const auto twice = [&]() -> Status {
        TESSERA_TRY(call());
        TESSERA_TRY_ASSIGN(const int one, call());
        return one == 1 ? Status() : Status(ErrorCode::runtime, "another value");
    };
    EXPECT_TRUE(twice());
    EXPECT_EQ(calls, 2);
}

Result<int> quarter_of(int number) {
    TESSERA_TRY_ASSIGN(const int half, half_of(number));
    TESSERA_TRY_ASSIGN(int quarter, half_of(half));
    quarter += 0;
    return quarter;
}

TEST(TryAssign, GivesTheValueOrReturnsTheError) {
    EXPECT_EQ(*quarter_of(12), 3);
    EXPECT_EQ(quarter_of(5).status().message(), "5 is odd");
    EXPECT_EQ(quarter_of(6).status().message(), "3 is odd");
}

TEST(TryAssign, AssignsToAnExistingVariable) {
    const auto run = []() -> Result<int> {
        int value = 0;
        TESSERA_TRY_ASSIGN(value, half_of(8));
        return value;
    };
    EXPECT_EQ(*run(), 4);
}

TEST(TryAssign, MovesTheValue) {
    const auto make = [](int number) -> Result<std::unique_ptr<int>> {
        // A nested use, and commas in a template.
        TESSERA_TRY_ASSIGN(const int half, [&]() -> Result<int> {
            TESSERA_TRY_ASSIGN(const auto one, half_of(number));
            return std::map<int, int>{{0, one}}.at(0);
        }());
        return std::make_unique<int>(half);
    };
    const auto run = [&](int number) -> Result<int> {
        TESSERA_TRY_ASSIGN(const std::unique_ptr<int> owned, make(number));
        return *owned;
    };
    EXPECT_EQ(*run(10), 5);
    EXPECT_EQ(run(11).status().code(), ErrorCode::bad_argument);
}

} // namespace
} // namespace tessera
